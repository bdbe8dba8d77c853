//! How the points of an answer were chosen.

use serde::Serialize;

use super::InformationGain;
use realgap_optimization::{Grid, Quadratic};

/// How the points of an answer were chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Every point of the study's grid.
    Sweep,
    /// An optimizer chose them.
    Tune(Tuned),
}

impl Method {
    /// The values that least squares chose; `None` of every other method.
    pub(super) fn fitted(&self) -> Option<Vec<f64>> {
        match self {
            Self::Tune(tuned) if !tuned.least_squares.is_empty() => {
                Some(tuned.least_squares.iter().map(|e| e.value).collect())
            }
            _ => None,
        }
    }

    /// Whether an optimizer chose the point of the run with this index for its score: such points crowd where the best is, and are no
    /// sample of what may be.
    pub(super) fn crowds(&self, run: usize) -> bool {
        match self {
            Self::Sweep => false,
            Self::Tune(tuned) => (tuned.design..tuned.evaluated).contains(&run),
        }
    }
}

/// Why tuning ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// The budget is spent.
    Budget,
    /// The optimizer has nothing more to try.
    Exhausted,
    /// `patience` points in a row were no better.
    NoImprovement,
    /// Stopped from outside; everything finished is stored.
    Interrupted,
}

/// How the points of a tuned study were chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tuned {
    /// Name of the optimizer.
    pub optimizer: &'static str,
    /// Most points.
    pub budget: usize,
    /// Points of the space-filling first design.
    pub design: usize,
    /// Points evaluated; what is simulated after them completes the settings of the best one.
    pub evaluated: usize,
    /// Why it ended.
    pub termination: Termination,
    /// What least squares know of each parameter where they ended; empty for other optimizers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub least_squares: Vec<Estimated>,
    /// Lowest score of all points, where least squares chose a point with another: they count large errors less, and prior
    /// knowledge, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lowest_score: Option<f64>,
    /// What each recording tells them that the others do not, the most first; empty for other optimizers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<InformationGain>,
}

/// What least squares know of a parameter: by what the fit is without each log, or with fewer than three by noise alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimated {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value of the simulated point whose robust loss is least of all: the answer's best.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Whether the recordings tell it: its spread is less than half of what was known beforehand.
    pub is_told: bool,
    /// The parameter with which it is exchanged most easily, and their correlation.
    pub partner: Option<(&'static str, f64)>,
}

/// Half of a 90 % interval in standard deviations.
const NINETY: f64 = 1.644_853_626_951;
/// A spread below this share of what was known beforehand is news.
const NEWS: f64 = 0.5;

impl Estimated {
    /// What a quadratic says of the parameters of a grid.
    pub(super) fn all(grid: &Grid, known: &Quadratic) -> Vec<Self> {
        let sd = |axis: usize| known.covariance[axis][axis].sqrt();
        let ranges = grid.ranges();
        let correlation = |a: usize, b: usize| known.covariance[a][b] / (sd(a) * sd(b));
        (0..ranges.len())
            .map(|axis| {
                let (range, at, middle) = (&ranges[axis], known.at[axis], known.point[axis]);
                let doubt = NINETY * sd(axis);
                let value = |coordinate: f64| range.at(coordinate.clamp(0.0, 1.0));
                let others = (0..ranges.len()).filter(|other| *other != axis);
                let partner = others.max_by(|a, b| {
                    correlation(axis, *a)
                        .abs()
                        .total_cmp(&correlation(axis, *b).abs())
                });
                let before = known.prior[axis].unwrap_or(1.0 / 12.0).sqrt();
                Self {
                    parameter: range.parameter.name,
                    value: value(at),
                    // Around where the loss is least by a quadratic; what was simulated is as good, and so within.
                    low: value(at.min(middle - doubt)),
                    high: value(at.max(middle + doubt)),
                    is_told: sd(axis) < NEWS * before,
                    partner: partner
                        .map(|other| (ranges[other].parameter.name, correlation(axis, other))),
                }
            })
            .collect()
    }
}
