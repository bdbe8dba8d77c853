//! What a fit by least squares tells about each parameter, from the draws of its posterior.

use serde::Serialize;

use super::LeastSquaresPosterior;
use super::combination::{Combination, combinations};
use crate::posterior::{INTERVAL_LEVEL, PosteriorDraws};
use realgap_optimization::Grid;

/// What least squares tell about a parameter. Every number is one of the posterior's draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Estimated"))]
pub struct LeastSquaresEstimate {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value at the simulated point with the smallest robust loss: the answer's best value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Whether the recordings determine the parameter: its interval is shorter than half of the range, does not reach an end of it, and
    /// does not end because the range of another parameter does.
    pub is_told: bool,
    /// The parameter that is most strongly correlated with it, and their correlation.
    pub partner: Option<(&'static str, f64)>,
    /// Where the recordings do not determine the parameter: a combination with another one that they do determine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub combination: Option<Combination>,
}

/// A parameter is determined where its interval is shorter than this share of the range.
const DETERMINED: f64 = 0.5;
/// An interval that comes this near to an end of the range, as a share of the range, reaches it.
const AT_THE_END: f64 = 0.01;

impl LeastSquaresEstimate {
    /// The estimates of all parameters of a grid from a posterior and its draws. A fit that has not converged determines none.
    pub fn all(
        grid: &Grid,
        posterior: &LeastSquaresPosterior,
        draws: &PosteriorDraws,
    ) -> Vec<Self> {
        let best = grid.values_at(posterior.best());
        let has_converged = posterior.agreement().has_converged();
        let ranges = grid.ranges();
        let told = |axis: usize| {
            let (low, high) = draws.interval(axis, INTERVAL_LEVEL);
            let ends = (ranges[axis].coordinate(low), ranges[axis].coordinate(high));
            let is_inside = ends.0 > AT_THE_END && ends.1 < 1.0 - AT_THE_END;
            let width = ends.1 - ends.0;
            let is_narrow = width < DETERMINED && !posterior.is_open(axis, width);
            (low, high, has_converged && is_inside && is_narrow)
        };
        let open: Vec<usize> = (0..ranges.len()).filter(|axis| !told(*axis).2).collect();
        let combinations = combinations(grid, draws, &open);
        (0..ranges.len())
            .map(|axis| {
                let (low, high, is_told) = told(axis);
                let others = (0..ranges.len()).filter(|other| *other != axis);
                let others = others.map(|other| (other, draws.correlation(axis, other)));
                let partner = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                let own = combinations.iter().find(|(number, _)| *number == axis);
                Self {
                    parameter: ranges[axis].parameter.name,
                    value: best[axis],
                    low,
                    high,
                    is_told,
                    partner: partner.map(|(other, value)| (ranges[other].parameter.name, value)),
                    combination: own.map(|(_, combination)| combination.clone()),
                }
            })
            .collect()
    }
}
