//! KITTI and EuRoC, and TUM as evo writes it.

use nalgebra::{UnitQuaternion, Vector3};
use realgap::trajectory::{Axes, Reading, read, write};
use realgap::warning::Code;

use super::common::{python_with, realgap, text};
use super::{codes, put, python};

const FORWARD: &str = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 -0.5 0 0 1 2\n";

#[test]
fn a_kitti_file_needs_a_rate_and_says_which_axes_it_is_taken_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "poses.txt", FORWARD);
    let error = read(&path, Reading::default()).unwrap_err();
    assert_eq!(error.field_name(), Some("rate_hz"));
    let error = error.to_string();
    assert!(error.contains("KITTI files hold no times"), "{error}");
    assert!(error.contains("`rate_hz: 10` in `reading`"), "{error}");

    let at = |axes| Reading {
        rate_hz: Some(10.0),
        axes,
        ..Reading::default()
    };
    let as_it_stands = read(&path, at(None)).unwrap();
    assert_eq!(codes(&as_it_stands), [Code::UnknownAxes, Code::ReadAs]);
    assert_eq!(as_it_stands.trajectory.times_s(), [0.0, 0.1]);

    // Two metres along the camera's view, half a metre up.
    let camera = read(&path, at(Some(Axes::Camera))).unwrap();
    assert_eq!(codes(&camera), [Code::ReadAs]);
    let end = camera.trajectory.positions_world_m()[1];
    assert!((end - Vector3::new(2.0, 0.0, 0.5)).norm() < 1e-15, "{end}");
    let turns = camera.trajectory.orientations_world_from_body().unwrap();
    assert!(turns[1].angle() < 1e-12);
}

#[test]
fn a_camera_that_turns_left_is_a_body_that_turns_left() {
    let folder = tempfile::tempdir().unwrap();
    // About the camera's y axis, which points down: a turn to the left is negative.
    let left = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.3).to_rotation_matrix();
    let row = |i: usize| format!("{} {} {} 0", left[(i, 0)], left[(i, 1)], left[(i, 2)]);
    let rows = format!(
        "1 0 0 0 0 1 0 0 0 0 1 0\n{} {} {}\n",
        row(0),
        row(1),
        row(2)
    );
    let path = put(folder.path(), "turn.kitti", &rows);
    let reading = Reading::parse(&realgap::file::Source::new(
        "reading.ron",
        "(rate_hz: 1, axes: \"camera\")",
    ));
    let turned = read(&path, reading.unwrap()).unwrap().trajectory;
    let wanted = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
    let found = turned.orientations_world_from_body().unwrap()[1];
    assert!(found.angle_to(&wanted) < 1e-12, "{found}");
    assert!((turned.turned_rad().unwrap() - 0.3).abs() < 1e-12);
}

#[test]
fn what_is_no_kitti_file_is_named_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let reading = Reading {
        rate_hz: Some(10.0),
        ..Reading::default()
    };
    for (content, place, said) in [
        ("", (1, 1), "too few points"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n", (1, 1), "too few points"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0\n", (2, 7), "12 columns"),
        (
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 nan 0 1 0 0 0 0 1 0\n",
            (2, 7),
            "not a finite number",
        ),
        (
            "1 0 0 0 0 1 0 0 0 0 1 0\n2 0 0 0 0 1 0 0 0 0 1 0\n",
            (2, 1),
            "not a rotation",
        ),
        // Mirrored.
        ("-1 0 0 0 0 1 0 0 0 0 1 0\n", (1, 1), "not a rotation"),
        ("1e200 0 0 0 0 1 0 0 0 0 1 0\n", (1, 1), "not a rotation"),
    ] {
        let path = put(folder.path(), "poses.kitti", content);
        let error = read(&path, reading.clone()).unwrap_err();
        assert_eq!(error.line_column(), Some(place), "{error}");
        assert!(error.to_string().contains(said), "{error}");
    }
    let path = put(folder.path(), "poses.kitti", FORWARD);
    let mut never = reading;
    never.rate_hz = Some(0.0);
    let error = read(&path, never).unwrap_err().to_string();
    assert!(error.contains("rate_hz"), "{error}");
}

#[test]
fn the_command_says_by_which_option_the_rate_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "poses.txt", FORWARD);
    let refused = realgap().arg("check").arg(&path).assert().failure();
    let said = text(&refused.get_output().stderr);
    assert!(said.contains("--rate-hz 10"), "{said}");
    let options = ["--rate-hz", "10", "--axes", "camera"];
    let fine = realgap().arg("check").arg(&path).args(options).assert();
    let fine = text(&fine.success().get_output().stderr);
    assert!(!fine.contains("unknown-axes"), "{fine}");
}

/// As the data sets' own files begin, positions and times invented.
const EUROC: &str = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]
1403636580838555648,4.0,-1.5,0.75,0.6,0,0.8,0,0,0,0,0,0,0,0,0,0
1403636580843555648,4.25,-1.5,0.75,0.6,0,0.8,0,0,0,0,0,0,0,0,0,0
";

#[test]
fn a_csv_file_with_the_header_of_euroc_needs_no_mapping() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "data.csv", EUROC);
    let recording = read(&path, Reading::default()).unwrap();
    assert_eq!(codes(&recording), [Code::ColumnsIgnored]);
    let motion = &recording.trajectory;
    assert!((motion.duration_s() - 0.005).abs() < 1e-6);
    assert_eq!(motion.positions_world_m()[1].x, 4.25);
    let turn = motion.orientations_world_from_body().unwrap()[0];
    assert_eq!((turn.w, turn.j), (0.6, 0.8));

    // Without orientations, as its laser trackers write; in microseconds, if somebody says so.
    let laser = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]\n0,1,2,3\n2000,1,2,4\n";
    let path = put(folder.path(), "leica.csv", laser);
    let laser = read(&path, Reading::default()).unwrap().trajectory;
    assert!(laser.orientations_world_from_body().is_none());
    assert_eq!(laser.times_s(), [0.0, 2e-6]);
    let reading = "(time: \"us\")";
    let reading = Reading::parse(&realgap::file::Source::new("reading.ron", reading)).unwrap();
    let slow = read(&path, reading).unwrap().trajectory;
    assert!((slow.duration_s() - 0.002).abs() < 1e-12);
}

#[test]
fn what_is_wrong_with_a_euroc_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (broken, place, said) in [
        (EUROC.replace("4.25", "there"), (3, 21), "not a number"),
        (EUROC.replace("q_RS_x []", "q_RS []"), (1, 1), "qx"),
        (
            EUROC.replace("1403636580843555648", "1403636580833555648"),
            (3, 1),
            "time does not increase",
        ),
    ] {
        let path = put(folder.path(), "data.csv", &broken);
        let error = read(&path, Reading::default()).unwrap_err();
        assert_eq!(error.line_column(), Some(place), "{error}");
        assert!(error.to_string().contains(said), "{error}");
    }
}

/// A path on a climbing curve with orientations, as Python makes it.
const PATH: &str = "
import numpy as np
from evo.core.trajectory import PoseTrajectory3D
from evo.tools import file_interface
n = 40
t = 1700000000.25 + 0.1 * np.arange(n)
s = np.arange(n) / n
xyz = np.stack([s, s ** 2, 0.1 * s], axis=1)
yaw, roll = 2.5 * s, 0.3 * s
wxyz = np.stack([np.cos(yaw / 2) * np.cos(roll / 2), np.cos(yaw / 2) * np.sin(roll / 2),
                 np.sin(yaw / 2) * np.sin(roll / 2), np.sin(yaw / 2) * np.cos(roll / 2)], axis=1)
path = PoseTrajectory3D(xyz, wxyz, t)
";

#[test]
fn evo_and_this_program_read_each_others_files() {
    let Some(program) = python_with("evo") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write_all = "
file_interface.write_tum_trajectory_file('evo.tum', path)
file_interface.write_kitti_poses_file('evo.txt', path)
";
    python(&program, folder, &format!("{PATH}{write_all}"));
    let kitti = Reading {
        rate_hz: Some(10.0),
        axes: Some(Axes::World),
        ..Reading::default()
    };
    let tum = read(folder.join("evo.tum"), Reading::default()).unwrap();
    let matrices = read(folder.join("evo.txt"), kitti).unwrap().trajectory;
    let poses = tum.trajectory;
    assert_eq!(poses.len(), 40);
    assert!((poses.duration_s() - matrices.duration_s()).abs() < 1e-6);
    let both = |i: usize| {
        let place = poses.positions_world_m()[i] - matrices.positions_world_m()[i];
        let [a, b] = [&poses, &matrices].map(|t| t.orientations_world_from_body().unwrap()[i]);
        (place.norm(), a.angle_to(&b))
    };
    for (place_m, turn_rad) in (0..40).map(both) {
        assert!(place_m < 1e-9 && turn_rad < 1e-7, "{place_m} {turn_rad}");
    }

    write(folder.join("own.kitti"), &poses).unwrap();
    write(folder.join("own.euroc"), &poses).unwrap();
    let compare = "
kitti = file_interface.read_kitti_poses_file('own.kitti')
euroc = file_interface.read_euroc_csv_trajectory('own.euroc')
assert np.abs(kitti.positions_xyz - xyz).max() < 1e-9
assert np.abs(euroc.positions_xyz - xyz).max() < 1e-9
assert np.abs(euroc.timestamps - t).max() < 1e-6
for found in (kitti, euroc):
    same = np.abs(np.sum(found.orientations_quat_wxyz * wxyz, axis=1))
    assert same.min() > 1 - 1e-9, same.min()
";
    python(&program, folder, &format!("{PATH}{compare}"));
}
