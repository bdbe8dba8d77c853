//! Which points of a study cannot be told apart from the best one.

use crate::statistics::{normal_quantile, resamples, standard_deviation};

/// Where the uncertainty of the scores comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum UncertaintySource {
    /// Resampling the recordings (two or more).
    Bootstrap,
    /// Repeating the best point with perturbed starts (one recording).
    Ensemble,
}

impl UncertaintySource {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Bootstrap => "bootstrap over recordings",
            Self::Ensemble => "perturbed starts of the best point",
        }
    }
}

/// The set of points that fit as well as the best within the uncertainty of the scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Where it comes from.
    pub source: UncertaintySource,
    /// Confidence level, e.g. 0.95.
    pub level: f64,
    /// Standard deviation of the best point's score when reality is sampled again, in the metric's unit.
    pub best_score_sd: f64,
    /// Standard deviation of the best point's score when its simulated start and timestep are varied, in the
    /// metric's unit; 0 where every recording has its own start, because then the recordings carry that noise.
    pub simulation_sd: f64,
    /// One flag per point; the best itself is always in.
    pub indistinguishable: Vec<bool>,
}

/// Confidence level of the indistinguishable set.
pub const LEVEL: f64 = 0.95;
/// Resamples of the bootstrap.
const RESAMPLES: usize = 2000;

/// Paired bootstrap over recordings (Efron & Tibshirani 1993, chapters 8 and 16).
///
/// `scores[point]` holds one score per recording, or `None` where the point has no score. Every point
/// is one deterministic simulation, whose score would differ by `simulation_sd` from an equally valid start;
/// the difference of two points then carries normal noise of √2 times that. A point is indistinguishable
/// from `best` when the probability that it does at least as well exceeds `1 − level`: the mean of
/// Φ(−difference / (√2 · simulation_sd)) over the resamples, or the share of resamples without that noise.
pub fn bootstrap_indistinguishable(
    scores: &[Option<Vec<f64>>],
    best: usize,
    simulation_sd: f64,
    level: f64,
    seed: u64,
) -> Uncertainty {
    let best_scores = scores[best].clone().unwrap_or_default();
    let resamples = resamples(best_scores.len(), RESAMPLES, seed);
    let noise_sd = std::f64::consts::SQRT_2 * simulation_sd;
    let as_good = |difference: f64| {
        if noise_sd > 0.0 {
            0.5 * libm::erfc(difference / noise_sd * std::f64::consts::FRAC_1_SQRT_2)
        } else {
            f64::from(u8::from(difference <= 0.0))
        }
    };
    let indistinguishable = scores
        .iter()
        .enumerate()
        .map(|(point, point_scores)| {
            let Some(point_scores) = point_scores else {
                return false;
            };
            let difference: Vec<f64> = point_scores
                .iter()
                .zip(&best_scores)
                .map(|(p, b)| p - b)
                .collect();
            let probability: f64 = resamples
                .iter()
                .map(|resample| as_good(resample.mean(&difference)))
                .sum();
            point == best || probability > (1.0 - level) * RESAMPLES as f64
        })
        .collect();
    let means: Vec<f64> = resamples
        .iter()
        .map(|resample| resample.mean(&best_scores))
        .collect();
    Uncertainty {
        source: UncertaintySource::Bootstrap,
        level,
        best_score_sd: standard_deviation(&means),
        simulation_sd,
        indistinguishable,
    }
}

/// With one recording: how much the score of the best point varies when its start is perturbed.
///
/// `repeats` are scores of the best point under perturbed starts. A point is indistinguishable when
/// its score exceeds the best's by no more than two such single runs differ by chance
/// (z·√2·sd, one-sided at `level`).
pub fn spread_indistinguishable(
    scores: &[Option<f64>],
    best: usize,
    repeats: &[f64],
    level: f64,
) -> Uncertainty {
    let best_score_sd = standard_deviation(repeats);
    let margin = normal_quantile(level) * std::f64::consts::SQRT_2 * best_score_sd;
    let limit = scores[best].unwrap_or(f64::NEG_INFINITY) + margin;
    let indistinguishable = scores
        .iter()
        .enumerate()
        .map(|(point, score)| point == best || score.is_some_and(|score| score <= limit))
        .collect();
    Uncertainty {
        source: UncertaintySource::Ensemble,
        level,
        best_score_sd,
        simulation_sd: best_score_sd,
        indistinguishable,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_that_is_worse_on_every_recording_is_told_apart() {
        let scores = vec![Some(vec![1.0, 2.0, 3.0]), Some(vec![1.1, 2.1, 3.1]), None];
        let set = bootstrap_indistinguishable(&scores, 0, 0.0, 0.95, 1);
        assert_eq!(set.indistinguishable, [true, false, false]);
    }

    #[test]
    fn a_point_that_wins_half_of_the_time_is_not_told_apart() {
        let best: Vec<f64> = (0..20).map(|r| f64::from(r % 2)).collect();
        let other: Vec<f64> = (0..20).map(|r| f64::from((r + 1) % 2) + 0.01).collect();
        let set = bootstrap_indistinguishable(&[Some(best), Some(other)], 0, 0.0, 0.95, 1);
        assert_eq!(set.indistinguishable, [true, true]);
    }

    #[test]
    fn the_noise_of_single_simulations_widens_the_set() {
        let scores = vec![Some(vec![1.0, 2.0, 3.0]), Some(vec![1.1, 2.1, 3.1])];
        let told_apart = |simulation_sd| {
            !bootstrap_indistinguishable(&scores, 0, simulation_sd, 0.95, 1).indistinguishable[1]
        };
        // One-sided 5 %: told apart from a difference of 1.645 · √2 · sd on.
        assert!(told_apart(0.1 / (1.65 * std::f64::consts::SQRT_2)));
        assert!(!told_apart(0.1 / (1.64 * std::f64::consts::SQRT_2)));
    }

    /// Standard error of the mean of n values: sd / √n (with the population sd).
    #[test]
    fn the_bootstrap_spread_is_the_standard_error() {
        let best: Vec<f64> = (0..50).map(|r| (f64::from(r) * 1.7).sin()).collect();
        let mean = best.iter().sum::<f64>() / 50.0;
        let expected = (best.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 50.0 / 50.0).sqrt();
        let set = bootstrap_indistinguishable(&[Some(best)], 0, 0.0, 0.95, 3);
        assert!(
            (set.best_score_sd / expected - 1.0).abs() < 0.05,
            "{} {expected}",
            set.best_score_sd
        );
    }

    #[test]
    fn with_one_recording_the_margin_is_what_two_runs_differ_by_chance() {
        let repeats = [0.9, 1.0, 1.1];
        let scores = [Some(1.0), Some(1.2), Some(1.3), None];
        let set = spread_indistinguishable(&scores, 0, &repeats, 0.95);
        assert!((set.best_score_sd - 0.1).abs() < 1e-12);
        assert_eq!(set.indistinguishable, [true, true, false, false]);
    }
}
