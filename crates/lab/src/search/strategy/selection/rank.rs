//! Rank selection: only the order of the fitnesses matters.

use rand::{Rng, RngExt};

use super::{Selection, comparable};

/// Picks with a probability that falls linearly from the fittest (n shares) to the least fit (one share).
pub(super) struct Rank;

impl Selection for Rank {
    realgap_core::constant_methods! {
        name: &'static str = "rank";
        doc: &'static str = "picks with a probability that falls linearly with the rank";
    }

    fn pick(&self, fitness: &[f64], rng: &mut dyn Rng) -> usize {
        let count = fitness.len();
        if count == 0 {
            return 0;
        }
        let mut order: Vec<usize> = (0..count).collect();
        // The sort is stable: of equals, the earlier one ranks higher.
        order.sort_by(|&a, &b| comparable(fitness[b]).total_cmp(&comparable(fitness[a])));
        let mut ticket = rng.random_range(0..count * (count + 1) / 2);
        for (rank, &index) in order.iter().enumerate() {
            let shares = count - rank;
            if ticket < shares {
                return index;
            }
            ticket -= shares;
        }
        order[count - 1]
    }
}
