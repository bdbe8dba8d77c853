//! The propagation model `walls`: the same loss for each wall, up to a maximum number of walls.

use super::{Link, LogDistance, Parameter, Propagation, Terms, counted_walls};
use realgap_core::constant_methods;

/// P(d₀) − 10 n log(d/d₀) − min(nW, C) WAF: equation 2 of paper 002 (the RADAR model).
pub struct Walls;

impl Propagation for Walls {
    constant_methods! {
        name: &'static str = "walls";
        formula: &'static str = "P(d0) - 10 n log(d/d0) - min(nW, C) WAF";
    }

    fn parameters(&self, materials: &[String]) -> Vec<Parameter> {
        let mut parameters = LogDistance.parameters(materials);
        parameters.push(Parameter::new("wall_loss_db", "dB"));
        parameters
    }

    fn factors(&self, link: &Link, terms: &Terms<'_>) -> Vec<f64> {
        let mut factors = LogDistance.factors(link, terms);
        factors.push(-counted_walls(link, terms.cap));
        factors
    }

    fn has_walls(&self) -> bool {
        true
    }
}
