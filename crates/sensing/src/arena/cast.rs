//! Casts beams in an arena: the first hit of a beam, and the walls between two points.

use super::{Arena, Object, Shape};

/// The first hit of a beam on an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the beam, metres; 0 if the beam begins inside of the object.
    pub distance_m: f64,
    /// Angle between the beam and the normal of the surface, radians, 0 to π/2.
    pub incidence_rad: f64,
    /// Angle between the sensor's axis and the beam, radians; 0 for a single beam.
    pub offset_rad: f64,
    /// Index of the object.
    pub object: usize,
}

impl Arena {
    /// The first hit of a beam from a point in a direction (radians from +x); `None` if the beam hits no object.
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

    /// The nearest hit of several beams that are spread evenly over a cone of this half angle about a direction; with one beam, the
    /// hit along the direction itself.
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

/// Factor on the squared radius in [`Object::may_meet`] that allows for rounding errors.
const ROUNDING: f64 = 1.0 + 1e-9;

/// A wall between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Length of the line within the wall, metres.
    pub thickness_m: f64,
    /// Index of the object; if the wall consists of several objects, the one with the longest part of the line.
    pub object: usize,
}

impl Arena {
    /// The walls between two points, in order. Objects that touch each other along the line count as one wall. An object that contains
    /// one of the two points is not counted.
    pub fn crossings(&self, from_m: [f64; 2], to_m: [f64; 2]) -> Vec<Crossing> {
        let [dx, dy] = [to_m[0] - from_m[0], to_m[1] - from_m[1]];
        let length_m = dx.hypot(dy);
        if length_m == 0.0 {
            return Vec::new();
        }
        let direction = [dx / length_m, dy / length_m];
        let mut spans: Vec<(f64, f64, usize)> = self
            .objects
            .iter()
            .enumerate()
            .filter_map(|(index, object)| {
                let span = object.span(from_m, direction)?;
                let is_between = span.enter_m > 0.0 && span.leave_m < length_m;
                // An object that the line touches at a corner only is not crossed.
                let is_crossed = span.leave_m - span.enter_m > 1e-9;
                (is_between && is_crossed).then_some((span.enter_m, span.leave_m, index))
            })
            .collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut walls: Vec<(f64, f64, f64, usize)> = Vec::new();
        for (enter, leave, object) in spans {
            let own = leave - enter;
            match walls.last_mut() {
                Some(last) if enter <= last.1 + TOUCHING_M => {
                    last.1 = last.1.max(leave);
                    if own > last.2 {
                        (last.2, last.3) = (own, object);
                    }
                }
                _ => walls.push((enter, leave, own, object)),
            }
        }
        walls
            .into_iter()
            .map(|(enter, leave, _, object)| Crossing {
                thickness_m: leave - enter,
                object,
            })
            .collect()
    }
}

/// Objects that are this near to each other along a line are one wall, metres.
const TOUCHING_M: f64 = 1e-6;

/// The part of a line that lies in an object.
struct Span {
    /// Where the line enters the object, metres along the line; may be negative.
    enter_m: f64,
    /// Where the line leaves the object, metres along the line.
    leave_m: f64,
    /// Cosine of the angle between the line and the normal of the surface where the line enters.
    along_normal: f64,
}

impl Object {
    /// A fast test: false if a beam misses the circle around the object. Most beams miss most objects.
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
    fn meet(&self, from_m: [f64; 2], direction: [f64; 2]) -> Option<(f64, f64)> {
        let span = self.span(from_m, direction)?;
        (span.leave_m >= 0.0).then(|| (span.enter_m.max(0.0), span.along_normal))
    }

    /// The part of a line of unit direction that lies in the object.
    fn span(&self, from_m: [f64; 2], [cos, sin]: [f64; 2]) -> Option<Span> {
        let [x, y] = self.local(from_m);
        match self.shape {
            Shape::Circle { radius_m } => {
                let along = -(x * cos + y * sin);
                let off2 = x * x + y * y - along * along;
                let half2 = radius_m * radius_m - off2;
                (half2 >= 0.0).then(|| Span {
                    enter_m: along - half2.sqrt(),
                    leave_m: along + half2.sqrt(),
                    along_normal: half2.sqrt() / radius_m,
                })
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
                (near <= far).then(|| Span {
                    enter_m: near,
                    leave_m: far,
                    along_normal: direction[axis].abs(),
                })
            }
        }
    }
}
