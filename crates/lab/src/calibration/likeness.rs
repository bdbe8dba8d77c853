//! Are the recordings drawn like repeats of the runs that come nearest to them?
//!
//! Where repeats differ much, a run is soon as near as one more recording, whatever made them: only what is drawn tells them apart.
//! So the nearest runs, each with its point and setting, are repeated under the study's noise as often as there are recordings. If
//! the model is right, reality is one more point and setting among them, and its recordings are no farther from the set that is most
//! like them than these sets are from one another: the rank among them is a p-value (a permutation test of one against the others). It is
//! cautious, for the sets were chosen around the recordings.

use rayon::prelude::*;

use super::nearness::middle;
use super::score::PointScore;
use super::setting::Settings;
use super::study::Study;
use crate::prediction::ensemble;
use realgap_core::error::Result;
use realgap_core::statistics::mean;
use realgap_engine::Noise;
use realgap_path::trajectory::{Prepared, mean_square_m2, prepare, rms_m};

/// Runs that are repeated: two of so many may be farther from the others than reality is.
const NEAR: usize = 40;
/// Fewer of them never tell anything at 5 %.
const FEWEST: usize = 20;
/// Repeats of a run at most.
const REPEATS: usize = 10;

/// How likely the recordings are so unlike every set of repeats near them, if they are one more such set; `None` where there are too few
/// runs. `runs` are those with a score, with their paths.
///
/// # Errors
/// Noise that cannot be, and motions that cannot be prepared.
pub(super) fn likeness(
    study: &Study,
    real: &[&Prepared],
    runs: &[(&PointScore, &Prepared)],
) -> Result<Option<f64>> {
    let middle_m = middle(&real.iter().map(|path| path.xy_m()).collect::<Vec<_>>());
    let far = |path: &Prepared| mean_square_m2(path.xy_m(), &middle_m);
    let mut near: Vec<(&PointScore, f64)> =
        runs.iter().map(|(run, path)| (*run, far(path))).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    near.truncate(NEAR);
    let repeats = real.len().min(REPEATS);
    // Starts differ by the noise alone.
    let settings = Settings {
        noise: Noise::default(),
        ..study.settings()
    };
    let definition = study.definition();
    let noise = definition.noise.unwrap_or_else(Noise::careful_repeat);
    let set_of = |(rank, (run, _)): (usize, &(&PointScore, f64))| -> Result<Vec<Prepared>> {
        let own = study.experiment_with(0, &study.parameter_set(&run.values))?;
        let own = settings.apply(settings.of_trial(run.index), &own);
        // Draws of their own for every set, or else all would err alike.
        let numbers = (0..repeats).map(|repeat| (rank * repeats + repeat) as u64);
        let paths = numbers.map(|number| {
            let run = ensemble::repeat(&own, &noise, definition.seed, number)?;
            run.outcome.get().map(prepare).transpose()
        });
        paths.filter_map(Result::transpose).collect()
    };
    let sets = near.par_iter().enumerate().map(set_of);
    let mut sets = sets.collect::<Result<Vec<_>>>()?;
    sets.retain(|set| set.len() > 1);
    let sets: Vec<Vec<&Prepared>> = sets.iter().map(|set| set.iter().collect()).collect();
    Ok((sets.len() >= FEWEST).then(|| rank(real, &sets)))
}

/// Rank of reality's distance to the set that is most like it among those of the sets to the others.
fn rank(real: &[&Prepared], sets: &[Vec<&Prepared>]) -> f64 {
    let all = std::iter::once(real).chain(sets.iter().map(Vec::as_slice));
    let all: Vec<&[&Prepared]> = all.collect();
    let within: Vec<f64> = all.iter().map(|set| within_m(set)).collect();
    let mut least_m = vec![f64::INFINITY; all.len()];
    for b in 1..all.len() {
        for a in 0..b {
            let apart_m = 2.0 * across_m(all[a], all[b]) - within[a] - within[b];
            least_m[a] = least_m[a].min(apart_m);
            // Sets are compared with each other, and not with reality.
            if a > 0 {
                least_m[b] = least_m[b].min(apart_m);
            }
        }
    }
    let as_far = least_m[1..].iter().filter(|m| **m >= least_m[0]);
    (as_far.count() + 1) as f64 / all.len() as f64
}

/// Mean distance of two members of different sets.
fn across_m(a: &[&Prepared], b: &[&Prepared]) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| rms_m(a, b)));
    mean(&pairs.collect::<Vec<f64>>())
}

/// The same of one set, without the bias of few members.
fn within_m(set: &[&Prepared]) -> f64 {
    let pairs = set.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| set[i + 1..].iter().map(move |b| rms_m(a, b)));
    mean(&pairs.collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;
    use realgap_path::trajectory::POINTS;

    /// Ways of 1 m that bend by this much, and each by as much as `spread` more or less.
    fn set(bend: f64, spread: f64, count: usize, rng: &mut Generator) -> Vec<Prepared> {
        let mut way = |_| {
            let normal: f64 = StandardNormal.sample(rng);
            let bend = bend + spread * normal;
            let point = |at: usize| {
                let share = at as f64 / (POINTS - 1) as f64;
                [share, bend * libm::sin(std::f64::consts::PI * share)]
            };
            Prepared::from_xy_m((0..POINTS).map(point).collect()).unwrap()
        };
        (0..count).map(&mut way).collect()
    }

    /// How many of 100 realities are told from 40 sets: points bend the way by 1 cm, repeats by `spread`; reality bends it by `off` and
    /// repeats it with `real_spread`.
    fn told(spread: f64, off: f64, real_spread: f64, recordings: usize) -> usize {
        let mut rng = Generator::seed_from_u64(3);
        let told = (0..100).filter(|_| {
            let mut bend =
                || -> f64 { 0.01 * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
            let bends: Vec<f64> = (0..NEAR).map(|_| bend()).collect();
            let own = off + bend();
            let sets = bends
                .iter()
                .map(|bend| set(*bend, spread, recordings, &mut rng));
            let sets: Vec<Vec<Prepared>> = sets.collect();
            let real = set(own, real_spread, recordings, &mut rng);
            let sets: Vec<Vec<&Prepared>> = sets.iter().map(|set| set.iter().collect()).collect();
            rank(&real.iter().collect::<Vec<_>>(), &sets) < 0.05
        });
        told.count()
    }

    /// At one false alarm in twenty more than 11 of 100 come in 1 % of cases.
    #[test]
    fn a_reality_among_the_points_is_one_more_set_however_much_repeats_differ() {
        for (spread, recordings) in [(0.001, 3), (0.01, 3), (0.01, 10), (0.05, 10)] {
            let alarms = told(spread, 0.0, spread, recordings);
            assert!(alarms <= 11, "{spread} {recordings}: {alarms}");
        }
    }

    #[test]
    fn a_reality_that_repeats_itself_otherwise_is_told_from_all_though_each_run_might_be_one_of_it()
    {
        // Ten times as sure of itself as the model, in the midst of the model's runs.
        assert!(told(0.03, 0.0, 0.003, 10) >= 90);
        // And one that lies beyond them.
        assert!(told(0.01, 0.06, 0.01, 10) >= 90);
    }
}
