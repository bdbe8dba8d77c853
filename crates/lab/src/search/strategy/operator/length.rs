//! Changes of the number of modules.

use rand::{Rng, RngExt};

use super::{Operator, VariationParams, child_or};
use realgap_robot::genome::{Gene, Genome};

/// One module more or fewer.
pub(super) enum Length {
    /// Inserts a random gene at a random place.
    Add,
    /// Removes a random gene.
    Remove,
    /// Inserts a copy of a random gene behind it.
    Duplicate,
}

impl Operator for Length {
    fn name(&self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Remove => "remove",
            Self::Duplicate => "duplicate",
        }
    }

    fn doc(&self) -> &'static str {
        match self {
            Self::Add => "inserts a random module, with the probability `rate`, up to the most",
            Self::Remove => {
                "removes a module, with the probability `rate`, but never the last one left"
            }
            Self::Duplicate => {
                "copies a module behind itself, with the probability `rate`, up to the most"
            }
        }
    }

    fn vary(
        &self,
        first: &Genome,
        _second: &Genome,
        params: &VariationParams,
        rng: &mut dyn Rng,
    ) -> Genome {
        let mut genes = first.genes().to_vec();
        let has_room = match self {
            Self::Add | Self::Duplicate => genes.len() < params.max_modules,
            Self::Remove => genes.len() > 1,
        };
        if !rng.random_bool(params.rate) || !has_room {
            return first.clone();
        }
        match self {
            Self::Add => {
                let at = rng.random_range(0..=genes.len());
                genes.insert(at, Gene::random(rng));
            }
            Self::Remove => {
                genes.remove(rng.random_range(0..genes.len()));
            }
            Self::Duplicate => {
                let at = rng.random_range(0..genes.len());
                genes.insert(at, genes[at]);
            }
        }
        child_or(first, genes)
    }
}
