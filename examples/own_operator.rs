#![allow(clippy::print_stdout)]
//! Shows how to write your own genetic operator: one type that implements `Operator`, a pure function of parents and generator.
//!
//! `cargo run --example own_operator`

use rand::{Rng, RngExt};
use realgap::Result;
use realgap::random::Numbered;
use realgap::robot::genome::Genome;
use realgap::search::{Operator, VariationParams};

/// A mutation that exchanges two modules.
struct Swap;

impl Operator for Swap {
    fn name(&self) -> &'static str {
        "swap"
    }
    fn doc(&self) -> &'static str {
        "two modules change places, with the probability `rate`"
    }
    fn is_crossover(&self) -> bool {
        false
    }
    fn vary(
        &self,
        first: &Genome,
        _: &Genome,
        params: &VariationParams,
        rng: &mut dyn Rng,
    ) -> Genome {
        if !rng.random_bool(params.rate) {
            return first.clone();
        }
        let mut genes = first.genes().to_vec();
        let (a, b) = (
            rng.random_range(0..genes.len()),
            rng.random_range(0..genes.len()),
        );
        genes.swap(a, b);
        Genome::new(genes).unwrap_or_else(|_| first.clone())
    }
}

fn main() -> Result<()> {
    let parent = Genome::random(4, &mut Numbered::SearchStep.generator(7, 0))?;
    let params = VariationParams {
        rate: 1.0,
        standard_deviation: 0.1,
        max_modules: parent.len(),
    };
    // One line in OPERATORS does the same for `operator: "swap"` in the file of a search.
    for step in 1..4 {
        let mut rng = Numbered::SearchStep.generator(7, step);
        let child = Swap.vary(&parent, &parent, &params, &mut rng);
        let kept = child
            .genes()
            .iter()
            .zip(parent.genes())
            .filter(|(a, b)| a == b);
        println!(
            "child {step}: {} of {} modules where they were",
            kept.count(),
            parent.len()
        );
    }
    Ok(())
}
