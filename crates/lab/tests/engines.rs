//! Two engines in one answer: where they part, the answer says which of them wants what.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_engine::{Experiment, Start, engine_by_name, run};
use realgap_lab::calibration::identification::StartState;
use realgap_lab::calibration::{EngineAnswer, Study};
use realgap_optimize::RunOptions;
use realgap_path::comparison;
use realgap_path::trajectory::State;
use realgap_robot::morphology::Morphology;

const FRICTION: f64 = 0.3;

/// A cube that comes down flat at an angle, recorded in one engine and fitted in both: what each says, and the warnings.
fn fitted(restitution: f64, recorded_in: &str) -> (Vec<EngineAnswer>, Vec<String>) {
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
    let mut study = Study::builder("oblique", robot)
        .duration_s(0.5)
        .start_from_recordings(StartState::FirstSample)
        .set("floor.restitution", restitution)
        .vary("floor.friction", 0.1, 0.5, 17)
        .metric(comparison::by_name("rms").unwrap());
    for (index, motion) in runs.into_iter().enumerate() {
        study = study.trajectory(format!("run_{index}"), motion);
    }
    let answer = study.build().unwrap();
    let answer = answer.sweep(&RunOptions::default()).unwrap();
    let warnings = answer.report.warnings.iter();
    let named = warnings.filter(|w| w.code.name() == "engines-differ");
    let said = named.map(|w| w.message.clone()).collect();
    (answer.report.engines, said)
}

#[test]
fn an_engine_that_wants_another_friction_is_named() {
    // Rapier's friction does not feel restitution, so it takes more of it to lose as much speed.
    let (engines, said) = fitted(0.5, "tree");
    let [rapier, tree] = engines.as_slice() else {
        panic!("{engines:?}");
    };
    let own = |engine: &EngineAnswer| engine.parameters["floor.friction"];
    assert!((own(tree) - FRICTION).abs() <= 0.026, "{tree:?}");
    assert!(own(rapier) > own(tree) + 0.04, "{rapier:?}");
    assert!(
        said.iter()
            .any(|message| message.contains("floor.friction")),
        "{engines:?} {said:?}"
    );
}

#[test]
fn engines_that_agree_are_not_said_to_differ() {
    let (engines, said) = fitted(0.0, "rapier");
    assert_eq!(engines.len(), 2);
    for engine in &engines {
        let off = engine.parameters["floor.friction"] - FRICTION;
        assert!(off.abs() <= 0.026, "{engine:?}");
    }
    assert!(said.is_empty(), "{said:?}");
}
