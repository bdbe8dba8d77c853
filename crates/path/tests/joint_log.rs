//! Joints, commands and sensors in logs that the package `rosbags` writes.

use std::path::Path;

use realgap_path::trajectory::{Reading, Recording, Trajectory, read};

use super::common::python_with;

const SCRIPT: &str = include_str!("../../../tests/recording/open_format/joint_log.py");

fn file(folder: &Path, name: &str, ending: &str) -> std::path::PathBuf {
    let name = format!("{name}_{ending}");
    folder.join(&name).join(format!("{name}.{ending}"))
}

fn signal(motion: &Trajectory, name: &str) -> Vec<f64> {
    let found = motion.signals().iter().find(|signal| signal.name == name);
    found
        .map(|signal| signal.values.clone())
        .unwrap_or_default()
}

/// The commanded angles of a joint.
fn command(motion: &Trajectory, joint: &str) -> Vec<f64> {
    let name = format!("{joint}_command");
    let found = motion.joints().iter().find(|joint| joint.name == name);
    found
        .map(|joint| joint.angles_rad.clone())
        .unwrap_or_default()
}

fn says(recording: &Recording, words: &str) -> bool {
    let mut all = recording.warnings.iter();
    all.any(|warning| warning.message.contains(words))
}

#[test]
fn joints_and_commands_of_ros_2_are_those_of_the_same_table_as_csv() {
    let Some(program) = python_with("rosbags") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut python = std::process::Command::new(program);
    let done = python
        .args(["-c", SCRIPT])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let own = read(folder.join("own.csv"), Reading::default()).unwrap();
    for ending in ["db3", "mcap"] {
        let of = |name: &str, reading: Reading| read(file(folder, name, ending), reading);
        let states = of("numbers", Reading::default()).unwrap();
        let measured = own
            .trajectory
            .joints()
            .iter()
            .filter(|joint| !joint.name.ends_with("_command"));
        let measured: Vec<_> = measured.cloned().collect();
        assert_eq!(states.trajectory.joints(), measured);
        assert!(states.trajectory.signals().is_empty());
        assert!(
            says(&states, "not read: /forward/commands"),
            "{:?}",
            states.warnings
        );

        let stated = Reading {
            command_topic: Some("/forward/commands".to_owned()),
            ..Reading::default()
        };
        let error = of("numbers", stated.clone()).unwrap_err().to_string();
        assert!(
            error.contains("2 numbers") && error.contains("lists: {\"/forward/commands\""),
            "{error}"
        );
        let names = ["pan_command_rad", "arm_lift_command_rad"].map(str::to_owned);
        let mut named = stated;
        (named.lists).insert("/forward/commands".to_owned(), names.to_vec());
        let found = of("numbers", named).unwrap();
        assert_eq!(found.trajectory, own.trajectory, "{ending}");
        assert!(says(&found, "moved by 3000.0 ms"), "{:?}", found.warnings);

        // A plan names its joints, so that nothing has to be stated; the sensor's values are between its samples.
        let found = of("plan", Reading::default()).unwrap();
        for joint in ["pan", "arm_lift"] {
            let ours = command(&found.trajectory, joint);
            assert!(!ours.is_empty() && ours == command(&own.trajectory, joint));
        }
        assert!(says(&found, "commands are those of /arm/joint_trajectory"));
        let turns = signal(&found.trajectory, "hand_gyro_x_rad_s");
        let first = found.trajectory.times_s()[0];
        for (turn, time_s) in turns.iter().zip(found.trajectory.times_s()) {
            assert!(
                (turn - 2.0 * (time_s - first)).abs() < 1e-6,
                "{turn} {time_s}"
            );
        }
        assert_eq!(signal(&found.trajectory, "hand_accel_z_m_s2")[7], 9.81);

        let found = of("order", Reading::default()).unwrap().trajectory;
        let by_name = |motion: &Trajectory, name: &str| {
            let joint = motion.joints().iter().find(|joint| joint.name == name);
            joint.cloned()
        };
        for name in ["pan", "arm_lift"] {
            assert_eq!(by_name(&found, name), by_name(&own.trajectory, name));
        }

        let error = of("two", Reading::default()).unwrap_err();
        assert_eq!(error.field_name(), Some("topic"), "{error}");
        assert!(
            error
                .to_string()
                .contains("/joint_commands (sensor_msgs/msg/JointState, 2 joints, 101 messages)"),
            "{error}"
        );
        let chosen = Reading {
            command_topic: Some("joint_commands".to_owned()),
            ..Reading::default()
        };
        let found = of("two", chosen).unwrap().trajectory;
        assert_eq!(command(&found, "pan"), found.joints()[0].angles_rad);
        let error = of("both", Reading::default()).unwrap_err();
        assert_eq!(error.field_name(), Some("command_topic"), "{error}");
        let nobody = Reading {
            command_topic: Some("/nobody".to_owned()),
            ..Reading::default()
        };
        let error = of("plan", nobody).unwrap_err().to_string();
        assert!(error.contains("/arm/joint_trajectory"), "{error}");
    }
}
