//! Logs of joints and poses as strangers keep them: text of `topic echo`, a row for each joint, names in cells, JSON around the samples.
//!
//! The layouts are those of files in public repositories (read 2026-11-29), each with a few rows of its own.

use realgap_path::trajectory::{InferredReading, Reading, Recording, read};

use super::{put, said};

/// Odometry as `ros2 topic echo /odom > odom.csv` writes it, with a last message that Ctrl-C has cut.
fn echoed(count: usize) -> String {
    let zeros = "  - 0.0\n".repeat(36);
    let messages = (0..count).map(|k| {
        format!(
            "header:\n  stamp:\n    sec: {}\n    nanosec: {}\n  frame_id: odom\nchild_frame_id: base_footprint\npose:\n  pose:\n    position:\n      x: {}\n      y: 1.1020885021439766\n      z: 0.0\n    orientation:\n      x: 0.0\n      y: 0.0\n      z: 0.6\n      w: 0.8\n  covariance:\n{zeros}twist:\n  twist:\n    linear:\n      x: 0.1\n      y: 0.0\n      z: 0.0\n    angular:\n      x: 0.0\n      y: 0.0\n      z: 0.0\n  covariance:\n{zeros}---\n",
            399 + k / 50,
            k % 50 * 20_000_000,
            1.5 + 0.25 * k as f64,
        )
    });
    messages.collect::<String>() + "header:\n  stamp:\n    sec: 4"
}

fn recording(name: &str, text: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    read(put(folder.path(), name, text), Reading::default()).unwrap()
}

/// As `recording`, with the settings that the file shows.
fn inferred(name: &str, text: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), name, text);
    let guess = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    read(&path, guess.reading).unwrap()
}

fn error(name: &str, text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), name, text);
    read(path, Reading::default()).unwrap_err().to_string()
}

fn angles(recording: &Recording, joint: &str) -> Vec<f64> {
    let track = recording.trajectory.joint(joint);
    let names: Vec<_> = (recording.trajectory.joints().iter())
        .map(|joint| &joint.name)
        .collect();
    track
        .unwrap_or_else(|| panic!("no {joint} among {names:?}"))
        .angles_rad
        .clone()
}

#[test]
fn echoed_odometry_is_read_with_its_stamps_whatever_the_file_is_called() {
    for name in ["odom.csv", "odom.txt", "odom.yaml"] {
        let odom = recording(name, &echoed(60));
        let motion = &odom.trajectory;
        assert_eq!(motion.len(), 60, "{name}");
        assert_eq!(motion.times_s()[..2], [399.0, 399.02], "{name}");
        assert_eq!(motion.positions_world_m()[4].x, 2.5, "{name}");
        let turn = motion.orientations_world_from_body().unwrap()[0];
        assert!((turn.w - 0.8).abs() < 1e-12 && (turn.k - 0.6).abs() < 1e-12);
        let said = said(&odom);
        assert!(
            said.contains("topic echo") && said.contains("behind the last"),
            "{said}"
        );
    }
}

#[test]
fn echoed_joints_have_their_names_in_both_styles_of_ros() {
    let ros_2 = |k: usize| {
        format!(
            "header:\n  stamp:\n    sec: 1700000000\n    nanosec: {}\n  frame_id: ''\nname:\n- pan\n- lift\nposition:\n- {}\n- -0.5\nvelocity: []\neffort: []\n---\n",
            k * 20_000_000,
            0.125 * k as f64
        )
    };
    let ros_1 = |k: usize| {
        format!(
            "header: \n  seq: {k}\n  stamp: \n    secs: 1700000000\n    nsecs: {}\n  frame_id: ''\nname: ['pan', 'lift']\nposition: [{}, -0.5]\nvelocity: []\neffort: []\n---\n",
            k * 20_000_000,
            0.125 * k as f64
        )
    };
    let all = [&ros_2 as &dyn Fn(usize) -> String, &ros_1];
    for message in all {
        let text: String = (0..5).map(message).collect();
        let joints = recording("joints.txt", &text);
        assert_eq!(angles(&joints, "pan"), [0.0, 0.125, 0.25, 0.375, 0.5]);
        assert_eq!(angles(&joints, "lift"), [-0.5; 5]);
    }
    let shortened = ros_2(0) + &ros_2(1).replace("- -0.5\n", "");
    let error = error("joints.csv", &shortened);
    assert!(
        error.contains("position") && error.contains("record a bag"),
        "{error}"
    );
}

#[test]
fn echoed_messages_without_times_and_broken_ones_are_refused_with_a_remedy() {
    let bare = "position:\n  x: 1.0\n  y: 2.0\n---\nposition:\n  x: 2.0\n  y: 2.0\n---\n";
    let untimed = error("pose.yaml", bare);
    assert!(untimed.contains("ros2 bag record"), "{untimed}");
    let moved = "header:\n  stamp:\n    sec: 1\n      nanosec: 2\n---\n";
    let moved = error("pose.yaml", moved);
    assert!(moved.contains("pose.yaml:4"), "{moved}");
}

#[test]
fn a_row_for_each_joint_becomes_a_column_for_each_joint() {
    let mut text = "time,name,position,velocity,effort\n".to_owned();
    for k in 0..6 {
        let time_s = 0.05 * f64::from(k);
        text += &format!(
            "{time_s:.6},brazo1_link_joint,{:.6},-0.099999,-1.205768\n",
            -0.53 - 0.005 * f64::from(k)
        );
        text += &format!("{time_s:.6},pinza_d_link_joint,0.000025,0.000000,0.038266\n");
    }
    let joints = inferred("joint_states.csv", &text);
    assert_eq!(
        angles(&joints, "brazo1_link_joint"),
        [-0.53, -0.535, -0.54, -0.545, -0.55, -0.555]
    );
    assert_eq!(angles(&joints, "pinza_d_link_joint"), [0.000_025; 6]);
    assert_eq!(joints.trajectory.times_s()[2], 0.1);
    assert!(
        said(&joints).contains("a row for each of 2 joints"),
        "{}",
        said(&joints)
    );
    // A joint that is missing at one time is a lost number, not the one before.
    let lost = text.replace(
        "0.100000,pinza_d_link_joint,0.000025,0.000000,0.038266\n",
        "",
    );
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "joint_states.csv", &lost);
    let error = InferredReading::of_file(&path, &Reading::default()).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("pinza_d_link_joint_rad") && error.contains("missing"),
        "{error}"
    );
}

#[test]
fn names_in_the_cells_of_rostopic_name_the_joints() {
    let mut text = "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.name0,field.name1,field.position0,field.position1,field.velocity0,field.velocity1\n".to_owned();
    for k in 0..5_u64 {
        let stamp = 1_483_699_372_187_413_129 + 20_000_000 * k;
        text += &format!(
            "{},{k},{stamp},,mico_joint_2,mico_joint_1,{},0.5,0.1,0.2\n",
            stamp + 7,
            0.25 * k as f64
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "joints.csv", &text);
    let guess = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    let joints = read(&path, guess.reading).unwrap();
    assert_eq!(angles(&joints, "mico_joint_2"), [0.0, 0.25, 0.5, 0.75, 1.0]);
    assert_eq!(angles(&joints, "mico_joint_1"), [0.5; 5]);
    let exchanged = text.replacen(
        ",mico_joint_2,mico_joint_1,0.5",
        ",mico_joint_1,mico_joint_2,0.5",
        1,
    );
    let error = error("joints.csv", &exchanged);
    assert!(error.contains("change their order"), "{error}");
}

#[test]
fn samples_inside_of_a_json_object_are_found() {
    let entries: Vec<String> = (0..5)
        .map(|k| {
            format!(
                "{{\"x_m\": {}, \"y_m\": 0.0, \"t_s\": {}, \"torque_enable\": true}}",
                0.5 * f64::from(k),
                0.02 * f64::from(k)
            )
        })
        .collect();
    let text = format!(
        "{{\"mass\": 1.13, \"motor\": \"sts3250\", \"entries\": [{}]}}",
        entries.join(", ")
    );
    let run = recording("run.json", &text);
    assert_eq!(run.trajectory.positions_world_m()[4].x, 2.0);
    assert!(said(&run).contains("the list `entries`"), "{}", said(&run));
}

#[test]
fn names_that_are_an_outline_belong_to_the_part_before_them() {
    let mut text = "rosbagTimestamp,header,seq,stamp,secs,nsecs,frame_id,child_frame_id,pose,pose,position,x,y,z,orientation,x,y,z,w\n".to_owned();
    for k in 0..60_u64 {
        let (stamp, secs, nsecs) = (50_000_000 * k, k / 20, k % 20 * 50_000_000);
        text += &format!(
            "{},,{k},,{},{nsecs},odom,base,,,,{},0.5,0.0,,0.0,0.0,0.6,0.8\n",
            1_569_846_001_000_000_000 + stamp,
            1_569_846_001 + secs,
            0.25 * k as f64
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "odom.csv", &text);
    let guess = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    let odom = read(&path, guess.reading).unwrap().trajectory;
    assert_eq!(odom.positions_world_m()[8].x, 2.0);
    assert_eq!(odom.positions_world_m()[8].y, 0.5);
    let turn = odom.orientations_world_from_body().unwrap()[3];
    assert!(
        (turn.w - 0.8).abs() < 1e-12 && (turn.k - 0.6).abs() < 1e-12,
        "{turn}"
    );
    assert!((odom.duration_s() - 2.95).abs() < 1e-6);
}

#[test]
fn a_path_that_ulog2csv_writes_is_turned_from_north_east_down_to_z_up() {
    let mut text =
        "timestamp,timestamp_sample,x,y,z,vx,z_deriv,heading,xy_valid,z_valid\n".to_owned();
    for k in 0..20 {
        text += &format!(
            "{},0,{},{},-10.0,0,0,0.5,1,1\n",
            56_000_000 + 100_000 * k,
            0.5 * f64::from(k),
            0.25 * f64::from(k)
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "log_vehicle_local_position_0.csv", &text);
    let guess = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    let flight = read(&path, guess.reading).unwrap();
    let place = flight.trajectory.positions_world_m()[4];
    assert_eq!([place.x, place.y, place.z], [2.0, -1.0, 10.0]);
    assert!((flight.trajectory.times_s()[4] - 56.4).abs() < 1e-9);
    assert!(
        said(&flight).contains("north, east, down"),
        "{}",
        said(&flight)
    );
}

#[test]
fn a_log_of_joints_without_units_is_read_with_the_robot() {
    let text = "timestamp,joint1,joint2\n1740416404.04,0.71,0.006\n1740416404.05,0.02,-0.002\n1740416404.06,0.02,-0.002\n";
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "joint_states.csv", text);
    let error = InferredReading::of_file(&path, &Reading::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("together with the robot"), "{error}");
}
