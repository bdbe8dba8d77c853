//! Operators: they make one child from parents.
//!
//! One file and one line in [`OPERATORS`] add another; `tests/strategy_contract.rs` checks the same contract for all of them.

mod gaussian;
mod length;
mod one_point;
mod uniform;

use rand::Rng;

use realgap_core::Result;
use realgap_core::file::look_up;
use realgap_core::range::Range;
use realgap_robot::genome::{Gene, Genome};

/// How much an operator may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VariationParams {
    /// Probability that it acts: on each number (`gaussian`), or on the genome (all others). At 0 the child equals the first
    /// parent.
    pub rate: f64,
    /// Standard deviation of a change of a number, as a share of its range (`gaussian` only).
    pub standard_deviation: f64,
    /// Most modules of a child, at least 1.
    pub max_modules: usize,
}

impl VariationParams {
    /// Checks every number.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn check(&self) -> Result<()> {
        let share = Range::within(0.0, 1.0, "");
        share.check(self.rate, "rate")?;
        share.check(self.standard_deviation, "standard_deviation")?;
        let modules = Range::within(1.0, Genome::MAX_MODULES as f64, "");
        modules.check(self.max_modules as f64, "max_modules")
    }
}

/// Makes one child. The child's numbers are from 0 to 1, and it has at most `max_modules` modules unless its parents have more.
/// The same parents, parameters and generator state give the same child.
pub trait Operator: Sync {
    /// Name in files and on the command line.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn doc(&self) -> &'static str;

    /// Whether it needs two different parents; otherwise the second is not used.
    fn is_crossover(&self) -> bool {
        false
    }

    /// The child.
    fn vary(
        &self,
        first: &Genome,
        second: &Genome,
        params: &VariationParams,
        rng: &mut dyn Rng,
    ) -> Genome;
}

/// Every operator.
pub const OPERATORS: &[&dyn Operator] = &[
    &gaussian::Gaussian,
    &length::Length::Add,
    &length::Length::Remove,
    &length::Length::Duplicate,
    &one_point::OnePoint,
    &uniform::Uniform,
];

/// The operator of this name.
///
/// # Errors
/// An unknown name.
pub fn operator_named(name: &str) -> Result<&'static dyn Operator> {
    look_up("operator", name, OPERATORS.iter().copied(), |operator| {
        operator.name()
    })
}

/// The child with these genes, or the parent where they do not form a genome.
fn child_or(parent: &Genome, genes: Vec<Gene>) -> Genome {
    Genome::new(genes).unwrap_or_else(|_| parent.clone())
}
