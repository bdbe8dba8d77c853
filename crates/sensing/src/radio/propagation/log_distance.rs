//! The propagation model `log-distance`: a power law whose exponent is a parameter.

use super::{Link, Parameter, Propagation, Terms};
use realgap_core::constant_methods;

/// P(d₀) − 10 n log(d/d₀): equation 2 of paper 002 without walls.
pub struct LogDistance;

impl Propagation for LogDistance {
    constant_methods! {
        name: &'static str = "log-distance";
        formula: &'static str = "P(d0) - 10 n log(d/d0)";
    }

    fn parameters(&self, _materials: &[String]) -> Vec<Parameter> {
        vec![
            Parameter::reference(),
            Parameter::new("path_loss_exponent", ""),
        ]
    }

    fn factors(&self, _link: &Link, terms: &Terms<'_>) -> Vec<f64> {
        vec![1.0, -10.0 * terms.log_distance]
    }
}
