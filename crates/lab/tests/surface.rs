//! The map of a study: what it expects between the runs, and how far it says that this is known.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use realgap_core::random::Generator;
use realgap_identification::StartState;
use realgap_lab::calibration::{Answer, Study};
use realgap_optimization::RunOptions;
use realgap_path::comparison;
use realgap_path::trajectory::{Alignment, State};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Start, run};

use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};

const DURATION_S: f64 = 2.0;
const FRICTION: f64 = 0.45;
const RESTITUTION: f64 = 0.2;
/// Points at which two maps are compared.
const POINTS: usize = 50;

/// A sweep of two modules that walk on a floor: friction and restitution within these ranges, so many points each.
fn swept(friction: (f64, f64), restitution: (f64, f64), points: usize) -> Answer {
    let robot = Morphology::read(common::project().join("morphologies/two_module.ron")).unwrap();
    let mut reality = Experiment::new(robot.assemble());
    reality.duration_s = DURATION_S;
    reality.floor.friction = FRICTION;
    reality.floor.restitution = RESTITUTION;
    let mut study = Study::builder("surface", robot)
        .duration_s(DURATION_S)
        .vary("floor.friction", friction.0, friction.1, points)
        .vary("floor.restitution", restitution.0, restitution.1, points)
        .metric(comparison::by_name("rms").unwrap());
    for (number, timestep_s) in [4e-4, 6e-4, 8e-4, 1.0e-3].into_iter().enumerate() {
        reality.solver.timestep_s = timestep_s;
        let motion = run(&reality).unwrap().outcome.completed().unwrap();
        study = study.trajectory(format!("run_{number}"), motion);
    }
    let study = study.build().unwrap();
    study.sweep(&RunOptions::default()).unwrap()
}

#[test]
fn a_finer_grid_changes_the_map_only_within_what_is_uncertain() {
    if !common::is_long_run("two sweeps of a walker") {
        return;
    }
    let whole = swept((0.1, 0.9), (0.0, 0.8), 21);
    let best = &whole.scores.points[whole.scores.best.unwrap()].values;
    // Eight steps of the coarse grid around its best point.
    let around = |value: f64, low: f64, high: f64| {
        let middle = value.clamp(low + 0.16, high - 0.16);
        (middle - 0.16, middle + 0.16)
    };
    let (friction, restitution) = (around(best[0], 0.1, 0.9), around(best[1], 0.0, 0.8));
    let zoom = swept(friction, restitution, 9);
    let mut rng = Generator::seed_from_u64(50);
    let mut within = |(low, high): (f64, f64)| low + (high - low) * rng.random::<f64>();
    let mut held = 0;
    for _ in 0..POINTS {
        let values = [within(friction), within(restitution)];
        let (far, (far_low, far_high)) = whole.expected_with_band(&values).unwrap();
        let (near, (near_low, near_high)) = zoom.expected_with_band(&values).unwrap();
        // Half of the width of the interval of a difference.
        let half = (0.5 * (far_high - far_low)).hypot(0.5 * (near_high - near_low));
        held += usize::from((far - near).abs() <= half);
    }
    println!("{held} of {POINTS} differences of the maps lie within their 90 % intervals");
    assert!(held * 100 >= 85 * POINTS, "{held} of {POINTS}");
}

/// The score of a sliding cube's friction by paths that are compared with this alignment: on a slope it is pushed uphill, comes to rest,
/// and stays there where friction holds it; with little friction it slides down past its start.
fn slides(align: Alignment) -> Answer {
    let robot = Morphology::read(common::project().join("morphologies/cube.ron")).unwrap();
    let mut reality = Experiment::new(robot.assemble());
    reality.duration_s = 0.8;
    reality.floor.friction = 0.15;
    reality.floor.slope_rad = 0.25;
    let half_m = 0.5 * reality.assembly.body_length_m;
    let study = Study::builder("slope", robot)
        .duration_s(0.8)
        .start_from_recordings(StartState::FirstSample)
        .set("floor.slope_rad", 0.25)
        .vary("floor.friction", 0.05, 1.0, 20)
        .align(align)
        .metric(comparison::by_name("rms").unwrap());
    let runs = [-0.5, -0.6, -0.7].map(|along_m_s| {
        reality.start = Start::State(State {
            position_world_m: Vector3::new(0.0, 0.0, half_m),
            orientation_world_from_body: UnitQuaternion::identity(),
            velocity_world_m_s: Vector3::new(along_m_s, 0.0, 0.0),
            angular_velocity_body_rad_s: Vector3::zeros(),
        });
        run(&reality).unwrap().outcome.completed().unwrap()
    });
    let numbered = runs.into_iter().enumerate();
    let study = numbered.fold(study, |study, (index, motion)| {
        study.trajectory(format!("run_{index}"), motion)
    });
    study
        .build()
        .unwrap()
        .sweep(&RunOptions::default())
        .unwrap()
}

#[test]
fn on_a_slope_paths_in_the_world_find_the_friction_and_turned_paths_are_warned_about() {
    let in_world = slides(Alignment::World);
    let codes = |answer: &Answer| {
        let warnings = answer.report.warnings.iter();
        warnings.map(|w| w.code.name()).collect::<Vec<_>>()
    };
    assert!(!codes(&in_world).contains(&"folded-directions"));
    let best = &in_world.scores.points[in_world.scores.best.unwrap()];
    assert!((best.values[0] - 0.15).abs() < 0.03, "{:?}", best.values);
    assert!(codes(&slides(Alignment::NetDisplacement)).contains(&"folded-directions"));
}

/// Slides of a worm on a ramp, where a friction below 0.2 makes it slide off by metres, beside millimetres at the true friction.
#[test]
fn a_cliff_of_the_score_does_not_hide_the_valley_beside_it() {
    if !common::is_long_run("a sweep of a worm on a ramp") {
        return;
    }
    let robot = Morphology::read(common::project().join("morphologies/worm4.ron")).unwrap();
    let mut reality = Experiment::new(robot.assemble());
    (
        reality.duration_s,
        reality.floor.friction,
        reality.floor.slope_rad,
    ) = (5.0, 0.26, 0.2);
    let mut study = Study::builder("cliff", robot)
        .duration_s(5.0)
        .align(Alignment::World)
        .vary("floor.friction", 0.1, 1.0, 19)
        .vary("floor.slope_rad", 0.18, 0.22, 9)
        .metric(comparison::by_name("rms").unwrap());
    for (number, timestep_s) in [4e-4, 5e-4, 6e-4, 8e-4, 1e-3].into_iter().enumerate() {
        reality.solver.timestep_s = timestep_s;
        let motion = run(&reality).unwrap().outcome.completed().unwrap();
        study = study.trajectory(format!("run_{number}"), motion);
    }
    let answer = study
        .build()
        .unwrap()
        .sweep(&RunOptions::default())
        .unwrap();
    let worst = answer.scores.runs.iter().filter_map(|run| run.score);
    assert!(worst.fold(0.0, f64::max) > 1.0, "nothing slid off");
    let verdict = &answer.report.verdicts[0];
    let (low, high) = verdict.interval.unwrap();
    println!("friction {low:.3} to {high:.3}, truth 0.26");
    assert!(
        low < 0.26 && 0.26 < high && high - low < 0.2,
        "{}",
        verdict.text
    );
}
