//! A Gaussian approximation of the posterior around a point (Laplace's method), in principal directions.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use realgap_optimization::{
    Linearisation, OptimizationProblem, UnitPoint, blocks_of, error_scales, minimum_within,
};

use super::disagreement::{self, Log, NO_INFORMATION, WholeFit};
use super::noise::ResidualNoise;

/// With fewer logs than this, their disagreement cannot be estimated, and only the noise is used.
const FEWEST_LOGS: usize = 3;
/// Factor on the error of a derivative: that of a difference to one side at an end of the range is twice that of one to both sides.
const DOUBT: f64 = 2.0;
/// Precision of a uniform distribution from 0 to 1. It keeps steps along directions without information within the range.
pub(super) const RANGE_PRECISION: f64 = 12.0;

/// A Gaussian approximation around a centre, in coordinates from 0 to 1.
///
/// Information that differences of runs cannot show is left out: where the derivatives to both sides of the centre differ, a direction
/// without effect seems to have one, and many errors make it seem certain.
#[derive(Debug, Clone)]
pub(super) struct Laplace {
    /// The point at which the deviance was last found to be lowest.
    centre: UnitPoint,
    /// The errors there.
    errors: Vec<f64>,
    /// The deviance there.
    lowest: f64,
    noise: ResidualNoise,
    /// Derivatives of the whitened errors.
    jacobian: DMatrix<f64>,
    /// Median and variance of the prior of each coordinate.
    prior: Vec<Option<(f64, f64)>>,
    /// Principal directions, a column each, the best determined last.
    pub directions: DMatrix<f64>,
    /// Information along each direction, as if errors were independent.
    information: DVector<f64>,
    /// The covariance of positions along the directions, in units of what independent errors would give along each: by how much
    /// variances are larger, because errors are correlated or logs disagree.
    inflation: DMatrix<f64>,
}

impl Laplace {
    /// Around a linearised point, with its derivatives as they are.
    pub fn new(problem: &OptimizationProblem, known: &Linearisation) -> Self {
        let dimensions = known.at.len();
        let blocks = blocks_of(&problem.error_blocks, known.errors.len());
        let noise = ResidualNoise::new(&known.errors, &known.scales, &blocks, dimensions);
        let mut prior = problem.priors.clone();
        prior.resize(dimensions, None);
        let one = DVector::from_element(dimensions, 1.0);
        let mut laplace = Self {
            centre: known.at.clone(),
            errors: known.errors.clone(),
            lowest: 0.0,
            jacobian: noise.whitened(&known.jacobian),
            noise,
            prior,
            directions: DMatrix::identity(dimensions, dimensions),
            inflation: DMatrix::from_diagonal(&one),
            information: one,
        };
        laplace.lowest = laplace.deviance(&known.at, &known.errors);
        laplace.decompose(&vec![0.0; dimensions]);
        laplace
    }

    /// Moves the centre to a point with these errors.
    pub fn move_to(&mut self, point: UnitPoint, errors: Vec<f64>) {
        self.lowest = self.deviance(&point, &errors);
        (self.centre, self.errors) = (point, errors);
    }

    /// Estimates the noise again from the errors at the centre, where the centre was moved to much smaller errors.
    pub fn renew(&mut self, problem: &OptimizationProblem) {
        let blocks = blocks_of(&problem.error_blocks, self.errors.len());
        let scales = error_scales(&blocks, &self.errors);
        let noise = ResidualNoise::new(&self.errors, &scales, &blocks, self.centre.len());
        self.jacobian = self.noise.whitened_by(&noise, &self.jacobian);
        self.noise = noise;
        self.lowest = self.deviance(&self.centre, &self.errors);
        self.decompose(&vec![0.0; self.centre.len()]);
    }

    /// The point at which the deviance was last found to be lowest.
    pub fn centre(&self) -> &UnitPoint {
        &self.centre
    }

    /// The errors at the centre.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// The deviance at the centre.
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// Takes derivatives at the centre from differences to both sides: `central` is the slope at the centre of the parabola through
    /// three points, and `asymmetry` half of the difference between the slopes to the two sides.
    ///
    /// The derivative of the parabola through three points is off by a share of about the square of the asymmetry
    /// relative to the slope (Nocedal & Wright 2006, section 8.1).
    pub fn with_both_sides(&mut self, central: &DMatrix<f64>, asymmetry: &DMatrix<f64>) {
        self.jacobian = self.noise.whitened(central);
        let asymmetry = self.noise.whitened(asymmetry);
        let doubts = asymmetry.column_iter().zip(self.jacobian.column_iter());
        let doubts = doubts.map(|(change, slope)| {
            let (change, slope) = (change.norm(), slope.norm());
            let share = (change / slope.max(f64::MIN_POSITIVE)).min(1.0);
            (DOUBT * change * share).powi(2)
        });
        let doubts: Vec<f64> = doubts.collect();
        self.decompose(&doubts);
    }

    /// Computes principal directions and their information. `doubts` has by coordinate the squared norm of the errors of its
    /// derivatives, which look like information and are none.
    fn decompose(&mut self, doubts: &[f64]) {
        let dimensions = self.centre.len();
        let mut information = self.jacobian.tr_mul(&self.jacobian);
        for (axis, (prior, doubt)) in self.prior.iter().zip(doubts).enumerate() {
            // The error of a sum over the coordinates is at most the sum of their errors (Cauchy and Schwarz).
            information[(axis, axis)] -= dimensions as f64 * doubt;
            information[(axis, axis)] += prior.map_or(0.0, |(_, variance)| 1.0 / variance);
        }
        let eigen = information.symmetric_eigen();
        let mut order: Vec<usize> = (0..dimensions).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        self.directions = DMatrix::from_fn(dimensions, dimensions, |row, column| {
            eigen.eigenvectors[(row, order[column])]
        });
        self.information =
            DVector::from_fn(dimensions, |k, _| eigen.eigenvalues[order[k]].max(0.0));
        self.inflation = self.inflations();
    }

    /// The inflation: from the disagreement between logs where there are three or more, or between blocks of time of fewer logs that are
    /// cut into windows; otherwise from the autocorrelation of the errors along each direction.
    fn inflations(&self) -> DMatrix<f64> {
        let logs = self.noise.logs();
        let is_few = logs.len() < FEWEST_LOGS;
        // Of few logs, blocks of time take the place of logs where there are windows enough.
        let parts = match is_few {
            false => Some(logs),
            true => self.noise.blocks_of_windows(),
        };
        let Some(parts) = parts else {
            return DMatrix::from_diagonal(&self.correlations());
        };
        let slopes = self.noise.slopes(&self.errors);
        let along = &self.jacobian * &self.directions;
        let log_of = |ranges: &[Range<usize>]| {
            let rows: Vec<usize> = ranges.iter().cloned().flatten().collect();
            Log::new(&along.select_rows(&rows), &slopes.select_rows(&rows))
        };
        let logs: Vec<Log> = parts.iter().map(|ranges| log_of(ranges)).collect();
        let dimensions = self.centre.len();
        let mut all = DMatrix::from_diagonal_element(dimensions, dimensions, RANGE_PRECISION);
        logs.iter().for_each(|log| all += &log.information);
        let left_out = WholeFit::new(all).map_or_else(Vec::new, |whole| {
            let all = logs.iter().enumerate().filter_map(|(log, own)| {
                let left_out = whole.without(own)?;
                if is_few || !left_out.is_alone() {
                    return Some(left_out);
                }
                let blocks = self.noise.blocks_of_time(log);
                let blocks: Vec<Log> = blocks.iter().map(|block| log_of(block)).collect();
                Some(left_out.with_blocks(&whole, &blocks))
            });
            all.collect()
        });
        disagreement::inflation(&left_out, &self.information, |direction| {
            self.correlation(&slopes, &(&self.directions * direction))
        })
    }

    /// By how much the variance along a direction is larger because neighbouring errors are correlated.
    fn correlation(&self, slopes: &DVector<f64>, direction: &DVector<f64>) -> f64 {
        let along = &self.jacobian * direction;
        let scores = along.component_mul(slopes);
        self.noise.inflation(&scores, along.norm_squared())
    }

    /// The same along each principal direction.
    fn correlations(&self) -> DVector<f64> {
        let slopes = self.noise.slopes(&self.errors);
        let all = self.directions.column_iter();
        let all = all.map(|own| self.correlation(&slopes, &own.into_owned()));
        DVector::from_iterator(self.centre.len(), all)
    }

    /// How many errors count as one because neighbours are correlated: the mean over the directions.
    pub fn errors_for_one(&self) -> f64 {
        self.correlations().mean()
    }

    /// The errors at the centre as they would be if the fit had not seen the group of each: one linear step for each group that is left
    /// out. `groups` has the number of its group for every error.
    pub fn left_out(&self, groups: &[usize]) -> Vec<f64> {
        let dimensions = self.centre.len();
        let slopes = self.noise.slopes(&self.errors);
        let count = groups.iter().map(|group| group + 1).max().unwrap_or(0);
        let mut rows = vec![Vec::new(); count];
        for (row, group) in groups.iter().enumerate() {
            rows[*group].push(row);
        }
        let mut all = self.jacobian.tr_mul(&self.jacobian);
        for (axis, precision) in self.prior_precisions().into_iter().enumerate() {
            all[(axis, axis)] += precision;
        }
        let mut errors = self.errors.clone();
        let factors = self.noise.whitening_factors();
        let whole = WholeFit::new(all.clone());
        for rows in rows.iter().filter(|rows| !rows.is_empty()) {
            let own = self.jacobian.select_rows(rows);
            let log = Log::new(&own, &slopes.select_rows(rows));
            let shift = match count {
                // Without its only group the fit is where the priors pull it.
                1 => (&all - &log.information)
                    .cholesky()
                    .map(|rest| rest.solve(&log.pull)),
                _ => whole
                    .as_ref()
                    .and_then(|whole| Some(whole.without(&log)?.shift)),
            };
            let shift = shift.unwrap_or_else(|| DVector::zeros(dimensions));
            let within = self.centre.iter().zip(shift.iter());
            let within = within.map(|(at, by)| (at + by).clamp(0.0, 1.0) - at);
            let moved = own * DVector::from_iterator(dimensions, within);
            for (row, by) in rows.iter().zip(moved.iter()) {
                errors[*row] += by / factors[*row];
            }
        }
        errors
    }

    /// Precision along each direction; 0 where nothing is known but the range.
    pub fn precision(&self, direction: usize) -> f64 {
        self.information[direction] / self.inflation[(direction, direction)]
    }

    /// Directions within some of the principal ones along which positions are uncorrelated, and the precision along each: a column each,
    /// in coordinates along the principal directions. The other principal directions are left as they are.
    pub fn uncorrelated(&self, of: &[usize]) -> (DMatrix<f64>, Vec<f64>) {
        let dimensions = self.centre.len();
        let mut directions = DMatrix::identity(dimensions, dimensions);
        let mut precisions: Vec<f64> = (0..dimensions).map(|k| self.precision(k)).collect();
        let correlated = |a: &usize| of.iter().any(|b| a != b && self.inflation[(*a, *b)] != 0.0);
        if !of.iter().any(correlated) {
            return (directions, precisions);
        }
        let root = |k: usize| self.information[k].max(NO_INFORMATION).sqrt();
        let covariance = DMatrix::from_fn(of.len(), of.len(), |a, b| {
            let (a, b) = (of[a], of[b]);
            self.inflation[(a, b)] / (root(a) * root(b))
        });
        let eigen = covariance.symmetric_eigen();
        for (column, k) in of.iter().enumerate() {
            for (row, axis) in of.iter().enumerate() {
                directions[(*axis, *k)] = eigen.eigenvectors[(row, column)];
            }
            precisions[*k] = 1.0 / eigen.eigenvalues[column].max(f64::MIN_POSITIVE);
        }
        (directions, precisions)
    }

    /// Standard deviation along a direction; at most a large number where nothing is known but the range.
    pub fn deviation(&self, direction: usize) -> f64 {
        1.0 / self.precision(direction).sqrt().max(1e-9)
    }

    /// By how much a step to the lowest deviance reduces the deviance, in units of the mean inflation.
    pub fn gain(&self, step: &DVector<f64>) -> f64 {
        self.sum_along(step, |k| self.information(k)) / self.mean_inflation()
    }

    /// The length of a step in standard deviations.
    pub fn deviations(&self, step: &DVector<f64>) -> f64 {
        self.sum_along(step, |k| self.precision(k)).sqrt()
    }

    /// Sum over the directions of a weight times the square of the step's part.
    fn sum_along(&self, step: &DVector<f64>, weight: impl Fn(usize) -> f64) -> f64 {
        let parts = self.directions.column_iter().enumerate();
        let parts = parts.map(|(k, direction)| {
            let part = direction.dot(step);
            weight(k) * part * part
        });
        parts.sum()
    }

    /// Information along each direction as if errors were independent.
    pub fn information(&self, direction: usize) -> f64 {
        self.information[direction]
    }

    /// Inflation of the variance of all errors together: the mean over the directions.
    pub fn mean_inflation(&self) -> f64 {
        self.inflation.trace() / self.centre.len() as f64
    }

    /// Inflation along one direction, at least that of all directions together: errors that a direction hardly changes do not show
    /// their own correlation.
    pub fn inflation_along(&self, direction: usize) -> f64 {
        self.inflation[(direction, direction)].max(self.mean_inflation())
    }

    /// Precision of each coordinate before the recordings: that of its prior, or of a uniform distribution over the range.
    pub fn prior_precisions(&self) -> Vec<f64> {
        let precision = |prior: &Option<(f64, f64)>| {
            prior.map_or(RANGE_PRECISION, |(_, variance)| 1.0 / variance)
        };
        self.prior.iter().map(precision).collect()
    }

    /// How many times as large as their own noise the errors at the centre are; `far` is the size of errors far from it, of which a
    /// small share is taken for noise.
    pub fn systematic(&self, far: f64) -> f64 {
        self.noise.systematic(&self.errors, far)
    }

    /// Variance of each error, as if errors were independent.
    pub fn variances(&self) -> Vec<f64> {
        self.noise.variances()
    }

    /// Twice the negative log-posterior of a point with these errors, as if errors were independent.
    pub fn deviance(&self, point: &[f64], errors: &[f64]) -> f64 {
        let priors = self.prior.iter().zip(point);
        let priors = priors.filter_map(|(prior, at)| {
            let (median, variance) = (*prior)?;
            Some((at - median).powi(2) / variance)
        });
        self.noise.deviance(errors) + priors.sum::<f64>()
    }

    /// The derivatives of the whitened errors at the centre.
    pub fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// Errors, each divided by its standard deviation.
    pub fn whitened(&self, errors: &[f64]) -> DVector<f64> {
        self.noise.whitened_errors(errors)
    }

    /// The step towards the lowest deviance within the range from a point with these errors. A coordinate that the step would move
    /// beyond an end of the range is moved to that end, and the step of the others is computed again.
    pub fn step(&self, point: &[f64], errors: &[f64]) -> DVector<f64> {
        let slope = self.slope(&self.jacobian, point, errors);
        let scaled = DMatrix::from_diagonal(&self.information.add_scalar(RANGE_PRECISION));
        let curvature = &self.directions * scaled * self.directions.transpose();
        let to = minimum_within(&curvature, &slope, point, vec![false; point.len()]);
        DVector::from_fn(point.len(), |axis, _| to[axis] - point[axis])
    }

    /// Derivative of half the deviance at a point, with these derivatives of the whitened errors.
    fn slope(&self, jacobian: &DMatrix<f64>, point: &[f64], errors: &[f64]) -> DVector<f64> {
        let mut slope = jacobian.tr_mul(&self.noise.slopes(errors));
        for (axis, prior) in self.prior.iter().enumerate() {
            if let Some((median, variance)) = prior {
                slope[axis] += (point[axis] - median) / variance;
            }
        }
        slope
    }

    /// The step towards the lowest deviance across a direction, with these derivatives of the whitened errors, and by how much it
    /// promises to reduce the deviance.
    pub fn step_across(
        &self,
        jacobian: &DMatrix<f64>,
        (point, errors): (&[f64], &[f64]),
        direction: usize,
    ) -> (DVector<f64>, f64) {
        let across = self.directions.clone().remove_column(direction);
        let slope = across.tr_mul(&self.slope(jacobian, point, errors));
        let change = jacobian * &across;
        let size = across.ncols();
        // Large errors weigh less, as in iteratively reweighted least squares; otherwise steps would be too short.
        let mut weighted = change.clone();
        let ratios = self
            .noise
            .slopes(errors)
            .component_div(&self.whitened(errors));
        for (mut row, ratio) in weighted.row_iter_mut().zip(ratios.iter()) {
            row *= if ratio.is_finite() { *ratio } else { 1.0 };
        }
        let curvature =
            change.tr_mul(&weighted) + DMatrix::from_diagonal_element(size, size, RANGE_PRECISION);
        let step = match curvature.cholesky() {
            Some(cholesky) => -cholesky.solve(&slope),
            None => DVector::zeros(size),
        };
        let gain = -slope.dot(&step);
        (across * step, gain)
    }

    /// The deviance above that of the centre that the approximation expects at a point, as if errors were independent.
    pub fn beyond(&self, point: &[f64]) -> f64 {
        let from = point.iter().zip(&self.centre).map(|(a, b)| a - b);
        let from = DVector::from_iterator(point.len(), from);
        let along = self.directions.tr_mul(&from);
        along.component_mul(&along).dot(&self.information)
    }

    /// The lowest deviance above that of the centre of all points with this coordinate along one axis.
    pub fn beyond_along(&self, axis: usize, coordinate: f64) -> f64 {
        let variances = (0..self.centre.len()).map(|k| {
            let share = self.directions[(axis, k)];
            share * share / (self.information[k] + RANGE_PRECISION)
        });
        (coordinate - self.centre[axis]).powi(2) / variances.sum::<f64>()
    }

    /// How far the lowest deviance moves where the errors at the centre become these.
    pub fn shift(&self, errors: &[f64]) -> DVector<f64> {
        let change = self.noise.slopes(errors) - self.noise.slopes(&self.errors);
        self.step_down(&self.jacobian.tr_mul(&change))
    }

    fn step_down(&self, slope: &DVector<f64>) -> DVector<f64> {
        let mut step = DVector::zeros(slope.len());
        for (k, direction) in self.directions.column_iter().enumerate() {
            let precision = self.information[k] + RANGE_PRECISION;
            step -= direction * (direction.dot(slope) / precision);
        }
        step
    }
}
