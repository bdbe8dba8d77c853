//! Uniform crossover: every number is from either parent.

use rand::{Rng, RngExt};

use super::{Operator, VariationParams, child_or};
use realgap_robot::genome::{Gene, Genome};

/// Chooses the length, and every number that both parents have, from either parent with equal probability.
pub(super) struct Uniform;

impl Operator for Uniform {
    realgap_core::constant_methods! {
        name: &'static str = "uniform";
        doc: &'static str = "every number from either parent, and the length of either, with the probability `rate`";
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
        let frame = if rng.random() { first } else { second };
        let genes = frame
            .genes()
            .iter()
            .enumerate()
            .map(|(index, &own)| {
                match (first.genes().get(index), second.genes().get(index)) {
                    (Some(a), Some(b)) => Gene::clamped(std::array::from_fn(|number| {
                        let from = if rng.random() { a } else { b };
                        from.values()[number]
                    })),
                    // Only the parent that gives the length has this module.
                    _ => own,
                }
            })
            .collect();
        child_or(first, genes)
    }
}
