//! A link: what lies between two places.

use crate::arena::Arena;

/// Nearer than this a distance counts as this, metres: the logarithm has no zero.
const NEAREST_M: f64 = 0.1;

/// What lies between a sender and a receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Distance in space, metres; at least 0.1.
    pub distance_m: f64,
    /// Material and thickness (metres along the ray) of every wall between, in order.
    pub crossed: Vec<(String, f64)>,
}

impl Link {
    /// The link between two places (x, y and height, metres). Walls reach from floor to ceiling.
    pub fn new(arena: &Arena, from_m: [f64; 3], to_m: [f64; 3]) -> Self {
        let apart = [0, 1, 2].map(|k| to_m[k] - from_m[k]);
        let level_m = apart[0].hypot(apart[1]);
        let distance_m = level_m.hypot(apart[2]);
        // A slanted ray is longer in a wall than its shadow on the floor.
        let slant = if level_m > 0.0 {
            distance_m / level_m
        } else {
            1.0
        };
        let crossed = arena
            .crossings([from_m[0], from_m[1]], [to_m[0], to_m[1]])
            .into_iter()
            .map(|crossing| {
                let material = arena.objects[crossing.object].material.clone();
                (material, slant * crossing.thickness_m)
            })
            .collect();
        Self {
            distance_m: distance_m.max(NEAREST_M),
            crossed,
        }
    }

    /// How many walls are between.
    pub fn walls(&self) -> usize {
        self.crossed.len()
    }

    /// Their thickness along the ray, all together, metres.
    pub fn thickness_m(&self) -> f64 {
        self.crossed
            .iter()
            .map(|(_, thickness_m)| thickness_m)
            .sum()
    }
}
