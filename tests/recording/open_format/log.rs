//! MCAP files and bags of ROS 2 without Python: what is chosen, what is broken.

use nalgebra::Vector3;
use realgap::trajectory::{Reading, Trajectory, read, write};

use super::common::{realgap, text};
use super::{codes, put};

/// A pose with a header, coded as ROS 2 does.
fn pose_stamped(time_s: u32, x_m: f64) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend((time_s as i32).to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    // A name of three letters and its end: 16 bytes so far.
    bytes.extend(4_u32.to_le_bytes());
    bytes.extend(b"map\0");
    for value in [x_m, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0] {
        bytes.extend(f64::to_le_bytes(value));
    }
    bytes
}

/// A bag with these topics, types and messages.
fn bag(folder: &std::path::Path, topics: &[(&str, &str, Vec<Vec<u8>>)]) -> std::path::PathBuf {
    let path = folder.join("bag.db3");
    let _ = std::fs::remove_file(&path);
    let file = rusqlite::Connection::open(&path).unwrap();
    file.execute_batch(
        "CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT);
         CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);",
    )
    .unwrap();
    for (id, (name, kind, messages)) in topics.iter().enumerate() {
        let topic = (id as i64, name, kind);
        file.execute("INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')", topic)
            .unwrap();
        for (time, data) in messages.iter().enumerate() {
            let message = (id as i64, time as i64, data);
            let sql = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
            file.execute(sql, message).unwrap();
        }
    }
    path
}

const POSE: &str = "geometry_msgs/msg/PoseStamped";

fn of(topic: &str) -> Reading {
    Reading {
        topic: Some(topic.to_owned()),
        ..Reading::default()
    }
}

#[test]
fn the_one_topic_with_poses_needs_no_name() {
    let folder = tempfile::tempdir().unwrap();
    let poses = vec![pose_stamped(5, 0.0), pose_stamped(7, 1.5)];
    let other = ("/image", "sensor_msgs/msg/Image", vec![vec![0; 9]]);
    // Said once: it stands still.
    let fixed = ("/start", POSE, vec![pose_stamped(5, 9.0)]);
    let path = bag(folder.path(), &[("/robot", POSE, poses), other, fixed]);
    let recording = read(&path, Reading::default()).unwrap();
    assert_eq!(codes(&recording), []);
    assert_eq!(recording.trajectory.times_s(), [5.0, 7.0]);
    let end = recording.trajectory.positions_world_m()[1];
    assert_eq!(end, Vector3::new(1.5, 2.0, 3.0));
    let checked = realgap().arg("check").arg(&path).assert().success();
    let said = text(&checked.get_output().stdout);
    assert!(said.contains("2 samples"), "{said}");
}

#[test]
fn times_of_recording_stand_in_for_messages_without_times() {
    let folder = tempfile::tempdir().unwrap();
    let poses = vec![
        pose_stamped(0, 0.0),
        pose_stamped(0, 1.0),
        pose_stamped(0, 2.0),
    ];
    let path = bag(folder.path(), &[("/robot", POSE, poses)]);
    let times = read(&path, Reading::default()).unwrap().trajectory;
    assert_eq!(times.times_s(), [0.0, 1e-9, 2e-9]);
}

#[test]
fn which_of_several_topics_is_asked_for_with_the_option_that_chooses() {
    let folder = tempfile::tempdir().unwrap();
    let poses = || vec![pose_stamped(5, 0.0), pose_stamped(7, 1.5)];
    let path = bag(
        folder.path(),
        &[("/a", POSE, poses()), ("/b", POSE, poses())],
    );
    let refused = realgap().arg("check").arg(&path).assert().failure();
    let said = text(&refused.get_output().stderr);
    for words in [
        "bag.db3",
        "several things",
        "/a (geometry_msgs/msg/PoseStamped, 2 poses); /b",
        "--topic",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let chosen = ["--topic", "/b"];
    realgap()
        .arg("check")
        .arg(&path)
        .args(chosen)
        .assert()
        .success();
    let error = read(&path, of("/c")).unwrap_err();
    assert_eq!(error.field_name(), Some("topic"));
    assert!(error.to_string().contains("/a (geometry_msgs"), "{error}");
}

#[test]
fn a_broken_message_is_an_error_where_its_topic_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut cut = pose_stamped(6, 1.0);
    cut.truncate(30);
    let broken = vec![pose_stamped(5, 0.0), cut, pose_stamped(7, 1.0)];
    let sound = vec![pose_stamped(5, 0.0), pose_stamped(7, 1.0)];
    let path = bag(folder.path(), &[("/a", POSE, sound), ("/b", POSE, broken)]);
    assert!(read(&path, of("/a")).is_ok());
    let error = read(&path, of("/b")).unwrap_err().to_string();
    assert!(error.contains("/b: a message cannot be decoded"), "{error}");
    assert!(
        error.contains("30 bytes, said to be geometry_msgs"),
        "{error}"
    );
}

#[test]
fn what_is_no_bag_is_called_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "text.db3", "t_s,x_m,y_m\n");
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("text.db3") && error.contains("no bag of ROS 2"),
        "{error}"
    );
    let file = folder.path().join("other.db3");
    let other = rusqlite::Connection::open(&file).unwrap();
    // A view that never ends.
    other
        .execute_batch(
            "CREATE TABLE topics (id INTEGER);
             CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n;",
        )
        .unwrap();
    drop(other);
    let error = read(&file, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("the tables `topics` and `messages`"),
        "{error}"
    );
    // Cut in the middle of its pages.
    let poses = (0..500).map(|i| pose_stamped(i, f64::from(i))).collect();
    let path = bag(folder.path(), &[("/robot", POSE, poses)]);
    let bytes = std::fs::read(&path).unwrap();
    for length in [17, 100, 5000, bytes.len() / 2] {
        let path = put(folder.path(), "cut.db3", &bytes[..length]);
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains("cut.db3"), "{length}: {error}");
    }
    let error = realgap::trajectory::check_output(&path)
        .unwrap_err()
        .to_string();
    assert!(error.contains(".mcap"), "{error}");
}

/// An MCAP file of ours.
fn own() -> Vec<u8> {
    let times = (0..50).map(|i| f64::from(i) * 0.125).collect();
    let places = (0..50)
        .map(|i| Vector3::new(f64::from(i), 0.5, 0.25))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.mcap");
    write(&path, &Trajectory::new(times, places).unwrap()).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn a_cut_or_damaged_mcap_file_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = own();
    let path = put(folder.path(), "run.mcap", &bytes);
    assert_eq!(
        read(&path, Reading::default()).unwrap().trajectory.len(),
        50
    );
    for (content, said) in [
        (&b"PK\x03\x04 no log at all"[..], "no MCAP file"),
        (&b""[..], "no MCAP file"),
        (&bytes[..8], "cut off"),
        (&bytes[..60], "cut off"),
        (&bytes[..bytes.len() / 2], "`mcap recover`"),
    ] {
        let path = put(folder.path(), "run.mcap", content);
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("run.mcap"),
            "{error}"
        );
    }
    // Any bit of the packed chunk.
    let chunk = bytes.windows(3).position(|w| w == b"lz4").unwrap() + 40;
    for place in (chunk..chunk + 200).step_by(7) {
        let mut broken = bytes.clone();
        broken[place] ^= 0x10;
        let path = put(folder.path(), "run.mcap", &broken);
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains("damaged"), "{place}: {error}");
    }
    // A chunk that says it unpacks to far more.
    let mut bomb = bytes.clone();
    let size = bytes.windows(3).position(|w| w == b"lz4").unwrap() - 4 - 4 - 8;
    bomb[size..size + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let path = put(folder.path(), "run.mcap", &bomb);
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("too large unpacked"), "{error}");
}

#[test]
fn the_same_motion_makes_the_same_bytes() {
    assert_eq!(own(), own());
}
