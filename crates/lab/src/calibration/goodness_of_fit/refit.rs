//! A short refit around the best point, so that a model is not blamed for a point between the nodes of a grid.
//!
//! "No parameters explain" is a statement about all parameters, and the best point of a sweep can lie half a step beside the
//! values that explain the recordings. So the residuals are minimised once more from there by Gauss–Newton steps (Nocedal &
//! Wright 2006, section 10.3), and what the parameters could still change in first order is given back.

use nalgebra::{DMatrix, DVector};
use realgap_core::error::Result;

/// The point where the residuals are smallest near the best point.
#[derive(Debug, Clone)]
pub(in crate::calibration) struct Refit {
    /// Its coordinates between the ends of the ranges.
    pub place: Vec<f64>,
    /// The residuals there.
    pub errors: Vec<f64>,
    /// The change of all residuals with each coordinate.
    pub changes: Vec<Vec<f64>>,
}

/// Distance of a finite difference, as a share of the range.
const STEP: f64 = 0.01;
/// Most steps, and the share of the sum of squares that a step has to take away for another one.
const STEPS: usize = 3;
const WORTH: f64 = 0.01;
/// More parameters than this are not refitted: their runs would cost more than the search itself, which for so many parameters
/// is a fit by least squares anyway.
const MOST: usize = 12;
/// Singular values below this share of the largest do not move the point.
const SINGULAR: f64 = 1e-6;

fn loss(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum()
}

impl Refit {
    /// The refit from this place, where the residuals are `errors`. `errors_at` simulates a place; `None` stands for a diverged
    /// run.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn new(
        place: Vec<f64>,
        errors: Vec<f64>,
        errors_at: impl Fn(&[f64]) -> Result<Option<Vec<f64>>>,
    ) -> Result<Self> {
        let mut refit = Self {
            place,
            errors,
            changes: Vec::new(),
        };
        if refit.place.len() > MOST {
            return Ok(refit);
        }
        for step in 0..=STEPS {
            refit.changes = refit.changes_by(&errors_at)?;
            if step == STEPS || !refit.goes_down(&errors_at)? {
                break;
            }
        }
        Ok(refit)
    }

    fn changes_by(
        &self,
        errors_at: &impl Fn(&[f64]) -> Result<Option<Vec<f64>>>,
    ) -> Result<Vec<Vec<f64>>> {
        let axes = 0..self.place.len();
        let change = |axis: usize| {
            let mut place = self.place.clone();
            let step = if place[axis] + STEP > 1.0 {
                -STEP
            } else {
                STEP
            };
            place[axis] += step;
            let known = errors_at(&place)?;
            let known = known.filter(|moved| moved.len() == self.errors.len());
            let moved = known.unwrap_or_else(|| self.errors.clone());
            let pairs = moved.iter().zip(&self.errors);
            Ok(pairs
                .map(|(after, before)| (after - before) / step)
                .collect())
        };
        axes.map(change).collect()
    }

    /// Takes one step, or a quarter of it; false where the residuals hardly become smaller.
    fn goes_down(
        &mut self,
        errors_at: &impl Fn(&[f64]) -> Result<Option<Vec<f64>>>,
    ) -> Result<bool> {
        let columns = self.changes.iter().map(|c| DVector::from_column_slice(c));
        let columns: Vec<DVector<f64>> = columns.collect();
        if columns.is_empty() || self.errors.is_empty() {
            return Ok(false);
        }
        let jacobian = DMatrix::from_columns(&columns);
        // Normal equations of scaled columns: there are few parameters and many residuals.
        let scales: Vec<f64> = columns.iter().map(|c| c.norm().max(1e-300)).collect();
        let scaled = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |row, column| {
            jacobian[(row, column)] / scales[column]
        });
        let errors = DVector::from_column_slice(&self.errors);
        let normal = scaled.tr_mul(&scaled);
        let inverse = normal.pseudo_inverse(SINGULAR).ok();
        let Some(inverse) = inverse else {
            return Ok(false);
        };
        let whole = -(inverse * scaled.tr_mul(&errors));
        for share in [1.0, 0.25] {
            let moved = self.place.iter().zip(whole.iter().zip(&scales));
            let moved =
                moved.map(|(at, (step, scale))| (at + share * step / scale).clamp(0.0, 1.0));
            let place: Vec<f64> = moved.collect();
            let Some(errors) = errors_at(&place)? else {
                continue;
            };
            let (before, after) = (loss(&self.errors), loss(&errors));
            if errors.len() == self.errors.len() && after < before {
                (self.place, self.errors) = (place, errors);
                return Ok(after < (1.0 - WORTH) * before);
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_between_the_nodes_is_found_with_few_runs() {
        let runs = std::cell::Cell::new(0);
        let errors_at = |place: &[f64]| {
            runs.set(runs.get() + 1);
            let at =
                |t: f64| libm::exp(-place[0] * t) - libm::exp(-0.31 * t) + place[1] * t - 0.6 * t;
            Ok(Some((0..50).map(|k| at(f64::from(k) * 0.1)).collect()))
        };
        let start = vec![0.5, 0.5];
        let errors = errors_at(&start).unwrap().unwrap();
        let refit = Refit::new(start, errors, errors_at).unwrap();
        assert!((refit.place[0] - 0.31).abs() < 1e-3, "{:?}", refit.place);
        assert!((refit.place[1] - 0.6).abs() < 1e-3, "{:?}", refit.place);
        assert!(runs.get() <= 14, "{}", runs.get());
    }

    #[test]
    fn a_parameter_without_effect_and_a_diverged_run_move_nothing() {
        let errors_at = |place: &[f64]| {
            let diverges = place[0] != 0.5;
            Ok((!diverges).then(|| vec![1.0, 2.0, 3.0]))
        };
        let refit = Refit::new(vec![0.5, 0.5], vec![1.0, 2.0, 3.0], errors_at).unwrap();
        assert_eq!(refit.place, [0.5, 0.5]);
        assert_eq!(refit.changes, vec![vec![0.0; 3]; 2]);
    }
}
