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
            // The last row is later than the last message of the sensor, and is left out.
            assert_eq!(ours.len(), 100);
            assert_eq!(ours, command(&own.trajectory, joint)[..100]);
            assert!(
                says(&found, "1 row left out (of 101)"),
                "{:?}",
                found.warnings
            );
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

/// Poses among pictures, in a file that is not taken into memory as a whole.
const PICTURES: &str = "
import os, sys
from mcap_ros2.writer import Writer
from mcap.writer import CompressionType
POSE = 'std_msgs/Header header\\ngeometry_msgs/Pose pose\\n' + '=' * 80 + '\\nMSG: std_msgs/Header\\nbuiltin_interfaces/Time stamp\\nstring frame_id\\n' \
    + '=' * 80 + '\\nMSG: geometry_msgs/Pose\\ngeometry_msgs/Point position\\ngeometry_msgs/Quaternion orientation\\n' \
    + '=' * 80 + '\\nMSG: geometry_msgs/Point\\nfloat64 x\\nfloat64 y\\nfloat64 z\\n' \
    + '=' * 80 + '\\nMSG: geometry_msgs/Quaternion\\nfloat64 x\\nfloat64 y\\nfloat64 z\\nfloat64 w\\n' \
    + '=' * 80 + '\\nMSG: builtin_interfaces/Time\\nint32 sec\\nuint32 nanosec\\n'
name, poses, every, size = sys.argv[1], *map(int, sys.argv[2:])
with open(name, 'wb') as file:
    writer = Writer(file, compression=CompressionType.ZSTD)
    pose = writer.register_msgdef('geometry_msgs/msg/PoseStamped', POSE)
    picture = writer.register_msgdef('sensor_msgs/msg/CompressedImage', 'uint8[] data')
    for k in range(poses):
        ns = 1700000000_000000000 + k * 10_000_000
        header = {'stamp': {'sec': ns // 10**9, 'nanosec': ns % 10**9}, 'frame_id': 'map'}
        place = {'position': {'x': 0.01 * k, 'y': 0.0, 'z': 0.5}, 'orientation': {'x': 0.0, 'y': 0.0, 'z': 0.0, 'w': 1.0}}
        writer.write_message('/pose', pose, {'header': header, 'pose': place}, log_time=ns, publish_time=ns)
        if k % every == 0:
            writer.write_message('/camera', picture, {'data': os.urandom(size)}, log_time=ns, publish_time=ns)
    writer.finish()
";

#[test]
fn poses_among_pictures_are_read_without_the_pictures() {
    let Some(program) = python_with("mcap_ros2.writer") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // 40 MB of pictures that cannot be packed.
    let mut python = std::process::Command::new(program);
    let done = python.args(["-c", PICTURES, "run.mcap", "2000", "10", "200000"]);
    let done = done.current_dir(folder.path()).output().unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let path = folder.path().join("run.mcap");
    let kept = realgap_path::trajectory::read_bytes(&path).unwrap();
    assert!(kept.len() < 1_000_000, "{}", kept.len());
    let motion = read(&path, Reading::default()).unwrap().trajectory;
    assert_eq!(motion.len(), 2000);
    assert_eq!(motion.positions_world_m()[1999].x, 0.01 * 1999.0);
    // A file that is cut anywhere is refused, also where its size tells nothing.
    let whole = std::fs::read(&path).unwrap();
    for length in [33_000_000, whole.len() - 9, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains("cut off"), "{error}");
    }
}
