//! Divergence rate: how fast two runs diverge that differ by almost nothing, and so whether single runs can be compared at all.

use serde::Serialize;

use realgap_core::{Code, Result, Warning};
use realgap_simulation::{Experiment, run};

/// Difference of the first servo's zero between the two runs, radians.
const NUDGE_RAD: f64 = 1e-6;
/// Above this distance two runs no longer diverge exponentially, metres.
const GROWN_M: f64 = 0.01;
/// The precision with which a robot is placed at its start, metres.
const START_M: f64 = 1e-3;

/// How fast a small difference grows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DivergenceRate {
    /// Divergence rate of two runs whose servo zeros differ by a microradian, 1/s: the slope of the logarithm of their distance
    /// over time, fitted by least squares until they are 1 cm apart.
    pub rate_1_s: f64,
    /// Length of the run, seconds.
    pub duration_s: f64,
    /// Edge length of the tracked module, metres.
    pub body_length_m: f64,
}

impl DivergenceRate {
    /// The rate of two runs of `experiment` without noise; `None` for a robot without servos, or where a run diverges.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn of(experiment: &Experiment) -> Result<Option<Self>> {
        let hinges = &experiment.assembly.hinges;
        let Some(first) = hinges.iter().position(|hinge| hinge.actuator.is_some()) else {
            return Ok(None);
        };
        let mut nudged = experiment.clone();
        nudged.perturbation.servo_zero_rad.resize(hinges.len(), 0.0);
        nudged.perturbation.servo_zero_rad[first] += NUDGE_RAD;
        let (Some(one), Some(other)) = (
            run(experiment)?.outcome.completed(),
            run(&nudged)?.outcome.completed(),
        ) else {
            return Ok(None);
        };
        let other_m = other.positions_world_m();
        let pairs = one.positions_world_m().iter().zip(other_m);
        let distances_m: Vec<f64> = pairs.map(|(a, b)| (a - b).norm()).collect();
        Ok(Some(Self {
            rate_1_s: slope(one.times_s(), &distances_m),
            duration_s: experiment.duration_s,
            body_length_m: experiment.assembly.body_length_m,
        }))
    }

    /// The factor by which a small difference grows in a second.
    pub(crate) fn factor_per_s(&self) -> f64 {
        self.rate_1_s.exp()
    }

    /// Whether a millimetre at the start becomes a body length within the run. Then only distributions can be compared, between
    /// settings, between engines, and with reality.
    pub(crate) fn only_distributions_compare(&self) -> bool {
        self.rate_1_s * self.duration_s > (self.body_length_m / START_M).ln()
    }

    /// The warning that belongs to the rate.
    pub fn warning(&self) -> Option<Warning> {
        self.only_distributions_compare().then(|| {
            Code::OnlyDistributions.warning(format!(
                "a small difference grows by a factor of {:.1} per second: single runs do not compare, between settings or engines, and distributions do",
                self.factor_per_s()
            ))
        })
    }
}

/// Slope of ln(distance) over time up to the first distance of `GROWN_M`; 0 where there is nothing to fit.
fn slope(times_s: &[f64], distances_m: &[f64]) -> f64 {
    let grown = distances_m.iter().position(|d| *d >= GROWN_M);
    let until = grown.map_or(distances_m.len(), |index| index + 1);
    let points: Vec<(f64, f64)> = times_s[..until]
        .iter()
        .zip(&distances_m[..until])
        .filter(|(_, d)| **d > 0.0)
        .map(|(t, d)| (*t, d.ln()))
        .collect();
    let count = points.len() as f64;
    let (mean_t, mean_y) = points
        .iter()
        .fold((0.0, 0.0), |(t, y), p| (t + p.0 / count, y + p.1 / count));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (t, y) in &points {
        covariance += (t - mean_t) * (y - mean_y);
        variance += (t - mean_t).powi(2);
    }
    if variance > 0.0 {
        covariance / variance
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_of_an_exponential_is_found_again() {
        let times_s: Vec<f64> = (0..600).map(|k| f64::from(k) / 60.0).collect();
        // 1 nm, growing by e^2 a second, saturated at 5 cm.
        let distances: Vec<f64> = times_s
            .iter()
            .map(|t| (1e-9 * (2.0 * t).exp()).min(0.05))
            .collect();
        assert!((slope(&times_s, &distances) - 2.0).abs() < 1e-6);
        assert_eq!(slope(&times_s, &vec![0.0; times_s.len()]), 0.0);
    }

    #[test]
    fn only_what_grows_to_a_body_length_is_called_chaotic() {
        let growth = |rate_1_s| DivergenceRate {
            rate_1_s,
            duration_s: 20.0,
            body_length_m: 0.06,
        };
        assert!(growth(1.0).only_distributions_compare());
        assert!(!growth(0.1).only_distributions_compare());
        assert!(growth(0.1).warning().is_none());
    }
}
