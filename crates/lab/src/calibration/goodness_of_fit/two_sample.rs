//! Two-sample goodness of fit: whether the recordings have the distribution of repeats of a run near them.
//!
//! Where repeats differ much, some run is soon as near to the recordings as one more recording would be; only the distribution
//! can then reject the model. So the points nearest to the recordings, each with its nearest setting, are repeated under the
//! study's noise, or a careful one where it states none, as often as there are recordings. If the model is right, reality is one more point and setting among them, and
//! its recordings are no farther from the most similar set of repeats than these sets are from one another. The rank among the
//! sets is a p-value (a permutation test of one set against the others). The test is conservative, because the sets were chosen
//! around the recordings.
//!
//! Three features are tested: where paths lie, and how they bend over short and over long strides. Small early differences can
//! move the later points of a path anywhere, while each stride of a gait stays the same. The product of the three ranks (Fisher
//! 1925) is ranked among those of the sets, so that three features do not raise the rate of false alarms.

use rayon::prelude::*;

use crate::calibration::answer::score::PointScore;
use crate::calibration::goodness_of_fit::path::middle;
use crate::calibration::goodness_of_fit::repeat_noise::noise_of_repeats;
use crate::calibration::numerics::setting::Settings;
use crate::calibration::study::Study;
use crate::prediction::ensemble;
use realgap_core::error::Result;
use realgap_core::statistics::mean;
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{Prepared, mean_square_m2};
use realgap_simulation::{Experiment, Noise};

/// Points that are repeated. At a level of 5 %, two of so many sets may be farther from the others than the recordings are.
const NEAR: usize = 40;
/// With fewer points than this the test cannot reject at 5 %.
const FEWEST: usize = 20;
/// Name of the step that repeats runs or imitates recordings.
pub(super) const JUDGING: &str = "judging the fit";
/// Most repeats of a run.
const REPEATS: usize = 10;

/// Probability that the recordings are so different from every set of repeats near them, if they are one more such set; `None`
/// where there are too few points. `runs` have a score and a path, and their points were not chosen by an optimizer because of
/// their scores.
///
/// # Errors
/// Invalid noise, and motions that cannot be prepared.
pub(in crate::calibration) fn two_sample_p_value(
    (study, run): (&Study, &RunOptions<'_>),
    real: &[&Prepared],
    runs: &[(&PointScore, &Prepared)],
) -> Result<Option<f64>> {
    let middle_m = middle(&real.iter().map(|path| path.xy_m()).collect::<Vec<_>>());
    let far = |path: &Prepared| mean_square_m2(path.xy_m(), &middle_m);
    let mut near: Vec<(&PointScore, f64)> =
        runs.iter().map(|(run, path)| (*run, far(path))).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    // With one or two recordings this test is the only one and is always made, so it has to be cheap.
    let most = if real.len() > 2 { NEAR } else { FEWEST };
    // Runs of one point are similar whatever their settings are, so each point is represented by its nearest run.
    let mut points: Vec<(&PointScore, f64)> = Vec::new();
    for run in near {
        if points.len() < most && points.iter().all(|(other, _)| other.values != run.0.values) {
            points.push(run);
        }
    }
    let repeats = real.len().min(REPEATS);
    // The repeats differ by the study's noise alone, so there is one engine and no other setting.
    let settings = Settings {
        noise: Noise::default(),
        ..study.settings()
    };
    let definition = study.definition();
    let experiment = |run: &PointScore| -> Result<Experiment> {
        let own = study.experiment_with(0, &study.parameter_set(&run.values))?;
        Ok(settings.apply(settings.of_trial(run.index), &own))
    };
    let Some((nearest, _)) = points.first().filter(|_| points.len() >= FEWEST) else {
        return Ok(None);
    };
    let noise = noise_of_repeats(study, real, &experiment(nearest)?)?;
    let step = run.step(JUDGING, points.len());
    let set_of = |(rank, (run, _)): (usize, &(&PointScore, f64))| -> Result<Vec<Prepared>> {
        let own = experiment(run)?;
        // Every set has random numbers of its own, because otherwise the deviations of all sets would be the same.
        let numbers = (0..repeats).map(|repeat| (rank * repeats + repeat) as u64);
        let paths = numbers.map(|number| {
            let run = ensemble::repeat(&own, &noise, definition.seed, number)?;
            let motion = run.outcome.get();
            motion.map(|motion| study.prepared(motion)).transpose()
        });
        let paths = paths.filter_map(Result::transpose).collect();
        step.count();
        paths
    };
    let sets = points.par_iter().enumerate().map(set_of);
    let mut sets = sets.collect::<Result<Vec<_>>>()?;
    sets.retain(|set| set.len() > 1 || repeats == 1 && !set.is_empty());
    let sets: Vec<Vec<&Prepared>> = sets.iter().map(|set| set.iter().collect()).collect();
    Ok((sets.len() >= FEWEST).then(|| rank(real, &sets)))
}

/// A feature of a path that is compared: points in the plane, metres.
type Feature = fn(&Prepared) -> Vec<[f64; 2]>;
/// Positions, and bends over 3 % and 17 % of the duration.
const FEATURES: [Feature; 3] = [
    |path| path.xy_m().to_vec(),
    |path| bends_m(path, 5),
    |path| bends_m(path, 30),
];

/// A shorter stride has no direction.
const STILL_M: f64 = 1e-4;

/// For each stride over so many points: how far it goes along the direction of the stride before it, and to the left of that
/// direction. Neither the heading nor earlier errors change these numbers.
fn bends_m(path: &Prepared, points: usize) -> Vec<[f64; 2]> {
    let strides = path.xy_m().windows(2 * points + 1).map(|window| {
        let stride = |from: usize| {
            let (a, b) = (window[from], window[from + points]);
            [b[0] - a[0], b[1] - a[1]]
        };
        let (a, b) = (stride(0), stride(points));
        let length_m = libm::hypot(a[0], a[1]) + STILL_M;
        let along_m = (a[0] * b[0] + a[1] * b[1]) / length_m;
        let left_m = (a[0] * b[1] - a[1] * b[0]) / length_m;
        [along_m, left_m]
    });
    strides.collect()
}

/// Rank of the recordings among the sets, as a probability: how likely they are so far from all sets if they are one more of
/// them.
fn rank(real: &[&Prepared], sets: &[Vec<&Prepared>]) -> f64 {
    let all = || std::iter::once(real).chain(sets.iter().map(Vec::as_slice));
    let ranks = FEATURES.map(|feature| {
        let all: Vec<Vec<Vec<[f64; 2]>>> = all()
            .map(|set| set.iter().map(|path| feature(path)).collect())
            .collect();
        let separations_m = least_separations_m(&all);
        let as_far = |own: &f64| separations_m.iter().filter(|m| *m >= own).count();
        separations_m.iter().map(as_far).collect::<Vec<usize>>()
    });
    let product = |set: usize| -> usize { ranks.iter().map(|ranks| ranks[set]).product() };
    let products: Vec<usize> = (0..=sets.len()).map(product).collect();
    let as_rare = products.iter().filter(|own| **own <= products[0]).count();
    as_rare as f64 / products.len() as f64
}

/// Energy distance of each set to the most similar other set. The first set is compared with all others, and the others with each
/// other but not with the first.
fn least_separations_m(sets: &[Vec<Vec<[f64; 2]>>]) -> Vec<f64> {
    let within: Vec<f64> = sets.iter().map(|set| within_m(set)).collect();
    let mut least_m = vec![f64::INFINITY; sets.len()];
    for b in 1..sets.len() {
        for a in 0..b {
            let separation_m = 2.0 * across_m(&sets[a], &sets[b]) - within[a] - within[b];
            least_m[a] = least_m[a].min(separation_m);
            if a > 0 {
                least_m[b] = least_m[b].min(separation_m);
            }
        }
    }
    least_m
}

fn distance_m(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    mean_square_m2(a, b).sqrt()
}

/// Mean distance between a member of one set and a member of another.
fn across_m(a: &[Vec<[f64; 2]>], b: &[Vec<[f64; 2]>]) -> f64 {
    let pairs = a
        .iter()
        .flat_map(|a| b.iter().map(move |b| distance_m(a, b)));
    mean(&pairs.collect::<Vec<f64>>())
}

/// Mean distance between two members of a set, corrected for the bias of few members; 0 for one member, where every set has one.
fn within_m(set: &[Vec<[f64; 2]>]) -> f64 {
    if set.len() < 2 {
        return 0.0;
    }
    let pairs = set.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| set[i + 1..].iter().map(move |b| distance_m(a, b)));
    mean(&pairs.collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;
    use realgap_path::trajectory::POINTS;

    /// Paths of 1 m that bend by the given amount, each by a random amount of size `spread` more or less, with strides that go
    /// sideways by `aside_m`.
    fn set(
        bend: f64,
        spread: f64,
        aside_m: f64,
        count: usize,
        rng: &mut Generator,
    ) -> Vec<Prepared> {
        let mut way = |_| {
            let normal: f64 = StandardNormal.sample(rng);
            let bend = bend + spread * normal;
            let point = |at: usize| {
                let share = at as f64 / (POINTS - 1) as f64;
                let bent = bend * libm::sin(std::f64::consts::PI * share);
                [share, bent + aside_m * libm::sin(0.15 * at as f64)]
            };
            Prepared::from_xy_m((0..POINTS).map(point).collect()).unwrap()
        };
        (0..count).map(&mut way).collect()
    }

    /// Number of 100 realities that are rejected against 40 sets: points bend the path by 1 cm, repeats by `spread`; reality
    /// bends it by `off`, repeats it with `real_spread`, and goes sideways by `aside_m` more.
    fn rejected(spread: f64, off: f64, real_spread: f64, aside_m: f64, recordings: usize) -> usize {
        let mut rng = Generator::seed_from_u64(3);
        let alarms = (0..100).filter(|_| {
            let mut bend =
                || -> f64 { 0.01 * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
            let bends: Vec<f64> = (0..NEAR).map(|_| bend()).collect();
            let own = off + bend();
            // A parameter also changes how far strides go sideways.
            let sets = bends
                .iter()
                .map(|bend| set(*bend, spread, 0.002 + 0.02 * bend, recordings, &mut rng));
            let sets: Vec<Vec<Prepared>> = sets.collect();
            let aside_m = 0.002 + 0.02 * (own - off) + aside_m;
            let real = set(own, real_spread, aside_m, recordings, &mut rng);
            let sets: Vec<Vec<&Prepared>> = sets.iter().map(|set| set.iter().collect()).collect();
            rank(&real.iter().collect::<Vec<_>>(), &sets) < 0.05
        });
        alarms.count()
    }

    /// At one false alarm in twenty, more than 11 of 100 occur with a probability of 1 %.
    #[test]
    fn a_reality_drawn_like_the_points_is_seldom_rejected_whatever_the_spread_of_repeats() {
        for (spread, recordings) in [(0.001, 3), (0.01, 3), (0.01, 10), (0.05, 10)] {
            let alarms = rejected(spread, 0.0, spread, 0.0, recordings);
            assert!(alarms <= 11, "{spread} {recordings}: {alarms}");
        }
    }

    #[test]
    fn a_reality_whose_repeats_spread_differently_is_rejected_even_where_each_single_run_fits() {
        // Reality repeats ten times as well as the model, in the middle of the model's runs.
        assert!(rejected(0.03, 0.0, 0.003, 0.0, 10) >= 90);
        // A reality that lies beyond the model's runs.
        assert!(rejected(0.01, 0.06, 0.01, 0.0, 10) >= 90);
    }

    /// The power is below 100 %, because the positions have a rank, too, and it is uniform here.
    #[test]
    fn a_reality_with_other_strides_is_mostly_rejected_even_where_its_mean_path_is_typical() {
        let alarms = rejected(0.05, 0.0, 0.05, 0.006, 10);
        assert!(alarms >= 75, "{alarms}");
    }
}
