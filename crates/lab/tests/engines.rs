//! Studies with two engines: where their best parameters differ, the answer states those of each engine.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_identification::StartState;
use realgap_lab::calibration::{Answer, Study, StudyBuilder};
use realgap_optimization::RunOptions;
use realgap_path::comparison;
use realgap_path::trajectory::State;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::by_name;
use realgap_simulation::{Experiment, Start, engine_by_name, run};

const FRICTION: f64 = 0.3;

/// A study of a cube that lands flat with a horizontal velocity, recorded in one engine.
fn study(restitution: f64, recorded_in: &str) -> StudyBuilder {
    let robot = Morphology::read(common::project().join("morphologies/cube.ron")).unwrap();
    let mut reality = Experiment::new(robot.assemble());
    reality.duration_s = 0.5;
    reality.floor.friction = FRICTION;
    reality.floor.restitution = restitution;
    reality.solver.engine = engine_by_name(recorded_in).unwrap();
    let half_m = 0.5 * reality.assembly.body_length_m;
    let runs = [1.5, 2.0, 2.5].map(|along_m_s| {
        reality.start = Start::State(State {
            position_world_m: Vector3::new(0.0, 0.0, half_m + 0.1),
            orientation_world_from_body: UnitQuaternion::identity(),
            velocity_world_m_s: Vector3::new(along_m_s, 0.0, 0.0),
            angular_velocity_body_rad_s: Vector3::zeros(),
        });
        run(&reality).unwrap().outcome.completed().unwrap()
    });
    let study = Study::builder("oblique", robot)
        .duration_s(0.5)
        .start_from_recordings(StartState::FirstSample)
        .set("floor.restitution", restitution)
        .vary("floor.friction", 0.1, 0.5, 33)
        .metric(comparison::by_name("rms").unwrap());
    let numbered = runs.into_iter().enumerate();
    numbered.fold(study, |study, (index, motion)| {
        study.trajectory(format!("run_{index}"), motion)
    })
}

fn answered(study: StudyBuilder) -> Answer {
    let study = study.build().unwrap();
    study.sweep(&RunOptions::default()).unwrap()
}

/// The messages of the warnings that the engines differ.
fn differ(answer: &Answer) -> Vec<&str> {
    let warnings = answer.report.warnings.iter();
    let named = warnings.filter(|w| w.code.name() == "engines-differ");
    named.map(|w| w.message.as_str()).collect()
}

#[test]
fn engines_with_different_best_friction_are_reported_with_their_values() {
    // Rapier's friction impulse does not grow with restitution, so Rapier needs a higher friction to lose as much speed.
    let answer = answered(study(0.5, "tree"));
    let [rapier, tree] = answer.report.engines.as_slice() else {
        panic!("{:?}", answer.report.engines);
    };
    assert_eq!((rapier.engine, tree.engine), ("rapier", "tree"));
    assert_eq!((rapier.settings, tree.settings), (6, 10));
    let [of_rapier, of_tree] =
        [rapier, tree].map(|preference| preference.parameters["floor.friction"]);
    assert!((of_tree - FRICTION).abs() <= 0.026, "{tree:?}");
    assert!(of_rapier > of_tree + 0.04, "{rapier:?}");
    let messages = differ(&answer);
    let [message] = messages.as_slice() else {
        panic!("{:?}", answer.report.engines);
    };
    assert!(message.contains("floor.friction"), "{message}");
    // The report contains the same sentence as the warning.
    assert!(answer.to_string().contains(message), "{answer}");
    // Rapier cannot explain these recordings at any friction, so that all rests on the other engine.
    assert!(tree.explains && !rapier.explains, "{rapier:?} {tree:?}");
    assert!(message.contains("rests on tree"), "{message}");
    let best = answer.report.best.as_ref().unwrap();
    assert_eq!((best.score, best.settings), (tree.score, tree.settings));
    let off = best.parameters["floor.friction"] - FRICTION;
    assert!(off.abs() <= 0.026, "{best:?}");
    let verdict = &answer.report.verdicts[0];
    let mut parts = verdict.interval.iter().chain(&verdict.intervals);
    let holds = |(low, high): &(f64, f64)| (*low..=*high).contains(&FRICTION);
    assert!(parts.any(holds), "{verdict}");
}

#[test]
fn engines_that_agree_are_reported_to_agree() {
    let answer = answered(study(0.0, "rapier"));
    let engines = &answer.report.engines;
    assert_eq!(engines.len(), 2);
    // Both explain the recordings, so that the score is the mean of the scores of both.
    assert!(engines.iter().all(|engine| engine.explains), "{engines:?}");
    let best = answer.report.best.as_ref().unwrap().score;
    let halves = 0.5 * (engines[0].score + engines[1].score);
    assert!((best - halves).abs() < 1e-12, "{best} {halves}");
    for preference in engines {
        let off = preference.parameters["floor.friction"] - FRICTION;
        assert!(off.abs() <= 0.026, "{preference:?}");
    }
    assert!(differ(&answer).is_empty(), "{engines:?}");
    assert!(answer.to_string().contains("the engines agree"), "{answer}");
}

#[test]
fn a_study_with_a_fixed_engine_uses_only_that_engine() {
    let engine = by_name("solver.engine").unwrap().name;
    for (number, name) in [(0.0, "rapier"), (1.0, "tree")] {
        let answer = answered(study(0.0, "rapier").set(engine, number));
        assert!(answer.report.engines.is_empty(), "{name}");
        let provenance = &answer.report.provenance;
        assert!(provenance["engine"].contains(name), "{provenance:?}");
        assert!(!provenance.contains_key("second engine"));
    }
    let free = study(0.0, "rapier").build().unwrap().fingerprint();
    let fixed = study(0.0, "rapier").set(engine, 0.0).build().unwrap();
    assert!(free.entries().len() > fixed.fingerprint().entries().len());
}
