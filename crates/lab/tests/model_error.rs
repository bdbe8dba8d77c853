//! A prediction says how much of it belongs to the model: other steps, other joints, other values that fit as well.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "a table is printed")]

use crate::common;

use common::project;
use realgap_core::unit::LengthUnit;
use realgap_engine::parameter::{Assignment, ParameterSet};
use realgap_engine::{Camera, Distribution, Experiment, Noise};
use realgap_lab::calibration::{Repeatable, Study};
use realgap_lab::prediction::ensemble::{self, Ensemble, Forecast};
use realgap_lab::prediction::{
    Card, EnsembleOptions, EnsembleReport, ModelError, Source, SuccessRule,
};
use realgap_optimize::RunOptions;
use realgap_path::trajectory;
use realgap_robot::morphology::Morphology;

fn robot(name: &str) -> Morphology {
    Morphology::read(project().join(format!("morphologies/{name}.ron"))).unwrap()
}

fn floor(friction: f64) -> ParameterSet {
    let assignment = Assignment::new("floor.friction", friction).unwrap();
    ParameterSet::new().with(assignment)
}

/// The two modules for one second, eight repeats.
fn walk() -> (Experiment, Ensemble, Forecast) {
    let mut experiment = Experiment::new(robot("two_module").assemble());
    experiment.duration_s = 1.0;
    let experiment = floor(0.4).apply(&experiment);
    let noise = Noise::careful_repeat();
    let repeats = ensemble::run(&experiment, &noise, 3, 8, &RunOptions::default()).unwrap();
    let forecast = Forecast::new(&repeats).unwrap();
    (experiment, repeats, forecast)
}

fn on(jobs: usize) -> RunOptions<'static> {
    RunOptions {
        jobs,
        ..RunOptions::default()
    }
}

#[test]
fn models_get_the_draws_of_the_repeats_and_what_they_change_is_laid_on_all_of_them() {
    let (experiment, repeats, forecast) = walk();
    let of = |points: &[ParameterSet], jobs| {
        ModelError::new(&experiment, &repeats, &forecast, points, &on(jobs))
            .unwrap()
            .unwrap()
    };
    let plain = of(&[], 2);
    assert_eq!(plain, of(&[], 1), "the same bits on any thread");
    let sources: Vec<Source> = plain.models.iter().map(|m| m.source).collect();
    assert_eq!(sources[..5], [Source::Numerics; 5]);
    assert_eq!(sources[5..], [Source::Joints]);
    let spread = forecast.displacement_m.unwrap();
    for (range, own) in plain
        .quantiles_m
        .iter()
        .zip([spread.q05, spread.q50, spread.q95])
    {
        assert!(range.low <= own && own <= range.high && range.low < range.high);
    }
    // A point that is the model itself changes nothing; one that is another floor does.
    let same = of(&[floor(0.4)], 2);
    let added = same.models.last().unwrap();
    assert_eq!(added.source, Source::Indistinguishable);
    assert_eq!(added.ratio, Some(1.0));
    assert_eq!(same.quantiles_m, plain.quantiles_m);
    let other = of(&[floor(0.05), floor(0.4)], 2);
    assert_eq!(other.models.len(), plain.models.len() + 2);
    let width = |model: &ModelError| model.quantiles_m[1].high - model.quantiles_m[1].low;
    assert!(width(&other) > width(&plain), "{other:?}");
    // Another engine only adds to what the models say.
    assert!(plain.further_run_m.low < spread.q05 && spread.q95 < plain.further_run_m.high);
}

#[test]
fn a_probability_of_success_comes_with_what_other_models_say() {
    let (experiment, repeats, forecast) = walk();
    let model = ModelError::new(&experiment, &repeats, &forecast, &[], &on(2)).unwrap();
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
    // Half of the repeats get that far; a few percent of displacement decide, so that models part widely.
    assert!(range.models.high - range.models.low > 0.2, "{range:?}");
    let said = card.to_string();
    for words in [
        "sampling error, 95 %",
        "other models",
        "with another engine",
        "model error       6 other models, 4 repeats each",
        "joint kind",
        "not covered       a robot that differs from its description",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn a_stopped_run_and_a_robot_that_goes_nowhere_have_no_model_error() {
    let (experiment, repeats, forecast) = walk();
    let stop = std::sync::atomic::AtomicBool::new(true);
    let stopped = RunOptions {
        stop: Some(&stop),
        ..RunOptions::default()
    };
    let found = ModelError::new(&experiment, &repeats, &forecast, &[], &stopped).unwrap();
    assert!(found.is_none());
    let mut experiment = Experiment::new(robot("cube").assemble());
    experiment.duration_s = 0.2;
    let noise = Noise::careful_start();
    let repeats = ensemble::run(&experiment, &noise, 3, 4, &on(2)).unwrap();
    let forecast = Forecast::new(&repeats).unwrap();
    let found = ModelError::new(&experiment, &repeats, &forecast, &[], &on(2)).unwrap();
    assert!(found.is_none());
}

/// The noise that the MuJoCo stand-ins were recorded with, as their meta.ron says.
fn recorded_with() -> Noise {
    let degree = Distribution::Normal(0.0175);
    Noise {
        start_position_m: Distribution::Normal(0.001),
        start_height_m: Distribution::Normal(0.001),
        start_tilt_rad: degree,
        start_heading_rad: degree,
        servo_zero_rad: Distribution::Normal(0.00436),
        camera: Camera {
            position_m: Distribution::Normal(0.001),
            angle_rad: Distribution::Normal(0.005),
            time_s: Distribution::default(),
        },
        ..Noise::default()
    }
}

/// The table of docs/fidelity/ensembles.md: another engine's recordings, on the floor that they were made with, fitted by nobody.
#[test]
#[ignore = "some minutes"]
fn the_table_of_the_mujoco_stand_ins() {
    println!(
        "| robot | stand-ins, cm | repeats, 90 %, cm | other models, 5 to 95 % | with another engine, 50 % | 90 % | inside each, of 10 |"
    );
    for (name, friction) in [("tripod", 0.47), ("two_module", 0.4), ("chain5", 0.6)] {
        let mut study = Study::builder(name, robot(name))
            .duration_s(20.0)
            .vary("floor.restitution", 0.0, 0.5, 2)
            .set("floor.friction", friction)
            .noise(recorded_with());
        let mut real_m = Vec::new();
        for number in 0..10 {
            let file = format!("real_trajectories/{name}_mujoco/run_{number:02}.csv");
            let recording = trajectory::read(project().join(file), LengthUnit::Metre).unwrap();
            let path = trajectory::prepare(&recording.trajectory).unwrap();
            real_m.push(path.net_displacement_m());
            study = study.recording(recording);
        }
        let study = Repeatable::new(study.build().unwrap()).unwrap();
        let options = EnsembleOptions {
            noise: recorded_with(),
            noise_from: "meta.ron".to_owned(),
            repeats: 200,
            seed: 1,
            model: Some(Vec::new()),
        };
        let report = EnsembleReport::new(&study, &options, &RunOptions::default()).unwrap();
        let case = &report.cases[0];
        let (spread, model) = (
            case.forecast.displacement_m.unwrap(),
            case.model.as_ref().unwrap(),
        );
        let models = (model.quantiles_m[0].low, model.quantiles_m[2].high);
        let half = (model.half_of_runs_m.low, model.half_of_runs_m.high);
        let most = (model.further_run_m.low, model.further_run_m.high);
        let inside = |(low, high): (f64, f64)| {
            let held = real_m.iter().filter(|m| (low..=high).contains(*m)).count();
            format!("{held}")
        };
        let cm = |(low, high): (f64, f64)| format!("{:.0} to {:.0}", 100.0 * low, 100.0 * high);
        let ends = real_m
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), m| (a.min(*m), b.max(*m)));
        let repeats = (spread.q05, spread.q95);
        let ranges = [repeats, models, half, most];
        println!(
            "| {name} | {} | {} | {} |",
            cm(ends),
            ranges.map(cm).join(" | "),
            ranges.map(inside).join(", ")
        );
    }
}
