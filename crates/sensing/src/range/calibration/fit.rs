//! Maximum-likelihood fit of normal readings whose mean and standard deviation ("spread") are curves over the distance, by Fisher
//! scoring.
//!
//! The Fisher information of mean and spread is block-diagonal for a normal density (Barndorff-Nielsen & Cox 1994, section 3.2), so
//! both are improved in turn: the mean by weighted least squares, the spread by scoring. The inverse information gives standard
//! errors.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::cell::Summary;
use crate::range::form::{Curve, Form, Point};

/// The forms and terms of a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub mean: &'static dyn Form,
    pub spread: &'static dyn Form,
    /// Whether the mean has a term in the angle of incidence.
    pub incidence: bool,
    /// Whether the mean has a term in the angle of offset.
    pub offset: bool,
    /// Lower limit of standard deviations, which follows from the rounding of readings.
    pub least_spread: f64,
}

impl Plan {
    /// Number of the mean's parameters.
    pub(super) fn parameters(&self, fitted: &Fitted) -> usize {
        fitted.mean.values.len() + usize::from(self.incidence) + usize::from(self.offset)
    }
}

/// A fitted density.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub mean: Curve,
    pub incidence_per_deg: f64,
    pub offset_per_deg: f64,
    pub spread: Curve,
    /// Standard errors of the mean's parameters, followed by those of the fitted terms in the angles.
    pub mean_errors: Vec<f64>,
    /// Standard errors of the spread's parameters.
    pub spread_errors: Vec<f64>,
}

const ROUNDS: usize = 200;
const HALVINGS: usize = 30;
/// The fit has converged if a round increases the log-likelihood per reading by less than this.
const GAIN: f64 = 1e-12;
/// Number of groups into which distances are pooled for the initial estimate of the spread.
const POOLS: usize = 21;

impl Fitted {
    pub(super) fn mean_at(&self, s: &Summary) -> f64 {
        self.mean.at(s.distance)
            + self.incidence_per_deg * s.incidence_deg
            + self.offset_per_deg * s.offset_deg
    }

    /// Log-likelihood of a cell; −∞ if the spread is not positive.
    pub(super) fn log_likelihood(&self, s: &Summary) -> f64 {
        let (mean, sd) = (self.mean_at(s), self.spread.at(s.distance));
        if !(sd > 0.0 && sd.is_finite() && mean.is_finite()) {
            return f64::NEG_INFINITY;
        }
        let squares = s.squares + s.count * (s.mean - mean).powi(2);
        -0.5 * squares / (sd * sd)
            - s.count * (libm::log(sd) + 0.5 * libm::log(std::f64::consts::TAU))
    }

    fn total(&self, data: &[Summary]) -> f64 {
        data.iter().map(|s| self.log_likelihood(s)).sum()
    }
}

/// Fits the plan to the data; `None` if a form cannot be fitted to the data.
pub(super) fn fit(plan: Plan, data: &[Summary]) -> Option<Fitted> {
    let mut distances: Vec<f64> = data.iter().map(|s| s.distance).collect();
    distances.dedup();
    let points: Vec<Point> = data
        .iter()
        .map(|s| Point {
            d: s.distance,
            y: s.mean,
            weight: s.count,
        })
        .collect();
    let curve = |form: &'static dyn Form, points: &[Point]| -> Option<Curve> {
        let knots = form.knots(&distances);
        let values = form.start(&knots, points)?;
        Curve::new(form, knots, values).ok()
    };
    let mean = curve(plan.mean, &points)?;
    let spread = curve(plan.spread, &spreads(&mean, data, plan.least_spread))?;
    let mut fitted = Fitted {
        mean,
        incidence_per_deg: 0.0,
        offset_per_deg: 0.0,
        spread,
        mean_errors: Vec::new(),
        spread_errors: Vec::new(),
    };
    let readings: f64 = data.iter().map(|s| s.count).sum();
    // Rounding contributes to the spread: each cell has at least the variance of uniform errors within one step. The parameters of
    // the mean take degrees of freedom, for which the sums of squares are corrected (as by n − 1 for a single mean).
    let parameters = plan.parameters(&fitted);
    let taken = readings / (readings - parameters as f64).max(1.0);
    let data: Vec<Summary> = data
        .iter()
        .map(|s| Summary {
            squares: (taken * s.squares).max(s.count * plan.least_spread.powi(2)),
            ..*s
        })
        .collect();
    let mut best = fitted.total(&data);
    if !best.is_finite() {
        return None;
    }
    for _ in 0..ROUNDS {
        let before = best;
        let (information, score) = mean_scores(&fitted, plan, &data);
        best = improve(
            &mut fitted,
            &data,
            best,
            &solve(&information, &score)?,
            |f, step| f.move_mean(plan, step),
        );
        let (information, score) = spread_scores(&fitted, &data);
        best = improve(
            &mut fitted,
            &data,
            best,
            &solve(&information, &score)?,
            |f, step| {
                f.spread
                    .values
                    .iter_mut()
                    .zip(step)
                    .for_each(|(v, s)| *v += s);
            },
        );
        if best - before <= GAIN * readings {
            break;
        }
    }
    fitted.mean_errors = errors(&mean_scores(&fitted, plan, &data).0)?;
    fitted.spread_errors = errors(&spread_scores(&fitted, &data).0)?;
    Some(fitted)
}

/// Standard deviations around a mean curve, pooled over neighbouring distances.
fn spreads(mean: &Curve, data: &[Summary], least: f64) -> Vec<Point> {
    let size = data.len().div_ceil(POOLS).max(1);
    data.chunks(size)
        .map(|pool| {
            let count: f64 = pool.iter().map(|s| s.count).sum();
            // Deviations are taken from the mean of the cell if it has several readings, and from the curve if it has one.
            let squares: f64 = pool
                .iter()
                .map(|s| match s.count {
                    count if count > 1.0 => s.squares * count / (count - 1.0),
                    _ => (s.mean - mean.at(s.distance)).powi(2),
                })
                .sum();
            Point {
                d: pool.iter().map(|s| s.count * s.distance).sum::<f64>() / count,
                y: (squares / count).sqrt().max(least).max(f64::MIN_POSITIVE),
                weight: count,
            }
        })
        .collect()
}

impl Fitted {
    /// Derivatives of a mean reading with respect to the parameters of the mean.
    pub(super) fn mean_gradient(&self, plan: Plan, s: &Summary) -> Vec<f64> {
        let mut gradient = self.mean.gradient(s.distance);
        gradient.extend(plan.incidence.then_some(s.incidence_deg));
        gradient.extend(plan.offset.then_some(s.offset_deg));
        gradient
    }

    pub(super) fn move_mean(&mut self, plan: Plan, step: &[f64]) {
        let own = self.mean.values.len();
        self.mean
            .values
            .iter_mut()
            .zip(step)
            .for_each(|(v, s)| *v += s);
        let mut rest = step[own..].iter();
        if plan.incidence {
            self.incidence_per_deg += rest.next().unwrap_or(&0.0);
        }
        if plan.offset {
            self.offset_per_deg += rest.next().unwrap_or(&0.0);
        }
    }
}

/// Information and score of the mean's parameters.
fn mean_scores(fitted: &Fitted, plan: Plan, data: &[Summary]) -> (DMatrix<f64>, DVector<f64>) {
    accumulate(data, |s| {
        let sd = fitted.spread.at(s.distance);
        let gradient = fitted.mean_gradient(plan, s);
        let weight = s.count / (sd * sd);
        (gradient, weight, weight * (s.mean - fitted.mean_at(s)))
    })
}

/// Information and score of the spread's parameters.
fn spread_scores(fitted: &Fitted, data: &[Summary]) -> (DMatrix<f64>, DVector<f64>) {
    accumulate(data, |s| {
        let sd = fitted.spread.at(s.distance);
        let squares = s.squares + s.count * (s.mean - fitted.mean_at(s)).powi(2);
        let score = squares / sd.powi(3) - s.count / sd;
        (
            fitted.spread.gradient(s.distance),
            2.0 * s.count / (sd * sd),
            score,
        )
    })
}

/// Sums of gradient · gradientᵀ · weight and of gradient · score.
fn accumulate(
    data: &[Summary],
    of: impl Fn(&Summary) -> (Vec<f64>, f64, f64),
) -> (DMatrix<f64>, DVector<f64>) {
    let mut sums: Option<(DMatrix<f64>, DVector<f64>)> = None;
    for summary in data {
        let (gradient, weight, score) = of(summary);
        let n = gradient.len();
        let (matrix, vector) =
            sums.get_or_insert_with(|| (DMatrix::zeros(n, n), DVector::zeros(n)));
        for (i, a) in gradient.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            vector[i] += a * score;
            for (j, b) in gradient.iter().enumerate() {
                matrix[(i, j)] += a * b * weight;
            }
        }
    }
    sums.unwrap_or_else(|| (DMatrix::zeros(0, 0), DVector::zeros(0)))
}

/// Cholesky factor of an information matrix that is scaled to a unit diagonal (because its parameters may differ by orders of
/// magnitude), and the scales; `None` if a parameter is not determined.
pub(super) fn factor(matrix: &DMatrix<f64>) -> Option<(Cholesky<f64, Dyn>, Vec<f64>)> {
    let scale: Vec<f64> = (0..matrix.nrows()).map(|i| matrix[(i, i)].sqrt()).collect();
    if !scale.iter().all(|s| s.is_finite() && *s > 0.0) {
        return None;
    }
    let scaled = scaled_by(matrix, &scale);
    Some((scaled.cholesky()?, scale))
}

/// A square matrix whose rows and columns are divided by the scales.
pub(super) fn scaled_by(matrix: &DMatrix<f64>, scale: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
        matrix[(i, j)] / (scale[i] * scale[j])
    })
}

fn inverse(information: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (factor, scale) = factor(information)?;
    let inverse = scaled_by(&factor.inverse(), &scale);
    inverse.iter().all(|v| v.is_finite()).then_some(inverse)
}

fn solve(information: &DMatrix<f64>, score: &DVector<f64>) -> Option<Vec<f64>> {
    Some((inverse(information)? * score).iter().copied().collect())
}

fn errors(information: &DMatrix<f64>) -> Option<Vec<f64>> {
    Some(
        inverse(information)?
            .diagonal()
            .iter()
            .map(|v| v.sqrt())
            .collect(),
    )
}

/// Takes the step, or a half, a quarter … of it: the longest one that does not decrease the likelihood.
fn improve(
    fitted: &mut Fitted,
    data: &[Summary],
    before: f64,
    step: &[f64],
    take: impl Fn(&mut Fitted, &[f64]),
) -> f64 {
    let mut share = 1.0;
    for _ in 0..HALVINGS {
        let mut tried = fitted.clone();
        take(
            &mut tried,
            &step.iter().map(|s| share * s).collect::<Vec<_>>(),
        );
        let likelihood = tried.total(data);
        if likelihood >= before {
            *fitted = tried;
            return likelihood;
        }
        share *= 0.5;
    }
    before
}
