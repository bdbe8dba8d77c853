//! MCAP files and bags of ROS 2 without Python: the choice of topics, and broken files.

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
        "several objects",
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
        error.contains("30 bytes of the type geometry_msgs"),
        "{error}"
    );
}

#[test]
fn a_file_that_is_not_a_bag_is_refused() {
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
    for length in (0..200).map(|share| bytes.len() * share / 200 + 1) {
        let path = put(folder.path(), "cut.db3", &bytes[..length]);
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains("cut.db3"), "{length}: {error}");
    }
    let error = realgap::trajectory::check_output(&path)
        .unwrap_err()
        .to_string();
    assert!(error.contains(".mcap"), "{error}");
}

/// A bag of 220 poses whose writer is still there: the last 200 in its log (`WAL`), or begun and never committed.
fn unclosed(folder: &std::path::Path, mode: &str) -> (std::path::PathBuf, rusqlite::Connection) {
    let poses = |all: std::ops::Range<u32>| all.map(|i| pose_stamped(i, f64::from(i)));
    let path = bag(folder, &[("/robot", POSE, poses(0..20).collect())]);
    let writer = rusqlite::Connection::open(&path).unwrap();
    writer.pragma_update(None, "journal_mode", mode).unwrap();
    // Pages reach the file before they are committed where the cache is small.
    writer.pragma_update(None, "cache_size", 1).unwrap();
    writer.pragma_update(None, "wal_autocheckpoint", 0).unwrap();
    writer.execute_batch("BEGIN").unwrap();
    for (time, data) in (20..).zip(poses(20..220)) {
        let sql = "INSERT INTO messages (topic_id, timestamp, data) VALUES (0, ?1, ?2)";
        writer.execute(sql, (time, data)).unwrap();
    }
    // What was there is rewritten, too.
    writer
        .execute_batch("UPDATE messages SET timestamp = timestamp + 100")
        .unwrap();
    if mode == "WAL" {
        writer.execute_batch("COMMIT").unwrap();
    }
    (path, writer)
}

/// What kill -9 of the writer leaves, under another name.
fn killed(path: &std::path::Path, to: &std::path::Path) -> std::path::PathBuf {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(path.parent().unwrap()).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
    to.join("bag.db3")
}

#[test]
fn a_bag_is_read_as_its_recorder_left_it_and_stays_as_it_is() {
    for (mode, beside, poses) in [("WAL", "-wal", 220), ("DELETE", "-journal", 20)] {
        let folder = tempfile::tempdir().unwrap();
        let open = folder.path().join("open");
        std::fs::create_dir(&open).unwrap();
        let (path, writer) = unclosed(&open, mode);
        let left = killed(&path, &folder.path().join("killed"));
        let beside = left.with_file_name(format!("bag.db3{beside}"));
        assert!(std::fs::metadata(&beside).unwrap().len() > 500, "{mode}");
        let before = super::common::files(left.parent().unwrap());
        let read_poses = || read(&left, Reading::default()).unwrap().trajectory.len();
        assert_eq!(read_poses(), poses, "{mode}");
        assert_eq!(read_poses(), poses, "{mode}");
        assert_eq!(super::common::files(left.parent().unwrap()), before);
        drop(writer);
    }
}

/// Beyond 32 MB only the messages that may be read are taken into memory: with pictures the path is the same to the last bit.
#[test]
fn a_bag_that_is_large_because_of_pictures_is_read_like_a_small_one() {
    let folder = tempfile::tempdir().unwrap();
    let poses: Vec<Vec<u8>> = (0..50).map(|i| pose_stamped(i, f64::from(i))).collect();
    let path = bag(folder.path(), &[("/robot", POSE, poses.clone())]);
    let small = read(&path, Reading::default()).unwrap().trajectory;
    let pictures = vec![vec![7; 1_400_000]; 25];
    let image = ("/image", "sensor_msgs/msg/Image", pictures);
    let path = bag(folder.path(), &[image, ("/robot", POSE, poses)]);
    assert!(std::fs::metadata(&path).unwrap().len() > 32_000_000);
    assert_eq!(read(&path, Reading::default()).unwrap().trajectory, small);
    // A name that SQLite would read as something else.
    let odd = folder.path().join("a b%20?mode=rw#.db3");
    std::fs::rename(&path, &odd).unwrap();
    assert_eq!(read(&odd, Reading::default()).unwrap().trajectory, small);
    // Cut off, it is refused as a small one is.
    let file = std::fs::OpenOptions::new().write(true).open(&odd).unwrap();
    file.set_len(33_000_001).unwrap();
    let error = read(&odd, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("truncated"), "{error}");
}

/// A journal that is cut off puts back only some of the pages, and a log only some of the messages; no length of them is silent.
#[test]
fn a_cut_log_or_journal_of_a_bag_is_refused_or_said() {
    for (mode, suffix, sound) in [("WAL", "-wal", 220), ("DELETE", "-journal", 20)] {
        let folder = tempfile::tempdir().unwrap();
        let open = folder.path().join("open");
        std::fs::create_dir(&open).unwrap();
        let (path, _writer) = unclosed(&open, mode);
        let left = killed(&path, &folder.path().join("killed"));
        let beside = left.with_file_name(format!("bag.db3{suffix}"));
        let whole = std::fs::read(&beside).unwrap();
        for share in 1..30 {
            // Lengths at the ends of pages, too.
            let length = match share % 3 {
                0 => 32 + 4120 * share.min((whole.len() - 32) / 4120 - 1),
                _ => whole.len() * share / 30,
            };
            std::fs::write(&beside, &whole[..length]).unwrap();
            match read(&left, Reading::default()) {
                Err(error) => assert!(error.to_string().contains(suffix), "{error}"),
                Ok(read) => {
                    let said = read.warnings.iter().any(|w| w.message.contains("left out"));
                    assert!(said, "{mode}, {length} of {}", whole.len());
                }
            }
        }
        std::fs::write(&beside, &whole).unwrap();
        let read = read(&left, Reading::default()).unwrap();
        assert_eq!(read.trajectory.len(), sound, "{mode}");
        let said = read.warnings.iter().any(|w| w.message.contains("left out"));
        assert_eq!(said, mode == "DELETE", "{mode}");
    }
}

#[test]
fn a_damaged_log_of_a_bag_or_that_of_another_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let open = folder.path().join("open");
    std::fs::create_dir(&open).unwrap();
    let (path, _writer) = unclosed(&open, "WAL");
    let left = killed(&path, &folder.path().join("killed"));
    let log = left.with_file_name("bag.db3-wal");
    let mut bytes = std::fs::read(&log).unwrap();
    bytes[600] ^= 4;
    std::fs::write(&log, &bytes).unwrap();
    let error = read(&left, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("bag.db3-wal") && error.contains("damaged"),
        "{error}"
    );
    // The log of a database of others, which has a single table.
    let other = folder.path().join("other.db3");
    let writer = rusqlite::Connection::open(&other).unwrap();
    writer.pragma_update(None, "journal_mode", "WAL").unwrap();
    writer
        .execute_batch("CREATE TABLE others (text TEXT); INSERT INTO others VALUES ('mine')")
        .unwrap();
    std::fs::copy(folder.path().join("other.db3-wal"), &log).unwrap();
    let error = read(&left, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("bag.db3"), "{error}");
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
fn a_cut_or_damaged_mcap_file_is_refused_with_an_error() {
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
    assert!(error.contains("too large when decompressed"), "{error}");
}

#[test]
fn the_same_motion_makes_the_same_bytes() {
    assert_eq!(own(), own());
}
