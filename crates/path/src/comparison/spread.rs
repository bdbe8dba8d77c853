//! The regularised covariance of repeated recordings of a run, with the Mahalanobis distance of the metric `pca-whitened`.

use super::basis::{Basis, Components, VECTOR, difference, dot};
use crate::trajectory::Prepared;
use realgap_core::error::{Error, Result};

/// Standard deviation of the tracker's noise in every coordinate, metres. It is added to the covariance of the recordings, so that no
/// direction has a smaller variance than the tracker's.
pub const TRACKER_NOISE_M: f64 = 1e-3;

/// Regularised covariance of prepared recordings of the same run, by which differences are scaled.
///
/// With S the covariance of the vectors (x1..xN, y1..yN) about their mean, p their length and µ = tr S / p, the regularised covariance is
/// C = (1 − α) S + (α µ + σ²) I. It is shrunk towards equal variances by the oracle approximating share α (Chen, Wiesel, Eldar and
/// Hero 2010, eq. 23, in the form of scikit-learn), because a few recordings do not determine the variance in most directions; and the
/// variance σ² of the tracker ([`TRACKER_NOISE_M`]) is added.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// The orthonormal directions in which the recordings differ.
    directions: Vec<Vec<f64>>,
    /// Variance of C along each of these directions, m².
    along_m2: Vec<f64>,
    /// Variance of C in every other direction, m².
    elsewhere_m2: f64,
    /// Mean square Mahalanobis distance of two recordings.
    of_two_recordings: f64,
    shrinkage: f64,
}

impl Spread {
    /// The regularised covariance of these recordings.
    ///
    /// # Errors
    /// Fewer than two recordings, or recordings that do not differ.
    pub fn of(recordings: &[&Prepared]) -> Result<Self> {
        let few = |found: String| {
            Error::invalid("the spread of repeated recordings needs recordings that differ")
                .field("recordings")
                .found(found)
                .allowed("at least two repeats of the same run")
                .hint("record more repeats, or choose another metric, e.g. pca")
        };
        let n = recordings.len();
        if n < 2 {
            return Err(few(format!("{n}")));
        }
        let basis = Basis::fit(recordings, Components::Variance(1.0))?;
        let coefficients: Vec<Vec<f64>> =
            recordings.iter().map(|r| basis.coefficients_m(r)).collect();
        let variances_m2: Vec<f64> = (0..basis.kept())
            .map(|k| coefficients.iter().map(|c| c[k] * c[k]).sum::<f64>() / n as f64)
            .collect();
        let trace_m2: f64 = variances_m2.iter().sum();
        if trace_m2 <= 0.0 {
            return Err(few(format!("{n} equal ones")));
        }
        let shrinkage = shrinkage(&variances_m2, n);
        let elsewhere_m2 = shrinkage * trace_m2 / VECTOR as f64 + TRACKER_NOISE_M.powi(2);
        let along_m2: Vec<f64> = variances_m2
            .iter()
            .map(|variance| (1.0 - shrinkage) * variance + elsewhere_m2)
            .collect();
        // The expected squared difference of two draws is twice the unbiased variance, in each direction.
        let unbiased = n as f64 / (n - 1) as f64;
        let of_two_recordings = variances_m2
            .iter()
            .zip(&along_m2)
            .map(|(variance, ruler)| 2.0 * unbiased * variance / ruler)
            .sum();
        Ok(Self {
            directions: basis.components[..basis.kept()].to_vec(),
            along_m2,
            elsewhere_m2,
            of_two_recordings,
            shrinkage,
        })
    }

    /// The Mahalanobis distance (d' C⁻¹ d)^½ of two paths, divided by the root mean square of this distance between two recordings: 1
    /// means the typical distance of two recordings. Dimensionless.
    pub fn distance(&self, a: &Prepared, b: &Prepared) -> f64 {
        let difference = difference(a, b);
        let mut rest_m2 = dot(&difference, &difference);
        let mut squared = 0.0;
        for (direction, ruler_m2) in self.directions.iter().zip(&self.along_m2) {
            let along_m2 = dot(direction, &difference).powi(2);
            rest_m2 -= along_m2;
            squared += along_m2 / ruler_m2;
        }
        squared += rest_m2.max(0.0) / self.elsewhere_m2;
        (squared / self.of_two_recordings).sqrt()
    }

    /// The same covariance for lengths that are multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let squared = factor * factor;
        Self {
            along_m2: self.along_m2.iter().map(|m2| m2 * squared).collect(),
            elsewhere_m2: self.elsewhere_m2 * squared,
            ..self.clone()
        }
    }

    /// The share α of shrinkage, 0 to 1.
    pub fn shrinkage(&self) -> f64 {
        self.shrinkage
    }
}

/// The oracle approximating share of shrinkage, from the nonzero eigenvalues of S and the number of recordings.
fn shrinkage(variances_m2: &[f64], n: usize) -> f64 {
    let p = VECTOR as f64;
    let mean_square: f64 = variances_m2.iter().map(|v| v * v).sum::<f64>() / (p * p);
    let squared_mean = (variances_m2.iter().sum::<f64>() / p).powi(2);
    let below = (n as f64 + 1.0) * (mean_square - squared_mean / p);
    if below <= 0.0 {
        return 1.0;
    }
    ((mean_square + squared_mean) / below).min(1.0)
}
