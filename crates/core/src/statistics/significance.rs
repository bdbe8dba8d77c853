//! Nonparametric tests: whether two samples differ, and whether two quantities are correlated.

use serde::{Deserialize, Serialize};
use statrs::function::beta::beta_reg;
use statrs::function::erf::erfc;
use statrs::stats_tests::NaNPolicy;
use statrs::stats_tests::ks_test::{KSTwoSampleAlternativeMethod, ks_twosample};

use super::rank::{check_sample, ranks};
use crate::error::{Error, Result};

/// Up to this number of values in the smaller sample, [`mann_whitney`] counts all orders, as scipy does.
const EXACT_SAMPLE: usize = 8;
/// Up to this product of the sample sizes, [`kolmogorov_smirnov`] counts all orders.
const EXACT_PRODUCT: usize = 10_000;

/// How a p value was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PValueMethod {
    /// All orders of the values were counted.
    Exact,
    /// The approximation for large samples.
    Asymptotic,
}

/// A two-sided test of two samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleTest {
    /// The statistic: U of the first sample, the largest distance D, or the rank correlation ρ.
    pub statistic: f64,
    /// Probability of a statistic at least as extreme if the samples came from one distribution (or if the quantities were
    /// independent).
    pub p_value: f64,
    /// How the p value was computed.
    pub method: PValueMethod,
}

impl SampleTest {
    pub(super) fn asymptotic(statistic: f64, p_value: f64) -> Self {
        Self {
            statistic,
            p_value,
            method: PValueMethod::Asymptotic,
        }
    }
}

/// Mann–Whitney U test (Mann & Whitney 1947): is one sample larger than the other?
///
/// As `scipy.stats.mannwhitneyu(x, y, method="auto")`: exact if the smaller sample has at most 8 values and no values are tied,
/// else the normal approximation with continuity and tie correction. The function of statrs 0.19 is not used, because it lists every
/// combination for the exact value (8 of 60 values: 2.6·10⁹).
///
/// ```
/// let test = realgap_core::statistics::mann_whitney(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0])?;
/// assert_eq!(test.statistic, 0.0);
/// assert!((test.p_value - 0.1).abs() < 1e-12);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// An empty sample, values that are not finite.
pub fn mann_whitney(x: &[f64], y: &[f64]) -> Result<SampleTest> {
    check_sample("x", x, 1)?;
    check_sample("y", y, 1)?;
    let (n1, n2) = (x.len() as f64, y.len() as f64);
    let (ranks, tie_term) = ranks(&[x, y].concat());
    let statistic = ranks[..x.len()].iter().sum::<f64>() - n1 * (n1 + 1.0) / 2.0;
    let larger = statistic.max(n1 * n2 - statistic);
    let (p_value, method) = if x.len().min(y.len()) <= EXACT_SAMPLE && tie_term == 0.0 {
        let tail = exact_u_tail(x.len(), y.len(), larger);
        ((2.0 * tail).min(1.0), PValueMethod::Exact)
    } else {
        let n = n1 + n2;
        let variance = n1 * n2 / 12.0 * (n + 1.0 - tie_term / (n * (n - 1.0)));
        let p_value = if variance > 0.0 {
            let z = (larger - n1 * n2 / 2.0 - 0.5) / variance.sqrt();
            erfc(z / std::f64::consts::SQRT_2).min(1.0)
        } else {
            1.0
        };
        (p_value, PValueMethod::Asymptotic)
    };
    Ok(SampleTest {
        statistic,
        p_value,
        method,
    })
}

/// P(U ≥ u) over all orders of n1 + n2 different values, by the recurrence of Mann & Whitney (1947).
fn exact_u_tail(n1: usize, n2: usize, u: f64) -> f64 {
    let (small, large) = (n1.min(n2), n1.max(n2));
    // share[m][k]: P(U = k) for m values of one sample and those of the other seen so far.
    let mut share = vec![vec![0.0; n1 * n2 + 1]; small + 1];
    for row in &mut share {
        row[0] = 1.0;
    }
    for n in 1..=large {
        for m in 1..=small {
            // The largest value is of the first sample (it is above n others) or of the second.
            let (first, second) = (m as f64 / (m + n) as f64, n as f64 / (m + n) as f64);
            let row: Vec<f64> = (0..=n1 * n2)
                .map(|k| {
                    let with = if k >= n { share[m - 1][k - n] } else { 0.0 };
                    first * with + second * share[m][k]
                })
                .collect();
            share[m] = row;
        }
    }
    let from = u.ceil() as usize;
    share[small][from.min(n1 * n2)..].iter().sum()
}

/// Two-sample Kolmogorov–Smirnov test: do the samples have different distributions?
///
/// Exact (as `scipy.stats.ks_2samp(x, y, method="exact")`, which is conservative with ties) up to a product of the sample sizes
/// of 10 000, else Kolmogorov's limit `scipy.stats.kstwobign.sf(D √(n₁n₂/(n₁+n₂)))`. It is computed by statrs.
///
/// # Errors
/// An empty sample, values that are not finite.
pub fn kolmogorov_smirnov(x: &[f64], y: &[f64]) -> Result<SampleTest> {
    check_sample("x", x, 1)?;
    check_sample("y", y, 1)?;
    let (how, method) = if x.len() * y.len() <= EXACT_PRODUCT {
        (
            KSTwoSampleAlternativeMethod::TwoSidedExact,
            PValueMethod::Exact,
        )
    } else {
        (
            KSTwoSampleAlternativeMethod::TwoSidedAsymptotic,
            PValueMethod::Asymptotic,
        )
    };
    let (statistic, p_value) = ks_twosample(x.to_vec(), y.to_vec(), how, NaNPolicy::Error)
        .map_err(|e| Error::invalid(format!("the samples cannot be compared: {e}")))?;
    Ok(SampleTest {
        statistic,
        p_value: p_value.clamp(0.0, 1.0),
        method,
    })
}

/// Spearman's rank correlation: do two quantities increase together?
///
/// ρ is computed from the mean ranks; p as in `scipy.stats.spearmanr`, by Student's t with n − 2 degrees of freedom, which is a rough
/// approximation below about ten values.
///
/// # Errors
/// Samples of different length, fewer than three values, values that are not finite, a constant sample.
pub fn spearman(x: &[f64], y: &[f64]) -> Result<SampleTest> {
    spearman_effective(x, y, x.len() as f64)
}

/// As [`spearman`], for pairs that are equivalent to only `pairs` independent pairs ([`independent_pairs`](super::independent_pairs)).
///
/// # Errors
/// As [`spearman`], and fewer than three independent pairs.
pub fn spearman_effective(x: &[f64], y: &[f64], pairs: f64) -> Result<SampleTest> {
    check_sample("x", x, 3)?;
    check_sample("y", y, 3)?;
    if x.len() != y.len() {
        return Err(Error::invalid("a correlation needs pairs").found(format!(
            "{} and {} values",
            x.len(),
            y.len()
        )));
    }
    let centre = (x.len() + 1) as f64 / 2.0;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (a, b) in ranks(x).0.into_iter().zip(ranks(y).0) {
        let (a, b) = (a - centre, b - centre);
        xx += a * a;
        xy += a * b;
        yy += b * b;
    }
    if xx == 0.0 || yy == 0.0 {
        return Err(Error::invalid(
            "a sample of equal values has no correlation",
        ));
    }
    let statistic = (xy / (xx * yy).sqrt()).clamp(-1.0, 1.0);
    if pairs.is_nan() || pairs < 3.0 {
        return Err(
            Error::invalid("too few independent pairs for a correlation")
                .found(format!("{pairs:.1}"))
                .allowed("3 or more"),
        );
    }
    let freedom = pairs - 2.0;
    // 2 P(T > |t|) with t² = ρ² ν / (1 − ρ²), so that ν / (ν + t²) = 1 − ρ².
    let p_value = match 1.0 - statistic * statistic {
        rest if rest > 0.0 => beta_reg(freedom / 2.0, 0.5, rest.min(1.0)),
        _ => 0.0,
    };
    Ok(SampleTest::asymptotic(statistic, p_value))
}
