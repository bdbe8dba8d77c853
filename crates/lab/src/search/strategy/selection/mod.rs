//! Selection of parents.

mod rank;
mod tournament;

use rand::Rng;

use realgap_core::Result;
use realgap_core::file::look_up;

/// Picks a parent by its fitness; larger is better, negative infinity is a failure, and NaN is worse than that.
pub trait Selection: Sync {
    /// Name in files and on the command line.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn doc(&self) -> &'static str;

    /// Index of the selected parent. `fitness` must not be empty; for an empty one the index is 0.
    fn pick(&self, fitness: &[f64], rng: &mut dyn Rng) -> usize;
}

/// Every selection.
pub const SELECTIONS: &[&dyn Selection] = &[&tournament::Tournament, &rank::Rank];

/// The selection of this name.
///
/// # Errors
/// An unknown name.
pub fn selection_named(name: &str) -> Result<&'static dyn Selection> {
    look_up("selection", name, SELECTIONS.iter().copied(), |selection| {
        selection.name()
    })
}

/// Fitness as it is compared: NaN below everything.
pub(super) fn comparable(fitness: f64) -> f64 {
    match fitness.is_nan() {
        true => f64::NEG_INFINITY,
        false => fitness,
    }
}
