//! Wilcoxon's signed-rank test: do paired values differ? It assumes only that the distribution of the differences is symmetric.

use serde::Serialize;
use statrs::function::erf::erfc;

use super::rank::{check_sample, ranks};
use super::significance::PValueMethod;
use crate::error::Result;

/// Up to this number of pairs, the p value is exact: all combinations of signs are counted.
const EXACT_PAIRS: usize = 60;

/// A two-sided test of differences, with the size of the effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairedTest {
    /// Number of pairs that differ.
    pub pairs: usize,
    /// Sum of the ranks of the positive differences.
    pub statistic: f64,
    /// Probability of a sum at least as extreme if both signs were equally likely.
    pub p_value: f64,
    /// How the p value was computed.
    pub method: PValueMethod,
    /// Rank-biserial correlation of matched pairs (Kerby 2014): the sum of the ranks of positive differences minus that of negative
    /// differences, as a share of the sum of all ranks; −1 to 1.
    pub effect: f64,
}

/// Wilcoxon's signed-rank test (Wilcoxon 1945): is the centre of the differences other than 0?
///
/// Differences of 0 are left out, as in `scipy.stats.wilcoxon(d, zero_method="wilcox")`. Up to 60 pairs, all combinations of signs are
/// counted, also with ties (scipy: `method=PermutationMethod()`; scipy's `"exact"` does not support ties); with more pairs, the normal
/// approximation with the correction for ties is used. If all differences are 0, p is 1 and the effect is 0.
///
/// ```
/// let test = realgap_core::statistics::wilcoxon_signed_rank(&[0.3, 0.1, 0.5, 0.2, 0.4])?;
/// assert_eq!((test.p_value, test.effect), (0.0625, 1.0));
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// An empty list of differences, differences that are not finite.
pub fn wilcoxon_signed_rank(differences: &[f64]) -> Result<PairedTest> {
    check_sample("differences", differences, 1)?;
    let kept: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
    let sizes: Vec<f64> = kept.iter().map(|d| d.abs()).collect();
    let (ranks, tie_term) = ranks(&sizes);
    let whole: f64 = ranks.iter().sum();
    let statistic: f64 = ranks
        .iter()
        .zip(&kept)
        .filter(|(_, d)| **d > 0.0)
        .map(|(rank, _)| rank)
        .sum();
    let larger = statistic.max(whole - statistic);
    let (p_value, method) = if kept.len() <= EXACT_PAIRS {
        ((2.0 * tail(&ranks, larger)).min(1.0), PValueMethod::Exact)
    } else {
        let n = kept.len() as f64;
        let variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - tie_term / 48.0;
        let z = (larger - 0.5 * whole) / variance.sqrt();
        (
            erfc(z / std::f64::consts::SQRT_2).min(1.0),
            PValueMethod::Asymptotic,
        )
    };
    Ok(PairedTest {
        pairs: kept.len(),
        statistic,
        p_value,
        method,
        effect: if whole > 0.0 {
            (2.0 * statistic - whole) / whole
        } else {
            0.0
        },
    })
}

/// Share of all combinations of signs whose positive ranks sum to `from` or more. Ranks are multiples of one half.
fn tail(ranks: &[f64], from: f64) -> f64 {
    let doubled: Vec<usize> = ranks
        .iter()
        .map(|rank| (2.0 * rank).round() as usize)
        .collect();
    let mut share = vec![0.0; doubled.iter().sum::<usize>() + 1];
    share[0] = 1.0;
    let mut most = 0;
    for rank in doubled {
        for sum in (0..=most).rev() {
            let half = 0.5 * share[sum];
            share[sum] = half;
            share[sum + rank] += half;
        }
        most += rank;
    }
    let first = ((2.0 * from).round() as usize).min(share.len() - 1);
    share[first..].iter().sum()
}
