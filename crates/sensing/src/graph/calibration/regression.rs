//! Forward regression with orthogonal least squares: chooses the terms of a polynomial that explain the data best (Chen, Billings &
//! Luo 1989).
//!
//! In every step each remaining candidate is made orthogonal to the chosen ones, and the one with the largest error reduction
//! ratio is chosen: the share of yᵀy that it explains. The results agree with `sysidentpy.model_structure_selection.FROLS` 0.9 with
//! `ols` (tests/golden/frols.json).

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use realgap_core::error::{Error, Result};

pub use crate::graph::monomial::{Powers, monomial};

/// The criterion by which the number of terms is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Stop {
    /// The minimum of n ln(σ²) + 2 k (Akaike 1974).
    Aic,
    /// The minimum of n ln(σ²) + k ln n (Schwarz 1978).
    Bic,
    /// The smallest number of terms that explains this share of yᵀy.
    Err(f64),
    /// This number of terms.
    Terms(usize),
    /// The number of terms and the degree with the smallest error in a cross-validation over parts of the path.
    Validation,
}

/// All monomials of two variables up to a degree, in the order of SysIdentPy: 1, x, y, x², xy, y², …
pub fn monomials(degree: u32) -> Vec<Powers> {
    (0..=degree)
        .flat_map(|total| (0..=total).map(move |y| [total - y, y]))
        .collect()
}

/// A chosen term and its error reduction ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// Index of the regressor.
    pub index: usize,
    /// Error reduction ratio.
    pub ratio: f64,
}

/// A candidate depends linearly on the chosen terms if the share of its squared norm that is orthogonal to them is below this.
const DEPENDENT: f64 = 1e-10;

/// The regressors in the order in which they are chosen: at most `most`, and none that depends linearly on earlier ones.
///
/// `regressors` has one row for each sample and one column for each candidate.
///
/// # Errors
/// More terms than samples, values that are not finite, a `y` of zeros.
pub fn order(regressors: &DMatrix<f64>, y: &DVector<f64>, most: usize) -> Result<Vec<Chosen>> {
    let (samples, count) = regressors.shape();
    if samples != y.len() || samples == 0 {
        return Err(Error::invalid("a regression needs one row for each sample")
            .found(format!("{samples} rows, {} samples", y.len())));
    }
    if most > samples {
        return Err(Error::invalid("more terms than samples")
            .found(format!("{most} terms, {samples} samples"))
            .hint("lower the degree or the number of terms, or log more"));
    }
    let total = y.norm_squared();
    if !total.is_finite() || regressors.iter().any(|v| !v.is_finite()) {
        return Err(Error::invalid("a regression needs finite numbers"));
    }
    if total == 0.0 {
        return Err(Error::invalid(
            "all values are 0, so that no terms can be chosen",
        ));
    }
    let size: Vec<f64> = regressors.column_iter().map(|c| c.norm_squared()).collect();
    let mut left = regressors.clone();
    let mut is_left = vec![true; count];
    let mut chosen = Vec::new();
    while chosen.len() < most.min(count) {
        let ratio = |index: usize| -> Option<f64> {
            let column = left.column(index);
            let norm = column.norm_squared();
            let is_free = is_left[index] && norm > DEPENDENT * size[index] && norm > 0.0;
            is_free.then(|| column.dot(y).powi(2) / (norm * total))
        };
        // Of candidates with equal ratios, the first is chosen, so that the result is deterministic.
        let best = (0..count).filter_map(|i| Some((i, ratio(i)?))).fold(
            None,
            |best: Option<(usize, f64)>, next| match best {
                Some(best) if best.1 >= next.1 => Some(best),
                _ => Some(next),
            },
        );
        let Some((index, ratio)) = best else {
            break;
        };
        is_left[index] = false;
        let direction = left.column(index).normalize();
        for other in (0..count).filter(|i| is_left[*i]) {
            let along = direction.dot(&left.column(other));
            left.column_mut(other).axpy(-along, &direction, 1.0);
        }
        chosen.push(Chosen { index, ratio });
    }
    Ok(chosen)
}

/// Least squares over chosen regressors.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Coefficients.
    pub values: Vec<f64>,
    /// Standard errors of the coefficients, computed as if errors were independent; infinite without degrees of freedom.
    pub errors: Vec<f64>,
    /// Mean squared residual.
    pub mean_square: f64,
}

/// Estimates the coefficients of these regressors.
///
/// # Errors
/// Dependent regressors.
pub fn estimate(
    regressors: &DMatrix<f64>,
    y: &DVector<f64>,
    chosen: &[Chosen],
) -> Result<Estimate> {
    let columns: Vec<usize> = chosen.iter().map(|c| c.index).collect();
    let part = regressors.select_columns(&columns);
    let factors = part.clone().qr();
    let (q, r) = (factors.q(), factors.r());
    let dependent = || {
        Error::invalid("the terms of a polynomial depend on each other")
            .hint("log scans at more positions")
    };
    let values = r
        .solve_upper_triangular(&(q.transpose() * y))
        .ok_or_else(dependent)?;
    let inverse = r
        .solve_upper_triangular(&DMatrix::identity(columns.len(), columns.len()))
        .ok_or_else(dependent)?;
    let squares = (y - &part * &values).norm_squared();
    let samples = y.len();
    let freedom = samples.saturating_sub(columns.len());
    let variance = if freedom > 0 {
        squares / freedom as f64
    } else {
        f64::INFINITY
    };
    Ok(Estimate {
        errors: inverse
            .row_iter()
            .map(|row| (variance * row.norm_squared()).sqrt())
            .collect(),
        values: values.iter().copied().collect(),
        mean_square: squares / samples as f64,
    })
}

/// The mean squared residuals after 1, 2, … terms, from the share of yᵀy that the terms do not explain.
pub fn mean_squares(chosen: &[Chosen], y: &DVector<f64>) -> Vec<f64> {
    let total = y.norm_squared();
    let mut left = 1.0;
    let mut squares = Vec::with_capacity(chosen.len());
    for term in chosen {
        left -= term.ratio;
        squares.push((left * total).max(0.0) / y.len() as f64);
    }
    squares
}

/// The information criterion after 1, 2, … terms: n ln σ² plus the penalty, as in SysIdentPy.
pub fn criterion(stop: Stop, squares: &[f64], samples: usize) -> Vec<f64> {
    let n = samples as f64;
    let penalty = if stop == Stop::Aic { 2.0 } else { libm::log(n) };
    // Residuals are limited from below so that rounding errors do not affect the choice.
    squares
        .iter()
        .enumerate()
        .map(|(k, s)| n * libm::log(s.max(1e-24)) + penalty * (k + 1) as f64)
        .collect()
}

/// How many of the ordered terms to keep. [`Stop::Validation`] is decided by the caller, not by this function.
pub fn count(stop: Stop, chosen: &[Chosen], y: &DVector<f64>) -> usize {
    let all = chosen.len();
    match stop {
        Stop::Terms(terms) => terms.min(all),
        Stop::Err(share) => {
            let mut sum = 0.0;
            let reached = chosen.iter().position(|term| {
                sum += term.ratio;
                sum >= share
            });
            reached.map_or(all, |index| index + 1)
        }
        Stop::Aic | Stop::Bic | Stop::Validation => {
            let values = criterion(stop, &mean_squares(chosen, y), y.len());
            let best = (0..all).min_by(|a, b| values[*a].total_cmp(&values[*b]));
            best.map_or(0, |index| index + 1)
        }
    }
}
