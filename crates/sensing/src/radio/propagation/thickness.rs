//! The propagation model `thickness`: a loss for each wall and a loss for each metre of wall.

use super::{Link, Parameter, Propagation, Terms, Walls};
use realgap_core::constant_methods;

/// The model [`Walls`] with an additional loss for every metre of wall along the ray. A ray through two thin walls may lose less than a
/// ray that crosses one thick wall at a shallow angle.
pub struct Thickness;

impl Propagation for Thickness {
    constant_methods! {
        name: &'static str = "thickness";
        formula: &'static str = "P(d0) - 10 n log(d/d0) - min(nW, C) WAF - a t";
    }

    fn parameters(&self, materials: &[String]) -> Vec<Parameter> {
        let mut parameters = Walls.parameters(materials);
        parameters.push(Parameter::new("thickness_loss_db_m", "dB/m"));
        parameters
    }

    fn factors(&self, link: &Link, terms: &Terms<'_>) -> Vec<f64> {
        let mut factors = Walls.factors(link, terms);
        factors.push(-link.thickness_m());
        factors
    }

    fn has_walls(&self) -> bool {
        true
    }
}
