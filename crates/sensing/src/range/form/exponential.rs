//! The form `exponential`: an exponential function of the distance.

use super::{Form, Point, log_points, weighted_line};
use realgap_core::constant_methods;

/// `factor · exp(rate · d)`.
pub struct Exponential;

impl Form for Exponential {
    constant_methods! {
        name: &'static str = "exponential";
        formula: &'static str = "factor exp(rate d)";
    }

    fn parameters(&self, _: &[f64]) -> Vec<String> {
        vec!["factor".to_owned(), "rate".to_owned()]
    }

    fn value(&self, _: &[f64], parameters: &[f64], d: f64) -> f64 {
        parameters[0] * libm::exp(parameters[1] * d)
    }

    fn gradient(&self, _: &[f64], parameters: &[f64], d: f64) -> Vec<f64> {
        let shape = libm::exp(parameters[1] * d);
        vec![shape, parameters[0] * shape * d]
    }

    fn is_factor(&self, parameter: usize) -> bool {
        parameter == 0
    }

    fn start(&self, _: &[f64], points: &[Point]) -> Option<Vec<f64>> {
        let (sign, logs) = log_points(points, |d| d)?;
        let [factor, rate] = weighted_line(&logs)?;
        Some(vec![sign * libm::exp(factor), rate])
    }
}
