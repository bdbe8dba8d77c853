//! The form `linear`: a straight line over the distance.

use super::{Form, Point, weighted_line};
use realgap_core::constant_methods;

/// `intercept + slope · d`.
pub struct Linear;

impl Form for Linear {
    constant_methods! {
        name: &'static str = "linear";
        formula: &'static str = "intercept + slope d";
    }

    fn parameters(&self, _: &[f64]) -> Vec<String> {
        vec!["intercept".to_owned(), "slope".to_owned()]
    }

    fn value(&self, _: &[f64], parameters: &[f64], d: f64) -> f64 {
        parameters[0] + parameters[1] * d
    }

    fn gradient(&self, _: &[f64], _: &[f64], d: f64) -> Vec<f64> {
        vec![1.0, d]
    }

    fn start(&self, _: &[f64], points: &[Point]) -> Option<Vec<f64>> {
        weighted_line(points).map(Vec::from)
    }
}
