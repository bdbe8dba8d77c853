//! Propagation models: how strength falls with distance and walls. One file and one line of [`PROPAGATIONS`] each.

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
    /// Its unit, empty for none.
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

/// What a model asks of a link beyond the link itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms<'a> {
    /// Logarithm of distance over reference distance, in the model's base.
    pub log_distance: f64,
    /// This is the same logarithm in base 10.
    pub log10_distance: f64,
    /// C: walls beyond so many do not count.
    pub cap: usize,
    /// Materials that have a loss of their own.
    pub materials: &'a [String],
}

/// A family of models, linear in its parameters for a given cap.
pub trait Propagation: Sync {
    /// Name in files and options.
    fn name(&self) -> &'static str;

    /// The formula, for people.
    fn formula(&self) -> &'static str;

    /// The parameters; the strength at the reference distance comes first.
    fn parameters(&self, materials: &[String]) -> Vec<Parameter>;

    /// What each parameter is multiplied with for a link; as many as parameters.
    fn factors(&self, link: &Link, terms: &Terms<'_>) -> Vec<f64>;

    /// What is added whatever the parameters are, dB.
    fn fixed_db(&self, _link: &Link, _terms: &Terms<'_>) -> f64 {
        0.0
    }

    /// Whether it says something of walls.
    fn has_walls(&self) -> bool {
        false
    }
}

realgap_core::serde_by_name!(dyn Propagation, propagation_by_name);

/// The capped number of walls, as equation 2 of paper 002 has it.
fn counted_walls(link: &Link, cap: usize) -> f64 {
    link.walls().min(cap) as f64
}
