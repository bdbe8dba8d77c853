//! Forward regression with orthogonal least squares: which terms of a polynomial explain the data (Chen, Billings & Luo 1989).
//!
//! In every step each candidate that is left is made orthogonal to the chosen ones, and the one with the largest error reduction
//! ratio is taken: the share of yᵀy that it explains. As `sysidentpy.model_structure_selection.FROLS` 0.9 with `ols`
//! (tests/golden/frols.json).

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use realgap_core::error::{Error, Result};

pub use crate::graph::monomial::{Powers, monomial};

/// When no more terms are taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Stop {
    /// At the least n ln(σ²) + 2 k (Akaike 1974).
    Aic,
    /// At the least n ln(σ²) + k ln n (Schwarz 1978).
    Bic,
    /// Once the chosen terms explain this share of yᵀy.
    Err(f64),
    /// At this many terms.
    Terms(usize),
    /// At the number and degree that foretell parts of the way that were left out best.
    Validation,
}

/// All monomials of two variables up to a degree, in the order of SysIdentPy: 1, x, y, x², xy, y², …
pub fn monomials(degree: u32) -> Vec<Powers> {
    (0..=degree)
        .flat_map(|total| (0..=total).map(move |y| [total - y, y]))
        .collect()
}

/// A term as it was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// Index of the regressor.
    pub index: usize,
    /// Error reduction ratio.
    pub ratio: f64,
}

/// What is left of a candidate below this share of its size is rounding: it depends on the terms before.
const DEPENDENT: f64 = 1e-10;

/// Regressors in the order in which they explain most, at most `most` of them and no dependent ones.
///
/// `regressors` has a row a sample.
///
/// # Errors
/// More terms than samples, values that are not finite, a `y` of zeros.
pub fn order(regressors: &DMatrix<f64>, y: &DVector<f64>, most: usize) -> Result<Vec<Chosen>> {
    let (samples, count) = regressors.shape();
    if samples != y.len() || samples == 0 {
        return Err(Error::invalid("a regression needs a row a sample")
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
            "there is nothing to explain: all values are 0",
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
        // The first of equals, so that the order of candidates decides and nothing else.
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
    /// Their standard errors, as if errors were independent; infinite without degrees of freedom.
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
    let dependent =
        || Error::invalid("the terms of a polynomial depend on each other").hint("log more places");
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

/// The mean squared residuals after 1, 2, … terms: what the ratios leave of yᵀy.
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

/// The criterion after 1, 2, … terms: n ln σ² and the penalty, as SysIdentPy's information criteria.
pub fn criterion(stop: Stop, squares: &[f64], samples: usize) -> Vec<f64> {
    let n = samples as f64;
    let penalty = if stop == Stop::Aic { 2.0 } else { libm::log(n) };
    // Residuals below rounding must not decide.
    squares
        .iter()
        .enumerate()
        .map(|(k, s)| n * libm::log(s.max(1e-24)) + penalty * (k + 1) as f64)
        .collect()
}

/// How many of the ordered terms to keep; [`Stop::Validation`] is not decided here.
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
