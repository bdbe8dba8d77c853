//! Torques, currents and inertial sensors as scored channels: parameters whose truth is known, which angles alone do not determine.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use realgap_core::file::Source;
use realgap_lab::calibration::{Overrides, Report, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{
    CommandTrack, Experiment, Instrument, JointState, Quantity, Sampling, run,
};

/// A link that turns about a vertical axis, so that gravity says nothing about its mass.
const ROBOT: &str = r#"(name: "arm", bodies: [
        (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
        (name: "link", mass_kg: 0.5, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.01))],
    joints: [(name: "elbow", parent: "base", child: "link", kind: Turn(axis: (0, 0, 1), armature_kg_m2: 0.01))],
    actuators: [(joint: "elbow", servo: (law: Torque(stiffness_nm_rad: 8, damping_nm_s_rad: 0.4), max_torque_nm: 20, torque_constant_nm_a: 0.5, max_speed_rad_s: 40))],
    marks: [(name: "imu", body: "link", pose: (at_m: (0.3, 0, 0)))],
    mount: (at_m: (0, 0, 1)))"#;

const SENSORS: [&str; 4] = [
    "elbow_torque_nm",
    "elbow_current_a",
    "link_gyro_z_rad_s",
    "imu_accel_y_m_s2",
];
/// Gain, damping and rotor inertia that are to be found.
const TRUTH: [(&str, f64); 3] = [
    ("servo.elbow.stiffness_nm_rad", 10.0),
    ("servo.elbow.damping_nm_s_rad", 0.6),
    ("hinge.elbow.armature_kg_m2", 0.03),
];
const FREE: &str = r#"parameters: [
    (name: "servo.elbow.stiffness_nm_rad", from: 3, to: 30),
    (name: "servo.elbow.damping_nm_s_rad", from: 0.1, to: 3),
    (name: "hinge.elbow.armature_kg_m2", from: 0.001, to: 0.1)]"#;

fn times() -> Vec<f64> {
    (0..400).map(|k| f64::from(k) * 0.01).collect()
}

fn command(t: f64) -> f64 {
    0.4 * (1.7 * t).sin() + 0.2 * (9.3 * t).cos() + if t > 2.0 { 0.3 } else { 0.0 }
}

/// A fixed sequence of numbers with mean 0 and variance 1, another one for each column.
fn noise(column: usize) -> impl FnMut() -> f64 {
    let mut state = 17 + 1000 * column as u64;
    move || {
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Writes the robot and a log of it with these true values; the angle has noise of 1 mrad, a sensor of 2 % of its spread. The columns
/// of `factor` are multiplied.
fn recorded(folder: &Path, factor: &dyn Fn(&str) -> f64) {
    std::fs::write(folder.join("arm.ron"), ROBOT).unwrap();
    let robot = Morphology::parse(&Source::new("arm.ron", ROBOT)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    let values = times().into_iter().map(command).collect();
    let track = CommandTrack::new(times(), values, None).unwrap();
    let track = Arc::new(track.of(Quantity::Position));
    experiment.commands.insert("elbow".to_owned(), track);
    experiment.start_joints = vec![JointState {
        angle_rad: 0.1,
        speed_rad_s: 0.0,
    }];
    experiment.sampling = Sampling::Times(times().into());
    experiment.duration_s = 3.99;
    let of = |column: &&str| Instrument::of_column(column, &experiment.assembly).unwrap();
    experiment.instruments = SENSORS.iter().map(of).collect();
    let set = TRUTH.map(|(name, value)| Assignment::new(name, value).unwrap());
    let set = set.into_iter().chain([
        Assignment::new("timestep_s", 0.0025).unwrap(),
        Assignment::new("solver.engine", 1.0).unwrap(),
    ]);
    let set: ParameterSet = set.collect();
    let motion = run(&set.apply(&experiment))
        .unwrap()
        .outcome
        .completed()
        .unwrap();
    let joint = &motion.joints()[0];
    let speeds = joint.speeds_rad_s.clone().unwrap();
    let mut columns: Vec<(String, Vec<f64>, f64)> = vec![
        ("elbow_rad".to_owned(), joint.angles_rad.clone(), 1e-3),
        ("elbow_rad_s".to_owned(), speeds, 0.02),
    ];
    for signal in motion.signals() {
        let values = &signal.values;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        let spread = (square / values.len() as f64).sqrt();
        columns.push((signal.name.clone(), values.clone(), 0.02 * spread));
    }
    let mut draws: Vec<_> = (0..columns.len()).map(noise).collect();
    let mut text = "t_s,elbow_command_rad".to_owned();
    for (name, ..) in &columns {
        write!(text, ",{name}").unwrap();
    }
    for (k, t) in times().into_iter().enumerate() {
        write!(text, "\n{t},{}", command(t)).unwrap();
        for ((name, values, size), draw) in columns.iter().zip(&mut draws) {
            // The run starts from the first sample, which therefore has no noise.
            let noise = if k == 0 { 0.0 } else { size * draw() };
            write!(text, ",{}", factor(name) * (values[k] + noise)).unwrap();
        }
    }
    std::fs::write(folder.join("log.csv"), text + "\n").unwrap();
}

fn study(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("study.ron");
    let text = format!(
        r#"Study(morphology: "arm.ron", recordings: ["log.csv"], start: FromRecording, timestep_s: 0.0025, metric: "joints",
            score: Single, commands: Commands(), set: {{"solver.engine": 1}}, {more}, {FREE})"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn read(folder: &Path, more: &str) -> Result<Study, String> {
    Study::read(study(folder, more), &Overrides::default()).map_err(|error| error.to_string())
}

fn fitted(folder: &Path, more: &str) -> Report {
    let options = TuneOptions {
        optimizer: optimizer_by_name("gauss-newton").unwrap(),
        budget: 80,
        patience: None,
    };
    let study = read(folder, more).unwrap();
    study.tune(&options, &RunOptions::default()).unwrap().report
}

#[test]
fn a_torque_channel_determines_gain_and_inertia_that_angles_alone_do_not() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), &|_| 1.0);
    let told = |report: &Report| -> Vec<bool> {
        let all = &report.tuning.as_ref().unwrap().least_squares;
        all.iter().map(|estimate| estimate.is_told).collect()
    };
    let angles = fitted(folder.path(), r#"left_out: []"#);
    assert_eq!(told(&angles), [false; 3], "{:?}", angles.tuning);
    for sensor in ["*_torque_nm", "*_current_a"] {
        let channels = format!(r#"channels: [(columns: "*_rad"), (columns: "{sensor}")]"#);
        let both = fitted(folder.path(), &channels);
        assert_eq!(told(&both), [true; 3], "{:?}", both.tuning);
        let all = &both.tuning.as_ref().unwrap().least_squares;
        for (estimate, (name, truth)) in all.iter().zip(TRUTH) {
            assert!(
                (estimate.low..=estimate.high).contains(&truth),
                "{name} {truth}: {estimate:?}"
            );
            // The noise of 2 % is averaged over 400 samples.
            assert!(estimate.high - estimate.low < 0.1 * truth, "{estimate:?}");
        }
        // Both channels end at their noise: the mean of a normal number's size is 0.8 of its standard deviation.
        let score = both.best.unwrap().score;
        assert!((0.6..1.0).contains(&score), "{score}");
    }
}

#[test]
fn every_kind_of_channel_is_scored_at_its_noise_and_doubling_it_changes_the_score() {
    for column in ["elbow_rad", "elbow_rad_s"].into_iter().chain(SENSORS) {
        let one = format!(r#"channels: [(columns: "{column}")]"#);
        let folder = tempfile::tempdir().unwrap();
        let of = |factor: f64| {
            recorded(folder.path(), &|name| {
                if name == column { factor } else { 1.0 }
            });
            let study = read(folder.path(), &one).unwrap();
            let set = TRUTH.map(|(name, value)| Assignment::new(name, value).unwrap());
            let result = study.evaluate_joints(&set.into_iter().collect(), &RunOptions::default());
            let channels = result.unwrap().channels;
            assert_eq!(channels.len(), 1);
            channels[0].clone()
        };
        let (as_recorded, doubled) = (of(1.0), of(2.0));
        assert!(
            (0.6..1.1).contains(&as_recorded.in_noise),
            "{as_recorded:?}"
        );
        assert!(doubled.mean > 3.0 * as_recorded.mean, "{doubled:?}");
        // The noise was drawn independently.
        assert!(as_recorded.independent > 100.0, "{as_recorded:?}");
    }
}

#[test]
fn a_stated_noise_weighs_its_channel() {
    let folder = tempfile::tempdir().unwrap();
    // The torque sensor reads 20 % too much, so the two channels disagree about the inertia.
    recorded(folder.path(), &|name| {
        if name.ends_with("_torque_nm") {
            1.2
        } else {
            1.0
        }
    });
    let inertia = |angle: f64, torque: f64| {
        let channels = format!(
            r#"channels: [(columns: "*_rad", noise: {angle}), (columns: "*_torque_nm", noise: {torque})],
               set: {{"solver.engine": 1, "servo.elbow.stiffness_nm_rad": 10.0}}"#
        );
        let path = study(folder.path(), "left_out: []");
        let text = std::fs::read_to_string(&path).unwrap();
        let text = text.replace(r#"set: {"solver.engine": 1}, left_out: []"#, &channels);
        let free = r#"(name: "servo.elbow.stiffness_nm_rad", from: 3, to: 30),"#;
        std::fs::write(&path, text.replace(free, "")).unwrap();
        let options = TuneOptions {
            optimizer: optimizer_by_name("gauss-newton").unwrap(),
            budget: 60,
            patience: None,
        };
        let study = Study::read(path, &Overrides::default()).unwrap();
        let report = study.tune(&options, &RunOptions::default()).unwrap().report;
        report.tuning.unwrap().least_squares[1].value
    };
    let (by_angles, by_torques) = (inertia(1e-4, 1.0), inertia(1.0, 1e-3));
    assert!((by_angles - 0.03).abs() < 0.001, "{by_angles}");
    assert!(by_torques - by_angles > 0.002, "{by_torques} {by_angles}");
}

#[test]
fn a_study_without_channels_says_what_it_does_not_use_and_scores_as_before() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), &|_| 1.0);
    let study = read(folder.path(), "left_out: []").unwrap();
    let said: Vec<String> = study.warnings().iter().map(|w| w.message.clone()).collect();
    for column in SENSORS {
        assert!(
            said.iter()
                .any(|text| text.contains("not used") && text.contains(column)),
            "{said:?}"
        );
    }
    let unused = study.unused_columns().unwrap();
    let unused: Vec<&String> = unused.iter().flat_map(|unused| &unused.columns).collect();
    assert!(
        SENSORS.iter().all(|name| unused.iter().any(|u| u == name)),
        "{unused:?}"
    );
    let channels = r#"channels: [(columns: "*_rad"), (columns: "*_torque_nm")]"#;
    let scored = read(folder.path(), channels).unwrap();
    let unused = scored.unused_columns().unwrap();
    let mut unused = unused.iter().flat_map(|unused| &unused.columns);
    assert!(unused.all(|name| name != "elbow_torque_nm"));
}

#[test]
fn channels_that_cannot_be_scored_are_refused_with_what_can_be() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), &|_| 1.0);
    for (more, said) in [
        (
            r#"channels: [(columns: "wrist_torque_nm")]"#,
            "elbow_torque_nm",
        ),
        (
            r#"channels: [(columns: "*_torque_nm", noise: -1)]"#,
            "above 0 N m",
        ),
        (
            r#"reading: (names: {"elbow_torque_nm": "wrist_torque_nm"}), channels: [(columns: "wrist_torque_nm")]"#,
            "belongs to no joint with a motor",
        ),
        (
            r#"reading: (names: {"link_gyro_z_rad_s": "trunk_gyro_z_rad_s"}), channels: [(columns: "trunk_*")]"#,
            "imu, base, link",
        ),
    ] {
        let error = read(folder.path(), more).unwrap_err();
        assert!(error.contains(said), "{more}: {error}");
    }
    let path = study(folder.path(), r#"channels: [(columns: "*_rad")]"#);
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace(r#"metric: "joints","#, "")).unwrap();
    let error = Study::read(path, &Overrides::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("metric"), "{error}");
    // A sensor that stands still has no noise to measure.
    recorded(folder.path(), &|name| {
        if name.ends_with("_current_a") {
            0.0
        } else {
            1.0
        }
    });
    let error = read(folder.path(), r#"channels: [(columns: "*_current_a")]"#).unwrap_err();
    assert!(error.contains("state its `noise`"), "{error}");
    let stated = r#"channels: [(columns: "*_current_a", noise: 0.1)]"#;
    read(folder.path(), stated).unwrap();
}

#[test]
fn commands_without_a_unit_or_beyond_the_servo_all_the_time_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path(), &|_| 1.0);
    let renamed = |to: &str| {
        let more = format!(r#"reading: (names: {{"elbow_command_rad": "{to}"}})"#);
        read(folder.path(), &more)
    };
    for (to, said) in [
        ("elbow_command", "states no unit"),
        ("elbow_command_torque", "states no unit"),
        (
            "wrist_command_a",
            "columns without a joint: wrist_command_a",
        ),
    ] {
        let error = renamed(to).unwrap_err();
        assert!(error.contains(said), "{to}: {error}");
    }
    for to in [
        "elbow_command_nm",
        "elbow_command_a",
        "elbow_command_duty",
        "elbow_command_rad_s",
    ] {
        renamed(to).unwrap();
    }
    // The same commands for a servo that has a hundredth of their torque.
    let weak = ROBOT.replace("max_torque_nm: 20", "max_torque_nm: 0.004");
    std::fs::write(folder.path().join("arm.ron"), weak).unwrap();
    let error = renamed("elbow_command_nm").unwrap_err();
    assert!(error.contains("beyond the limit"), "{error}");
    let plain = ROBOT.replace(", torque_constant_nm_a: 0.5, max_speed_rad_s: 40", "");
    std::fs::write(folder.path().join("arm.ron"), plain).unwrap();
    for (to, said) in [
        ("elbow_command_a", "torque_constant_nm_a"),
        ("elbow_command_duty", "max_speed_rad_s"),
    ] {
        let error = renamed(to).unwrap_err();
        assert!(error.contains(said), "{to}: {error}");
    }
}
