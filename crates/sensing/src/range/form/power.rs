//! The form `power`: a power of the distance.

use super::{Form, Point, log_points, weighted_line};
use realgap_core::constant_methods;

/// `factor · d^exponent`, for example for infrared sensors, whose received light falls with a power of the distance.
pub struct Power;

impl Form for Power {
    constant_methods! {
        name: &'static str = "power";
        formula: &'static str = "factor d^exponent";
    }

    fn parameters(&self, _: &[f64]) -> Vec<String> {
        vec!["factor".to_owned(), "exponent".to_owned()]
    }

    fn value(&self, _: &[f64], parameters: &[f64], d: f64) -> f64 {
        parameters[0] * libm::pow(d, parameters[1])
    }

    fn gradient(&self, _: &[f64], parameters: &[f64], d: f64) -> Vec<f64> {
        let shape = libm::pow(d, parameters[1]);
        vec![shape, parameters[0] * shape * libm::log(d)]
    }

    fn is_factor(&self, parameter: usize) -> bool {
        parameter == 0
    }

    fn start(&self, _: &[f64], points: &[Point]) -> Option<Vec<f64>> {
        let (sign, logs) = log_points(points, libm::log)?;
        let [factor, exponent] = weighted_line(&logs)?;
        Some(vec![sign * libm::exp(factor), exponent])
    }
}
