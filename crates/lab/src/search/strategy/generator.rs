//! Random numbers of a search: every step has a generator of its own.

use realgap_core::random::{Generator, Numbered};

/// The generator of step number `step` of the search with this seed. Steps are independent, so that any step can be repeated
/// without those before it.
pub fn generator(seed: u64, step: u64) -> Generator {
    Numbered::SearchStep.generator(seed, step)
}
