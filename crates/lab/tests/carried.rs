//! Predictions propagate the uncertainty of a fit: repeats draw their parameters from its posterior instead of using its best
//! point.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use realgap_core::unit::LengthUnit;
use realgap_lab::calibration::{Fitted, Repeatable, Study, read_best};
use realgap_lab::prediction::gap::{GapOptions, StudyGap};
use realgap_lab::prediction::{EnsembleOptions, EnsembleReport, ModelError, ModelOptions};
use realgap_optimization::RunOptions;
use realgap_path::{comparison, trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::Noise;
use realgap_simulation::parameter::{Assignment, ParameterSet};

const SEED: u64 = 3;
const REPEATS: usize = 24;

fn friction(value: f64) -> ParameterSet {
    ParameterSet::new().with(Assignment::new("floor.friction", value).unwrap())
}

/// A study of the tripod for two seconds with a best friction of 0.5 and posterior draws of the friction from `low` to `high`.
fn study(low: f64, high: f64) -> Study {
    let root = common::project();
    let morphology = Morphology::read(root.join("morphologies/tripod.ron")).unwrap();
    let mut study = Study::builder("carried", morphology);
    for run in ["run_00", "run_01", "run_02"] {
        let path = root.join(format!("real_trajectories/tripod_standin/{run}.csv"));
        study = study.recording(trajectory::read(path, LengthUnit::Metre).unwrap());
    }
    let study = study.duration_s(2.0).vary("floor.friction", 0.1, 0.9, 3);
    let study = study
        .metric(comparison::by_name("rms").unwrap())
        .build()
        .unwrap();
    let drawn = (0..16).map(|k| friction(low + (high - low) * f64::from(k) / 15.0));
    study
        .at(&friction(0.5), vec![drawn.collect()], &[])
        .unwrap()
}

fn options() -> EnsembleOptions {
    EnsembleOptions {
        noise: Noise::careful_repeat(),
        noise_from: "a test".to_owned(),
        repeats: REPEATS,
        seed: SEED,
        model: None,
    }
}

fn ensemble(low: f64, high: f64) -> EnsembleReport {
    let study = Repeatable::new(study(low, high)).unwrap();
    EnsembleReport::new(&study, &options(), &RunOptions::default()).unwrap()
}

#[test]
fn an_ensemble_spreads_more_where_the_fit_is_more_uncertain() {
    let spread_m = |report: &EnsembleReport| {
        let far = report.cases[0].forecast.displacement_m.unwrap();
        far.q95 - far.q05
    };
    let (point, wide) = (ensemble(0.5, 0.5), ensemble(0.1, 0.9));
    let (alone_m, carried_m) = (spread_m(&point), spread_m(&wide));
    assert!(carried_m > 1.5 * alone_m, "{alone_m} m, {carried_m} m");
    // The run without noise uses the best point in both cases, and a warning says that the parameters are uncertain.
    let ideal_m = |report: &EnsembleReport| report.cases[0].forecast.noise_free_displacement_m;
    assert_eq!(ideal_m(&point), ideal_m(&wide));
    let codes = wide.warnings.iter().map(|warning| warning.code.name());
    assert_eq!(
        codes.filter(|code| *code == "uncertain-parameters").count(),
        1
    );
}

#[test]
fn a_repeat_that_is_run_alone_equals_that_repeat_of_the_ensemble() {
    let study = Repeatable::new(study(0.1, 0.9)).unwrap();
    let report = EnsembleReport::new(&study, &options(), &RunOptions::default()).unwrap();
    let alone = EnsembleReport::run(&study, &options(), 0, 7).unwrap();
    let far_m = alone.outcome.completed().unwrap();
    let far_m = trajectory::prepare(&far_m).unwrap().net_displacement_m();
    let known = report.cases[0].ensemble.repeats[7].outcome.get().unwrap();
    assert_eq!(known.net_displacement_m(), far_m);
}

/// Both use the same draws, so that their results cannot contradict each other.
#[test]
fn gap_and_ensemble_of_a_fit_have_the_same_p_value() {
    let study = study(0.1, 0.9);
    let options = GapOptions {
        noise: Some(Noise::careful_repeat()),
        repeats: REPEATS,
        seed: SEED,
        ..GapOptions::of(&study).unwrap()
    };
    let gap = StudyGap::new(&study, &options, &RunOptions::default()).unwrap();
    let alike = gap.metrics.iter().find(|row| row.metric == "rms");
    let of_ensemble = ensemble(0.1, 0.9).reality.unwrap().alike.unwrap();
    assert_eq!(alike.unwrap().alike.unwrap().p_value, of_ensemble.p_value);
}

#[test]
fn a_parameter_that_repeats_draw_is_not_counted_again_as_another_model() {
    let report = ensemble(0.1, 0.9);
    let case = &report.cases[0];
    let study = Repeatable::new(study(0.1, 0.9)).unwrap();
    let (experiment, run) = (&study.cases[0].experiment, RunOptions::default());
    let options = ModelOptions {
        points: vec![friction(0.1), friction(0.9)],
        ..ModelOptions::default()
    };
    let model = ModelError::new(experiment, &case.ensemble, &case.forecast, &options, &run);
    let models = model.unwrap().unwrap().models;
    assert!(
        models
            .iter()
            .all(|model| !model.name.contains("floor.friction"))
    );
}

#[test]
fn a_parameter_file_has_draws_and_a_value_set_later_replaces_its_draws() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let best = file(
        "best.ron",
        r#"(parameters: { "floor.friction": 0.5, "floor.restitution": 0.1 },
            draws: { "floor.friction": [0.4, 0.6], "floor.restitution": [0.1, 0.2] })"#,
    );
    let fitted = Fitted::read(&[&best]).unwrap();
    assert_eq!(fitted.draws[0].len(), 2);
    assert_eq!(fitted.draws[0][1].value("floor.friction"), Some(0.6));
    let known = fitted.with_values(&friction(0.3));
    assert_eq!(known.draws[0][1].value("floor.friction"), None);
    assert_eq!(known.draws[0][1].value("floor.restitution"), Some(0.2));
    let torn = file(
        "torn.ron",
        r#"(parameters: {}, draws: { "floor.friction": [0.4], "floor.restitution": [] })"#,
    );
    let error = read_best(torn).unwrap_err().to_string();
    assert!(error.contains("as many as every parameter has"), "{error}");
}
