//! Recordings of joints with their commands.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;
use std::sync::Arc;

use crate::change::{Change as _, film};
use crate::common;
use realgap::calibration::{Definition, Overrides, Study};
use realgap::optimization::RunOptions;
use realgap::robot::morphology::Morphology;
use realgap::simulation::parameter::ParameterSet;
use realgap::simulation::{CommandTrack, Experiment, Sampling};

/// Commands and angles of a run of the shipped pendulum at a gain, as a recording of joints alone.
fn recorded(folder: &Path, gain: f64, name: &str) {
    let path = common::project().join("morphologies/servo_pendulum.ron");
    let robot = Morphology::read(path).unwrap().assemble();
    let times: Vec<f64> = (0..=600).map(|k| f64::from(k) * 0.005).collect();
    let commands: Vec<f64> = times.iter().map(|t| (1.5 * t).sin()).collect();
    let track = CommandTrack::new(times.clone(), commands.clone(), Some(2.0)).unwrap();
    let experiment = Experiment::new(robot)
        .with(|e| {
            e.commands.insert("angle".to_owned(), Arc::new(track));
            e.sampling = Sampling::Times(times.clone().into());
            e.solver.timestep_s = 0.002;
        })
        .set("servo.position_gain", gain)
        .from(0.0, 0.0)
        .lasting(3.0);
    let (_, joint) = film(&experiment);
    let mut text = "t_s,command_rad,angle_rad\n".to_owned();
    for ((time, command), angle) in times.iter().zip(&commands).zip(&joint.angles_rad) {
        text.push_str(&format!("{time},{command},{angle}\n"));
    }
    std::fs::write(folder.join(name), text).unwrap();
}

fn angle_mrad(study: &Path) -> f64 {
    let definition = Definition::read(study, &Overrides::default()).unwrap();
    let study = Study::new(definition).unwrap();
    let result = study.evaluate_joints(&ParameterSet::new(), &RunOptions::default());
    result.unwrap().angle_mrad.mean
}

#[test]
fn a_recording_of_joints_brings_its_commands_its_gain_and_when_torque_was_off() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), 200.0, "kp200_drop.csv");
    let project = common::project().display();
    let study = |off: &str| {
        let path = folder.path().join("study.ron");
        let text = format!(
            r#"Study(morphology: "{project}/morphologies/servo_pendulum.ron", recordings: ["kp*.csv"], start: FromRecording,
                commands: Commands(columns: [(hinge: "angle", column: "command")], gain_after: "kp", off: [{off}]),
                timestep_s: 0.002, parameters: [(name: "servo.dry_nm", from: 0, to: 0.02, points: 3)],
                metric: "joints", score: Single)"#
        );
        std::fs::write(&path, text).unwrap();
        path
    };
    let off = r#"(recordings: "*drop*", from_s: 2.0)"#;
    let same = angle_mrad(&study(off));
    assert!(same < 0.1, "{same} mrad");
    let said = common::realgap()
        .args(["evaluate", "--format", "json"])
        .arg(study(off))
        .output()
        .unwrap();
    let said = common::schema::answer("evaluate-joints", &common::text(&said.stdout));
    assert_eq!(said["angle_mrad"]["mean"].as_f64(), Some(same));
    // With torque on all the time, the motion differs; it also differs with the gain of another file name.
    let held = angle_mrad(&study(""));
    assert!(held > 20.0, "{held} mrad");
    let renamed = folder.path().join("kp800_drop.csv");
    std::fs::rename(folder.path().join("kp200_drop.csv"), renamed).unwrap();
    let other = angle_mrad(&study(off));
    assert!(other > 20.0, "{other} mrad");
}

#[test]
fn identify_ranks_the_parameters_of_a_joint_log_and_names_what_determines_none() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), 200.0, "kp200.csv");
    let project = common::project().display();
    let path = folder.path().join("study.ron");
    // Friction in the gear acts on the angle; that of the floor, which nothing touches, does not.
    let text = format!(
        r#"Study(morphology: "{project}/morphologies/servo_pendulum.ron", recordings: ["kp*.csv"], start: FromRecording,
            commands: Commands(columns: [(hinge: "angle", column: "command")], gain_after: "kp", off: [(recordings: "*", from_s: 2.0)]),
            timestep_s: 0.002, parameters: [(name: "floor.friction", from: 0.2, to: 0.8),
                (name: "servo.dry_nm", from: 0.0, to: 0.1)],
            metric: "joints", score: Single)"#
    );
    std::fs::write(&path, text).unwrap();
    let identify = |format: &[&str]| {
        let said = common::realgap()
            .args(["study", "identify"])
            .arg(&path)
            .args(format)
            .output()
            .unwrap();
        assert!(said.status.success(), "{}", common::text(&said.stderr));
        common::text(&said.stdout)
    };
    let said = common::schema::answer("identify-logs", &identify(&["--format", "json"]));
    let ranked = said["parameters"].as_array().unwrap();
    let of = |index: usize, field: &str| ranked[index][field].clone();
    assert_eq!(of(0, "parameter"), "servo.dry_nm", "{said}");
    assert_eq!(of(0, "is_determined"), true, "{said}");
    assert_eq!(of(1, "parameter"), "floor.friction", "{said}");
    assert_eq!(of(1, "is_determined"), false, "{said}");
    let table = identify(&[]);
    let rows: Vec<&str> = table
        .lines()
        .filter(|line| line.contains("determined"))
        .collect();
    assert!(
        rows[0].starts_with("servo.dry_nm") && rows[1].contains("not determined"),
        "{table}"
    );
}
