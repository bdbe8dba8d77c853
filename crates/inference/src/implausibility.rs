//! How implausible points are: by how much another point scores better, in standard deviations of what is uncertain about the two.

use nalgebra::DMatrix;

use crate::emulator::ScoreField;
use realgap_core::statistics::mean;

/// Weight of the pooled covariance of observations, in observations, beside the covariance that each pair of points shows.
const POOLED: f64 = 4.0;
/// Variance of a single observation, in variances of a run. A kernel that is smooth everywhere understates how much a deviation of the
/// observation moves the bottom of a valley of the score; with 4 the intervals of the worlds in `coverage.rs` have their stated
/// coverage.
const SINGLE_OBSERVATION: f64 = 4.0;
/// Variance of a single observation, in variances of its surrogates: nothing shows that reality repeats as well as the black box.
const SURROGATE: f64 = 2.0;

/// What makes the difference of two scores uncertain beside emulator and settings.
#[derive(Debug, Clone, Copy)]
pub struct ObservationUncertainty {
    /// Number of observations that are fitted.
    pub observations: usize,
    /// Variance of the model's discrepancy, in variances of an observation; 0 where the model explains the observations.
    pub discrepancy: f64,
}

/// Covariance of the uncertain scores of several points.
pub struct ScoreCovariance {
    /// Of all sources together.
    pub all: DMatrix<f64>,
    /// Of the observations with the model's discrepancy alone.
    observations: DMatrix<f64>,
    /// Degrees of freedom of the latter.
    freedom: f64,
    /// Variance of an observation pooled over the points, in variances of the score before any run.
    pub pooled: f64,
}

impl ScoreCovariance {
    /// The covariance of observations is estimated from their scores at each pair of points and shrunk towards one that is the same
    /// everywhere, more strongly the fewer observations there are (as a prior of `POOLED` observations would; Ledoit & Wolf 2004). A
    /// single observation shows no variance: it is assumed to vary `SINGLE_OBSERVATION` times as a single run does.
    ///
    /// Further points that are compared with earlier ones take the `pooled` variance of these, so that an answer about a point does not
    /// depend on what else is asked.
    pub fn new(
        field: &ScoreField,
        uncertainty: ObservationUncertainty,
        pooled: Option<f64>,
    ) -> Self {
        let n = field.means.len() as f64;
        let pairs = |matrix: &DMatrix<f64>| n * matrix.trace() - matrix.sum();
        let observations = field.observation_deviations.ncols();
        let more = observations.saturating_sub(1) as f64;
        let own = &field.observation_deviations * field.observation_deviations.transpose();
        let pooled = pooled.unwrap_or_else(|| match more > 0.0 {
            true => pairs(&own) / more / pairs(&field.correlation).max(1e-9),
            false => SINGLE_OBSERVATION * (field.noise + field.setting),
        });
        let one = (&field.correlation * (POOLED * pooled) + own) / (POOLED + more);
        // A distance does not show whether the observation or the run deviates. So the unknown setting of reality changes the score as
        // one more observation would, in the ratio of the variances of settings and observations. Surrogates of a single observation
        // have settings of their own already.
        let setting = match uncertainty.observations > 1 {
            true => field.setting / field.observation.max(1e-12),
            false => 0.0,
        };
        let one_over = match (uncertainty.observations, observations) {
            (..=1, 2..) => SURROGATE,
            (fitted, _) => 1.0 / fitted.max(1) as f64,
        };
        let from_observations = one * (one_over + setting + uncertainty.discrepancy);
        Self {
            all: &field.emulator + &field.numerics + &from_observations,
            observations: from_observations,
            pooled,
            // Along a single valley the pooled covariance is made of the same few observations, so it adds no degrees of freedom.
            freedom: if uncertainty.observations > 1 {
                more
            } else {
                POOLED
            },
        }
    }

    /// Variance of the difference of two points' scores.
    pub(crate) fn of_difference(covariance: &DMatrix<f64>, a: usize, b: usize) -> f64 {
        covariance[(a, a)] + covariance[(b, b)] - 2.0 * covariance[(a, b)]
    }
}

/// Smaller variances of a difference are rounding errors.
const ROUNDING: f64 = 1e-8;

/// The implausibility of each point: the largest standardised amount by which any other point scores better; 0 for the best.
pub fn implausibility(field: &ScoreField, covariance: &ScoreCovariance) -> Vec<f64> {
    implausibility_beside(field, covariance, 0)
}

/// As [`implausibility`], where a point is compared only with the points from number `first` on.
pub fn implausibility_beside(
    field: &ScoreField,
    covariance: &ScoreCovariance,
    first: usize,
) -> Vec<f64> {
    let n = field.means.len();
    let worse_by = |point: usize, other: usize| {
        let difference = field.means[point] - field.means[other];
        if difference <= 0.0 {
            return 0.0;
        }
        let all = ScoreCovariance::of_difference(&covariance.all, point, other).max(ROUNDING);
        let observations = ScoreCovariance::of_difference(&covariance.observations, point, other);
        // Degrees of freedom of a sum of variances of which one is estimated (Welch 1947; Satterthwaite 1946).
        let share = (observations / all).clamp(1e-3, 1.0);
        as_normal(
            difference / all.sqrt(),
            covariance.freedom / (share * share),
        )
    };
    (0..n)
        .map(|point| (first..n).fold(0.0, |most: f64, other| most.max(worse_by(point, other))))
        .collect()
}

/// The normal number that is as improbable as `t` of Student's distribution (Wallace 1959, section 3).
pub(crate) fn as_normal(t: f64, freedom: f64) -> f64 {
    let correction = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    correction * (freedom * libm::log1p(t * t / freedom)).sqrt()
}

/// Share of the emulator in the variance of the difference between the best point and another, mean over the points up to a limit of
/// implausibility.
pub(crate) fn emulator_share(
    field: &ScoreField,
    covariance: &ScoreCovariance,
    implausibility: &[f64],
    limit: f64,
) -> f64 {
    let best = field.means.imin();
    let inside = (0..implausibility.len()).filter(|i| *i != best && implausibility[*i] <= limit);
    let shares = inside.map(|point| {
        let all = ScoreCovariance::of_difference(&covariance.all, point, best).max(ROUNDING);
        ScoreCovariance::of_difference(&field.emulator, point, best) / all
    });
    let shares: Vec<f64> = shares.collect();
    if shares.is_empty() {
        0.0
    } else {
        mean(&shares)
    }
}
