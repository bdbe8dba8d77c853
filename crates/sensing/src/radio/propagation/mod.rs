//! Propagation models: the strength of a signal as a function of distance and walls. Each model is one file and one line of
//! [`PROPAGATIONS`].

mod free_space;
mod log_distance;
mod material;
mod thickness;
mod wall;

pub use free_space::FreeSpace;
pub use log_distance::LogDistance;
pub use material::Materials;
pub use thickness::Thickness;
pub use wall::Walls;

use super::link::Link;
use realgap_core::error::Result;
use realgap_core::file::look_up;

/// Every model that a log is fitted with, simplest first.
pub const PROPAGATIONS: [&dyn Propagation; 5] =
    [&FreeSpace, &LogDistance, &Walls, &Thickness, &Materials];

/// The model of this name.
///
/// # Errors
/// No such model; the error lists them.
pub fn propagation_by_name(name: &str) -> Result<&'static dyn Propagation> {
    look_up("propagation model", name, PROPAGATIONS, |model| {
        model.name()
    })
}

/// A parameter of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Name in files and tables.
    pub name: String,
    /// Unit of the parameter; empty for a parameter without unit.
    pub unit: &'static str,
}

impl Parameter {
    fn new(name: impl Into<String>, unit: &'static str) -> Self {
        Self {
            name: name.into(),
            unit,
        }
    }

    /// Strength at the reference distance, the first parameter of every model.
    fn reference() -> Self {
        Self::new("reference_dbm", "dBm")
    }
}

/// Quantities that a propagation model needs in addition to the link itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms<'a> {
    /// Logarithm of the distance divided by the reference distance, in the model's base.
    pub log_distance: f64,
    /// Logarithm of the distance divided by the reference distance, in base 10.
    pub log10_distance: f64,
    /// C, the largest number of walls that count.
    pub cap: usize,
    /// Materials whose losses are parameters of the model.
    pub materials: &'a [String],
}

/// A propagation model, which is linear in its parameters for a given cap.
pub trait Propagation: Sync {
    /// Name in files and options.
    fn name(&self) -> &'static str;

    /// The formula, as shown to users.
    fn formula(&self) -> &'static str;

    /// The parameters; the strength at the reference distance comes first.
    fn parameters(&self, materials: &[String]) -> Vec<Parameter>;

    /// The factor of each parameter for a link, in the order of the parameters.
    fn factors(&self, link: &Link, terms: &Terms<'_>) -> Vec<f64>;

    /// A term that does not depend on the parameters, dB.
    fn fixed_db(&self, _link: &Link, _terms: &Terms<'_>) -> f64 {
        0.0
    }

    /// Whether the strength depends on walls.
    fn has_walls(&self) -> bool {
        false
    }
}

realgap_core::serde_by_name!(dyn Propagation, propagation_by_name);

/// The capped number of walls, min(nW, C), of equation 2 of paper 002.
fn counted_walls(link: &Link, cap: usize) -> f64 {
    link.walls().min(cap) as f64
}
