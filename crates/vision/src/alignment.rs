//! Aligns two pictures by the known positions of things in both, so that distances do not include the displacement of cameras.

use super::extractor::{Feature, Sought};
use super::picture::Grey;

/// Whether two pictures are aligned before the distance between them is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RelativeTo {
    /// Pictures are aligned by rotation and translation, from the positions that are known for each picture.
    #[default]
    Own,
    /// Pictures are compared without alignment.
    View,
}

/// The positions of the same point in two pictures, with a weight.
type Pair = ([f64; 2], [f64; 2], f64);

/// A rotation and translation in the plane of the picture. There is no scaling, because the size of things in a picture depends on
/// the lens, which is to be compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    turn: [f64; 2],
    from_px: [f64; 2],
    to_px: [f64; 2],
}

impl Motion {
    const NONE: Self = Self {
        turn: [1.0, 0.0],
        from_px: [0.0; 2],
        to_px: [0.0; 2],
    };

    /// The motion that brings the known points of one picture nearest to those of another (least squares); the identity if no point is
    /// known in both.
    pub(super) fn between(from: &Sought, to: &Sought) -> Self {
        let mut pairs: Vec<Pair> = Vec::new();
        if from.outline_px.len() == to.outline_px.len() {
            // All points of an outline together have the same weight as a template.
            let weight = 1.0 / from.outline_px.len().max(1) as f64;
            let both = from.outline_px.iter().zip(&to.outline_px);
            pairs.extend(both.map(|(a, b)| (*a, *b, weight)));
        }
        if let (Some(a), Some(b)) = (from.template_at_px, to.template_at_px) {
            pairs.push((a, b, 1.0));
        }
        let sum: f64 = pairs.iter().map(|p| p.2).sum();
        if pairs.is_empty() || pairs.iter().all(|(a, b, _)| a == b) {
            return Self::NONE;
        }
        let middle = |of: fn(&Pair) -> [f64; 2]| {
            [0, 1].map(|k| pairs.iter().map(|p| p.2 * of(p)[k]).sum::<f64>() / sum)
        };
        let (from_px, to_px) = (middle(|p| p.0), middle(|p| p.1));
        let (mut along, mut across) = (0.0, 0.0);
        for (a, b, weight) in &pairs {
            let a = [a[0] - from_px[0], a[1] - from_px[1]];
            let b = [b[0] - to_px[0], b[1] - to_px[1]];
            along += weight * (a[0] * b[0] + a[1] * b[1]);
            across += weight * (a[0] * b[1] - a[1] * b[0]);
        }
        let length = along.hypot(across);
        let turn = if length > 0.0 {
            [along / length, across / length]
        } else {
            [1.0, 0.0]
        };
        Self {
            turn,
            from_px,
            to_px,
        }
    }

    fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([cos, sin], [x, y]) = (self.turn, [x - self.from_px[0], y - self.from_px[1]]);
        [
            self.to_px[0] + cos * x - sin * y,
            self.to_px[1] + sin * x + cos * y,
        ]
    }

    fn reversed(&self) -> Self {
        Self {
            turn: [self.turn[0], -self.turn[1]],
            from_px: self.to_px,
            to_px: self.from_px,
        }
    }

    /// The feature after the motion. A map is 0 beyond the border of the picture.
    pub(super) fn moved(&self, feature: &Feature) -> Feature {
        if *self == Self::NONE {
            return feature.clone();
        }
        let back = self.reversed();
        let map = feature.map.as_ref().map(|map| {
            let (right, low) = (map.width() as f64 - 1.0, map.height() as f64 - 1.0);
            Grey::from_fn(map.width(), map.height(), |x, y| {
                let [x, y] = back.of([x as f64, y as f64]);
                if (0.0..=right).contains(&x) && (0.0..=low).contains(&y) {
                    map.between(x, y)
                } else {
                    0.0
                }
            })
        });
        Feature {
            map,
            points_px: feature.points_px.iter().map(|p| self.of(*p)).collect(),
            text: feature.text.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alignment_undoes_a_rotation_and_translation_of_a_picture() {
        let (sin, cos) = 0.1_f64.sin_cos();
        let moved = |[x, y]: [f64; 2]| [cos * x - sin * y + 7.0, sin * x + cos * y - 3.0];
        let known = |of: &dyn Fn([f64; 2]) -> [f64; 2]| Sought {
            outline_px: [[10.0, 10.0], [40.0, 12.0], [30.0, 50.0]].map(of).to_vec(),
            template_at_px: Some(of([80.0, 60.0])),
            ..Sought::default()
        };
        let (a, b) = (known(&|p| p), known(&moved));
        let feature = Feature {
            points_px: vec![[25.0, 33.0]],
            ..Feature::default()
        };
        let there = Motion::between(&a, &b).moved(&feature).points_px[0];
        let wanted = moved([25.0, 33.0]);
        assert!((there[0] - wanted[0]).hypot(there[1] - wanted[1]) < 1e-9);
        let back = Motion::between(&b, &a).moved(&Feature {
            points_px: vec![wanted],
            ..Feature::default()
        });
        assert!((back.points_px[0][0] - 25.0).abs() < 1e-9);
        // If no point is known in one picture, or if both have the same points, there is no motion.
        assert_eq!(Motion::between(&a, &Sought::default()), Motion::NONE);
        assert_eq!(Motion::between(&a, &a), Motion::NONE);
        // A map is moved in the same way as points.
        let dot = Grey::from_fn(60, 50, |x, y| f32::from(u8::from((x, y) == (20, 30))));
        let place = |x: f64| Sought {
            template_at_px: Some([x, 10.0]),
            ..Sought::default()
        };
        let map = Motion::between(&place(5.0), &place(9.0)).moved(&Feature {
            map: Some(dot),
            ..Feature::default()
        });
        assert_eq!(
            map.map.map(|m| (m.at(24, 30), m.at(20, 30))),
            Some((1.0, 0.0))
        );
    }
}
