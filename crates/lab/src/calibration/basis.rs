//! Where the basis of the `pca` metric comes from.

use std::path::Path;

use super::study::Study;
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;
use realgap_path::comparison::Basis;
use realgap_path::trajectory::Prepared;
use realgap_store::CaseRow;

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

/// The basis of a study's scores: of all recordings and all completed simulations, diverged ones left out, unless the study
/// knows it beforehand; `None` where the metric needs none.
///
/// # Errors
/// Paths from which no basis can be built.
pub(super) fn basis<'a>(
    study: &Study,
    rows: impl IntoIterator<Item = &'a CaseRow>,
) -> Result<Option<Basis>> {
    let definition = study.definition();
    if !definition.metric.needs().basis {
        return Ok(None);
    }
    let real = study.real_paths();
    match &definition.basis {
        BasisRule::Saved { basis, .. } => Ok(Some((**basis).clone())),
        BasisRule::Recordings => {
            let fitted = study.part_of(&real, false);
            let basis = Basis::fit(&fitted, definition.components)?;
            if basis.kept() == 0 {
                return Err(Error::invalid("these recordings have no principal components")
                    .field("basis")
                    .found(format!("{} that do not differ", fitted.len()))
                    .allowed("at least two different recordings")
                    .hint("record more repeats, or let the simulations have their say: basis: Everything"));
            }
            Ok(Some(basis))
        }
        BasisRule::Everything => {
            let simulated: Vec<Prepared> = rows
                .into_iter()
                .filter_map(CaseRow::completed)
                .map(|result| Prepared::from_xy_m(result.path_xy_m.clone()))
                .collect::<Result<_>>()?;
            let all: Vec<&Prepared> = real.iter().copied().chain(&simulated).collect();
            Basis::fit(&all, definition.components).map(Some)
        }
    }
}
