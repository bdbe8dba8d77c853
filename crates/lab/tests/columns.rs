//! Every column that the reader accepts is used, or the study says that it is not: doubling its values changes the runs or the
//! scores, or the column is named as unused, or the study is refused.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use realgap_lab::calibration::{Overrides, Study};

/// A cart on two driven wheels and a ball, or an arm that is held.
fn robot(kind: &str, law: &str) -> String {
    let actuators = format!(
        "actuators: [(joint: \"left\", servo: (law: {law}, max_torque_nm: 2)), (joint: \"right\", servo: (law: {law}, max_torque_nm: 2))]"
    );
    let turn = "kind: Turn(axis: (0, 1, 0), viscous_nm_s_rad: 0.01)";
    match kind {
        "cart" => format!(
            r#"(name: "cart", bodies: [
                (name: "base", mass_kg: 0.8, shapes: [(form: Box(sides_m: (0.14, 0.14, 0.06)), pose: (at_m: (0, 0, 0.05)))]),
                (name: "caster", mass_kg: 0.01, shapes: [(form: Sphere(radius_m: 0.01))]),
                (name: "a", mass_kg: 0.05, shapes: [(form: Sphere(radius_m: 0.03))]),
                (name: "b", mass_kg: 0.05, shapes: [(form: Sphere(radius_m: 0.03))])],
            joints: [
                (name: "left", parent: "base", child: "a", pose: (at_m: (0.02, 0.11, 0.02)), {turn}),
                (name: "right", parent: "base", child: "b", pose: (at_m: (0.02, -0.11, 0.02)), {turn}),
                (name: "caster_fixed", parent: "base", child: "caster", pose: (at_m: (-0.06, 0, 0)), kind: Fixed)],
            {actuators}, track: "base")"#
        ),
        _ => format!(
            r#"(name: "arm", bodies: [
                (name: "base", mass_kg: 1.0, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
                (name: "a", mass_kg: 0.2, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 7e-4, zz: 7e-4)),
                (name: "b", mass_kg: 0.1, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 1e-4, yy: 4e-4, zz: 4e-4))],
            joints: [
                (name: "left", parent: "base", child: "a", pose: (at_m: (0.1, 0, 0)), {turn}),
                (name: "right", parent: "a", child: "b", pose: (at_m: (0.2, 0, 0)), {turn})],
            {actuators}, mount: (at_m: (0, 0, 1)))"#
        ),
    }
}

/// The names of columns; `POSES` are those of a robot that moves as a whole.
const POSES: [&str; 21] = [
    "x_m",
    "y_m",
    "z_m",
    "qw",
    "qx",
    "qy",
    "qz",
    "vx_m_s",
    "vy_m_s",
    "vz_m_s",
    "wx_rad_s",
    "wy_rad_s",
    "wz_rad_s",
    "box_x_m",
    "box_y_m",
    "box_z_m",
    "box_qw",
    "box_qx",
    "box_qy",
    "box_qz",
    "battery_v",
];
const JOINTS: [&str; 6] = [
    "left_rad",
    "left_rad_s",
    "right_rad",
    "right_rad_s",
    "left_on",
    "battery_v",
];

/// The value of a column at a time.
fn value(column: &str, t: f64) -> f64 {
    match column {
        "x_m" => 0.1 * t + 0.01 * (3.0 * t).sin(),
        "y_m" => 0.02 * t * t,
        "z_m" => 0.03 + 0.002 * (5.0 * t).sin(),
        "qw" | "box_qw" => (0.15 * t).cos(),
        "qz" | "box_qz" => (0.15 * t).sin(),
        "qx" | "qy" | "box_qx" | "box_qy" => 0.0,
        "vx_m_s" => 0.1,
        "vy_m_s" => 0.04 * t + 0.01,
        "vz_m_s" => 0.01,
        "wx_rad_s" | "wy_rad_s" => 0.02,
        "wz_rad_s" => 0.3,
        "box_x_m" => 2.0 + 0.05 * t,
        "box_y_m" | "box_z_m" => 0.5,
        "left_on" | "right_on" => 1.0,
        "battery_v" => 12.0 - 0.1 * t,
        name if name.ends_with("_nm") => 0.3 * (2.0 * t).cos(),
        name if name.starts_with("left") => 0.4 * (1.7 * t + 0.3).sin(),
        _ => 0.3 * (2.3 * t + 0.9).sin(),
    }
}

fn record(folder: &Path, columns: &[String], doubled: Option<&str>) {
    let mut text = format!("t_s,{}\n", columns.join(","));
    for k in 0..30 {
        let t = 0.02 * f64::from(k);
        let cell = |column: &String| {
            let value = value(column, t);
            match doubled {
                Some(name) if name == column && name.ends_with("_on") => 0.0,
                // A turn stays one of length 1: its angle is doubled in all of its columns.
                Some(name) if name.ends_with("qw") && column.ends_with(&name[..name.len() - 1]) => {
                    value
                }
                Some(name)
                    if is_turn(name)
                        && is_turn(column)
                        && name.starts_with("box") == column.starts_with("box") =>
                {
                    match &column[column.len() - 1..] {
                        "w" => (0.3 * t + 0.1).cos(),
                        "z" => (0.3 * t + 0.1).sin(),
                        _ => 0.0,
                    }
                }
                Some(name) if name == column => 2.0 * value,
                _ => value,
            }
        };
        let cells: Vec<String> = columns
            .iter()
            .map(|column| cell(column).to_string())
            .collect();
        text += &format!("{t},{}\n", cells.join(","));
    }
    std::fs::write(folder.join("run.csv"), text).unwrap();
}

fn is_turn(column: &str) -> bool {
    ["qw", "qx", "qy", "qz"].iter().any(|q| column.ends_with(q))
}

/// The scores of a study's first point, and everything that it says about its columns; `None` where it is refused.
fn run(folder: &Path, text: &str) -> Option<(String, String)> {
    std::fs::write(folder.join("study.ron"), text).unwrap();
    let study = Study::read(folder.join("study.ron"), &Overrides::default()).ok()?;
    let trial = study.simulate(1).unwrap();
    let mut said: Vec<String> = study.warnings().iter().map(|w| w.message.clone()).collect();
    for unused in study.unused_columns().unwrap() {
        assert!(!unused.because.is_empty() && !unused.remedy.is_empty());
        said.extend(
            unused
                .columns
                .iter()
                .map(|column| format!("not used: {column}")),
        );
    }
    Some((format!("{:?}", trial.cases), said.join("\n")))
}

/// Tries every column of one kind of study; returns the number of columns that were used, named as unused, and refused.
fn try_columns(robot_kind: &str, law: &str, columns: &[String], fields: &str) -> [usize; 3] {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.ron"), robot(robot_kind, law)).unwrap();
    let text = format!(
        "Study(morphology: \"robot.ron\", recordings: [\"*.csv\"], {fields}
            parameters: [(name: \"gravity_m_s2\", from: 9.7, to: 9.81, points: 2)], score: Single)"
    );
    record(folder.path(), columns, None);
    let Some((scores, said)) = run(folder.path(), &text) else {
        return [0, 0, columns.len()];
    };
    let mut counts = [0; 3];
    for column in columns {
        record(folder.path(), columns, Some(column));
        match run(folder.path(), &text) {
            None => counts[2] += 1,
            Some((changed, _)) if changed != scores => counts[0] += 1,
            Some(_) => {
                let is_named = said.lines().any(|line| {
                    (line.contains("not used") || line.contains("does not have"))
                        && (line.contains(column.as_str())
                            || line.contains(column.trim_end_matches("_rad")))
                });
                assert!(
                    is_named,
                    "{robot_kind} {law} {fields}: doubling {column} changes nothing, and nothing says so:\n{said}"
                );
                counts[1] += 1;
            }
        }
    }
    counts
}

const LAWS: [&str; 3] = [
    "Velocity(gain_1_s: 20)",
    "Torque(stiffness_nm_rad: 4, damping_nm_s_rad: 0.2)",
    "Direct",
];
const COMMANDS: [&str; 3] = ["_command_rad", "_command_rad_s", "_command_nm"];

#[test]
fn every_column_changes_the_run_or_is_said_to_be_unused() {
    let mut all = [0; 3];
    for law in LAWS {
        for command in COMMANDS {
            let commands = ["left", "right"].map(|joint| format!("{joint}{command}"));
            let joints = JOINTS
                .iter()
                .map(|name| (*name).to_owned())
                .chain(commands.clone());
            let joints: Vec<String> = joints.collect();
            let poses: Vec<String> = POSES
                .iter()
                .map(|name| (*name).to_owned())
                .chain(joints.clone())
                .collect();
            let poses: Vec<String> = poses
                .into_iter()
                .filter(|name| name != "battery_v")
                .collect();
            for (kind, columns, fields) in [
                ("cart", &poses, "start: Settled, metric: \"rms\","),
                (
                    "cart",
                    &poses,
                    "start: Settled, commands: Commands(), metric: \"rms\",",
                ),
                (
                    "cart",
                    &poses,
                    "start: Settled, commands: Commands(), metric: \"pose\",",
                ),
                (
                    "cart",
                    &poses,
                    "start: FromRecording, left_out: [\"*_command*\", \"*_on\"], metric: \"rms\",",
                ),
                (
                    "cart",
                    &poses,
                    "start: FromRecording, commands: Commands(), metric: \"rms\",",
                ),
                (
                    "cart",
                    &poses,
                    "start: FromRecording, start_state: HalfSampleCorrected, commands: Commands(), metric: \"pose\",",
                ),
                (
                    "cart",
                    &poses,
                    "start: FromRecording, commands: Commands(), horizon: (0.2, 0.2), metric: \"pose\",",
                ),
                (
                    "arm",
                    &joints,
                    "start: FromRecording, commands: Commands(), metric: \"joints\",",
                ),
                (
                    "arm",
                    &joints,
                    "start: FromRecording, left_out: [\"*_command*\", \"*_on\"], metric: \"joints\",",
                ),
                (
                    "arm",
                    &joints,
                    "start: FromRecording, commands: Commands(), horizon: (0.2, 0.2), metric: \"joints\",",
                ),
            ] {
                let counts = try_columns(kind, law, columns, fields);
                for (sum, count) in all.iter_mut().zip(counts) {
                    *sum += count;
                }
            }
        }
    }
    let [used, named, refused] = all;
    println!("{used} used, {named} named as unused, {refused} refused");
    assert!(used > 500 && named > 100, "{all:?}");
}
