//! The link between two positions: its length and the walls that it crosses.

use crate::arena::Arena;

/// Smallest distance of a link, metres; smaller distances are set to this value because the logarithm of 0 is not finite.
const NEAREST_M: f64 = 0.1;

/// The distance and the walls between a sender and a receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Distance in space, metres; at least 0.1.
    pub distance_m: f64,
    /// Material and thickness (metres along the ray) of every wall between sender and receiver, in order.
    pub crossed: Vec<(String, f64)>,
}

impl Link {
    /// The link between two positions (x, y and height, metres). Walls reach from floor to ceiling.
    pub fn new(arena: &Arena, from_m: [f64; 3], to_m: [f64; 3]) -> Self {
        let difference_m = [0, 1, 2].map(|k| to_m[k] - from_m[k]);
        let level_m = difference_m[0].hypot(difference_m[1]);
        let distance_m = level_m.hypot(difference_m[2]);
        // The part of a slanted ray inside of a wall is longer than its projection onto the floor.
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

    /// Number of walls between sender and receiver.
    pub fn walls(&self) -> usize {
        self.crossed.len()
    }

    /// Sum of the thicknesses of all walls along the ray, metres.
    pub fn thickness_m(&self) -> f64 {
        self.crossed
            .iter()
            .map(|(_, thickness_m)| thickness_m)
            .sum()
    }
}
