//! Who compares pictures, and how.

use super::alignment::RelativeTo;
use super::extractor::Extractor;
use super::registry::own_extractors;

/// How pictures are compared.
#[derive(Clone)]
pub struct VisionOptions {
    /// Who looks at them.
    pub extractors: Vec<&'static dyn Extractor>,
    /// What distances are relative to.
    pub relative_to: RelativeTo,
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Default for VisionOptions {
    /// All extractors that need no other program.
    fn default() -> Self {
        Self {
            extractors: own_extractors(),
            relative_to: RelativeTo::default(),
            seed: 1,
        }
    }
}
