//! What least squares tell about each parameter.

use serde::Serialize;

use realgap_optimization::{Grid, Quadratic};

/// What least squares tell about a parameter. From three groups of errors on (of a joint log, for example) the interval comes from the
/// fits without each group, with fewer groups from the noise of the errors alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Estimated"))]
pub struct LeastSquaresEstimate {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value at the evaluated point of the smallest robust loss: the answer's best value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Whether the recordings determine the parameter: its standard deviation is less than half of what was known beforehand.
    pub is_told: bool,
    /// The parameter that is most strongly correlated with it, and their correlation.
    pub partner: Option<(&'static str, f64)>,
}

/// Half of a 90 % interval in standard deviations.
const NINETY: f64 = 1.644_853_626_951;
/// A parameter is determined where its standard deviation is less than this share of the standard deviation known beforehand.
const DETERMINED: f64 = 0.5;

impl LeastSquaresEstimate {
    /// The estimates of all parameters of a grid from the loss near its minimum.
    pub fn all(grid: &Grid, known: &Quadratic) -> Vec<Self> {
        let sd = |axis: usize| known.covariance[axis][axis].sqrt();
        let ranges = grid.ranges();
        let correlation = |a: usize, b: usize| known.covariance[a][b] / (sd(a) * sd(b));
        (0..ranges.len())
            .map(|axis| {
                let (range, at, middle) = (&ranges[axis], known.at[axis], known.point[axis]);
                let half_width = NINETY * sd(axis);
                let value = |coordinate: f64| range.at(coordinate.clamp(0.0, 1.0));
                let others = (0..ranges.len()).filter(|other| *other != axis);
                let partner = others.max_by(|a, b| {
                    correlation(axis, *a)
                        .abs()
                        .total_cmp(&correlation(axis, *b).abs())
                });
                // Without prior knowledge the prior is uniform over the range.
                let before = known.prior[axis].unwrap_or(1.0 / 12.0).sqrt();
                Self {
                    parameter: range.parameter.name,
                    value: value(at),
                    // The interval is centred on the minimum of the quadratic. The evaluated point is as good, so the interval holds it.
                    low: value(at.min(middle - half_width)),
                    high: value(at.max(middle + half_width)),
                    is_told: sd(axis) < DETERMINED * before,
                    partner: partner
                        .map(|other| (ranges[other].parameter.name, correlation(axis, other))),
                }
            })
            .collect()
    }
}
