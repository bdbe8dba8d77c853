//! The propagation model `free-space`: power falls with the square of the distance.

use super::{Link, Parameter, Propagation, Terms};
use realgap_core::constant_methods;

/// P(d₀) − 20 log₁₀(d/d₀): power falls with the square of the distance (Friis 1946).
pub struct FreeSpace;

impl Propagation for FreeSpace {
    constant_methods! {
        name: &'static str = "free-space";
        formula: &'static str = "P(d0) - 20 log10(d/d0)";
    }

    fn parameters(&self, _materials: &[String]) -> Vec<Parameter> {
        vec![Parameter::reference()]
    }

    fn factors(&self, _link: &Link, _terms: &Terms<'_>) -> Vec<f64> {
        vec![1.0]
    }

    fn fixed_db(&self, _link: &Link, terms: &Terms<'_>) -> f64 {
        -20.0 * terms.log10_distance
    }
}
