//! Where the basis of the `pca` metric comes from.

use std::path::Path;

use realgap_core::Result;
use realgap_core::file::Source;
use realgap_path::comparison::Basis;

/// Where the basis of the `pca` metric comes from.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum BasisRule {
    /// The basis is fitted on the recordings and on every simulation that is compared with them (paper 003, section 2.2).
    #[default]
    Everything,
    /// The basis is fitted on the fitted recordings alone, so that it does not depend on what was simulated.
    Recordings,
    /// A basis that was saved before, so that the scores of different studies can be compared.
    Saved {
        /// The basis.
        basis: Box<Basis>,
        /// Checksum of its file.
        sha256: String,
    },
}

impl BasisRule {
    /// Reads a basis from a results folder, or one that a comparison saved.
    ///
    /// # Errors
    /// A file that cannot be read or holds no basis.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let source = Source::read(path.as_ref(), "basis")?;
        Ok(Self::Saved {
            basis: Box::new(Basis::parse(&source)?),
            sha256: source.sha256(),
        })
    }

    /// Whether the basis is known before anything is simulated.
    pub fn is_known(&self) -> bool {
        *self != Self::Everything
    }

    /// A short description for reports.
    pub fn label(&self) -> String {
        match self {
            Self::Everything => "recordings and simulations".to_owned(),
            Self::Recordings => "recordings".to_owned(),
            Self::Saved { sha256, .. } => format!("saved, sha256 {sha256}"),
        }
    }
}
