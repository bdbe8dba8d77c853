//! The step between the values that a sensor can report, found from the values themselves.

/// Values that are equal to this share of the largest one differ by rounding only.
const ROUNDING: f64 = 1e-12;
/// Gaps between values are multiples of the step to within this share of it.
const TOLERANCE: f64 = 0.15;
/// Gaps that show a step where most values differ; chance makes one gap a multiple in three of ten cases.
const GAPS: usize = 8;
/// The smallest gap is at most so many steps.
const MOST_STEPS: u32 = 3;
/// Where there are so many samples to each value, few gaps show a step, too.
const REPEATED: usize = 4;

/// The step of which all differences between these values are multiples (the resolution of an encoder, or the last digit of a file);
/// `None` where there is none, or where all values are the same.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.first()?.abs().max(sorted.last()?.abs());
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let gaps: Vec<f64> = gaps.filter(|gap| *gap > ROUNDING * largest).collect();
    let least = gaps.iter().copied().reduce(f64::min)?;
    let is_step = |step: f64| {
        let is_multiple = |gap: &f64| (gap / step - (gap / step).round()).abs() < TOLERANCE;
        gaps.iter().all(is_multiple)
    };
    if gaps.len() < GAPS {
        let is_repeated = sorted.len() >= REPEATED * (gaps.len() + 1);
        return (is_repeated && is_step(least)).then_some(least);
    }
    // A fast motion may skip values, so that even the smallest gap is several steps.
    let mut parts = (1..=MOST_STEPS).map(|steps| least / f64::from(steps));
    parts.find(|step| is_step(*step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_of_an_encoder_is_found_and_values_without_a_step_have_none() {
        let step = std::f64::consts::TAU / 4096.0;
        let angle = |k: i32| 0.1 * f64::from(k).sqrt();
        let smooth: Vec<f64> = (0..200).map(angle).collect();
        let read = |angle: &f64| (angle / step).round() * step;
        let encoder: Vec<f64> = smooth.iter().map(read).collect();
        let found = resolution(&encoder).unwrap();
        assert!((found / step - 1.0).abs() < 1e-6, "{found}");
        assert_eq!(resolution(&smooth), None);
        // A file keeps seven digits of it.
        let digits: Vec<f64> = encoder
            .iter()
            .map(|angle| (angle * 1e7).round() / 1e7)
            .collect();
        assert!((resolution(&digits).unwrap() / step - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_joint_that_stands_still_shows_its_step_and_a_constant_shows_none() {
        let toggles: Vec<f64> = (0..40).map(|k| 0.1 + 0.002 * f64::from(k % 2)).collect();
        assert!((resolution(&toggles).unwrap() - 0.002).abs() < 1e-12);
        assert_eq!(resolution(&[0.3; 40]), None);
        assert_eq!(resolution(&[]), None);
        assert_eq!(resolution(&[0.1, 0.2]), None);
    }
}
