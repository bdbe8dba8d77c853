//! The jackknife: intervals from leaving out one item at a time, for few items; and quantiles of Student's t, χ² and F.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, StudentsT};

/// Whether a statistic is a mean over items or over pairs, which decides how the jackknife's variance is corrected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Degree {
    /// A mean over items, or a function of such means.
    Items,
    /// A mean over pairs of items.
    Pairs {
        /// Variance of a single pair, divided by the square of the mean.
        variance: f64,
    },
}

/// Student's t interval of a positive number at `level` by the jackknife of its logarithm (Tukey 1958; Efron & Tibshirani
/// 1993, chapter 11; the logarithm is used because the number is a scale: Miller 1974).
///
/// `left_out` holds the value of the statistic without each item. A mean over pairs is a U-statistic, whose variance has two parts
/// (Hoeffding 1948, section 5): the variance of the items, which the jackknife overestimates by (n − 1)² / (n − 2)² (Efron & Stein 1981), and
/// the variance of single pairs divided by n (n − 1) / 2, which the jackknife misses, and which is the larger part if items are of few
/// kinds. `None` for fewer than three items, or values that are not all positive.
///
/// ```
/// use realgap_core::statistics::{Degree, jackknife_interval};
///
/// let heights_m = [1.0, 1.2, 1.1, 1.4, 0.9];
/// let sum: f64 = heights_m.iter().sum();
/// let without: Vec<f64> = heights_m.iter().map(|h| (sum - h) / 4.0).collect();
/// let (low, high) = jackknife_interval(sum / 5.0, &without, 0.95, Degree::Items).expect("five");
/// // As Student's t of the heights themselves: 0.88 to 1.36.
/// assert!((low - 0.90).abs() < 0.01 && (high - 1.39).abs() < 0.01);
/// ```
pub fn jackknife_interval(
    value: f64,
    left_out: &[f64],
    level: f64,
    degree: Degree,
) -> Option<(f64, f64)> {
    let n = left_out.len() as f64;
    let positive = |v: &f64| v.is_finite() && *v > 0.0;
    if left_out.len() < 3 || !positive(&value) || !left_out.iter().all(positive) {
        return None;
    }
    let logs: Vec<f64> = left_out.iter().map(|v| libm::log(*v)).collect();
    let mut variance = jackknife_variance(&logs);
    if let Degree::Pairs { variance: of_pairs } = degree {
        variance = variance * ((n - 2.0) / (n - 1.0)).powi(2) + 2.0 * of_pairs / (n * (n - 1.0));
    }
    let t = student_quantile(0.5 + 0.5 * level, n - 1.0);
    let factor = libm::exp(t * variance.sqrt());
    Some((value / factor, value * factor))
}

/// The jackknife variance of a statistic, from its values without each item (Tukey 1958).
pub fn jackknife_variance(left_out: &[f64]) -> f64 {
    let n = left_out.len() as f64;
    let mean = left_out.iter().sum::<f64>() / n;
    left_out.iter().map(|v| (v - mean).powi(2)).sum::<f64>() * (n - 1.0) / n
}

/// Quantile of Student's t distribution; infinite without degrees of freedom.
pub fn student_quantile(level: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::INFINITY, |t| t.inverse_cdf(level))
}

/// Quantile of the χ² distribution; infinite without degrees of freedom.
pub fn chi_squared_quantile(level: f64, degrees: f64) -> f64 {
    ChiSquared::new(degrees).map_or(f64::INFINITY, |chi| chi.inverse_cdf(level))
}

/// Probability of a larger value of Fisher's F distribution; 1 without degrees of freedom.
///
/// ```
/// use realgap_core::statistics::fisher_tail;
///
/// // scipy.stats.f.sf(3.0, 4.0, 16.0)
/// assert!((fisher_tail(3.0, 4.0, 16.0) - 0.050345).abs() < 1e-6);
/// ```
pub fn fisher_tail(value: f64, first: f64, second: f64) -> f64 {
    FisherSnedecor::new(first, second).map_or(1.0, |f| f.sf(value.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_items_and_values_that_are_not_positive_have_no_interval() {
        for (value, left_out) in [
            (1.0, vec![1.0, 2.0]),
            (0.0, vec![0.0; 4]),
            (1.0, vec![0.0, 1.0, 1.0]),
            (1.0, vec![f64::NAN, 1.0, 1.0]),
        ] {
            assert!(jackknife_interval(value, &left_out, 0.95, Degree::Items).is_none());
        }
        let same = jackknife_interval(2.0, &[2.0; 5], 0.95, Degree::Pairs { variance: 0.0 });
        assert_eq!(same, Some((2.0, 2.0)));
    }
}
