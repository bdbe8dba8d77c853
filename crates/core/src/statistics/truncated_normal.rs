//! Quantiles of a normal distribution that is truncated to an interval.

use super::normal_quantile;

/// Share of the standard normal distribution below a value.
fn share_below(value: f64) -> f64 {
    0.5 * libm::erfc(-value * std::f64::consts::FRAC_1_SQRT_2)
}

/// The value below which `share` (0 to 1) of the standard normal distribution between `low` and `high` lies. Where the distribution is
/// practically 0 between them, the end that is nearer to 0 is returned.
///
/// ```
/// use realgap_core::statistics::truncated_normal_quantile;
///
/// assert!(truncated_normal_quantile(-1.0, 1.0, 0.5).abs() < 1e-12);
/// // Far from the centre the distribution falls as exp(−low · x).
/// let median = truncated_normal_quantile(20.0, 40.0, 0.5);
/// assert!((median - 20.0 - 2f64.ln() / 20.0).abs() < 1e-3);
/// ```
pub fn truncated_normal_quantile(low: f64, high: f64, share: f64) -> f64 {
    if low > 0.0 {
        // Shares near 1 cannot be told apart, those near 0 can.
        return -truncated_normal_quantile(-high, -low, 1.0 - share);
    }
    let (from, to) = (share_below(low), share_below(high));
    if to - from < 1e-300 {
        return high.min(0.0);
    }
    normal_quantile(from + share * (to - from)).clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_an_interval_increase_from_one_end_to_the_other() {
        for (low, high) in [
            (-1.0, 2.0),
            (-9.0, -7.0),
            (5.0, 30.0),
            (-60.0, -50.0),
            (0.0, 0.0),
        ] {
            let quantile = |share: f64| truncated_normal_quantile(low, high, share);
            let all: Vec<f64> = (0..=10).map(|k| quantile(f64::from(k) / 10.0)).collect();
            assert!(all.windows(2).all(|pair| pair[0] <= pair[1]), "{all:?}");
            assert!(
                all.iter().all(|value| (low..=high).contains(value)),
                "{all:?}"
            );
        }
        // The whole distribution.
        let upper = truncated_normal_quantile(-40.0, 40.0, 0.95);
        assert!((upper - 1.644_853_626_951).abs() < 1e-9);
    }
}
