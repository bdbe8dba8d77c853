//! The noise of a sensor, measured from its own samples: from their high frequencies, and from the step of its values.

use super::resolution::resolution;
use realgap_core::statistics::median;

/// Squared sum of the weights of a third difference, (1, −3, 3, −1): white noise of variance 1 gives differences of this variance.
const THIRD_DIFFERENCE: f64 = 20.0;
/// Median absolute value of normal numbers of standard deviation 1.
const NORMAL_MEDIAN: f64 = 0.674_49;
/// No sensor is better than this share of the spread of what it measures: recordings of a simulation without noise show none.
const LEAST_SHARE: f64 = 1e-4;

/// Standard deviation of the noise of a sensor; `None` where its values are all the same.
///
/// Third differences remove every motion that is a parabola over four samples. Their median is that of the noise even where a few
/// samples jump. Values in steps have at least the noise of rounding, step / √12.
pub fn sensor_noise(values: &[f64]) -> Option<f64> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
    let differences = values.windows(4);
    let differences: Vec<f64> = differences
        .map(|w| (w[0] - 3.0 * w[1] + 3.0 * w[2] - w[3]).abs())
        .collect();
    let high = match differences.is_empty() {
        true => 0.0,
        false => median(&differences) / NORMAL_MEDIAN / THIRD_DIFFERENCE.sqrt(),
    };
    let rounding = resolution(values).unwrap_or(0.0) / 12.0_f64.sqrt();
    let noise = high.max(rounding).max(LEAST_SHARE * spread);
    (noise > 0.0 && noise.is_finite()).then_some(noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(size: f64) -> Vec<f64> {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let normal =
            |uniform: &mut dyn FnMut() -> f64| (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let sample = |k: i32| 3.0 * (0.02 * f64::from(k)).sin();
        (0..4000)
            .map(|k| sample(k) + size * normal(&mut uniform))
            .collect()
    }

    #[test]
    fn noise_is_found_beside_a_motion_that_is_much_larger() {
        for size in [0.003, 0.1] {
            let found = sensor_noise(&noisy(size)).unwrap();
            assert!((found / size - 1.0).abs() < 0.1, "{size}: {found}");
        }
    }

    #[test]
    fn steps_of_a_sensor_are_noise_and_a_constant_has_none() {
        let step = 0.05;
        let read: Vec<f64> = noisy(0.0)
            .iter()
            .map(|v| (v / step).round() * step)
            .collect();
        let ratio = sensor_noise(&read).unwrap() / (step / 12.0_f64.sqrt());
        // Third differences of steps are whole steps, and so is their median: one step stands for 1.15 of the noise of rounding.
        assert!((1.0..1.16).contains(&ratio), "{ratio}");
        assert_eq!(sensor_noise(&[2.0; 50]), None);
        // A recording without noise has a ten-thousandth of its spread.
        let clean = sensor_noise(&noisy(0.0)).unwrap();
        assert!((clean / 2.12e-4 - 1.0).abs() < 0.05, "{clean}");
    }
}
