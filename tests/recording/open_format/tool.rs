//! Logs that the packages `mcap`, `mcap-ros2-support` and `rosbags` write, and what they read of ours.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use realgap::trajectory::{Reading, Trajectory, read, write};

use super::common::python_with;
use super::python;

/// Forty poses on a climbing curve, as messages of every kind that is read.
const MESSAGES: &str = "
import json, math
from pathlib import Path
from rosbags.typesys import Stores, get_typestore
store = get_typestore(Stores.ROS2_HUMBLE)
T = store.types
def cls(name): return T[name]
import numpy as np
def stamp(i):
    return cls('builtin_interfaces/msg/Time')(sec=1700000000 + i // 10, nanosec=(i % 10) * 100000000)
def header(i, frame='odom'):
    return cls('std_msgs/msg/Header')(stamp=stamp(i), frame_id=frame)
def numbers(i):
    s = i / 40
    yaw = 2.5 * s
    return (s, s * s, 0.1 * s), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
def pose(i):
    p, q = numbers(i)
    return cls('geometry_msgs/msg/Pose')(position=cls('geometry_msgs/msg/Point')(*p),
                                         orientation=cls('geometry_msgs/msg/Quaternion')(*q))
def pose_stamped(i): return cls('geometry_msgs/msg/PoseStamped')(header=header(i), pose=pose(i))
def odometry(i):
    V = cls('geometry_msgs/msg/Vector3')
    twist = cls('geometry_msgs/msg/Twist')(linear=V(0.5, 0.0, 0.0), angular=V(0.0, 0.0, 0.25))
    return cls('nav_msgs/msg/Odometry')(header=header(i), child_frame_id='base_link',
        pose=cls('geometry_msgs/msg/PoseWithCovariance')(pose=pose(i), covariance=np.zeros(36)),
        twist=cls('geometry_msgs/msg/TwistWithCovariance')(twist=twist, covariance=np.zeros(36)))
def transforms(i):
    p, q = numbers(i)
    V, Q = cls('geometry_msgs/msg/Vector3'), cls('geometry_msgs/msg/Quaternion')
    def one(parent, child, p, q):
        return cls('geometry_msgs/msg/TransformStamped')(header=header(i, parent), child_frame_id=child,
            transform=cls('geometry_msgs/msg/Transform')(translation=V(*p), rotation=Q(*q)))
    return cls('tf2_msgs/msg/TFMessage')(transforms=[
        one('odom', 'base_link', p, q), one('base_link', 'wheel', (0.0, 0.1, 0.0), (0.0, 0.0, 0.0, 1.0))])
def path(i):
    return cls('nav_msgs/msg/Path')(header=header(i), poses=[pose_stamped(k) for k in range(i + 1)])
def chatter(i): return cls('std_msgs/msg/String')(data='x' * (i % 7))
TOPICS = [('/chatter', 'std_msgs/msg/String', chatter), ('/pose', 'geometry_msgs/msg/PoseStamped', pose_stamped),
          ('/odom', 'nav_msgs/msg/Odometry', odometry), ('/tf', 'tf2_msgs/msg/TFMessage', transforms),
          ('/plan', 'nav_msgs/msg/Path', path)]
def log_ns(i): return 1700000005_000000000 + i * 100000000
";

/// The poses that those messages hold.
fn must_be_the_path(found: &Trajectory, what: &str) {
    assert_eq!(found.len(), 40, "{what}");
    let turns = found.orientations_world_from_body().unwrap();
    for (i, turn) in turns.iter().enumerate() {
        let s = i as f64 / 40.0;
        let place = Vector3::new(s, s * s, 0.1 * s);
        assert_eq!(found.positions_world_m()[i], place, "{what}");
        let wanted = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.5 * s);
        assert!(turn.angle_to(&wanted) < 1e-7, "{what}");
        let time_s = 1_700_000_000.0 + 0.1 * i as f64;
        assert!((found.times_s()[i] - time_s).abs() < 1e-6, "{what}");
    }
}

fn of(topic: &str, child_frame: Option<&str>) -> Reading {
    Reading {
        topic: Some(topic.to_owned()),
        child_frame: child_frame.map(str::to_owned),
        ..Reading::default()
    }
}

/// Every kind of message in this file gives the path.
fn must_hold_the_path(file: &Path) {
    let name = file.display().to_string();
    let choices = [
        ("/pose", None),
        ("odom", None),
        ("/plan", None),
        ("/tf", Some("base_link")),
    ];
    for (topic, child) in choices {
        let found = read(file, of(topic, child)).unwrap().trajectory;
        must_be_the_path(&found, &format!("{name} {topic}"));
        let speeds = found.velocities_world_m_s();
        assert_eq!(speeds.is_some(), topic == "odom", "{name} {topic}");
        let turns = found.orientations_world_from_body().unwrap();
        for (v, turn) in speeds.into_iter().flatten().zip(turns) {
            let ahead = turn * Vector3::new(0.5, 0.0, 0.0);
            assert!((v - ahead).norm() < 1e-12, "{name}");
        }
    }
    let wheel = read(file, of("/tf", Some("wheel"))).unwrap().trajectory;
    assert_eq!(wheel.extent_m(), 0.0);
    let error = read(file, Reading::default()).unwrap_err().to_string();
    for listed in [
        "/pose (geometry_msgs/msg/PoseStamped, 40 poses)",
        "/odom (nav_msgs/msg/Odometry, 40 poses)",
        "/tf base_link in odom (tf2_msgs/msg/TFMessage, 40 poses)",
        "/tf wheel in base_link",
        "/plan (nav_msgs/msg/Path, 40 poses)",
        "`topic: \"/NAME\"` in `reading`",
    ] {
        assert!(error.contains(listed), "{name}: {error}");
    }
    let error = read(file, of("/tf", None)).unwrap_err();
    assert_eq!(error.field_name(), Some("child_frame"), "{error}");
    let error = read(file, of("/chatter", None)).unwrap_err().to_string();
    assert!(
        error.contains("/chatter (std_msgs/msg/String, 40)"),
        "{error}"
    );
}

#[test]
fn mcap_files_of_ros_2_are_read_however_they_are_packed() {
    let Some(program) = python_with("mcap_ros2.writer, rosbags") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let script = "
from dataclasses import fields
from mcap_ros2.writer import Writer
def plain(value):
    if isinstance(value, np.ndarray): return value.tolist()
    if isinstance(value, list): return [plain(one) for one in value]
    if hasattr(value, '__dataclass_fields__'): return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    return value
from mcap.writer import CompressionType
for kind in ('NONE', 'ZSTD', 'LZ4'):
    with open(f'{kind}.mcap', 'wb') as file:
        writer = Writer(file, chunk_size=4096, compression=getattr(CompressionType, kind))
        schemas = {name: writer.register_msgdef(name, store.generate_msgdef(name, ros_version=2)[0]) for _, name, _ in TOPICS}
        for i in range(40):
            for topic, name, make in TOPICS:
                writer.write_message(topic, schemas[name], plain(make(i)), log_time=log_ns(i), publish_time=log_ns(i))
        writer.finish()
";
    python(&program, folder, &format!("{MESSAGES}{script}"));
    for kind in ["NONE", "ZSTD", "LZ4"] {
        must_hold_the_path(&folder.join(format!("{kind}.mcap")));
    }
}

#[test]
fn bags_of_ros_2_are_read_from_either_storage_and_byte_order() {
    let Some(program) = python_with("rosbags") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let script = "
from rosbags.rosbag2 import StoragePlugin, Writer
for plugin in (StoragePlugin.SQLITE3, StoragePlugin.MCAP):
    for little in (True, False):
        name = f'{plugin.name}_{little}'
        with Writer(Path(name), version=9, storage_plugin=plugin) as writer:
            where = {topic: writer.add_connection(topic, name, typestore=store) for topic, name, _ in TOPICS}
            for i in range(40):
                for topic, name, make in TOPICS:
                    data = store.serialize_cdr(make(i), name, little_endian=little)
                    writer.write(where[topic], log_ns(i), data)
";
    python(&program, folder, &format!("{MESSAGES}{script}"));
    for (plugin, ending) in [("SQLITE3", "db3"), ("MCAP", "mcap")] {
        for little in ["True", "False"] {
            let name = format!("{plugin}_{little}");
            must_hold_the_path(&folder.join(&name).join(format!("{name}.{ending}")));
        }
    }
}

#[test]
fn the_pose_of_a_frame_in_another_follows_from_the_transforms_between_them() {
    let Some(program) = python_with("rosbags") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // A map drifts against the odometry, at other times; a camera is mounted, as the static topic says.
    let script = "
from rosbags.rosbag2 import StoragePlugin, Writer
def one(i, parent, child, p, q):
    V, Q = cls('geometry_msgs/msg/Vector3'), cls('geometry_msgs/msg/Quaternion')
    return cls('geometry_msgs/msg/TransformStamped')(header=header(i, parent), child_frame_id=child,
        transform=cls('geometry_msgs/msg/Transform')(translation=V(*p), rotation=Q(*q)))
def message(*all): return cls('tf2_msgs/msg/TFMessage')(transforms=list(all))
half = math.sqrt(0.5)
with Writer(Path('tree'), version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
    kind = 'tf2_msgs/msg/TFMessage'
    tf, static = (writer.add_connection(topic, kind, typestore=store) for topic in ('/tf', '/tf_static'))
    put = lambda where, i, it: writer.write(where, log_ns(i), store.serialize_cdr(it, kind))
    put(static, 0, message(one(0, 'base_link', 'camera', (0.5, 0.0, 0.25), (0.0, 0.0, half, half)), one(0, 'island', 'rock', (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))))
    for i in range(40):
        p, q = numbers(i)
        put(tf, i, message(one(i, 'odom', 'base_link', p, q)))
        if i % 3 == 0:
            put(tf, i, message(one(i, 'map', 'odom', (0.1 * i, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0))))
";
    python(&program, folder, &format!("{MESSAGES}{script}"));
    let file = folder.join("tree/tree.db3");
    let frame = |child: &str| Reading {
        child_frame: Some(child.to_owned()),
        ..Reading::default()
    };
    must_be_the_path(
        &read(&file, frame("base_link in odom")).unwrap().trajectory,
        "one step",
    );
    let found = read(&file, frame("camera in map")).unwrap();
    let motion = &found.trajectory;
    assert_eq!(motion.len(), 40);
    let turns = motion.orientations_world_from_body().unwrap();
    for (i, (turn, place)) in turns.iter().zip(motion.positions_world_m()).enumerate() {
        let s = i as f64 / 40.0;
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.5 * s);
        let wanted = Vector3::new(0.1 * i as f64, 2.0, 0.0)
            + Vector3::new(s, s * s, 0.1 * s)
            + yaw * Vector3::new(0.5, 0.0, 0.25);
        assert!((place - wanted).norm() < 1e-9, "{i}: {place} {wanted}");
        let quarter =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        assert!(turn.angle_to(&(yaw * quarter)) < 1e-7, "{i}");
    }
    let said: Vec<&str> = found.warnings.iter().map(|w| w.message.as_str()).collect();
    assert!(
        said.iter()
            .any(|said| said.contains("/tf_static camera in base_link")),
        "{said:?}"
    );
    // The other way round is the inverse.
    let back = read(&file, frame("map in camera")).unwrap().trajectory;
    let (turn, place) = (turns[20], motion.positions_world_m()[20]);
    assert!((back.positions_world_m()[20] + turn.inverse() * place).norm() < 1e-9);
    let refused = |child: &str| read(&file, frame(child)).unwrap_err().to_string();
    let error = refused("rock in map");
    assert!(
        error.contains("rock in island") && error.contains("odom in map"),
        "{error}"
    );
    assert!(refused("camera in base_link").contains("nothing moves"));
    let error = read(&file, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("base_link in odom") && error.contains("FRAME in OTHER"),
        "{error}"
    );
}

#[test]
fn the_package_mcap_reads_what_is_written() {
    let Some(program) = python_with("mcap.reader") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // More than one chunk.
    let times_s: Vec<f64> = (0..12_000).map(|i| 0.01 * f64::from(i)).collect();
    let places = times_s.iter().map(|t| Vector3::new(t.sin(), t.cos(), *t));
    let motion = Trajectory::new(times_s.clone(), places.collect()).unwrap();
    let turn = |t: &f64| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *t);
    let motion = motion
        .with_orientations(times_s.iter().map(turn).collect())
        .unwrap();
    write(folder.join("own.mcap"), &motion).unwrap();
    let script = "
import json, math
from mcap.reader import make_reader, NonSeekingReader
def check(reader):
    count = 0
    for schema, channel, message in reader.iter_messages():
        pose = json.loads(message.data)
        t = pose['timestamp']['sec'] + pose['timestamp']['nsec'] * 1e-9
        assert schema.name == 'foxglove.PoseInFrame' and json.loads(schema.data)['type'] == 'object'
        assert channel.topic == '/pose' and channel.message_encoding == 'json'
        assert abs(t - 0.01 * count) < 1e-9 and message.log_time == round(1e7 * count), (t, count)
        assert abs(pose['pose']['position']['x'] - math.sin(t)) < 1e-8
        assert abs(pose['pose']['orientation']['z'] - math.sin(t / 2)) < 1e-8
        count += 1
    assert count == 12000, count
with open('own.mcap', 'rb') as file:
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    assert summary.statistics.message_count == 12000
    assert summary.statistics.chunk_count == len(summary.chunk_indexes) > 1
    check(reader)
    late = list(reader.iter_messages(start_time=119_000_000_000))
    assert len(late) == 100, len(late)
with open('own.mcap', 'rb') as file:
    check(NonSeekingReader(file, validate_crcs=True))
";
    python(&program, folder, script);
}
