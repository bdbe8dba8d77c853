//! Small changes of single numbers.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use super::{Operator, VariationParams, child_or};
use realgap_robot::genome::{Gene, Genome, Locus};

/// Adds a normal random number to each number, with the probability of the rate.
pub(super) struct Gaussian;

impl Operator for Gaussian {
    realgap_core::constant_methods! {
        name: &'static str = "gaussian";
        doc: &'static str = "adds a normal change to each number, with the probability `rate`";
    }

    fn vary(
        &self,
        first: &Genome,
        _second: &Genome,
        params: &VariationParams,
        rng: &mut dyn Rng,
    ) -> Genome {
        let genes = first.genes().iter().map(|gene| {
            let mut values = *gene.values();
            for (locus, value) in Locus::ALL.into_iter().zip(&mut values) {
                if rng.random_bool(params.rate) {
                    let normal: f64 = StandardNormal.sample(rng);
                    let moved = *value + normal * params.standard_deviation;
                    *value = if locus.is_periodic() {
                        moved.rem_euclid(1.0)
                    } else {
                        reflect(moved)
                    };
                }
            }
            Gene::clamped(values)
        });
        let genes = genes.collect();
        child_or(first, genes)
    }
}

/// Reflects a value into 0 to 1 at either end; clamping would accumulate numbers at the ends.
fn reflect(value: f64) -> f64 {
    let folded = value.rem_euclid(2.0);
    if folded > 1.0 { 2.0 - folded } else { folded }
}

#[cfg(test)]
mod tests {
    use super::reflect;

    #[test]
    fn what_leaves_at_an_end_comes_back_from_it() {
        for (value, expected) in [(0.25, 0.25), (-0.25, 0.25), (1.25, 0.75), (2.25, 0.25)] {
            assert_eq!(reflect(value), expected);
        }
    }
}
