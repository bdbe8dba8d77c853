//! Tests of the two-wheel robot: closed-form solutions, noise, several robots, and refused files.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::sync::Arc;

use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Noise, Vehicle, run};

fn two_wheel() -> Experiment {
    let vehicle = Vehicle::read(common::project().join("vehicles/two_wheel.ron"), None).unwrap();
    let cube = Morphology::read(common::project().join("morphologies/cube.ron")).unwrap();
    let mut experiment = Experiment::new(cube.assemble());
    experiment.drive = vehicle.drive;
    experiment.vehicle = Some(Arc::new(vehicle));
    experiment.duration_s = 5.0;
    experiment
}

fn motion(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

/// The ideal robot of paper 000, section 5.2: straight to the first box, right, straight to the second, right, and back.
#[test]
fn the_ideal_robot_follows_the_path_of_the_paper() {
    let mut experiment = two_wheel();
    experiment.drive.ideal_actuator = 1.0;
    experiment.drive.ideal_sensor = 1.0;
    experiment.drive.ideal_control = 1.0;
    // The paper measures distances from the robot's middle.
    experiment.drive.sensor_ahead_m = 0.0;
    let path = motion(&experiment);
    let positions = path.positions_world_m();
    let most_x = positions.iter().map(|p| p.x).fold(0.0, f64::max);
    assert!((most_x - 0.76).abs() < 0.005, "{most_x}");
    let turned = path.turned_rad().unwrap();
    assert!((turned + std::f64::consts::PI).abs() < 1e-6, "{turned}");
    let last = positions[positions.len() - 1];
    assert!((last.y - 0.31).abs() < 0.005 && last.x < 0.5, "{last:?}");
    let speed = positions[60].x - positions[0].x;
    assert!(
        (speed - 0.2266).abs() < 1e-6,
        "constants must apply once per command, not once per epoch: {speed}"
    );
}

#[test]
fn constants_of_a_command_apply_once_per_command() {
    let mut experiment = two_wheel();
    experiment.drive.drift_rad_s = 0.0;
    experiment.drive.drift_offset_rad = 0.0;
    experiment.drive.ideal_sensor = 1.0;
    experiment.drive.sampling_s = 0.01;
    let far = |coast_m: f64| {
        let mut changed = experiment.clone();
        changed.drive.coast_m = coast_m;
        motion(&changed)
            .positions_world_m()
            .iter()
            .map(|p| p.x)
            .fold(0.0, f64::max)
    };
    let gained = far(0.0134) - far(0.0);
    assert!((gained - 0.0134).abs() < 0.003, "{gained}");
    let turned = |coast_rad: f64| {
        let mut changed = experiment.clone();
        changed.drive.turn_coast_rad = coast_rad;
        // The run contains one turn.
        changed.duration_s = 2.5;
        motion(&changed).turned_rad().unwrap()
    };
    let more = turned(0.1) - turned(0.2);
    assert!((more - 0.1).abs() < 1e-6, "{more}");
}

/// False alarms are a Poisson process: after a time t, all but exp(-rate t) of the runs have turned. With 600 runs the standard
/// error is 0.02.
#[test]
fn false_alarms_occur_at_the_stated_rate_and_not_by_default() {
    let mut experiment = two_wheel();
    // The robot needs 1.7 s to the first box.
    experiment.duration_s = 1.0;
    let turned = |rate_hz: f64| {
        let mut changed = experiment.clone();
        changed.drive.false_alarm_hz = rate_hz;
        let of = |repeat: u64| motion(&Noise::default().perturb(&changed, 7, repeat));
        let turns = (0..600).map(|repeat| of(repeat).turned_rad().unwrap());
        turns.filter(|turned| *turned < -0.3).count() as f64 / 600.0
    };
    assert_eq!(turned(0.0), 0.0);
    // The robot coasts for 0.06 s, and 0.06 s later it has turned by 0.2 rad more than by drift.
    for rate_hz in [0.5, 2.0] {
        let (found, expected) = (turned(rate_hz), 1.0 - (-rate_hz * 0.88).exp());
        assert!((found - expected).abs() < 0.06, "{found}, {expected}");
    }
    experiment.drive.false_alarm_hz = 5.0;
    let without_draws = motion(&experiment).turned_rad().unwrap();
    assert!(without_draws > -0.3, "{without_draws}");
    experiment.drive.ideal_sensor = 1.0;
    let ideal = motion(&Noise::default().perturb(&experiment, 7, 1));
    assert!(ideal.turned_rad().unwrap() > -0.3);
}

#[test]
fn repeats_depend_on_their_number_and_are_reproducible() {
    let experiment = two_wheel();
    let noise = Noise::default();
    let of = |repeat: u64| motion(&noise.perturb(&experiment, 7, repeat));
    assert_eq!(of(3), of(3));
    assert_ne!(of(3), of(4));
    assert_eq!(motion(&experiment), motion(&experiment));
    // Switching off errors of actuators and readings changes no draw of the sensor.
    let mut quiet = experiment.clone();
    quiet.drive.actuator_noise = 0.0;
    quiet.drive.sensor_noise = 0.0;
    let quiet = |repeat: u64| motion(&noise.perturb(&quiet, 7, repeat));
    // Only the time of the first reading remains random: it is within one sampling time.
    let off = (quiet(3).positions_world_m()[80] - quiet(4).positions_world_m()[80]).norm();
    assert!(off < 1e-9, "{off}");
}

/// Robots in an empty field, the first at (1, 1) looking along +x.
fn crowd(others: &str) -> realgap_core::Result<Experiment> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "field.ron",
        "(name: \"field\", size_m: (4.0, 3.0), boundary: Open, start: (x_m: 1.0, y_m: 1.0))"
            .to_owned(),
    );
    write(
        "robot.ron",
        format!(
            "(name: \"robot\", radius_m: 0.08, arena: \"field.ron\", sensor: \"ultrasonic\", others: [{others}])"
        ),
    );
    let vehicle = Vehicle::read(folder.path().join("robot.ron"), None)?;
    let mut experiment = two_wheel();
    experiment.drive = vehicle.drive;
    experiment.vehicle = Some(Arc::new(vehicle));
    experiment.duration_s = 3.0;
    Ok(experiment)
}

#[test]
fn robots_in_one_arena_detect_and_avoid_each_other() {
    let turned_rad = |experiment: &Experiment| {
        let motion = motion(experiment);
        let all = motion.orientations_world_from_body().unwrap();
        all[0].angle_to(&all[all.len() - 1])
    };
    // A single robot only drifts; another robot that comes towards it makes it turn to the right.
    let alone = turned_rad(&crowd("").unwrap());
    assert!(alone < 0.3, "{alone}");
    let met = turned_rad(&crowd("(x_m: 1.8, y_m: 0.97, heading_deg: 180.0)").unwrap());
    assert!(met > 1.2, "{met}");
    // A distant robot changes nothing, not even the random draws.
    let mut far = crowd("(x_m: 3.9, y_m: 2.9, heading_deg: 90.0)").unwrap();
    let mut lone = crowd("").unwrap();
    for experiment in [&mut far, &mut lone] {
        experiment.perturbation.draw = Some((3, 4));
    }
    assert_eq!(motion(&far), motion(&lone));
    // Robots that do not react to their sensors stop before they overlap.
    let mut blind = crowd("(x_m: 1.5, y_m: 1.0, heading_deg: 180.0)").unwrap();
    blind.drive.threshold_m = 0.0;
    blind.drive.ideal_sensor = 1.0;
    let path = motion(&blind);
    let farthest_m = path
        .positions_world_m()
        .iter()
        .map(|p| p.x)
        .fold(0.0, f64::max);
    assert!((farthest_m - 1.17).abs() < 0.01, "{farthest_m}");
    for (others, said) in [
        ("(x_m: 1.1, y_m: 1.0)", "starts in another"),
        ("(x_m: 9.0, y_m: 1.0)", "inside of the field"),
        ("(x_m: 2.0, y_m: 1.0), (x_m: 2.0, y_m: 1.1)", "others[1]"),
    ] {
        let error = crowd(others).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("robot.ron:1:"),
            "{error}"
        );
    }
}

#[test]
fn a_thousand_runs_take_seconds() {
    let experiment = two_wheel();
    let begun = std::time::Instant::now();
    for repeat in 0..100 {
        let _motion = motion(&Noise::default().perturb(&experiment, 1, repeat));
    }
    // A release build needs 2 CPU s per thousand runs; test builds are slower, and machines may be busy.
    assert!(begun.elapsed().as_secs_f64() < 2.0, "{:?}", begun.elapsed());
}
