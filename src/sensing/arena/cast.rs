//! What a beam meets.

use super::{Arena, Object, Shape};

/// Where a beam meets an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the beam, metres; 0 where the beam begins inside of the object.
    pub distance_m: f64,
    /// Angle between the beam and the normal of the surface, radians, 0 to π/2.
    pub incidence_rad: f64,
    /// Angle between the sensor's axis and the beam, radians; 0 but in a cone.
    pub offset_rad: f64,
    /// Index of the object.
    pub object: usize,
}

impl Arena {
    /// What a beam from a point in a direction (radians from +x) meets first; `None` where nothing stands in its way.
    pub fn cast(&self, from_m: [f64; 2], direction_rad: f64) -> Option<Hit> {
        let (sin, cos) = direction_rad.sin_cos();
        let mut nearest: Option<(f64, f64, usize)> = None;
        for (index, object) in self.objects.iter().enumerate() {
            if !object.may_meet(from_m, [cos, sin]) {
                continue;
            }
            let Some((distance, normal)) = object.meet(from_m, [cos, sin]) else {
                continue;
            };
            if nearest.is_none_or(|(known, ..)| distance < known) {
                nearest = Some((distance, normal, index));
            }
        }
        nearest.map(|(distance_m, along_normal, object)| Hit {
            distance_m,
            incidence_rad: libm::acos(along_normal.clamp(0.0, 1.0)),
            offset_rad: 0.0,
            object,
        })
    }

    /// What the nearest of several beams meets, spread evenly over a cone of this half angle about a direction; the ideal line for one
    /// beam.
    pub fn cast_cone(
        &self,
        from_m: [f64; 2],
        direction_rad: f64,
        half_angle_rad: f64,
        beams: usize,
    ) -> Option<Hit> {
        let offset = |k: usize| match beams {
            0 | 1 => 0.0,
            beams => half_angle_rad * (2.0 * k as f64 / (beams - 1) as f64 - 1.0),
        };
        (0..beams.max(1))
            .filter_map(|k| {
                let hit = self.cast(from_m, direction_rad + offset(k))?;
                Some(Hit {
                    offset_rad: offset(k).abs(),
                    ..hit
                })
            })
            .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }
}

/// Room for rounding in [`Object::may_meet`].
const ROUNDING: f64 = 1.0 + 1e-9;

impl Object {
    /// False where a beam passes the circle around the object: most beams pass most objects.
    fn may_meet(&self, from_m: [f64; 2], [cos, sin]: [f64; 2]) -> bool {
        let radius2 = match self.shape {
            Shape::Circle { radius_m } => radius_m * radius_m,
            Shape::Box {
                half_m: [hx, hy], ..
            } => hx * hx + hy * hy,
        } * ROUNDING;
        let [dx, dy] = [self.centre_m[0] - from_m[0], self.centre_m[1] - from_m[1]];
        let (across, along) = (dx * sin - dy * cos, dx * cos + dy * sin);
        across * across <= radius2 && (along >= 0.0 || along * along <= radius2)
    }

    /// Distance along a beam of unit direction, and the cosine of its angle of incidence.
    fn meet(&self, from_m: [f64; 2], [cos, sin]: [f64; 2]) -> Option<(f64, f64)> {
        let [x, y] = self.local(from_m);
        match self.shape {
            Shape::Circle { radius_m } => {
                let along = -(x * cos + y * sin);
                let off2 = x * x + y * y - along * along;
                let half2 = radius_m * radius_m - off2;
                if half2 < 0.0 || (along < 0.0 && x * x + y * y > radius_m * radius_m) {
                    return None;
                }
                let distance = (along - half2.sqrt()).max(0.0);
                Some((distance, half2.sqrt() / radius_m))
            }
            Shape::Box {
                half_m,
                turn: [c, s],
            } => {
                let direction = [c * cos + s * sin, c * sin - s * cos];
                let (mut near, mut far, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 0);
                for (k, (place, half)) in [x, y].into_iter().zip(half_m).enumerate() {
                    if direction[k].abs() < 1e-12 {
                        if place.abs() > half {
                            return None;
                        }
                        continue;
                    }
                    let (a, b) = (
                        (-half - place) / direction[k],
                        (half - place) / direction[k],
                    );
                    let (enter, leave) = (a.min(b), a.max(b));
                    if enter > near {
                        (near, axis) = (enter, k);
                    }
                    far = far.min(leave);
                }
                (near <= far && far >= 0.0).then(|| (near.max(0.0), direction[axis].abs()))
            }
        }
    }
}
