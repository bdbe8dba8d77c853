//! Files without a line of names: the layouts of `ros2 topic echo --csv` are known, and of others the names are asked for and can be stated.

use realgap_core::error::Advice;
use realgap_path::trajectory::{InferredReading, Reading, Recording, read, read_all};

use super::{heading, place, put, said, stated, time_s};

const SAMPLES: usize = 60;
const PATH: [&str; 2] = ["path.csv", "path.txt"];

/// Seconds and nanoseconds of sample `k`.
fn stamp(k: usize) -> String {
    format!("1700000000,{}", 1_000_000 + 10_000_000 * k)
}

/// Place and quaternion with the real part last.
fn pose(k: usize) -> String {
    let [x, y, z] = place(k);
    let half = 0.5 * heading(k);
    format!("{x},{y},{z},0.0,0.0,{},{}", half.sin(), half.cos())
}

fn zeros(count: usize) -> String {
    vec!["0.0"; count].join(",")
}

fn rows(row: impl Fn(usize) -> String) -> String {
    (0..SAMPLES).map(|k| row(k) + "\n").collect()
}

/// What the file says with nothing but its rows.
fn inferred(name: &str, text: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), name, text);
    let inferred = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    read_all(&path, &inferred.reading).unwrap().swap_remove(0)
}

fn refused(name: &str, text: &str, known: &Reading) -> realgap_core::Error {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), name, text);
    InferredReading::without_questions(&path, known).unwrap_err()
}

fn is_path(recording: &Recording) {
    let motion = &recording.trajectory;
    assert_eq!(motion.len(), SAMPLES);
    let turns = motion.orientations_world_from_body().unwrap();
    for (k, (found, turn)) in motion.positions_world_m().iter().zip(turns).enumerate() {
        let [x, y, z] = place(k);
        assert!((found.x - x).abs() + (found.y - y).abs() + (found.z - z).abs() < 1e-12);
        assert!((turn.euler_angles().2 - heading(k)).abs() < 1e-12);
        assert!((motion.times_s()[k] - motion.times_s()[0] - 0.01 * k as f64).abs() < 1e-6);
    }
}

#[test]
fn poses_of_topic_echo_are_known_by_their_layout() {
    let kinds: [(&str, &dyn Fn(usize) -> String); 4] = [
        ("PoseStamped", &|k| format!("{},map,{}", stamp(k), pose(k))),
        ("PoseWithCovarianceStamped", &|k| {
            format!("{},map,{},{}", stamp(k), pose(k), zeros(36))
        }),
        ("Odometry", &|k| {
            let rest = [zeros(36), zeros(6), zeros(36)].join(",");
            format!("{},odom,base_link,{},{rest}", stamp(k), pose(k))
        }),
        ("odom", &|k| format!("{},map,odom,{}", stamp(k), pose(k))),
    ];
    for (kind, row) in kinds {
        for name in PATH {
            let recording = inferred(name, &rows(row));
            is_path(&recording);
            assert!(said(&recording).contains(kind), "{}", said(&recording));
        }
        // What `topic echo` says between messages, and a last line that was cut off.
        let text = rows(row);
        let (first, rest) = text.split_once('\n').unwrap();
        let told = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n";
        let cut = format!("{first}\n{told}{rest}1700000001,5,ma");
        is_path(&inferred("cut.csv", &cut));
        let other = format!("{text}1700000001,5,map,0.5\n{first}\n");
        let error = refused("other.csv", &other, &Reading::default()).to_string();
        assert!(error.contains("different parts"), "{error}");
    }
}

#[test]
fn one_frame_of_several_is_asked_for() {
    let row = |k| {
        let laser = format!("{},base_link,laser,0.1,0,0,0,0,0,1", stamp(k));
        format!("{},odom,base_link,{},{laser}", stamp(k), pose(k))
    };
    let text = rows(row);
    let error = refused("tf.csv", &text, &Reading::default());
    assert!(
        error
            .to_string()
            .contains("base_link in odom, laser in base_link"),
        "{error}"
    );
    assert_eq!(error.advice(), [Advice::Topic]);
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "tf.csv", text);
    let known = stated("(child_frame: Some(\"base_link\"))");
    is_path(&read(&path, &known).unwrap());
}

#[test]
fn joints_of_topic_echo_are_known_by_their_layout() {
    let angle = |k: usize, joint: usize| (0.1 * k as f64 + joint as f64).sin();
    let speed = |k: usize, joint: usize| 10.0 * (0.1 * k as f64 + joint as f64).cos();
    let row = |lists: usize, order: [&str; 2], k: usize| {
        let all = [
            format!("{},{}", angle(k, 0), angle(k, 1)),
            format!("{},{}", speed(k, 0), speed(k, 1)),
            "3,4".to_owned(),
        ];
        let [one, other] = order;
        format!("{},,{one},{other},{}", stamp(k), all[..lists].join(","))
    };
    let names = ["pan", "lift"];
    for lists in 1..=3 {
        let recording = inferred("joints.csv", &rows(|k| row(lists, names, k)));
        let motion = &recording.trajectory;
        for (index, name) in names.iter().enumerate() {
            let joint = motion.joint(name).unwrap();
            for k in 0..SAMPLES {
                assert!((joint.angles_rad[k] - angle(k, index)).abs() < 1e-12);
            }
            assert_eq!(joint.speeds_rad_s.is_some(), lists > 1);
        }
    }
    // Two lists may be angles and efforts.
    let torques = rows(|k| format!("{},,pan,lift,{},{},3,4", stamp(k), angle(k, 0), angle(k, 1)));
    let recording = inferred("joints.csv", &torques);
    assert!(
        recording
            .trajectory
            .joint("pan")
            .unwrap()
            .speeds_rad_s
            .is_none()
    );
    assert!(
        said(&recording).contains("speeds or efforts"),
        "{}",
        said(&recording)
    );
    // The order of the joints changes.
    let mixed = rows(|k| row(3, if k == 7 { ["lift", "pan"] } else { names }, k));
    let error = refused("joints.csv", &mixed, &Reading::default()).to_string();
    assert!(
        error.contains(":8:1") && error.contains("change their order"),
        "{error}"
    );
}

#[test]
fn the_names_of_other_rows_are_asked_for_and_can_be_stated() {
    let commas = rows(|k| {
        let [x, y, _] = place(k);
        format!("{},{x},{y},7", time_s(k))
    });
    let usual = Reading::default();
    for (name, text) in [
        ("optitrack.csv", commas.clone()),
        ("optitrack.txt", commas.replace(',', " ")),
        ("optitrack.dat", commas.replace(',', "\t")),
        ("optitrack.log", format!("# a comment\n\n{commas}")),
    ] {
        let error = refused(name, &text, &usual);
        let words = error.to_string();
        assert!(
            words.contains("the first line holds numbers") && words.contains("4 columns"),
            "{name}: {words}"
        );
        assert!(error.advice().contains(&Advice::NameColumns), "{name}");
        let folder = tempfile::tempdir().unwrap();
        let path = put(folder.path(), name, &text);
        for names in [
            "\"t_s\",\"x_m\",\"y_m\",\"\"",
            "\"time\",\"x\",\"y\",\"battery\"",
        ] {
            let known = stated(&format!("(header: [{names}])"));
            let inferred = InferredReading::without_questions(&path, &known).unwrap();
            let recording = read(&path, &inferred.reading).unwrap();
            assert_eq!(recording.trajectory.len(), SAMPLES, "{name}");
            for (k, found) in recording.trajectory.positions_world_m().iter().enumerate() {
                assert_eq!([found.x, found.y], [place(k)[0], place(k)[1]], "{name}");
            }
        }
        // A line of the file is named as the file counts it.
        let lines = text.lines().count();
        let broken = text.clone() + "oops,1,2,3\n";
        let broken = if name.ends_with(".csv") {
            broken
        } else {
            continue;
        };
        let path = put(folder.path(), name, &broken);
        let error = read(&path, stated("(header: [\"t_s\",\"x_m\",\"y_m\",\"\"])")).unwrap_err();
        assert_eq!(error.line_column().unwrap().0, lines + 1, "{error}");
    }
}

#[test]
fn names_that_are_stated_in_vain_are_refused() {
    let known = stated("(header: [\"t_s\",\"x_m\",\"y_m\"])");
    let named = "t_s,x_m,y_m\n0,0,0\n1,1,1\n";
    let tum = "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n";
    for (name, text, words) in [
        ("a.csv", named, "names its columns itself"),
        (
            "a.txt",
            tum,
            "files of this format name their columns themselves",
        ),
        (
            "b.csv",
            "0,0,0,0\n1,1,1,1\n",
            "3 names for rows of 4 columns",
        ),
    ] {
        let error = refused(name, text, &known).to_string();
        assert!(
            error.contains(words) && error.contains("header"),
            "{name}: {error}"
        );
    }
}

#[test]
fn text_files_with_names_are_tables_and_others_stay_poses() {
    let named = "timestamp actual_q_0 x_m y_m\n0.0 1 2 3\n0.1 1 2 3\n";
    let recording = inferred("recording.txt", named);
    assert_eq!(recording.trajectory.positions_world_m()[0].y, 3.0);
    let tum = "# timestamp tx ty tz qx qy qz qw\n0.0 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n";
    assert_eq!(inferred("path.txt", tum).trajectory.len(), 2);
}
