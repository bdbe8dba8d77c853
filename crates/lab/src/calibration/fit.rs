//! Does the model explain the recordings at all? Judged before its numbers.

use serde::Serialize;

use super::score::{PointScore, Scores};
use super::study::Study;
use crate::claim::{self, SIGNIFICANT};
use crate::prediction::ensemble::rms_m;
use realgap_core::error::Result;
use realgap_core::statistics::{energy_test, mean, student_quantile};
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::Prepared;

/// The best point's runs against the recordings, both against what repeats differ by; distances are those of the metric `rms`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Mean distance of the best point's runs to the recordings, in noise floors: mean distances between recordings of the same
    /// run.
    pub noise_floors: f64,
    /// How likely the runs are as unlike the recordings if both are drawn alike (energy test; Székely & Rizzo 2013); `None` for
    /// fewer than three recordings.
    pub p_value: Option<f64>,
    /// False where the recordings are farther from the runs than from each other, and neither chance nor a setting that reality
    /// has of its own explains it: no parameters of this model explain these recordings.
    pub explains: bool,
    /// Variance of the model's discrepancy in those of a recording, which widens the intervals; 0 where the model explains the
    /// recordings.
    pub discrepancy: f64,
    /// Where runs are of two engines, the one whose runs these are: it explains the recordings better.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<&'static str>,
}

/// Fewer recordings than this cannot be told from anything.
const LEAST: usize = 3;

impl Fit {
    /// `None` without a best point, for fewer than two recordings of one start, or for recordings that do not differ.
    ///
    /// # Errors
    /// Paths that cannot be compared.
    pub(super) fn new(study: &Study, scores: &Scores) -> Result<Option<Self>> {
        let Some(best) = scores.best else {
            return Ok(None);
        };
        let settings = study.settings();
        let path = |run: &PointScore| Prepared::from_xy_m(run.path_xy_m.clone());
        let mut engines = Vec::new();
        for runs in scores.runs_by_engine(&settings, best) {
            let paths = runs.iter().map(|run| path(run));
            let engine = runs.first().map(|run| settings.engine_of_trial(run.index));
            engines.push((paths.collect::<Result<Vec<_>>>()?, engine));
        }
        let spread = Spread::within(engines.iter().map(|(paths, _)| paths.as_slice()));
        let mut fits = Vec::new();
        // Reality is none of two engines: where one explains the recordings, the model does.
        for (runs, engine) in &engines {
            let engine = engine.and_then(|engine| study.engine_named(engine));
            let fit = Self::of_runs(study, runs, spread)?;
            fits.extend(fit.map(|fit| Self { engine, ..fit }));
        }
        let order = |a: &Self, b: &Self| {
            let by_distance = a.noise_floors.total_cmp(&b.noise_floors);
            b.explains.cmp(&a.explains).then(by_distance)
        };
        Ok(fits.into_iter().min_by(order))
    }

    fn of_runs(study: &Study, runs: &[Prepared], spread: Spread) -> Result<Option<Self>> {
        let real = study.part_of(&study.real_paths(), false);
        if study.cases().len() != 1 || real.len() < 2 {
            return Ok(None);
        }
        let all: Vec<&Prepared> = real.iter().copied().chain(runs).collect();
        let pairs = || (0..all.len()).flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)));
        let distances: Vec<f64> = pairs().map(|(i, j)| rms_m(all[i], all[j])).collect();
        // Within the recordings, across, within the runs.
        let over = |kind: usize, power: i32| {
            let kinds =
                pairs().map(|(i, j)| usize::from(i >= real.len()) + usize::from(j >= real.len()));
            let chosen = kinds.zip(&distances).filter(|(k, _)| *k == kind);
            mean(&chosen.map(|(_, d)| d.powi(power)).collect::<Vec<f64>>())
        };
        let floor_m = over(0, 1);
        if floor_m <= 0.0 || runs.is_empty() {
            return Ok(None);
        }
        let noise_floors = over(1, 1) / floor_m;
        let p_value = match real.len() >= LEAST && runs.len() > 1 {
            true => Some(energy_test(&distances, real.len(), study.definition().seed)?.p_value),
            false => None,
        };
        let spreads = [
            (0.5 * over(0, 2), real.len()),
            (0.5 * over(2, 2), runs.len()),
        ];
        let excess = over(1, 2) - spreads[0].0 - spreads[1].0;
        let explains = noise_floors <= 1.0
            || p_value.is_none_or(|p| p >= SIGNIFICANT)
            || chance_parts(excess, spreads, spread);
        Ok(Some(Self {
            noise_floors,
            p_value,
            explains,
            discrepancy: match explains {
                true => 0.0,
                false => (excess / spreads[0].0).max(0.0),
            },
            engine: None,
        }))
    }

    /// A warning where nothing explains so many recordings.
    pub(super) fn warning(&self, recordings: usize) -> Option<Warning> {
        let said = claim::model(self, recordings).text;
        (!self.explains).then(|| Warning::new(Code::ModelContradicted, said))
    }
}

/// How far settings part runs of one engine: the variance, over both where there are two, and its degrees of freedom.
#[derive(Debug, Clone, Copy)]
struct Spread {
    variance: f64,
    freedom: f64,
}

impl Spread {
    /// Within these groups of runs.
    fn within<'a>(groups: impl Iterator<Item = &'a [Prepared]>) -> Self {
        let (mut squares, mut freedom) = (0.0, 0.0);
        for runs in groups.filter(|runs| runs.len() > 1) {
            let pairs = (0..runs.len()).flat_map(|i| (i + 1..runs.len()).map(move |j| (i, j)));
            let distances = pairs.map(|(i, j)| rms_m(&runs[i], &runs[j]).powi(2));
            // The sum over all pairs is as many times that of deviations from their mean.
            squares += distances.sum::<f64>() / runs.len() as f64;
            freedom += runs.len() as f64 - 1.0;
        }
        Self {
            variance: squares / freedom.max(1.0),
            freedom,
        }
    }
}

/// Whether chance parts the mean paths as far as they are: Welch's t test (1947), with distances for differences. `excess` is what
/// parts a recording from a run, squared, beyond the variance of either, and the spreads are those variances with how many
/// paths showed them; `settings` is what runs of either engine say about that of runs. The energy test alone also rejects
/// recordings that merely spread more than runs. Reality has one setting of its own, which moves all of its recordings, so that
/// their mean varies as a single run does, too. All variance is taken to lie in one direction, where chance goes farthest.
fn chance_parts(excess: f64, [recordings, runs]: [(f64, usize); 2], settings: Spread) -> bool {
    let of_mean = |(variance, count): (f64, usize)| variance / count as f64;
    let apart = (excess + of_mean(recordings) + of_mean(runs)).max(0.0);
    let own_setting = settings.variance + of_mean((settings.variance, runs.1));
    let variance = of_mean(recordings) + own_setting;
    let doubt = of_mean(recordings).powi(2) / (recordings.1 as f64 - 1.0)
        + own_setting.powi(2) / settings.freedom;
    let limit = student_quantile(1.0 - 0.5 * SIGNIFICANT, variance * variance / doubt);
    apart <= limit * limit * variance
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    /// How many of 400 realities chance does not explain: `spread` times as far apart as runs are, so many of these off.
    fn unexplained(directions: usize, recordings: usize, spread: f64, off: f64) -> usize {
        let mut rng = Generator::seed_from_u64(7);
        let mut path = |centre: &[f64], size: f64| -> Vec<f64> {
            let normal = |rng: &mut _| -> f64 { StandardNormal.sample(rng) };
            centre.iter().map(|c| c + size * normal(&mut rng)).collect()
        };
        let mean_square = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
            let squares = pairs.map(|(p, q)| p.iter().zip(q).map(|(p, q)| (p - q).powi(2)).sum());
            let other = squares.filter(|square: &f64| *square > 0.0);
            mean(&other.collect::<Vec<f64>>())
        };
        let alarm = |_: &usize| {
            let mut origin = vec![0.0; directions];
            let runs: Vec<Vec<f64>> = (0..16).map(|_| path(&origin, 1.0)).collect();
            origin[0] = off;
            let own = path(&origin, 1.0);
            let real: Vec<Vec<f64>> = (0..recordings).map(|_| path(&own, spread)).collect();
            let half = |paths: &[Vec<f64>]| 0.5 * mean_square(paths, paths);
            let spreads = [(half(&real), real.len()), (half(&runs), runs.len())];
            let excess = mean_square(&real, &runs) - spreads[0].0 - spreads[1].0;
            let settings = Spread {
                variance: spreads[1].0,
                freedom: runs.len() as f64 - 1.0,
            };
            !chance_parts(excess, spreads, settings)
        };
        (0..400).filter(alarm).count()
    }

    /// At one false alarm in twenty more than 28 of 400 come in 3 % of cases.
    #[test]
    fn a_reality_that_is_one_of_the_settings_is_explained_however_much_its_recordings_differ() {
        for (directions, recordings) in [(1, 3), (1, 10), (4, 3), (4, 10)] {
            for spread in [0.3, 1.0, 3.0] {
                let alarms = unexplained(directions, recordings, spread, 0.0);
                assert!(alarms <= 28, "{directions} {recordings} {spread}: {alarms}");
            }
        }
    }

    #[test]
    fn a_reality_that_no_setting_comes_near_is_not_explained() {
        for (recordings, spread) in [(3, 0.3), (5, 1.0), (10, 1.0)] {
            let found = unexplained(1, recordings, spread, 5.0);
            assert!(found >= 360, "{recordings} {spread}: {found}");
        }
    }
}
