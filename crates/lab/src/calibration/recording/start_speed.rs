//! The speed with which a recorded joint starts, where its angles alone were recorded.

use nalgebra::{Matrix3, Vector3};

/// Samples of this time are used, seconds: short beside a swing, and long beside the interval of most logs.
const SPAN_S: f64 = 0.06;
/// A parabola through fewer samples follows their noise more than a line through two does.
const FEWEST: usize = 5;

/// A speed at the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::calibration) struct StartSpeed {
    /// Estimate, rad/s (of a slide m/s).
    pub rad_s: f64,
    /// Standard deviation of the estimate, as a multiple of that of one angle, 1/s.
    pub noise_1_s: f64,
}

impl StartSpeed {
    /// The slope at the first sample of the least-squares parabola through the samples of the first 0.06 s; of a line through two
    /// samples, where these are fewer than five. A difference of two samples would be the speed half an interval later, and have more
    /// noise.
    ///
    /// There are at least two samples, at increasing times.
    pub fn of(times_s: &[f64], angles_rad: &[f64]) -> Self {
        let since = |k: usize| times_s[k] - times_s[0];
        let count = times_s.partition_point(|t| t - times_s[0] <= SPAN_S + 1e-9);
        if count >= FEWEST {
            let rows = (0..count).map(|k| {
                let t = since(k) / SPAN_S;
                (Vector3::new(1.0, t, t * t), angles_rad[k] - angles_rad[0])
            });
            let (mut square, mut product) = (Matrix3::zeros(), Vector3::zeros());
            for (row, angle_rad) in rows {
                square += row * row.transpose();
                product += row * angle_rad;
            }
            if let Some(inverse) = square.try_inverse() {
                return Self {
                    rad_s: (inverse * product).y / SPAN_S,
                    noise_1_s: inverse[(1, 1)].sqrt() / SPAN_S,
                };
            }
        }
        let step_s = since(1);
        Self {
            rad_s: (angles_rad[1] - angles_rad[0]) / step_s,
            noise_1_s: std::f64::consts::SQRT_2 / step_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    fn times_s(step_s: f64) -> Vec<f64> {
        (0..200).map(|k| 3.0 + step_s * f64::from(k)).collect()
    }

    #[test]
    fn a_swinging_joint_starts_with_its_speed_and_not_with_that_of_half_an_interval_later() {
        let times_s = times_s(0.01);
        // A swing of 1 rad at 1 Hz that is recorded from its largest angle on accelerates by 39 rad/s².
        let turn = |t: f64| std::f64::consts::TAU * (t - 3.0);
        let angles_rad: Vec<f64> = times_s.iter().map(|t| libm::cos(turn(*t))).collect();
        let difference = (angles_rad[1] - angles_rad[0]) / 0.01;
        let speed = StartSpeed::of(&times_s, &angles_rad).rad_s;
        assert!(
            difference < -0.19 && speed.abs() < 0.03,
            "{difference} {speed}"
        );
    }

    #[test]
    fn the_noise_of_the_speed_is_what_many_logs_show() {
        let times_s = times_s(0.005);
        let mut rng = Generator::seed_from_u64(5);
        let (mut squares, mut expected) = (0.0, 0.0);
        for _ in 0..4000 {
            let normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let angles_rad: Vec<f64> = std::iter::repeat_with(normal).take(200).collect();
            let speed = StartSpeed::of(&times_s, &angles_rad);
            squares += speed.rad_s.powi(2);
            expected = speed.noise_1_s;
        }
        let seen = (squares / 4000.0_f64).sqrt();
        assert!((seen / expected - 1.0).abs() < 0.04, "{seen} {expected}");
        // A difference of two samples has several times as much.
        assert!(
            expected < 0.3 * std::f64::consts::SQRT_2 / 0.005,
            "{expected}"
        );
    }

    #[test]
    fn few_samples_make_a_line() {
        let speed = StartSpeed::of(&[0.0, 0.05, 0.1], &[0.0, 0.1, 0.9]);
        assert_eq!(speed.rad_s, 2.0);
        assert!((speed.noise_1_s - std::f64::consts::SQRT_2 / 0.05).abs() < 1e-9);
    }
}
