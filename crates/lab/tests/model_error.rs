//! The model error of a prediction: how much it changes with other numerical settings, joint formulations, engines and parameter
//! values that fit as well.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "a table is printed")]

use crate::common;

use common::project;
use realgap_lab::prediction::ensemble::{self, Ensemble, Forecast};
use realgap_lab::prediction::{
    Card, Judged, ModelError, ModelOptions, OtherEngine, OwnEngines, Source, SuccessRule,
};
use realgap_optimization::RunOptions;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{Experiment, Noise};

fn robot(name: &str) -> Morphology {
    Morphology::read(project().join(format!("morphologies/{name}.ron"))).unwrap()
}

fn floor(friction: f64) -> ParameterSet {
    let assignment = Assignment::new("floor.friction", friction).unwrap();
    ParameterSet::new().with(assignment)
}

/// The robot of two modules for one second, with eight repeats.
fn walk() -> (Experiment, Ensemble, Forecast) {
    let mut experiment = Experiment::new(robot("two_module").assemble());
    experiment.duration_s = 1.0;
    let experiment = floor(0.4).apply(&experiment);
    let noise = Noise::careful_repeat();
    let repeats = ensemble::run(&experiment, &noise, 3, 8, &RunOptions::default()).unwrap();
    let forecast = Forecast::new(&repeats).unwrap();
    (experiment, repeats, forecast)
}

/// The model error with these points of the confidence set, and the table as the third opinion.
fn with(points: &[ParameterSet]) -> ModelOptions {
    ModelOptions {
        points: points.to_vec(),
        ..ModelOptions::default()
    }
}

fn on(jobs: usize) -> RunOptions<'static> {
    RunOptions {
        jobs,
        ..RunOptions::default()
    }
}

#[test]
fn other_models_run_with_the_draws_of_the_repeats_and_widen_the_quantiles() {
    let (experiment, repeats, forecast) = walk();
    let of = |points: &[ParameterSet], jobs| {
        ModelError::new(&experiment, &repeats, &forecast, &with(points), &on(jobs))
            .unwrap()
            .unwrap()
    };
    let plain = of(&[], 2);
    assert_eq!(
        plain,
        of(&[], 1),
        "the result depends on the number of threads"
    );
    let sources: Vec<Source> = plain.models.iter().map(|m| m.source).collect();
    assert_eq!(sources[..5], [Source::Numerics; 5]);
    assert_eq!(
        sources[5..],
        [Source::Joints, Source::Engine, Source::Contact]
    );
    let spread = forecast.displacement_m.unwrap();
    for (range, own) in plain
        .quantiles_m
        .iter()
        .zip([spread.q05, spread.q50, spread.q95])
    {
        assert!(range.low <= own && own <= range.high && range.low < range.high);
    }
    // A point with the values of the model itself changes nothing, and a point with another floor does.
    let same = of(&[floor(0.4)], 2);
    let added = same.models.last().unwrap();
    assert_eq!(added.source, Source::Indistinguishable);
    assert_eq!(added.ratio, Some(1.0));
    assert_eq!(same.quantiles_m, plain.quantiles_m);
    let other = of(&[floor(0.05), floor(0.4)], 2);
    assert_eq!(other.models.len(), plain.models.len() + 2);
    let width = |model: &ModelError| model.quantiles_m[1].high - model.quantiles_m[1].low;
    assert!(width(&other) > width(&plain), "{other:?}");
    // The 50 % range of a run in another engine lies inside of the range of most runs, and its lower end adds a negative distance.
    let (half, most) = (plain.half_of_runs_m.unwrap(), plain.further_run_m.unwrap());
    assert!(0.0 <= most.low && most.low < half.low && half.high < most.high);
    let adds = plain.other_engine_adds_m.unwrap();
    assert!((most.high - spread.mean - adds.high).abs() < 1e-12 && adds.low < 0.0);
}

#[test]
fn a_probability_of_success_has_the_range_of_other_models() {
    let (experiment, repeats, forecast) = walk();
    let model = ModelError::new(&experiment, &repeats, &forecast, &with(&[]), &on(2)).unwrap();
    let median_m = forecast.displacement_m.unwrap().q50;
    let card = Card::new("two_module", &repeats, SuccessRule::AtLeast(median_m)).unwrap();
    assert!(card.success.as_ref().unwrap().range.is_none());
    let card = card.with_model(&repeats, model);
    let success = card.success.as_ref().unwrap();
    let range = success.range.unwrap();
    assert!(
        range.models.contains(success.probability.share),
        "{range:?}"
    );
    // The probability with another engine is learned from robots of which some walk far in one engine and not in another, so that
    // it is never 0 or 1.
    assert!((0.0..1.0).contains(&range.other_engine) && range.other_engine > 0.0);
    // Half of the repeats reach the median, and a change of the displacement by a few percent decides about success, so that the
    // probabilities of the models differ widely.
    assert!(range.models.high - range.models.low > 0.2, "{range:?}");
    let text = card.to_string();
    for words in [
        "sampling error, 95 %",
        "other models",
        "with another engine",
        "model error       8 other models, 4 repeats each",
        "second engine",
        "relaxed contact",
        "another engine  50 %",
        "joint kind",
        "not covered       a robot that differs from its description",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_stopped_run_and_a_robot_that_does_not_move_have_no_model_error() {
    let (experiment, repeats, forecast) = walk();
    let stop = std::sync::atomic::AtomicBool::new(true);
    let stopped = RunOptions {
        stop: Some(&stop),
        ..RunOptions::default()
    };
    let found = ModelError::new(&experiment, &repeats, &forecast, &with(&[]), &stopped).unwrap();
    assert!(found.is_none());
    let mut experiment = Experiment::new(robot("cube").assemble());
    experiment.duration_s = 0.2;
    let noise = Noise::careful_start();
    let repeats = ensemble::run(&experiment, &noise, 3, 4, &on(2)).unwrap();
    let forecast = Forecast::new(&repeats).unwrap();
    let found = ModelError::new(&experiment, &repeats, &forecast, &with(&[]), &on(2)).unwrap();
    assert!(found.is_none());
}

#[test]
fn a_robot_that_the_second_engine_cannot_run_uses_its_own_engine_and_the_text_says_so() {
    let (experiment, repeats, forecast) = walk();
    // Only Rapier has impulse joints, so the second engine cannot run this experiment.
    let joints = ParameterSet::new().with(Assignment::new("solver.joint", 0.0).unwrap());
    let experiment = joints.apply(&experiment);
    let model = ModelError::new(&experiment, &repeats, &forecast, &with(&[]), &on(2)).unwrap();
    let model = model.unwrap();
    assert!(model.models.iter().all(|one| one.source != Source::Engine));
    assert!(model.to_string().contains("the second one cannot run this"));
    assert!(model.further_run_m.unwrap().low < model.half_of_runs_m.unwrap().low);
}

#[test]
fn the_range_for_another_engine_grows_with_every_sign_of_sensitivity() {
    let calm = OwnEngines {
        own_m: 0.4,
        second_m: Some(0.4),
        relaxed_m: Some(0.4),
        spread_m: 0.0,
        sensitivity_m: 0.0,
        body_length_m: 0.058,
    };
    let ends = |known: &OwnEngines| OtherEngine::new(known).central(0.9);
    let share = |known: &OwnEngines| {
        let middle_m = (known.own_m * known.second_m.unwrap_or(known.own_m)).sqrt();
        (ends(known).high - ends(known).low) / middle_m
    };
    let doubts: [fn(&mut OwnEngines); 5] = [
        |known| known.second_m = Some(0.1),
        |known| known.relaxed_m = Some(0.1),
        |known| known.spread_m = 0.1,
        |known| known.sensitivity_m = 0.1,
        // A robot that moves slowly is compared with robots that move slowly, which have wider ranges.
        |known| {
            known.own_m = 0.05;
            (known.second_m, known.relaxed_m) = (Some(0.05), Some(0.05));
        },
    ];
    for doubt in doubts {
        let mut doubted = calm;
        doubt(&mut doubted);
        assert!(share(&doubted) > share(&calm), "{doubted:?}");
    }
    // The range is proportional to the displacement.
    let twice = OwnEngines {
        own_m: 0.8,
        second_m: Some(0.8),
        relaxed_m: Some(0.8),
        ..calm
    };
    assert!((ends(&twice).high - 2.0 * ends(&calm).high).abs() < 1e-12);
    let reaches = |least_m: f64| OtherEngine::new(&calm).reaches(least_m);
    assert!(1.0 > reaches(0.0) && reaches(0.0) > reaches(0.3) && reaches(0.3) > reaches(9.0));
    assert!(reaches(9.0) > 0.0);
}

/// The robots come from seeds that were not used for learning (docs/validation/ensembles.md).
#[test]
fn the_coverage_for_robots_not_used_for_learning_is_as_documented() {
    let table = project().join("crates/lab/tests/golden/engines_judged.csv");
    let table = std::fs::read_to_string(table).unwrap();
    let robots: Vec<Judged> = Judged::table(&table).collect();
    assert_eq!(robots.len(), table.lines().count() - 1);
    let (mut held, mut runs, mut score, mut sure, mut widths) = ([0, 0], 0, 0.0, 0.0, Vec::new());
    for Judged { known, theirs_m } in &robots {
        let other = OtherEngine::new(known);
        let [half, most] = [0.5, 0.9].map(|level| other.central(level));
        widths.push((most.high - most.low) / known.own_m);
        // Success is defined as in the card: half of the displacement that the robot's own engine predicts.
        let least_m = 0.5 * known.own_m;
        for m in theirs_m {
            runs += 1;
            held[0] += usize::from(half.contains(*m));
            held[1] += usize::from(most.contains(*m));
            let happened = f64::from(u8::from(*m >= least_m));
            score += (other.reaches(least_m) - happened).powi(2);
            sure += (1.0 - happened).powi(2);
        }
    }
    assert_eq!(
        (held, runs),
        ([84, 145], 160),
        "as docs/validation/ensembles.md says"
    );
    let share = |sum: f64| sum / runs as f64;
    let [half, most] = held.map(|count| share(count as f64));
    let width = realgap_core::statistics::median(&widths);
    println!(
        "{} robots, {runs} runs: 50 % ranges hold {half:.3}, 90 % {most:.3}, median width {width:.2} of the displacement; \
         Brier score of success {:.3}, of one that is always sure {:.3}",
        robots.len(),
        share(score),
        share(sure)
    );
}
