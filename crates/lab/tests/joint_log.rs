//! Logs of joints: parameters of single joints are fitted to commands and encoder values whose true parameters are known.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use realgap_core::Code;
use realgap_core::file::Source;
use realgap_lab::calibration::{Overrides, Split, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{CommandTrack, Experiment, JointState, Quantity, Sampling, run};

/// An arm of two joints on a table. One joint is called `pitch`, which is also the name of a rotation of the whole body.
pub(crate) fn robot(law: &str) -> String {
    format!(
        r#"(name: "arm", bodies: [
            (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
            (name: "upper", mass_kg: 0.2, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 7e-4, zz: 7e-4)),
            (name: "lower", mass_kg: 0.1, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 4e-4, zz: 4e-4))],
        joints: [
            (name: "pitch", parent: "base", child: "upper", pose: (at_m: (0.1, 0, 0)), kind: Turn(axis: (0, 1, 0), viscous_nm_s_rad: 0.01)),
            (name: "elbow", parent: "upper", child: "lower", pose: (at_m: (0.2, 0, 0)), kind: Turn(axis: (0, 1, 0), viscous_nm_s_rad: 0.01))],
        actuators: [
            (joint: "pitch", servo: (law: {law}, max_torque_nm: 3)),
            (joint: "elbow", servo: (law: {law}, max_torque_nm: 3))],
        mount: (at_m: (0, 0, 1)))"#
    )
}

pub(crate) const SPRING: &str = "Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.4)";

fn times() -> Vec<f64> {
    (0..200).map(|k| f64::from(k) * 0.02).collect()
}

/// The commands of a joint: angles or torques, by quantity.
fn commands(quantity: Quantity, joint: usize) -> Vec<f64> {
    let size = if quantity == Quantity::Torque {
        0.5
    } else {
        0.4
    };
    let wave = |t: f64| (1.7 * t + joint as f64).sin() + 0.5 * (5.3 * t).cos();
    times().into_iter().map(|t| size * wave(t)).collect()
}

/// Writes the file of the robot and a log that is simulated with these true parameters.
pub(crate) fn recorded(
    folder: &Path,
    law: &str,
    quantity: Quantity,
    truth: &[(&str, f64)],
    header: &str,
) {
    record(
        folder,
        "log.csv",
        &robot(law),
        (quantity, [1.0; 2]),
        truth,
        header,
    );
}

/// Like [`recorded`], for any robot and file; `sizes` multiply the commands of each joint, and a joint of size 0 does not move.
pub(crate) fn record(
    folder: &Path,
    file: &str,
    robot: &str,
    (quantity, sizes): (Quantity, [f64; 2]),
    truth: &[(&str, f64)],
    header: &str,
) {
    std::fs::write(folder.join("arm.ron"), robot).unwrap();
    let assembly = Morphology::parse(&Source::new("arm.ron", robot)).unwrap();
    let commanded = |joint: usize| -> Vec<f64> {
        let commands = commands(quantity, joint).into_iter();
        commands.map(|command| sizes[joint] * command).collect()
    };
    let mut experiment = Experiment::new(assembly.assemble());
    let names: Vec<String> = experiment
        .assembly
        .hinges
        .iter()
        .map(|h| h.name.clone())
        .collect();
    for (joint, name) in names.iter().enumerate() {
        let track = CommandTrack::new(times(), commanded(joint), None).unwrap();
        experiment
            .commands
            .insert(name.clone(), Arc::new(track.of(quantity)));
    }
    let start = sizes.map(|size| JointState {
        angle_rad: 0.1 * size,
        speed_rad_s: 0.0,
    });
    experiment.start_joints = start.to_vec();
    experiment.sampling = Sampling::Times(times().into());
    experiment.duration_s = 3.98;
    experiment.solver.timestep_s = 0.005;
    let set: ParameterSet = truth
        .iter()
        .map(|(name, value)| Assignment::new(name, *value).unwrap())
        .collect();
    let motion = run(&set.apply(&experiment))
        .unwrap()
        .outcome
        .completed()
        .unwrap();
    let mut text = format!("{header},pitch_rad_s,elbow_rad_s\n");
    for (k, t) in times().iter().enumerate() {
        // Encoder noise of 1 mrad: a fixed sequence, the same in every run of the test, and zero at the start.
        let encoder_noise_rad = |joint: usize| 1e-3 * ((k * (7919 + joint * 104_729)) as f64).sin();
        text.push_str(&t.to_string());
        for joint in 0..2 {
            text.push_str(&format!(",{}", commanded(joint)[k]));
        }
        for joint in 0..2 {
            text.push_str(&format!(
                ",{}",
                motion.joints()[joint].angles_rad[k] + encoder_noise_rad(joint)
            ));
        }
        for joint in motion.joints() {
            text.push_str(&format!(",{}", joint.speeds_rad_s.as_ref().unwrap()[k]));
        }
        text.push('\n');
    }
    let motion = motion.joints();
    assert_eq!([&motion[0].name, &motion[1].name], [&names[0], &names[1]]);
    std::fs::write(folder.join(file), text).unwrap();
}

/// A folder with the file of a robot and a log of it, whose commands are angles of these sizes.
pub(crate) fn logged(robot: &str, sizes: [f64; 2]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let motion = (Quantity::Position, sizes);
    record(folder.path(), "log.csv", robot, motion, &[], POSITIONS);
    folder
}

pub(crate) fn study(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("study.ron");
    let text = format!(
        r#"Study(morphology: "arm.ron", recordings: ["log.csv"], start: FromRecording, timestep_s: 0.005,
            metric: "joints", score: Single, {more})"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

pub(crate) const POSITIONS: &str = "t_s,pitch_command_rad,elbow_command_rad,pitch_rad,elbow_rad";
const FREE: &str = r#"parameters: [
    (name: "servo.pitch.stiffness_nm_rad", from: 4, to: 16),
    (name: "servo.elbow.stiffness_nm_rad", from: 4, to: 16),
    (name: "servo.*.damping_nm_s_rad", from: 0.1, to: 1),
    (name: "joint.pitch.zero_rad", from: -0.1, to: 0.1),
    (name: "joint.elbow.delay_s", from: 0, to: 0.1, prior: (0.05, 0.02)),
    (name: "body.lower.mass_scale", from: 0.5, to: 2),
]"#;

#[test]
fn least_squares_find_the_true_parameters_of_a_log_in_few_runs() {
    let truth = [
        ("servo.pitch.stiffness_nm_rad", 9.0),
        ("servo.elbow.stiffness_nm_rad", 6.0),
        ("servo.*.damping_nm_s_rad", 0.5),
        ("joint.pitch.zero_rad", 0.03),
        ("joint.elbow.delay_s", 0.04),
        ("body.lower.mass_scale", 1.3),
    ];
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), SPRING, Quantity::Position, &truth, POSITIONS);
    let path = study(folder.path(), &format!("commands: Commands(), {FREE}"));
    let study = Study::read(path, &Overrides::default()).unwrap();
    let options = TuneOptions {
        optimizer: optimizer_by_name("gauss-newton").unwrap(),
        budget: 150,
        patience: None,
    };
    let one = RunOptions {
        jobs: 1,
        ..RunOptions::default()
    };
    let answer = study.tune(&options, &one).unwrap();
    let tuning = answer.report.tuning.clone().unwrap();
    for (known, (_, value)) in tuning.least_squares.iter().zip(truth) {
        // Such a short log contains less information about delay and mass.
        let may_be_vague = known.parameter.contains("mass") || known.parameter.contains("latency");
        assert!(known.is_told || may_be_vague, "{known:?}");
        let wide = known.high - known.low;
        let off = (known.value - value).abs();
        assert!(off < 1.5 * wide, "{known:?}: {value}");
    }
    assert!(answer.report.best.unwrap().score < 1.2e-3);
    let two = RunOptions {
        jobs: 2,
        ..RunOptions::default()
    };
    let again = study.tune(&options, &two).unwrap();
    assert_eq!(
        again.report.tuning.unwrap().least_squares,
        tuning.least_squares
    );
}

#[test]
fn recorded_torques_are_applied_to_the_joints() {
    let folder = tempfile::tempdir().unwrap();
    let truth = [
        ("hinge.pitch.viscous_nm_s_rad", 0.2),
        ("hinge.elbow.viscous_nm_s_rad", 0.1),
    ];
    let header = "t_s,pitch_command_nm,elbow_command_nm,pitch_rad,elbow_rad";
    recorded(folder.path(), "Direct", Quantity::Torque, &truth, header);
    let path = study(
        folder.path(),
        r#"commands: Commands(), parameters: [(name: "hinge.viscous_nm_s_rad", from: 0, to: 1)],
           set: {"hinge.pitch.viscous_nm_s_rad": 0.2, "hinge.elbow.viscous_nm_s_rad": 0.1}"#,
    );
    let study = Study::read(path, &Overrides::default()).unwrap();
    let one = study.evaluate_joints(&ParameterSet::new(), &RunOptions::default());
    let mrad = one.unwrap().angle_mrad.mean;
    // The encoder noise is 1 mrad. An error this small shows that the values fixed for single joints are used.
    assert!(mrad < 2.0, "{mrad}");
}

#[test]
fn joints_and_columns_that_do_not_match_are_refused_and_the_error_lists_both() {
    let folder = tempfile::tempdir().unwrap();
    let header = POSITIONS.replace(",elbow_rad", ",jaw_rad");
    recorded(folder.path(), SPRING, Quantity::Position, &[], &header);
    let read = |more: &str| {
        let path = study(folder.path(), &format!("{more}, {FREE}"));
        Study::read(path, &Overrides::default()).map_err(|error| error.to_string())
    };
    let error = read("commands: Commands()").unwrap_err();
    assert!(
        error.contains("joints without a column: elbow; columns without a joint: jaw"),
        "{error}"
    );
    let vain = |study: Study| {
        let mut all = study.warnings().iter();
        all.find(|w| w.code == Code::NoEffect)
            .map(|w| w.message.clone())
    };
    let all_used = read(r#"commands: Commands(), left_out: ["elbow", "jaw"]"#).unwrap();
    assert_eq!(vain(all_used), None);
    // A misspelt name, and a joint that has its column.
    let odd = read(r#"commands: Commands(), left_out: ["elbow", "j*", "jow", "pitch"]"#).unwrap();
    let said = vain(odd).unwrap();
    assert!(
        said.starts_with("`left_out` names \"jow\", \"pitch\""),
        "{said}"
    );
    read(r#"commands: Commands(), reading: (names: {"jaw_rad": "elbow_rad"})"#).unwrap();
    let error = read(r#"reading: (names: {"jaw_rad": "elbow_rad"})"#).unwrap_err();
    assert!(error.contains("add `commands: Commands()`"), "{error}");
}

#[test]
fn a_motion_that_does_not_move_a_joint_has_no_information_about_its_parameters() {
    // Two arms that do not influence each other: they stand side by side on one base and turn about vertical axes.
    let robot = robot(SPRING)
        .replace(r#"parent: "upper""#, r#"parent: "base""#)
        .replace("axis: (0, 1, 0)", "axis: (0, 0, 1)");
    let truth = [
        ("servo.pitch.stiffness_nm_rad", 9.0),
        ("servo.elbow.stiffness_nm_rad", 6.0),
        ("servo.pitch.damping_nm_s_rad", 0.5),
        ("servo.elbow.damping_nm_s_rad", 0.5),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (file, sizes) in [
        ("both.csv", [2.0, 2.0]),
        ("pitch.csv", [1.0, 0.0]),
        ("elbow.csv", [0.0, 1.0]),
        ("neither.csv", [0.0, 0.0]),
    ] {
        let commands = (Quantity::Position, sizes);
        record(folder.path(), file, &robot, commands, &truth, POSITIONS);
    }
    let path = study(
        folder.path(),
        r#"commands: Commands(), parameters: [
            (name: "servo.pitch.stiffness_nm_rad", from: 4, to: 16),
            (name: "servo.elbow.stiffness_nm_rad", from: 4, to: 16),
            (name: "servo.pitch.damping_nm_s_rad", from: 0.1, to: 1),
            (name: "servo.elbow.damping_nm_s_rad", from: 0.1, to: 1),
        ]"#,
    );
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("log.csv", "*.csv")).unwrap();
    let options = TuneOptions {
        optimizer: optimizer_by_name("gauss-newton").unwrap(),
        budget: 60,
        patience: None,
    };
    for split in [None, Some(Split::HoldOut(0.25))] {
        let overrides = Overrides {
            split,
            ..Overrides::default()
        };
        let study = Study::read(&path, &overrides).unwrap();
        let answer = study.tune(&options, &RunOptions::default()).unwrap();
        let report = answer.to_string();
        let motions = answer.report.tuning.unwrap().motions;
        let kept = motions.iter().filter(|motion| !motion.is_fitted);
        assert_eq!(kept.count(), usize::from(split.is_some()), "{motions:?}");
        assert_eq!(motions[3].recording, "neither", "{motions:?}");
        for motion in &motions {
            let moves = |joint: &str| ["both", joint].contains(&motion.recording.as_str());
            for (name, bits) in &motion.parameters {
                let joint = if name.contains("pitch") {
                    "pitch"
                } else {
                    "elbow"
                };
                let is_correct = if moves(joint) {
                    *bits > 0.1
                } else {
                    bits.abs() < 1e-9
                };
                assert!(is_correct, "{} of {name}: {bits}", motion.recording);
            }
        }
        let bits = |name: &str| motions.iter().find(|m| m.recording == name).unwrap().bits;
        assert!(bits("neither").abs() < 1e-9, "{motions:?}");
        if split.is_none() {
            // In this motion both joints move twice as far as in the others.
            assert!(bits("both") > bits("pitch") + bits("elbow"), "{motions:?}");
            assert!(report.contains("the others do not:\n    both "), "{report}");
        }
    }
}
