//! Data as people have it, at the first attempt: three commands lead to a verdict, and no file is edited.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::start::start;
use crate::start_drive::CART;

use std::path::{Path, PathBuf};

use common::{realgap, text};

/// An arm of one joint on a foot.
pub const ARM: &str = r#"<robot name="arm">
  <link name="foot"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0 0 -0.15"/><mass value="0.4"/><inertia ixx="0.003" iyy="0.003" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="foot"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="8" velocity="6"/></joint>
</robot>"#;

fn put(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// Four seconds of the cart's odometry, in centimetres and degrees, with what `commands` says of each row; the wheels turn at these
/// speeds, first both alike.
fn odometry(folder: &Path, header: &str, commands: &dyn Fn([f64; 2]) -> String) -> PathBuf {
    let mut table = format!("time,odom_x_cm,odom_y_cm,odom_theta_deg{header}\n");
    let (mut x_m, mut y_m, mut heading_rad) = (0.0, 0.0, 0.0_f64);
    for k in 0..200 {
        let speeds_rad_s = if k < 60 { [3.0, 3.0] } else { [3.5, 2.0] };
        table += &format!(
            "{:.2},{},{},{}{}\n",
            0.02 * f64::from(k),
            1e2 * x_m,
            1e2 * y_m,
            heading_rad.to_degrees(),
            commands(speeds_rad_s)
        );
        let [left, right] = speeds_rad_s;
        let speed_m_s = 0.035 * 0.5 * (left + right);
        heading_rad += 0.02 * 0.035 * (right - left) / 0.2;
        x_m += 0.02 * speed_m_s * heading_rad.cos();
        y_m += 0.02 * speed_m_s * heading_rad.sin();
    }
    put(folder, "drive.csv", &table)
}

/// The verdict and the best score of a short sweep of a study, the second of the three commands, whose page the third one renews.
fn swept(study: &Path) -> (String, f64) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut sweep = realgap();
    sweep.arg("sweep").arg(study).arg("-o").arg(&out);
    sweep.args(["--points", "2", "--score", "single", "--no-audit"]);
    let said = sweep.output().unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
    let shown = text(&said.stdout);
    let first: Vec<&str> = shown.lines().take(3).collect();
    assert!(first[0].starts_with("gap: "), "{shown}");
    assert!(
        first.iter().any(|line| line.starts_with("trust: ")),
        "{shown}"
    );
    realgap().arg("report").arg(&out).assert().success();
    let summary: serde_json::Value =
        serde_json::from_str(&common::read(&out, "summary.json")).unwrap();
    let score = summary["best"]["score"].as_f64().unwrap();
    (first.join("\n"), score)
}

/// The text of a row's commands, from the speeds of both wheels.
type Commanded = dyn Fn([f64; 2]) -> String;

#[test]
fn a_robot_on_wheels_follows_commands_of_its_wheels_or_of_speed_and_turn_rate() {
    let folder = tempfile::tempdir().unwrap();
    let robot = put(folder.path(), "cart.urdf", CART);
    let wheels = |[left, right]: [f64; 2]| format!(",{left},{right}");
    let twist = |scale: f64| {
        move |[left, right]: [f64; 2]| {
            let (v, w) = (0.035 * 0.5 * (left + right), 0.035 * (right - left) / 0.2);
            format!(",{},{w}", scale * v)
        }
    };
    let cases: [(&str, &Commanded, &[&str]); 5] = [
        (",left_cmd,right_cmd", &wheels, &[]),
        (",left_cmd_rad_s,right_cmd_rad_s", &wheels, &[]),
        (",linear,angular", &twist(1.0), &["--track", "0.2"]),
        (",cmd_vel.linear.x,cmd_vel.angular.z", &twist(1.0), &[]),
        (",cmd_linear_cm_s,cmd_angular", &twist(100.0), &[]),
    ];
    for (header, commands, words) in cases {
        let log = odometry(folder.path(), header, commands);
        let study = folder.path().join("mine.ron");
        let mut words = words.to_vec();
        words.push("--force");
        let (code, said) = start(&words, &[log, robot.clone()], &study);
        assert_eq!(code, 0, "{header}: {said}");
        assert!(!said.contains("doubt"), "{header}: {said}");
        let (verdict, score) = swept(&study);
        assert!(score < 0.03, "{header}: {score} m: {verdict}\n{said}");
    }
}

#[test]
fn a_robot_on_wheels_without_commands_is_not_fitted_and_the_error_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let robot = put(folder.path(), "cart.urdf", CART);
    let log = odometry(folder.path(), "", &|_| String::new());
    let study = folder.path().join("mine.ron");
    let (code, said) = start(&[], &[log, robot], &study);
    assert_eq!(code, 2, "{said}");
    for words in [
        "nothing drives the robot",
        "left_command_rad_s",
        "linear and angular",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(!study.exists());
}

#[test]
fn an_arm_whose_columns_are_called_pos_and_cmd_is_fitted() {
    let folder = tempfile::tempdir().unwrap();
    let robot = put(folder.path(), "arm.urdf", ARM);
    // The joint follows its command as a spring with damping would, a little late.
    let (mut at, mut speed) = (0.0, 0.0);
    let mut table = "time,shoulder_pos,shoulder_cmd\n".to_owned();
    for k in 0..400 {
        let t = 0.02 * f64::from(k);
        let command = 0.6 * (1.3 * t).sin() + 0.3 * (3.1 * t).sin();
        table += &format!("{t:.3},{at:.5},{command:.5}\n");
        for _ in 0..20 {
            speed += 1e-3 * (150.0 * (command - at) - 20.0 * speed);
            at += 1e-3 * speed;
        }
    }
    let log = put(folder.path(), "log.csv", &table);
    let study = folder.path().join("mine.ron");
    let (code, said) = start(&[], &[log, robot], &study);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("commanded angles of joints: shoulder from `shoulder_cmd`"),
        "{said}"
    );
    let out = folder.path().join("out");
    let mut tune = realgap();
    tune.arg("tune").arg(&study).arg("-o").arg(&out);
    tune.args(["--optimizer", "gauss-newton", "--budget", "16"]);
    let said = tune.output().unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
    let shown = text(&said.stdout);
    assert!(
        shown.starts_with("gap: ") && shown.contains("mrad away"),
        "{shown}"
    );
    realgap().arg("report").arg(&out).assert().success();
}

#[test]
fn a_modular_robot_that_a_camera_tracked_in_pixels_is_compared_in_its_own_lengths() {
    let folder = tempfile::tempdir().unwrap();
    let robot = common::project().join("morphologies/two_module.ron");
    let run = folder.path().join("run.csv");
    let mut simulate = realgap();
    simulate
        .arg("simulate")
        .arg(&robot)
        .args(["--duration", "4s", "-o"]);
    simulate.arg(&run).assert().success();
    let table = std::fs::read_to_string(&run).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|one| *one == name).unwrap();
    let (t, x, y) = (at("t_s"), at("x_m"), at("y_m"));
    let pixel_m = 0.5 / 238.0;
    let rows = table.lines().skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [x_px, y_px] = [cells[x], cells[y]].map(|m| m / pixel_m + 300.0);
        format!("{},{x_px:.1},{y_px:.1}\n", cells[t])
    });
    let rows: String = rows.collect();
    let log = put(
        folder.path(),
        "tracked.csv",
        &format!("time_s,x_px,y_px\n{rows}"),
    );
    let study = folder.path().join("mine.ron");
    let (code, said) = start(&[], &[log.clone(), robot.clone()], &study);
    assert_ne!(code, 0, "{said}");
    assert!(said.contains("--scale"), "{said}");
    let (code, said) = start(&["--scale", "0.5/238"], &[log, robot], &study);
    assert_eq!(code, 0, "{said}");
    let (verdict, _) = swept(&study);
    assert!(!verdict.contains("px"), "{verdict}");
}

#[test]
fn a_car_is_studied_by_the_columns_that_drove_it_and_its_runs_have_a_trim_each() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study.ron");
    let data = common::project().join("real_trajectories/dart_car");
    let begin = || {
        let mut command = realgap();
        command.arg("start").arg(data.join("rubber_free_02.csv"));
        command.arg(data.join("rubber_ramps_06.csv"));
        command.arg(common::project().join("morphologies/dart_car.ron"));
        command.arg("-o").arg(&study);
        command
    };
    let refused = begin().output().unwrap();
    assert!(!refused.status.success());
    assert!(
        text(&refused.stderr).contains("nothing drives"),
        "{}",
        text(&refused.stderr)
    );
    let mut started = begin();
    started.args([
        "--command",
        "drive_*=throttle:enabled",
        "--command",
        "steer_*=steering",
    ]);
    let said = started.output().unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
    let shown = text(&said.stdout);
    assert!(
        shown.contains("optimizer gauss-newton") && !shown.contains("not used:"),
        "{shown}"
    );
    let written = std::fs::read_to_string(&study).unwrap();
    for part in [
        r#"(name: "tyre.f*.slip_stiffness_1_rad""#,
        r#"(name: "command.steer_*.offset", from: -0.1, to: 0.1, each: Run)"#,
        r#"windows: (from_m_s: 0.2, on: Some("enabled")"#,
    ] {
        assert!(written.contains(part), "{part} is not in {written}");
    }
    // The robot's own numbers, with nothing fitted, already say how far a prediction reaches, and twice the throttle says less.
    let errors = |more: &[&str]| -> Vec<f64> {
        let mut evaluate = realgap();
        evaluate
            .arg("evaluate")
            .arg(&study)
            .args(["--format", "json"])
            .args(more);
        let found = evaluate.output().unwrap();
        assert!(found.status.success(), "{}", text(&found.stderr));
        let found: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
        let runs = found["over_horizon"].as_array().unwrap();
        let names: Vec<&str> = runs
            .iter()
            .map(|run| run["recording"].as_str().unwrap())
            .collect();
        assert_eq!(names, ["rubber_free_02", "rubber_ramps_06", "all"]);
        let all = runs[2]["median_m"].as_array().unwrap();
        all.iter().map(|error| error.as_f64().unwrap()).collect()
    };
    let own = errors(&["--set", "floor.friction=0.85"]);
    assert!(own.is_sorted() && own[11] < 0.6, "{own:?}");
    let without_grip = errors(&["--set", "floor.friction=0.3"]);
    assert!(without_grip[11] > 2.0 * own[11], "{own:?} {without_grip:?}");
    let wrong = begin()
        .args(["--command", "wheel_*=throttle"])
        .output()
        .unwrap();
    let said = text(&wrong.stderr);
    assert!(
        !wrong.status.success() && said.contains("drive_front_left"),
        "{said}"
    );
}
