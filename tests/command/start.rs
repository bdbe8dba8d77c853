//! From a user's own files to a verdict in three commands, and common mistakes on this path.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{realgap, text};

/// Three real tosses as another program wrote them: millimetres, milliseconds, y up, names of its own, two lines before the header.
pub(crate) fn foreign_tosses(folder: &Path) -> Vec<PathBuf> {
    let own = common::project().join("real_trajectories/cube_tosses");
    ["toss_003", "toss_015", "toss_026"]
        .iter()
        .map(|name| {
            let table = std::fs::read_to_string(own.join(format!("{name}.csv"))).unwrap();
            let mut text =
                "exported\n\nTime;Pos X;Pos Y;Pos Z;Rot W;Rot X;Rot Y;Rot Z\n".to_owned();
            for line in table.lines().skip(1) {
                let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
                let row = [
                    v[0] * 1e3,
                    v[2] * 1e3,
                    v[3] * 1e3,
                    v[1] * 1e3,
                    v[4],
                    v[6],
                    v[7],
                    v[5],
                ];
                text += &format!("{}\n", row.map(|v| v.to_string()).join(";"));
            }
            let path = folder.join(format!("{name}.csv"));
            std::fs::write(&path, text).unwrap();
            path
        })
        .collect()
}

pub(crate) fn start(words: &[&str], files: &[PathBuf], study: &Path) -> (i32, String) {
    let said = realgap()
        .arg("start")
        .args(files)
        .args(words)
        .arg("-o")
        .arg(study)
        .write_stdin("")
        .output()
        .unwrap();
    let all = text(&said.stdout) + &text(&said.stderr);
    (said.status.code().unwrap(), all)
}

pub(crate) const CUBE: [&str; 3] = ["--cube", "0.1048", "0.37"];

#[test]
fn three_commands_lead_from_own_files_to_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let files = foreign_tosses(folder.path());
    let (code, said) = start(&CUBE, &files, &study);
    assert_eq!(code, 0, "{said}");
    for words in [
        "y points up",
        "lengths are in millimetres",
        "times are in milliseconds",
        "line 3 names",
        "next: realgap sweep",
        "of their reach apart",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(
        written.contains("start: FromRecording") && written.contains("y-up"),
        "{written}"
    );
    let out = folder.path().join("out");
    let sweep = ["--points", "3", "--score", "single", "-o"];
    realgap()
        .arg("sweep")
        .arg(&study)
        .args(sweep)
        .arg(&out)
        .assert()
        .success();
    realgap().arg("report").arg(&out).assert().success();
    let best = common::read(&out, "best.ron");
    assert!(best.contains("floor.friction"), "{best}");
}

#[test]
fn common_mistakes_are_asked_about_or_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let files = foreign_tosses(folder.path());
    let put = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let path = |i: i32| (f64::from(i) * 0.02, 0.3 * f64::from(i) * 0.02);
    let table = |header: &str, row: &dyn Fn(i32) -> String| {
        let rows: Vec<String> = (0..200).map(row).collect();
        format!("{header}\n{}\n", rows.join("\n"))
    };
    let plain = put(
        "plain.csv",
        &table("t,x,y", &|i| format!("{},{},0", path(i).0, path(i).1)),
    );
    let slow = put(
        "slow.csv",
        &table("t,x [m],y [m]", &|i| {
            format!("{},{},0", i as f64 * 0.5, path(i).1)
        }),
    );
    let untimed = put(
        "untimed.csv",
        &table("frame,x,y", &|i| format!("{i},{},0", path(i).1)),
    );
    let flat = put(
        "flat.csv",
        &table("t,x,z", &|i| format!("{},{},0", path(i).0, path(i).1)),
    );
    let space = put(
        "space.csv",
        &table("t,x [m],y [m],z [m]", &|i| {
            let (t, x) = path(i);
            format!("{t},{x},{x},{x}")
        }),
    );
    let two = put(
        "two.csv",
        &table("t_s,x_m,y_m,who", &|i| {
            format!(
                "{},{},{},{}",
                path(i).0,
                path(i).1,
                3 * (i % 2),
                ["a", "b"][i as usize % 2]
            )
        }),
    );
    let robot = common::project().join("morphologies/tripod.ron");
    let own_study = common::project().join("sweeps/tripod_floor.ron");
    let whole = std::fs::read_to_string(&files[0]).unwrap();
    let half = put("half.csv", &whole[..whole.rfind(';').unwrap()]);
    let joints = put(
        "joints.csv",
        &table("t_s,elbow_command,elbow", &|i| {
            format!("{},{},0", path(i).0, path(i).1)
        }),
    );
    let far = put(
        "far.csv",
        &table("t_s,x_m,y_m", &|i| {
            format!("{},{},0", path(i).0, 900.0 * path(i).1)
        }),
    );
    for (words, files, says) in [
        (vec![], files.clone(), "--cube"),
        (
            vec![],
            vec![robot.clone()],
            "realgap start runs/*.csv robot.ron",
        ),
        (
            vec![],
            vec![files[0].clone(), robot.clone(), robot.clone()],
            "one robot",
        ),
        (
            vec![],
            vec![files[0].clone(), own_study.clone()],
            "not a morphology",
        ),
        (
            CUBE.to_vec(),
            vec![folder.path().join("gone.csv")],
            "gone.csv",
        ),
        (
            CUBE.to_vec(),
            vec![folder.path().to_path_buf()],
            "this is a folder",
        ),
        (
            CUBE.to_vec(),
            vec![put("none.csv", "")],
            "the file is empty",
        ),
        (
            CUBE.to_vec(),
            vec![put("names.csv", "t_s,x_m,y_m\n")],
            "copy it again",
        ),
        (CUBE.to_vec(), vec![files[0].clone(), half], "copy it again"),
        (CUBE.to_vec(), vec![joints], "NAME_rad or NAME_deg"),
        (
            vec!["--cube", "104.8", "370"],
            files.clone(),
            "metres and kilograms",
        ),
        (CUBE.to_vec(), vec![own_study], "a study, not a morphology"),
        // A recording in free fall is not one of a robot that stands on the floor and walks.
        (
            vec![],
            vec![files[0].clone(), robot.clone()],
            "name the robot that was thrown",
        ),
        (
            CUBE.to_vec(),
            vec![put("short.csv", "t_s,x_m,y_m\n0,0,0\n")],
            "samples",
        ),
        (
            CUBE.to_vec(),
            vec![untimed],
            "no column has a name for a time",
        ),
        (CUBE.to_vec(), vec![flat], "both x and y"),
        (CUBE.to_vec(), vec![slow], "--time-unit"),
        (CUBE.to_vec(), vec![space], "--axes"),
        (CUBE.to_vec(), vec![two], "--where"),
        (CUBE.to_vec(), vec![far], "--unit"),
        (vec!["--cube", "-1", "0.37"], files.clone(), "side_m"),
        (
            vec!["--cube", "0.1", "0.37", "--column", "x=nowhere"],
            files.clone(),
            "nowhere",
        ),
    ] {
        let (code, said) = start(&words, &files, &study);
        assert!(
            code != 0 && said.contains(says),
            "{words:?} {files:?}: {code} {said}"
        );
        assert!(!study.exists());
    }
    // Only the size of the robot determines the unit.
    let (code, said) = start(&CUBE, &[plain], &study);
    assert!(
        code == 0 && said.contains("lengths are in metres"),
        "{said}"
    );
}

#[test]
fn the_first_of_several_bodies_is_the_robot_and_the_output_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let pushes = common::project().join("real_trajectories/cube_pushes");
    let files: Vec<PathBuf> = ["push_01.csv", "push_02.csv"]
        .map(|name| pushes.join(name))
        .into();
    let (code, said) = start(&["--cube", "0.075", "0.85"], &files, &study);
    assert!(
        code == 0
            && said.contains("the robot is `cube`: it is the first of the bodies cube, effector"),
        "{code} {said}"
    );
}

#[test]
fn guesses_that_contradict_the_robot_are_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let files = foreign_tosses(folder.path());
    // Millimetres and y up as before, but the real part of the orientation stands last under the names of the others.
    let turned: Vec<PathBuf> = files
        .iter()
        .map(|file| {
            let table = std::fs::read_to_string(file).unwrap();
            let lines = table.lines().map(|line| {
                let cells: Vec<&str> = line.split(';').collect();
                match cells.as_slice() {
                    [t, x, y, z, w, i, j, k] if *t != "Time" => [t, x, y, z, i, j, k, w]
                        .map(|cell| (*cell).to_owned())
                        .join(";"),
                    _ => line.to_owned(),
                }
            });
            let path = folder.path().join(format!(
                "turned_{}",
                file.file_name().unwrap().to_string_lossy()
            ));
            std::fs::write(&path, lines.collect::<Vec<_>>().join("\n")).unwrap();
            path
        })
        .collect();
    let copy = folder.path().join("copy.csv");
    std::fs::copy(&files[0], &copy).unwrap();
    let twice = vec![files[0].clone(), files[1].clone(), copy];
    for (words, files, says) in [
        (vec!["--cube", "0.14", "400"], &files, "unlikely-mass"),
        (vec!["--cube", "1.048", "37"], &files, "off-floor"),
        (CUBE.to_vec(), &turned, "off-floor"),
        (CUBE.to_vec(), &twice, "same-run"),
    ] {
        let (code, said) = start(&words, files, &study);
        assert!(code == 0 && said.contains(says), "{words:?}: {code} {said}");
        std::fs::remove_file(&study).unwrap();
    }
    let (_, said) = start(&CUBE, &files, &study);
    for word in ["unlikely", "off-floor", "same-run", "other-robot"] {
        assert!(!said.contains(word), "{said}");
    }
    std::fs::remove_file(&study).unwrap();
    // Names of quaternion columns that do not tell which component is which.
    let renamed: Vec<PathBuf> = (0..)
        .zip(&files)
        .map(|(index, file)| {
            let table = std::fs::read_to_string(file).unwrap();
            let path = folder.path().join(format!("renamed_{index}.csv"));
            let table = table.replace("Rot W;Rot X;Rot Y;Rot Z", "q0;q1;q2;q3");
            std::fs::write(&path, table).unwrap();
            path
        })
        .collect();
    let (code, said) = start(&CUBE, &renamed, &study);
    assert!(
        code != 0 && said.contains("--column qw=NAME"),
        "{code} {said}"
    );
    // An arm that is held at its root was not thrown.
    let arm = common::project().join("morphologies/so101_arm.ron");
    let (_, said) = start(&[], &[files[0].clone(), arm.clone()], &study);
    assert!(said.contains("falls freely"), "{said}");
    let walk = folder.path().join("walk.csv");
    let rows: String = (0..100)
        .map(|i| format!("{},{},0\n", f64::from(i) * 0.02, f64::from(i) * 0.01))
        .collect();
    std::fs::write(&walk, format!("t_s,x_m,y_m\n{rows}")).unwrap();
    let (_, said) = start(&[], &[walk, arm], &study);
    assert!(said.contains("is held at its root"), "{said}");
}

#[test]
fn errors_name_a_robot_among_trajectories_and_a_missing_file() {
    let toss = "real_trajectories/cube_tosses/toss_003.csv";
    for (words, says) in [
        (
            ["compare", toss, "morphologies/tripod.ron"],
            "a morphology, not a trajectory",
        ),
        (["check", toss, "nowhere"], "No such file"),
    ] {
        let said = realgap()
            .current_dir(common::project())
            .args(words)
            .output()
            .unwrap();
        let error = text(&said.stderr);
        assert!(
            !said.status.success() && error.contains(says) && error.contains("hint"),
            "{words:?}: {error}"
        );
    }
}

#[test]
fn boxes_with_a_free_hinge_start_from_their_first_recorded_state() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("mine.ron");
    let root = common::project();
    let files = [
        root.join("real_trajectories/elbow_tosses/toss_002.csv"),
        root.join("morphologies/elbow.ron"),
    ];
    let (code, said) = start(&["--axes", "world"], &files, &study);
    assert_eq!(code, 0, "{said}");
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(written.contains("start: FromRecording"), "{written}");
}

/// A forearm as a URDF: a free base, and limits of a motor without the law of its servo.
const FOREARM: &str = r#"<robot name="forearm">
<link name="base"><inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.1 0 0"/><mass value="0.3"/><inertia ixx="1e-4" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow_flex" type="revolute"><parent link="base"/><child link="lower"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="3" velocity="6"/></joint>
</robot>"#;

#[test]
fn joint_logs_and_a_urdf_become_a_fit_of_the_servos() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let logs = common::project().join("real_trajectories/so101_arm");
    let log = logs.join("random_waypoints.csv");
    let urdf = put("arm.urdf", FOREARM);
    let study = folder.path().join("mine.ron");
    let (code, said) = start(&[], &[log.clone(), urdf.clone()], &study);
    assert_eq!(code, 0, "{said}");
    for words in [
        "the root is held",
        "not used: shoulder_pan_command_rad, shoulder_lift_command_rad",
        "tune",
        "--optimizer gauss-newton --budget 64    # 6 parameters",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let written = std::fs::read_to_string(&study).unwrap();
    for words in [
        "commands: Commands()",
        "servo.elbow_flex.stiffness_nm_rad\", from: 1.5, to: 60.0",
        "timestep_s: 0.01,",
    ] {
        assert!(written.contains(words), "{words}: {written}");
    }
    let robot = common::read(folder.path(), "mine_robot.ron");
    assert!(
        robot.contains("Imported by realgap") && robot.contains("Torque("),
        "{robot}"
    );
    // The next command reads the file that it wrote.
    let out = folder.path().join("out");
    let words = ["--optimizer", "gauss-newton", "--budget", "20", "-o"];
    realgap()
        .arg("tune")
        .arg(&study)
        .args(words)
        .arg(&out)
        .assert()
        .success();
    assert!(common::read(&out, "best.ron").contains("servo.elbow_flex.stiffness_nm_rad"));

    // With one servo and one column of goals, the column needs no name of a joint.
    let rows: String = (0..100)
        .map(|i| {
            format!(
                "{},{},{}\n",
                f64::from(i) * 0.02,
                (f64::from(i) * 0.02).sin(),
                (f64::from(i) * 0.02).sin()
            )
        })
        .collect();
    let single = put(
        "single.csv",
        &format!("t_s,goal_rad,elbow_flex_rad\n{rows}"),
    );
    let (code, said) = start(&["--force"], &[single, urdf.clone()], &study);
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(
        code == 0 && written.contains("(hinge: \"elbow_flex\", column: \"goal\")"),
        "{said}{written}"
    );

    // Columns of unknown joints, and a robot that must be held, are errors with a remedy.
    let other = put(
        "other.csv",
        &format!("t_s,knee_command_rad,knee_rad\n{rows}"),
    );
    let (code, said) = start(&["--force"], &[other, urdf.clone()], &study);
    assert!(
        code == 2 && said.contains("knee") && said.contains("--reading FILE"),
        "{said}"
    );
    let free = put(
        "free.ron",
        &format!(
            "Study(morphology: {:?}, recordings: [{:?}], start: FromRecording, commands: Commands(), left_out: [\"shoulder_*\", \"wrist_*\", \"gripper*\"], parameters: [(name: \"servo.elbow_flex.gain_1_s\", from: 1, to: 9)], metric: \"joints\")",
            urdf.display().to_string(),
            log.display().to_string()
        ),
    );
    let said = realgap().arg("check").arg(&free).output().unwrap();
    assert!(
        text(&said.stderr).contains("robot import ROBOT --mounted"),
        "{}",
        text(&said.stderr)
    );
}
