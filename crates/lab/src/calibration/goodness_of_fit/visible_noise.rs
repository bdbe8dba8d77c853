//! Noise that a recording shows by itself: its high frequencies, and the steps of its resolution.
//!
//! A motion is smooth between neighbouring samples, and noise of measurement is not. Each sample is compared with the cubic
//! polynomial through two samples on either side, which is the fourth difference of the series divided by six (variance of noise
//! from differences: von Neumann 1941; Gasser, Sroka & Jennen-Steinmetz 1986). The scale is a median, so that contacts and
//! outliers do not count as noise. What the run without noise shows at the same samples is the motion's own share.

use realgap_core::statistics::{ends_of, median};

/// Noise of measurement of one series.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::calibration) struct VisibleNoise {
    /// Standard deviation of independent errors; 0 where none are visible.
    pub independent: f64,
    /// Distance of neighbouring values that can be recorded; 0 where none is visible.
    pub step: f64,
    /// One of these values.
    pub offset: f64,
}

/// Errors and steps smaller than this (10 µm, 10 µrad) are those of the numbers in a file, not of a sensor.
pub(in crate::calibration) const LEAST: f64 = 1e-5;
/// Errors are visible where they are so many times as large as the same differences of the run without noise.
const ABOVE_MOTION: f64 = 2.0;
/// For independent errors the fourth differences over one and over two samples have the same scale; for a smooth motion the first
/// are a sixteenth of the second. Errors are visible above this share.
const ALIKE: f64 = 0.25;
/// Rounding leaves deviations of a quarter of a step; this share is the least that is taken for rounding.
const ROUNDED: f64 = 0.05;
/// Samples between the neighbours of a difference. Errors that a filter has smoothed show over two samples only.
const STRIDES: [usize; 2] = [1, 2];
/// Normal errors with standard deviation 1 have this median absolute value.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;
/// Fewer samples than this do not show their noise.
pub(in crate::calibration) const FEWEST: usize = 12;

impl VisibleNoise {
    /// The noise of a recorded series; `simulated` is the run at the same times, without noise.
    pub fn of(times_s: &[f64], recorded: &[f64], simulated: &[f64]) -> Self {
        if recorded.len() < FEWEST {
            return Self::default();
        }
        let step =
            step(recorded).filter(|step| *step > LEAST && is_rounded(times_s, recorded, *step));
        let step = step.unwrap_or(0.0);
        let visible = STRIDES.iter().filter_map(|&stride| {
            let own = scale(times_s, recorded, stride);
            let of_motion = scale(times_s, simulated, stride);
            let is_noise = own > ABOVE_MOTION * of_motion
                && own > ALIKE * scale(times_s, recorded, 2 * stride);
            is_noise.then(|| (own * own - of_motion * of_motion).sqrt())
        });
        let errors = visible.fold(0.0, f64::max);
        // Rounding to steps looks like noise up to the size of a step.
        let independent = match errors > step.max(LEAST) {
            true => (errors * errors - step * step / 12.0).max(0.0).sqrt(),
            false => 0.0,
        };
        Self {
            independent,
            step,
            offset: recorded[0],
        }
    }

    /// The largest independent errors that a recorded series can have: all of its high frequencies, those of the motion included.
    /// `None` for too few samples.
    pub fn at_most(times_s: &[f64], recorded: &[f64]) -> Option<f64> {
        (recorded.len() >= FEWEST).then(|| scale(times_s, recorded, 1))
    }

    /// Standard deviation of the error of one sample; rounding is uniform within a step.
    pub fn size(&self) -> f64 {
        (self.independent.powi(2) + self.step.powi(2) / 12.0).sqrt()
    }

    /// The value as it would be recorded; `normal` is a standard normal number.
    pub fn record(&self, value: f64, normal: f64) -> f64 {
        let seen = value + self.independent * normal;
        match self.step > 0.0 {
            true => self.offset + self.step * ((seen - self.offset) / self.step).round(),
            false => seen,
        }
    }
}

/// Standard deviation of independent errors whose fourth differences over this stride would have the series' median absolute
/// size.
fn scale(times_s: &[f64], values: &[f64], stride: usize) -> f64 {
    let deviations = deviations(times_s, values, stride);
    match deviations.is_empty() {
        true => 0.0,
        false => median(&deviations) / NORMAL_MEDIAN,
    }
}

/// Absolute deviations from the polynomials through neighbours, which for independent errors have their standard deviation.
fn deviations(times_s: &[f64], values: &[f64], stride: usize) -> Vec<f64> {
    let span = 4 * stride;
    let all = (0..values.len().saturating_sub(span)).map(|first| {
        let at = [0, 1, 3, 4].map(|k| first + k * stride);
        let middle = first + 2 * stride;
        let weight = |of: usize| -> f64 {
            let others = at.iter().filter(|other| **other != at[of]);
            let factors = others.map(|other| {
                (times_s[middle] - times_s[*other]) / (times_s[at[of]] - times_s[*other])
            });
            factors.product()
        };
        let weights = [0, 1, 2, 3].map(weight);
        let expected: f64 = weights.iter().zip(at).map(|(w, k)| w * values[k]).sum();
        let variance = 1.0 + weights.iter().map(|w| w * w).sum::<f64>();
        (values[middle] - expected).abs() / variance.sqrt()
    });
    all.collect()
}

/// Whether the series has errors of rounding to this step where it changes; a steady motion has equal steps without them.
fn is_rounded(times_s: &[f64], values: &[f64], step: f64) -> bool {
    let is_moving = |first: &usize| {
        values[*first..first + 5]
            .iter()
            .any(|v| *v != values[*first])
    };
    let all = deviations(times_s, values, 1).into_iter().enumerate();
    let moving = all
        .filter(|(first, _)| is_moving(first))
        .map(|(_, deviation)| deviation);
    let moving: Vec<f64> = moving.collect();
    !moving.is_empty() && median(&moving) > ROUNDED * step
}

/// The distance of which all differences of recorded values are multiples; `None` where there is none, or where fewer than three
/// different values were recorded.
fn step(recorded: &[f64]) -> Option<f64> {
    let mut values = recorded.to_vec();
    values.sort_by(f64::total_cmp);
    let (low, high) = ends_of(recorded.iter().copied());
    let same = 1e-9 * (high - low);
    values.dedup_by(|a, b| (*a - *b).abs() <= same);
    let gaps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let gaps: Vec<f64> = gaps.collect();
    if gaps.len() < 2 {
        return None;
    }
    let (least, _) = ends_of(gaps.iter().copied());
    // Values were rounded to some digits of the file, so that multiples are not exact.
    let is_multiple = |gap: &f64| {
        let count = gap / least;
        (count - count.round()).abs() < 0.02 + 1e-3 * count
    };
    let count = ((high - low) / least).round();
    gaps.iter().all(is_multiple).then(|| (high - low) / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    fn swing(samples: usize) -> (Vec<f64>, Vec<f64>) {
        let times_s: Vec<f64> = (0..samples).map(|k| k as f64 / 60.0).collect();
        let angles = times_s.iter().map(|t| 0.8 * libm::cos(6.0 * t)).collect();
        (times_s, angles)
    }

    #[test]
    fn the_noise_of_a_camera_is_found_beside_a_fast_motion() {
        let (times_s, smooth) = swing(200);
        for sd in [1e-4, 1e-3, 1e-2] {
            let mut rng = Generator::seed_from_u64(5);
            let mut seen = |m: &f64| -> f64 {
                let normal: f64 = StandardNormal.sample(&mut rng);
                m + sd * normal
            };
            let recorded: Vec<f64> = smooth.iter().map(&mut seen).collect();
            let found = VisibleNoise::of(&times_s, &recorded, &smooth);
            let ratio = found.size() / sd;
            assert!((0.8..1.25).contains(&ratio), "{sd}: {found:?}");
            assert_eq!(found.step, 0.0);
        }
    }

    #[test]
    fn the_step_of_an_encoder_is_its_resolution_and_digits_of_a_file_are_not() {
        let (times_s, smooth) = swing(200);
        let step = std::f64::consts::TAU / 4096.0;
        let rounded =
            |to: f64| -> Vec<f64> { smooth.iter().map(|v| (v / to).round() * to).collect() };
        let found = VisibleNoise::of(&times_s, &rounded(step), &smooth);
        assert!((found.step / step - 1.0).abs() < 1e-6, "{found:?}");
        assert!(found.size() < 0.5 * step, "{found:?}");
        let digits = VisibleNoise::of(&times_s, &rounded(1e-6), &smooth);
        assert_eq!(digits.size(), 0.0, "{digits:?}");
    }

    #[test]
    fn smooth_constant_and_short_recordings_show_no_noise() {
        let (times_s, smooth) = swing(200);
        let damped: Vec<f64> = times_s
            .iter()
            .zip(&smooth)
            .map(|(t, v)| v * libm::exp(-t))
            .collect();
        assert_eq!(VisibleNoise::of(&times_s, &smooth, &damped).size(), 0.0);
        assert_eq!(VisibleNoise::of(&times_s, &damped, &[0.0; 200]).size(), 0.0);
        assert_eq!(VisibleNoise::of(&times_s, &[0.3; 200], &smooth).size(), 0.0);
        // A steady drive that stops has equal steps and is not rounded.
        let drive: Vec<f64> = times_s.iter().map(|t| 0.3 * t.min(2.0)).collect();
        assert_eq!(VisibleNoise::of(&times_s, &drive, &smooth).size(), 0.0);
        let two = ([0.0, 1.0], [0.0, 0.5]);
        assert_eq!(VisibleNoise::of(&two.0, &two.1, &two.1).size(), 0.0);
    }
}
