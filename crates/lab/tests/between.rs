//! Two sets of recorded runs without a simulator: do they move alike?

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use realgap_lab::calibration::Overrides;
use realgap_lab::prediction::gap::{Alike, Between, Sample, Scoring, read_sets};
use realgap_path::comparison::{Components, by_name};

fn scoring(metric: &str) -> Scoring {
    Scoring {
        metrics: vec![by_name(metric).unwrap()],
        components: Components::default(),
        body_length_m: None,
        channels: None,
        seed: 1,
    }
}

/// The runs of one set of these files.
fn runs(glob: &str, set: Option<&str>) -> Vec<Sample> {
    let overrides = Overrides {
        recordings: vec![glob.to_owned()],
        ..Overrides::default()
    };
    let sets = read_sets(&overrides, None).unwrap().into_iter();
    let sets = sets.filter(|found| set.is_none_or(|name| found.name == name));
    sets.flat_map(|set| set.runs).collect()
}

/// How many of 60 random halvings of one set are said to differ. By chance alone 5 % of them are, and more than 8 in 1 of 200 cases.
fn false_alarms(mut runs: Vec<Sample>, metric: &str) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let differ = (0..60).filter(|_| {
        runs.shuffle(&mut rng);
        let (first, second) = runs.split_at(runs.len() / 2);
        let found = Between::repeats(first, second, &scoring(metric)).unwrap();
        found.answer == Alike::Differ
    });
    differ.count()
}

#[test]
fn halves_of_one_set_of_tosses_are_alike_and_longer_ones_differ() {
    let tosses = runs("../../real_trajectories/cube_tosses/toss_*.csv", None);
    let tosses = tosses[..16].to_vec();
    let alarms = false_alarms(tosses.clone(), "pca");
    println!("{alarms} of 60 halvings of 16 tosses differ");
    assert!(alarms <= 8, "{alarms} of 60");
    let (first, second) = tosses.split_at(8);
    let longer: Vec<Sample> = second
        .iter()
        .map(|run| Sample::new(run.name.clone(), run.motion.scaled(2.0).unwrap()).unwrap())
        .collect();
    let found = Between::repeats(first, &longer, &scoring("pca")).unwrap();
    println!("{found}");
    assert_eq!(found.answer, Alike::Differ);
}

#[test]
fn a_run_in_both_sets_and_too_few_repeats_are_refused() {
    let tosses = runs("../../real_trajectories/cube_tosses/toss_*.csv", None);
    let twice = Between::repeats(&tosses[..5], &tosses[4..], &scoring("pca")).unwrap_err();
    assert!(twice.to_string().contains("in both sets"), "{twice}");
    let few = Between::repeats(&tosses[..3], &tosses[3..], &scoring("pca")).unwrap_err();
    assert!(few.to_string().contains("4 or more"), "{few}");
}
