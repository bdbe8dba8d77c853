//! Tests of bodies of the scene: driven, fixed and free.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use realgap_path::trajectory::{State, Trajectory};
use realgap_simulation::{Experiment, SceneBody, SceneBox, SceneMotion, Start, run};

use crate::bodies::robot;

const G: f64 = 9.81;

fn cube_at(x: f64) -> Experiment {
    let cube = robot(
        r#"(name: "cube", modules: [(name: "cube", kind: Passive(side_m: 0.08, mass_kg: 0.1))])"#,
    );
    let mut experiment = Experiment::new(cube.assemble());
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(x, 0.0, 0.04),
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::zeros(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    experiment
}

fn body(motion: SceneMotion) -> SceneBody {
    SceneBody {
        name: "pusher".to_owned(),
        boxes: vec![SceneBox {
            sides_m: Vector3::new(0.02, 0.04, 0.02),
            body_from_box: Isometry3::translation(0.05, 0.0, 0.03),
        }],
        friction: 0.3,
        motion,
    }
}

#[test]
fn a_driven_body_follows_its_track_and_pushes_a_cube_along() {
    let times: Vec<f64> = (0..=100).map(|k| 0.02 * f64::from(k)).collect();
    let along = |t: f64| 0.1 * (1.0 - (PI * t / 2.0).cos()) / 2.0;
    let track = Trajectory::new(
        times.clone(),
        times
            .iter()
            .map(|t| Vector3::new(along(*t), 0.0, 0.0))
            .collect(),
    )
    .unwrap()
    .with_orientations(vec![UnitQuaternion::identity(); times.len()])
    .unwrap();
    let mut experiment = cube_at(0.12);
    experiment.duration_s = 2.2;
    experiment.scene = vec![body(SceneMotion::Driven {
        track: Some(Arc::new(track)),
    })];
    let end = |experiment: &Experiment| {
        let motion = run(experiment).unwrap().outcome.completed().unwrap();
        let last = motion.len() - 1;
        (
            motion.positions_world_m()[last],
            motion.orientations_world_from_body().unwrap()[last],
        )
    };
    // The tip's front face is at 0.06 m at the start and 0.1 m further at the end, where it touches the cube's rear face.
    let (position, turn) = end(&experiment);
    assert!(
        (position.x - 0.2).abs() < 1e-3 && turn.angle() < 0.02,
        "{position}"
    );
    // A tip further forward pushes the cube further; a tip above the cube does not push it.
    experiment.adjustment.pusher_offset_m.x = 0.01;
    assert!((end(&experiment).0.x - 0.21).abs() < 1e-3);
    experiment.adjustment.pusher_offset_m.z = 0.2;
    assert!((end(&experiment).0.x - 0.12).abs() < 1e-4);
}

#[test]
fn a_fixed_body_stops_a_sliding_cube_and_a_free_one_is_pushed_away() {
    let slide = |motion: SceneMotion| {
        let mut experiment = cube_at(0.0);
        experiment.floor.friction = 0.1;
        experiment.duration_s = 1.5;
        if let Start::State(state) = &mut experiment.start {
            state.velocity_world_m_s.x = 1.0;
        }
        let mut obstacle = body(motion);
        obstacle.boxes[0] = SceneBox {
            sides_m: Vector3::new(0.1, 0.1, 0.1),
            body_from_box: Isometry3::identity(),
        };
        experiment.scene = vec![obstacle];
        let motion = run(&experiment).unwrap().outcome.completed().unwrap();
        motion.net_displacement_world_m().x
    };
    let here: Isometry3<f64> = Isometry3::translation(0.25, 0.0, 0.05);
    let against_wall = slide(SceneMotion::Fixed {
        world_from_body: here,
    });
    let against_free = slide(SceneMotion::Free {
        world_from_body: here,
        mass_kg: 0.1,
    });
    // From its centre to the obstacle's face less half the cube: 0.25 - 0.05 - 0.04.
    assert!(against_wall < 0.161 && against_wall > 0.1, "{against_wall}");
    assert!(against_free > 0.18, "{against_free}");
    let far: Isometry3<f64> = Isometry3::translation(5.0, 0.0, 0.05);
    let alone = slide(SceneMotion::Fixed {
        world_from_body: far,
    });
    assert!(
        (alone / (1.0 / (2.0 * 0.1 * G)) - 1.0).abs() < 0.02,
        "{alone}"
    );
}
