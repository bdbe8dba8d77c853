//! What drives a recorded robot: recorded commands act, a gait is named, and nothing is fitted that stands still.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::start::start;

use std::path::{Path, PathBuf};

use common::{realgap, text};

/// A cart on two wheels whose file states no motors.
pub(crate) const CART: &str = r#"<robot name="cart">
  <link name="base"><inertial><mass value="1.2"/><inertia ixx="0.005" iyy="0.006" izz="0.008" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.02"/><geometry><box size="0.2 0.14 0.04"/></geometry></collision></link>
  <link name="lw"><inertial><mass value="0.05"/><inertia ixx="2e-5" iyy="3e-5" izz="2e-5" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.035"/></geometry></collision></link>
  <link name="rw"><inertial><mass value="0.05"/><inertia ixx="2e-5" iyy="3e-5" izz="2e-5" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.035"/></geometry></collision></link>
  <link name="ball"><inertial><mass value="0.02"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.015"/></geometry></collision></link>
  <joint name="left" type="continuous"><parent link="base"/><child link="lw"/><origin xyz="0.03 0.1 0"/><axis xyz="0 1 0"/></joint>
  <joint name="right" type="continuous"><parent link="base"/><child link="rw"/><origin xyz="0.03 -0.1 0"/><axis xyz="0 1 0"/></joint>
  <joint name="b" type="fixed"><parent link="base"/><child link="ball"/><origin xyz="-0.08 0 -0.02"/></joint>
</robot>"#;

/// A pendulum of 0.4 m and 0.5 kg whose file states neither a motor nor a place in the world.
const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"><inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="bob"><inertial><origin xyz="0 0 -0.4"/><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hub" type="continuous"><parent link="base"/><child link="bob"/><axis xyz="0 1 0"/></joint>
</robot>"#;

/// Three seconds of a cart at these speeds of its wheels, with columns of commands named so; without a name no commands.
fn drive(
    folder: &Path,
    name: &str,
    speeds_rad_s: [f64; 2],
    command: Option<&str>,
    factor: f64,
) -> PathBuf {
    let [left, right] = speeds_rad_s;
    let header = command.map_or_else(String::new, |c| format!(",left_{c},right_{c}"));
    let mut table = format!("t_s,x_m,y_m{header}\n");
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for k in 0..150 {
        let t = 0.02 * f64::from(k);
        let of = |speed: f64| match command {
            Some("command_rad") => factor * speed * t,
            _ => factor * speed,
        };
        table += &format!("{t},{x},{y}");
        if command.is_some() {
            table += &format!(",{},{}", of(left), of(right));
        }
        table += "\n";
        let speed_m_s = 0.035 * 0.5 * (left + right);
        heading += 0.02 * 0.035 * (right - left) / 0.2;
        x += 0.02 * speed_m_s * heading.cos();
        y += 0.02 * speed_m_s * heading.sin();
    }
    let path = folder.join(format!("{name}.csv"));
    std::fs::write(&path, table).unwrap();
    path
}

/// The score of the study's first grid point.
fn score(study: &Path) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "--points",
        "2",
        "--score",
        "single",
        "--no-audit",
        "--format",
        "json",
        "-o",
    ];
    let said = realgap()
        .arg("sweep")
        .arg(study)
        .args(words)
        .arg(folder.path().join("out"))
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
    let json: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
    json["best"]["score"]
        .as_f64()
        .unwrap_or_else(|| panic!("{json}"))
}

#[test]
fn wheels_whose_file_states_no_motor_do_what_was_commanded() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("cart.urdf");
    std::fs::write(&robot, CART).unwrap();
    for command in ["command_rad", "command_rad_s"] {
        let study = folder.path().join(format!("{command}.ron"));
        let log = drive(folder.path(), "log", [3.0, 2.0], Some(command), 1.0);
        let (code, said) = start(&[], &[log, robot.clone()], &study);
        assert_eq!(code, 0, "{said}");
        assert!(
            said.contains("control laws of servos are assumed") && !said.contains("doubt"),
            "{said}"
        );
        let as_recorded = score(&study);
        assert!(as_recorded < 0.02, "{command}: {as_recorded} m");
        drive(folder.path(), "log", [3.0, 2.0], Some(command), 2.0);
        let doubled = score(&study);
        assert!(
            doubled > 5.0 * as_recorded,
            "{command}: {as_recorded} and {doubled} m"
        );
    }
}

#[test]
fn motion_that_nothing_drives_is_refused_and_the_error_names_the_columns_that_lack() {
    let folder = tempfile::tempdir().unwrap();
    let cart = folder.path().join("cart.urdf");
    std::fs::write(&cart, CART).unwrap();
    let turtle = common::project().join("morphologies/turtlebot3_burger.ron");
    let study = folder.path().join("study.ron");
    let log = drive(folder.path(), "log", [3.0, 2.0], None, 1.0);
    for robot in [&cart, &turtle] {
        let (code, said) = start(&[], &[log.clone(), robot.clone()], &study);
        assert_eq!(code, 2, "{said}");
        assert!(
            said.contains("nothing drives the robot") && said.contains("left_command_rad_s"),
            "{said}"
        );
        assert!(!study.exists());
    }
    let (code, said) = start(&["--own-gait"], &[log, turtle], &study);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("by the gait in its own file: left 12 rad at 0.05 Hz"),
        "{said}"
    );
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(
        written.contains("\"gait.amplitude_scale\": 1.0"),
        "{written}"
    );
}

#[test]
fn recordings_of_which_some_hold_no_commands_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let robot = common::project().join("morphologies/turtlebot3_burger.ron");
    let with = drive(folder.path(), "with", [3.0, 2.0], Some("command_rad"), 1.0);
    let without = drive(folder.path(), "without", [3.0, 2.0], None, 1.0);
    let (code, said) = start(
        &[],
        &[with, without, robot],
        &folder.path().join("study.ron"),
    );
    assert_eq!(code, 2, "{said}");
    assert!(
        said.contains("1 of 2 without commands") && said.contains("without.csv"),
        "{said}"
    );
}

#[test]
fn a_robot_that_stands_still_is_doubted_before_anything_else_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let robot = common::project().join("morphologies/turtlebot3_burger.ron");
    let log = drive(folder.path(), "log", [3.0, 2.0], Some("command_rad"), 0.0);
    let (code, said) = start(&[], &[log, robot], &folder.path().join("study.ron"));
    assert_eq!(code, 0, "{said}");
    assert!(
        said.starts_with("doubt: the simulated robot moves"),
        "{said}"
    );
    assert!(
        said.contains("commands of left, right change nothing"),
        "{said}"
    );
    assert!(said.contains("answers nothing before"), "{said}");
}

/// Twelve seconds of a pendulum with dry friction of `dry_nm` under a commanded torque, by small steps.
fn swing(folder: &Path, dry_nm: f64) -> PathBuf {
    let (inertia, weight_nm) = (0.5 * 0.16 + 0.001, 0.5 * 9.81 * 0.4);
    let torque = |t: f64| 0.9 * (4.6 * t).sin() + 0.5 * (1.3 * t).cos();
    let mut table = "t_s,hub_rad,hub_rad_s,hub_command_nm\n".to_owned();
    let (mut angle, mut speed) = (0.4_f64, 0.0_f64);
    for k in 0..1200 {
        let t = 0.01 * f64::from(k);
        table += &format!("{t},{angle},{speed},{}\n", torque(t));
        for _ in 0..100 {
            let free = torque(t) - weight_nm * angle.sin();
            let next = speed + 1e-4 * free / inertia;
            let brake = 1e-4 * dry_nm / inertia;
            speed = if next.abs() <= brake {
                0.0
            } else {
                next - brake * next.signum()
            };
            angle += 1e-4 * speed;
        }
    }
    let path = folder.join("swing.csv");
    std::fs::write(&path, table).unwrap();
    path
}

#[test]
fn torques_of_a_file_without_motors_act_and_the_true_friction_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("pendulum.urdf");
    std::fs::write(&robot, PENDULUM).unwrap();
    let study = folder.path().join("study.ron");
    let log = swing(folder.path(), 0.2);
    let (code, said) = start(&[], &[log, robot], &study);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("hub: each exerts the commanded torque") && !said.contains("doubt"),
        "{said}"
    );
    let words = [
        "--optimizer",
        "gauss-newton",
        "--budget",
        "40",
        "--format",
        "json",
        "-o",
    ];
    let out = realgap()
        .arg("tune")
        .arg(&study)
        .args(words)
        .arg(folder.path().join("out"))
        .output()
        .unwrap();
    let json: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let verdicts = json["verdicts"]
        .as_array()
        .unwrap_or_else(|| panic!("{json}"));
    let dry = verdicts
        .iter()
        .find(|v| v["parameter"] == "hinge.hub.dry_nm")
        .unwrap();
    let best = dry["best"].as_f64().unwrap_or_else(|| panic!("{dry}"));
    assert!(
        (best - 0.2).abs() < 0.01 && dry["identified"] == true,
        "{dry}"
    );
    // The pendulum goes over the top, so whole runs would not be predicted.
    assert!(said.contains("small errors grow by a factor of"), "{said}");
}

#[test]
fn what_a_study_does_not_use_is_named_with_its_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let own = common::project().join("real_trajectories/tripod_mujoco/run_00.csv");
    let robot = common::project().join("morphologies/tripod.ron");
    let study = folder.path().join("study.ron");
    let (code, said) = start(&[], &[own, robot], &study);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("not used: z_m, qw, qx, qy, qz") && said.contains("metric: \"pose\""),
        "{said}"
    );
    assert!(
        said.contains("by the gait in its own file: leg_a"),
        "{said}"
    );
}

/// A leg of two joints with torque motors, as MuJoCo describes it.
const LEG: &str = r#"<mujoco model="leg"><worldbody><body name="hip" pos="0 0 1"><freejoint/>
  <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
  <body name="thigh"><inertial pos="0 0 -0.1" mass="1" diaginertia="0.006 0.006 0.001"/>
    <joint name="thigh" axis="0 1 0" armature="0.02" damping="0.3" frictionloss="0.2"/>
    <body name="calf" pos="0 0 -0.2"><inertial pos="0 0 -0.1" mass="0.3" diaginertia="0.002 0.002 0.0003"/>
      <joint name="calf" axis="0 1 0" armature="0.02" damping="0.3" frictionloss="0.2"/></body></body></body></worldbody>
  <actuator><motor joint="thigh" ctrlrange="-30 30"/><motor joint="calf" ctrlrange="-30 30"/></actuator></mujoco>"#;

/// Angles of the leg's joints that follow commands late and not quite, as if by a position loop.
fn chirp(folder: &Path) -> PathBuf {
    let mut table = "t_s,thigh_rad,calf_rad,thigh_command_rad,calf_command_rad\n".to_owned();
    let command = |t: f64, joint: f64| 0.3 * ((2.0 + 0.5 * joint + 0.6 * t) * t).sin();
    for k in 0..600 {
        let t = 0.005 * f64::from(k);
        let late = (t - 0.03).max(0.0);
        let [thigh, calf] = [0.0, 1.0].map(|joint| 0.9 * command(late, joint));
        table += &format!(
            "{t},{thigh},{calf},{},{}\n",
            command(t, 0.0),
            command(t, 1.0)
        );
    }
    let path = folder.join("chirp.csv");
    std::fs::write(&path, table).unwrap();
    path
}

#[test]
fn commanded_angles_of_torque_motors_need_the_gains_of_the_firmware() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("leg.xml");
    std::fs::write(&robot, LEG).unwrap();
    let study = folder.path().join("study.ron");
    let files = [chirp(folder.path()), robot];
    let (code, said) = start(&[], &files, &study);
    assert_eq!(code, 2, "{said}");
    assert!(
        said.contains("2 motors without gains: thigh, calf") && said.contains("--pd 20,1.5"),
        "{said}"
    );
    for (wrong, says) in [
        ("20", "KP,KD"),
        ("-1,2", "KP,KD"),
        ("knee=20,1", "no joint of the robot has these gains"),
    ] {
        let (code, said) = start(&["--pd", wrong], &files, &study);
        assert!(code == 2 && said.contains(says), "{wrong}: {code} {said}");
    }
    let (code, said) = start(&["--pd", "20,1", "--pd", "calf=12,0.7"], &files, &study);
    assert_eq!(code, 0, "{said}");
    assert!(
        said.contains("gains are known") && !said.contains("doubt"),
        "{said}"
    );
    let robot = std::fs::read_to_string(folder.path().join("study_robot.ron")).unwrap();
    for law in [
        "stiffness_nm_rad: 20.0, damping_nm_s_rad: 1.0",
        "stiffness_nm_rad: 12.0, damping_nm_s_rad: 0.7",
    ] {
        assert!(robot.contains(law), "{robot}");
    }
    let written = std::fs::read_to_string(&study).unwrap();
    for name in [
        "hinge.thigh.armature_kg_m2",
        "hinge.calf.viscous_nm_s_rad",
        "hinge.calf.dry_nm",
        "joint.thigh.zero_rad",
        "servo.latency_s",
    ] {
        assert!(written.contains(name), "{name}: {written}");
    }
    assert!(
        !written.contains("servo.thigh.stiffness_nm_rad"),
        "{written}"
    );
    // The robot's own values are the weak prior of each parameter.
    assert!(
        written.contains("armature_kg_m2\", from: 0.0, to: 0.4, prior: (0.02, 0.2)"),
        "{written}"
    );
}

#[test]
fn logs_of_other_programs_give_the_answer_of_a_log_in_own_names() {
    let folder = tempfile::tempdir().unwrap();
    let own = common::project().join("real_trajectories/so101_arm/random_waypoints.csv");
    let robot = common::project().join("morphologies/so101_feetech.ron");
    let table = std::fs::read_to_string(&own).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let score_of = |name: &str, text: &str, words: &[&str]| {
        let file = folder.path().join(format!("{name}.csv"));
        std::fs::write(&file, text).unwrap();
        let study = folder.path().join(format!("{name}.ron"));
        let (code, said) = start(words, &[file, robot.clone()], &study);
        assert_eq!(code, 0, "{name}: {said}");
        let out = realgap()
            .arg("evaluate")
            .arg(&study)
            .args(["--format", "json"])
            .output()
            .unwrap();
        let json: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        json["angle_mrad"]["mean"]
            .as_f64()
            .unwrap_or_else(|| panic!("{json}"))
    };
    let expected = score_of("own", &table, &[]);
    let renamed = |rename: &dyn Fn(&str) -> String| {
        let names: Vec<String> = header.iter().map(|name| rename(name)).collect();
        table.replacen(&header.join(","), &names.join(","), 1)
    };
    let joint = |name: &str| {
        name.trim_end_matches("_rad")
            .trim_end_matches("_command")
            .to_owned()
    };
    let is_command = |name: &str| name.contains("_command");
    let dotted = renamed(&|name| match name {
        "t_s" => "time".to_owned(),
        name if is_command(name) => format!("action.{}.pos", joint(name)),
        name => format!("observation.state.{}.pos", joint(name)),
    });
    assert_eq!(score_of("dotted", &dotted, &[]), expected);
    let target = renamed(&|name| match name {
        "t_s" => "t".to_owned(),
        name if is_command(name) => format!("target_{}", joint(name)),
        name => format!("actual_{}", joint(name)),
    });
    assert_eq!(score_of("target", &target, &[]), expected);
    let joints: Vec<String> = header[1..]
        .iter()
        .filter(|name| !is_command(name))
        .map(|name| joint(name))
        .collect();
    let numbered = renamed(&|name| match name {
        "t_s" => "time".to_owned(),
        name => {
            let number = 1 + joints.iter().position(|one| *one == joint(name)).unwrap();
            format!("{}{number}", if is_command(name) { "q_des" } else { "q" })
        }
    });
    assert_eq!(
        score_of("numbered", &numbered, &["--joints", &joints.join(",")]),
        expected
    );
}
