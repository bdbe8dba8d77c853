//! Tournament selection: the best of a few.

use rand::{Rng, RngExt};

use super::{Selection, comparable};

/// Number of entrants, drawn with replacement.
const ENTRANTS: usize = 2;

/// Draws two evenly and keeps the fitter one; of equals the one that was drawn first.
pub(super) struct Tournament;

impl Selection for Tournament {
    realgap_core::constant_methods! {
        name: &'static str = "tournament";
        doc: &'static str = "draws two evenly and keeps the fitter";
    }

    fn pick(&self, fitness: &[f64], rng: &mut dyn Rng) -> usize {
        if fitness.is_empty() {
            return 0;
        }
        let mut winner = rng.random_range(0..fitness.len());
        for _ in 1..ENTRANTS {
            let other = rng.random_range(0..fitness.len());
            if comparable(fitness[other]) > comparable(fitness[winner]) {
                winner = other;
            }
        }
        winner
    }
}
