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
use realgap::simulation::{CommandTrack, Experiment, Instrument, Sampling, run};

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

#[test]
fn identify_ranks_by_every_channel_that_the_study_scores_and_torques_tell_inertia_that_angles_do_not()
 {
    // A link about a vertical axis: without its torque, stiffness, damping and inertia are known by their ratios alone.
    let robot = r#"(name: "arm", bodies: [
        (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
        (name: "link", mass_kg: 0.5, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.01))],
        joints: [(name: "elbow", parent: "base", child: "link", kind: Turn(axis: (0, 0, 1)))],
        actuators: [(joint: "elbow", servo: (law: Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.4), max_torque_nm: 20))],
        mount: (at_m: (0, 0, 1)))"#;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.ron"), robot).unwrap();
    let source = realgap::file::Source::new("arm.ron", robot);
    let assembly = Morphology::parse(&source).unwrap().assemble();
    let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.01).collect();
    let commands: Vec<f64> = times
        .iter()
        .map(|t| 0.4 * (1.7 * t).sin() + 0.2 * (9.3 * t).cos() - 0.2)
        .collect();
    let track = CommandTrack::new(times.clone(), commands.clone(), None).unwrap();
    let experiment = Experiment::new(assembly)
        .with(|e| {
            e.commands.insert("elbow".to_owned(), Arc::new(track));
            e.sampling = Sampling::Times(times.clone().into());
            e.solver.timestep_s = 0.0025;
            let torque = Instrument::of_column("elbow_torque_nm", &e.assembly).unwrap();
            e.instruments = vec![torque];
        })
        .set("solver.engine", 1.0)
        .from(0.0, 0.0)
        .lasting(4.0);
    let motion = run(&experiment).unwrap().outcome.completed().unwrap();
    let mut text = "t_s,elbow_command_rad,elbow_rad,elbow_torque_nm\n".to_owned();
    let angles = &motion.joint("elbow").unwrap().angles_rad;
    let torques = &motion.signal("elbow_torque_nm").unwrap().values;
    for (k, t) in times.iter().enumerate() {
        // Fixed sequences of noise: 2 mrad and 20 mN m.
        let noise = |step: usize| ((k * step) as f64).sin();
        text.push_str(&format!(
            "{t},{},{},{}\n",
            commands[k],
            angles[k] + 2e-3 * noise(7919),
            torques[k] + 0.02 * noise(104_729)
        ));
    }
    std::fs::write(folder.path().join("log.csv"), text).unwrap();
    let armature = |more: &str| {
        let path = folder.path().join("study.ron");
        let text = format!(
            r#"Study(morphology: "arm.ron", recordings: ["log.csv"], start: FromRecording, commands: Commands(), timestep_s: 0.0025,
                set: {{"solver.engine": 1}}, parameters: [
                    (name: "servo.elbow.stiffness_nm_rad", from: 2, to: 30),
                    (name: "servo.elbow.damping_nm_s_rad", from: 0.1, to: 3),
                    (name: "hinge.elbow.armature_kg_m2", from: 0.0, to: 0.05)],
                metric: "joints", score: Single, {more})"#
        );
        std::fs::write(&path, text).unwrap();
        let said = common::realgap()
            .args(["study", "identify", "--format", "json"])
            .arg(&path)
            .output()
            .unwrap();
        assert!(said.status.success(), "{}", common::text(&said.stderr));
        let said = common::schema::answer("identify-logs", &common::text(&said.stdout));
        let ranked = said["parameters"].as_array().unwrap().clone();
        let mut ranked = ranked.into_iter();
        ranked
            .find(|one| one["parameter"] == "hinge.elbow.armature_kg_m2")
            .unwrap()
    };
    let angles = armature("");
    assert_eq!(angles["is_determined"], false, "{angles}");
    let both = armature(r#"channels: [(columns: "*_rad"), (columns: "*_torque_nm")]"#);
    assert_eq!(both["is_determined"], true, "{both}");
    let width = |one: &serde_json::Value| one["half_width"].as_f64().unwrap();
    assert!(width(&both) < 0.5 * width(&angles), "{both} {angles}");
}
