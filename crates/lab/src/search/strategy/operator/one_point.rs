//! One-point crossover: the first modules of one parent, the rest of the other.

use rand::{Rng, RngExt};

use super::{Operator, VariationParams, child_or};
use realgap_robot::genome::Genome;

/// Cuts both parents behind the same module.
pub(super) struct OnePoint;

impl Operator for OnePoint {
    realgap_core::constant_methods! {
        name: &'static str = "one-point";
        doc: &'static str = "the first modules of one parent and the rest of the other, with the probability `rate`";
        is_crossover: bool = true;
    }

    fn vary(
        &self,
        first: &Genome,
        second: &Genome,
        params: &VariationParams,
        rng: &mut dyn Rng,
    ) -> Genome {
        if !rng.random_bool(params.rate) {
            return first.clone();
        }
        let cut = rng.random_range(1..=first.len().min(second.len()));
        let mut genes = first.genes()[..cut].to_vec();
        genes.extend_from_slice(&second.genes()[cut..]);
        child_or(first, genes)
    }
}
