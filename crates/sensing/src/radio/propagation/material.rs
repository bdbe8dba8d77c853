//! The propagation model `materials`: a loss for each wall that depends on its material.

use super::{Link, LogDistance, Parameter, Propagation, Terms};
use realgap_core::constant_methods;

/// P(d₀) − 10 n log(d/d₀) − Σ WAF, with the sum over the first C walls and WAF the loss of the material of each wall.
pub struct Materials;

impl Propagation for Materials {
    constant_methods! {
        name: &'static str = "materials";
        formula: &'static str = "P(d0) - 10 n log(d/d0) - sum of WAF[material] over the first C walls";
    }

    fn parameters(&self, materials: &[String]) -> Vec<Parameter> {
        let mut parameters = LogDistance.parameters(materials);
        parameters.extend(materials.iter().map(|material| {
            let name = if material.is_empty() {
                "unnamed"
            } else {
                material
            };
            Parameter::new(format!("wall_loss_db[{name}]"), "dB")
        }));
        parameters
    }

    fn factors(&self, link: &Link, terms: &Terms<'_>) -> Vec<f64> {
        let mut factors = LogDistance.factors(link, terms);
        factors.extend(terms.materials.iter().map(|material| {
            let own = link
                .crossed
                .iter()
                .take(terms.cap)
                .filter(|(crossed, _)| crossed == material);
            -(own.count() as f64)
        }));
        factors
    }

    fn has_walls(&self) -> bool {
        true
    }
}
