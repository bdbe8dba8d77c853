//! How far logs disagree about the parameters: the covariance of fits that leave out one log after the other (Tukey 1958).
//!
//! Their covariance is used as a whole. Variances along principal directions one by one would carry the disagreement about one parameter
//! to every other that shares a direction with it, however small its part is.

use nalgebra::{DMatrix, DVector};
use realgap_core::statistics::{median, student_quantile};

use super::laplace::RANGE_PRECISION;

/// Half of a 90 % interval of a normal distribution, in standard deviations.
const NINETY: f64 = 1.644_853_626_951;
/// A log that has more than this share of the information about a direction tells of it alone: without the log, the direction would have
/// less than a twentieth of its information, and a linear step along it shows nothing.
const ALONE: f64 = 0.95;
/// The typical disagreement counts as that of so many logs more in every direction, because few logs span few directions.
const TYPICAL_LOGS: f64 = 1.0;
/// Logs that agree by chance do not make an estimate more certain than this share of the noise's variance.
const LEAST_INFLATION: f64 = 0.25;
/// The least share of a direction that logs other than those that tell of it alone have, for what is typical.
const LEAST_SHARE: f64 = 0.1;
/// With fewer blocks of time than this, how they disagree is not known.
const FEWEST_BLOCKS: usize = 3;
/// The least information of a direction here. Its standard deviation is then ten ranges, as good as none.
pub(super) const NO_INFORMATION: f64 = 1e-2;

/// What one log says: its information about the parameters, and the pull of its errors.
pub(super) struct Log {
    /// Information, as if errors were independent.
    pub information: DMatrix<f64>,
    /// Sum of the derivatives of the errors, each times the slope of its loss.
    pub pull: DVector<f64>,
}

impl Log {
    /// From the derivatives of whitened errors and the slopes of their losses.
    pub fn new(jacobian: &DMatrix<f64>, slopes: &DVector<f64>) -> Self {
        Self {
            information: jacobian.tr_mul(jacobian),
            pull: jacobian.tr_mul(slopes),
        }
    }
}

/// One linear step of a fit that leaves out a log.
pub(super) struct LeftOut {
    /// How far the fit moves.
    pub shift: DVector<f64>,
    /// The directions about which the log tells alone, a column each. The fit does not move along them, because nothing else would hold
    /// it. The sum of their outer products is the part of the covariance that the log alone shows.
    alone: DMatrix<f64>,
    /// By how much the variance along each of these directions is larger than independent errors would let it be, because blocks of time
    /// of the log disagree; 0 where that is not known.
    over_time: DVector<f64>,
}

impl LeftOut {
    /// With what disjoint blocks of time of the log disagree about: another log along these directions is not known, and parts of this
    /// one are the nearest to it.
    #[must_use]
    pub fn with_blocks(self, whole: &WholeFit, blocks: &[Log]) -> Self {
        let along: Vec<DVector<f64>> = (blocks.iter())
            .filter_map(|block| Some(whole.along(&self.alone, &whole.without(block)?.shift)))
            .collect();
        if along.len() < FEWEST_BLOCKS {
            return self;
        }
        let count = along.len() as f64;
        let zero = DVector::zeros(self.alone.ncols());
        let mean = along.iter().fold(zero.clone(), |sum, one| sum + one) / count;
        let squares = along
            .iter()
            .fold(zero, |sum, one| sum + (one - &mean).map(|part| part * part));
        Self {
            over_time: squares * ((count - 1.0) / count),
            ..self
        }
    }

    /// Whether the log tells of something alone.
    pub fn is_alone(&self) -> bool {
        self.alone.ncols() > 0
    }
}

/// A fit to all logs, as its information: the lower triangle of Cholesky's decomposition.
pub(super) struct WholeFit(DMatrix<f64>);

impl WholeFit {
    /// With this information, which includes that of the range or of priors; `None` where it is not positive definite.
    pub fn new(information: DMatrix<f64>) -> Option<Self> {
        Some(Self(information.cholesky()?.unpack()))
    }

    /// The fit without a log; `None` where numbers are not finite.
    pub fn without(&self, log: &Log) -> Option<LeftOut> {
        let Self(lower) = self;
        let half = lower.solve_lower_triangular(&log.information)?;
        let share = lower.solve_lower_triangular(&half.transpose())?;
        let share = 0.5 * (&share + share.transpose());
        if !share.iter().all(|value| value.is_finite()) {
            return None;
        }
        let eigen = share.symmetric_eigen();
        let pull = lower.solve_lower_triangular(&log.pull)?;
        let along = eigen.eigenvectors.tr_mul(&pull);
        let is_alone = |k: usize| eigen.eigenvalues[k] > ALONE;
        let step = DVector::from_fn(along.len(), |k, _| match is_alone(k) {
            true => 0.0,
            false => along[k] / (1.0 - eigen.eigenvalues[k]),
        });
        let alone: Vec<usize> = (0..along.len()).filter(|k| is_alone(*k)).collect();
        let alone = eigen.eigenvectors.select_columns(&alone);
        Some(LeftOut {
            shift: lower.tr_solve_lower_triangular(&(&eigen.eigenvectors * step))?,
            over_time: DVector::zeros(alone.ncols()),
            alone: lower.tr_solve_lower_triangular(&alone)?,
        })
    }

    /// A shift in standard deviations of independent errors along each of these directions, which are those of [`LeftOut::alone`].
    fn along(&self, alone: &DMatrix<f64>, shift: &DVector<f64>) -> DVector<f64> {
        let Self(lower) = self;
        lower.tr_mul(alone).tr_mul(&lower.tr_mul(shift))
    }
}

/// The covariance of the parameters by the disagreement of logs, in units of the standard deviations that independent errors would give
/// along each coordinate: `information` has that of each coordinate (they are principal directions), and `from_noise` gives how much
/// larger the variance along a direction is because errors are correlated.
pub(super) fn inflation(
    logs: &[LeftOut],
    information: &DVector<f64>,
    from_noise: impl Fn(&DVector<f64>) -> f64,
) -> DMatrix<f64> {
    let dimensions = information.len();
    let count = logs.len() as f64;
    let roots = information.map(|own| own.max(NO_INFORMATION).sqrt());
    let mut mean = DVector::zeros(dimensions);
    logs.iter().for_each(|log| mean += &log.shift / count);
    let mut disagreement = DMatrix::zeros(dimensions, dimensions);
    let mut held = DVector::zeros(dimensions);
    for log in logs {
        let apart = (&log.shift - &mean).component_mul(&roots);
        disagreement += &apart * apart.transpose() * ((count - 1.0) / count);
        for alone in log.alone.column_iter() {
            held += alone.component_mul(&roots).map(|part| part * part);
        }
    }
    // Directions with less information than a range alone has do not show what disagreement is typical.
    let all = 0..dimensions;
    let known = all.clone().filter(|k| information[*k] > RANGE_PRECISION);
    let known: Vec<usize> = known.collect();
    let known = if known.is_empty() {
        all.collect()
    } else {
        known
    };
    let shares = known.iter().map(|k| {
        let share = (1.0 - held[*k]).max(LEAST_SHARE);
        disagreement[(*k, *k)] / share
    });
    let typical = median(&shares.collect::<Vec<f64>>()).max(LEAST_INFLATION);
    let all = logs
        .iter()
        .flat_map(|log| log.alone.column_iter().zip(log.over_time.iter()));
    for (alone, over_time) in all {
        let own = typical.max(from_noise(&alone.into_owned())).max(*over_time);
        let along = alone.component_mul(&roots);
        disagreement += &along * along.transpose() * own;
    }
    let degrees = count - 1.0 + TYPICAL_LOGS;
    let student = student_quantile(0.95, degrees) / NINETY;
    let typical = DMatrix::from_diagonal_element(dimensions, dimensions, typical * TYPICAL_LOGS);
    let whole = (disagreement * (count - 1.0) + typical) * (student.powi(2) / degrees);
    let mut eigen = whole.symmetric_eigen();
    eigen
        .eigenvalues
        .apply(|own| *own = own.max(LEAST_INFLATION));
    eigen.recompose()
}
