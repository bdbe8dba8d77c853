//! Studies of a car whose recordings hold a throttle, a steering and a switch without units, beside its path.

use std::path::Path;
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_lab::calibration::{Overrides, Study};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{CommandTrack, Experiment, Quantity, Sampling, Start, run};

const CAR: &str = include_str!("../../../tests/common/small_car.ron");
const WHEELS: [&str; 4] = ["fl", "fr", "rl", "rr"];
const STEP_S: f64 = 0.02;
const SAMPLES: usize = 200;
const FRICTION: f64 = 0.5;

fn throttle(t: f64) -> f64 {
    0.4 + 0.3 * (1.3 * t).sin()
}

fn steering(t: f64) -> f64 {
    0.9 * (2.1 * t).sin()
}

fn is_enabled(t: f64) -> bool {
    !(1.0..1.6).contains(&t)
}

fn times() -> Vec<f64> {
    (0..SAMPLES).map(|k| STEP_S * k as f64).collect()
}

/// The path of the car on a floor of [`FRICTION`].
fn driven() -> Trajectory {
    let robot = Morphology::parse(&Source::new("car.ron", CAR)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.floor.friction = FRICTION;
    experiment.floor.restitution = 0.0;
    experiment.solver.timestep_s = 0.005;
    experiment.start = Start::State(State {
        position_world_m: Vector3::zeros(),
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::x(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    experiment.sampling = Sampling::Times(times().into());
    experiment.duration_s = STEP_S * (SAMPLES - 1) as f64;
    let on: Vec<f64> = times()
        .into_iter()
        .map(|t| f64::from(is_enabled(t)))
        .collect();
    for name in WHEELS {
        let values = times().into_iter().map(throttle).collect();
        let track = CommandTrack::new(times(), values, None).unwrap();
        let track = track.of(Quantity::Duty).switched(&on);
        (experiment.commands).insert(name.to_owned(), Arc::new(track));
        if name.starts_with('f') {
            let values = times().into_iter().map(steering).collect();
            let track = CommandTrack::new(times(), values, None).unwrap();
            (experiment.commands).insert(format!("steer_{name}"), Arc::new(track));
        }
    }
    run(&experiment).unwrap().outcome.completed().unwrap()
}

/// Writes robot and log; the logged throttle is multiplied by `gain`.
fn recorded(folder: &Path, gain: f64) {
    std::fs::write(folder.join("car.ron"), CAR).unwrap();
    let path = driven();
    let mut text = "t_s,x_m,y_m,heading_rad,throttle,steering,enabled\n".to_owned();
    let turns = path.orientations_world_from_body().unwrap();
    for (k, t) in times().into_iter().enumerate() {
        let place = path.positions_world_m()[k];
        text += &format!(
            "{t},{},{},{},{},{},{}\n",
            place.x,
            place.y,
            turns[k].euler_angles().2,
            gain * throttle(t),
            steering(t),
            f64::from(is_enabled(t))
        );
    }
    std::fs::write(folder.join("log.csv"), text).unwrap();
}

fn columns(switch: &str) -> String {
    let wheels =
        WHEELS.map(|name| format!("(hinge: \"{name}\", column: \"throttle\", on: \"{switch}\")"));
    let steers =
        ["fl", "fr"].map(|name| format!("(hinge: \"steer_{name}\", column: \"steering\")"));
    [wheels.join(", "), steers.join(", ")].join(", ")
}

fn study(folder: &Path, columns: &str) -> realgap_core::Result<Study> {
    let path = folder.join("study.ron");
    let text = format!(
        r#"Study(morphology: "car.ron", recordings: ["log.csv"], reading: (columns: (heading: "heading_rad")), start: FromRecording, horizon: (0.8, 0.4), align: World,
            timestep_s: 0.005, set: {{"floor.restitution": 0}}, metric: "pose", score: Single,
            commands: Commands(columns: [{columns}]), parameters: [(name: "floor.friction", from: 0.1, to: 1.2)])"#
    );
    std::fs::write(&path, text).unwrap();
    Study::read(path, &Overrides::default())
}

/// Mean error of the position over windows of 0.8 s, body lengths.
fn error_lengths(folder: &Path, friction: f64) -> f64 {
    let study = study(folder, &columns("enabled")).unwrap();
    let set: ParameterSet = [format!("floor.friction={friction}").parse().unwrap()]
        .into_iter()
        .collect();
    let found = study.evaluate(&set, &RunOptions::default()).unwrap();
    found.position_percent.mean / 100.0
}

#[test]
fn columns_without_units_drive_a_car_and_its_windows_tell_the_friction_of_the_floor() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), 1.0);
    let right = error_lengths(folder.path(), FRICTION);
    // What remains is the velocity at the start of a window, which the past tells.
    assert!(right < 0.01, "{right}");
    for wrong in [0.2, 1.0] {
        assert!(error_lengths(folder.path(), wrong) > 3.0 * right, "{wrong}");
    }
    // A larger throttle is another run, and one above the full drive is none.
    recorded(folder.path(), 1.4);
    assert!(error_lengths(folder.path(), FRICTION) > 3.0 * right);
    recorded(folder.path(), 2.0);
    let refused = study(folder.path(), &columns("enabled")).unwrap_err();
    assert!(refused.to_string().contains("-1 to 1"), "{refused}");
}

#[test]
fn switches_and_columns_that_cannot_be_meant_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), 1.0);
    let refused = |columns: &str| study(folder.path(), columns).unwrap_err().to_string();
    let said = refused(&columns("enable"));
    assert!(
        said.contains("unknown recorded column") && said.contains("name a column"),
        "{said}"
    );
    let without_scale = CAR.replace(", command: (factor: 0.4)", "");
    std::fs::write(folder.path().join("car.ron"), without_scale).unwrap();
    let said = refused(&columns("enabled"));
    assert!(
        said.contains("steering") && said.contains("command: (factor"),
        "{said}"
    );
}
