//! Options of comparing pictures.

use super::alignment::RelativeTo;
use super::extractor::Extractor;
use super::registry::own_extractors;

/// Options of comparing pictures.
#[derive(Clone)]
pub struct VisionOptions {
    /// The feature extractors that are used.
    pub extractors: Vec<&'static dyn Extractor>,
    /// Whether pictures are aligned before distances are computed.
    pub relative_to: RelativeTo,
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Default for VisionOptions {
    /// The default is to use all extractors that need no other program.
    fn default() -> Self {
        Self {
            extractors: own_extractors(),
            relative_to: RelativeTo::default(),
            seed: 1,
        }
    }
}
