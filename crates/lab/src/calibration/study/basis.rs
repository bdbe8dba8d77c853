//! Where the basis of the `pca` metric comes from.

use std::path::Path;

use realgap_core::Result;
use realgap_core::file::Source;
use realgap_path::comparison::Basis;

/// Where the basis of the `pca` metric comes from.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum BasisRule {
    /// The recordings and every simulation that is compared with them (paper 003, section 2.2).
    #[default]
    Everything,
    /// The recordings that are fitted alone: what reality does, whatever was simulated.
    Recordings,
    /// A basis that was saved, so that numbers of different studies can be compared.
    Saved {
        /// The basis.
        basis: Box<Basis>,
        /// This is the check sum of its file.
        sha256: String,
    },
}

impl BasisRule {
    /// A basis as a results folder holds it or a comparison saved it.
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

    /// Whether it is known before anything is simulated.
    pub fn is_known(&self) -> bool {
        *self != Self::Everything
    }

    /// For people.
    pub fn label(&self) -> String {
        match self {
            Self::Everything => "recordings and simulations".to_owned(),
            Self::Recordings => "recordings".to_owned(),
            Self::Saved { sha256, .. } => format!("saved, sha256 {sha256}"),
        }
    }
}
