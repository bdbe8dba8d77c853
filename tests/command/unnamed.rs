//! Files without a line of names: they are checked, started with and studied, with the names that the user states or that their layout says.

use std::path::Path;

use crate::common::{realgap, text};
use crate::own_data::ARM;
use crate::start::start;

/// A joint that follows its command as a spring with damping would: time, angle, command.
fn followed() -> Vec<[f64; 3]> {
    let (mut at, mut speed) = (0.0, 0.0);
    let rows = (0..400).map(|k| {
        let t = 0.02 * f64::from(k);
        let command = 0.6 * (1.3 * t).sin() + 0.3 * (3.1 * t).sin();
        let row = [t, at, command];
        for _ in 0..20 {
            speed += 1e-3 * (150.0 * (command - at) - 20.0 * speed);
            at += 1e-3 * speed;
        }
        row
    });
    rows.collect()
}

fn put(folder: &Path, name: &str, content: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

#[test]
fn rows_without_names_are_asked_about_and_read_with_the_names_that_are_stated() {
    let folder = tempfile::tempdir().unwrap();
    let rows = followed();
    let rows = rows
        .iter()
        .map(|[t, at, command]| format!("{t:.3} {at:.5} {command:.5} 42\n"));
    let log = put(folder.path(), "log.txt", &rows.collect::<String>());
    let robot = put(folder.path(), "arm.urdf", ARM);
    let checked = realgap().arg("check").arg(&log).output().unwrap();
    let said = text(&checked.stderr) + &text(&checked.stdout);
    assert!(!checked.status.success());
    assert!(
        said.contains("4 columns") && said.contains("--header t_s,x_m,y_m"),
        "{said}"
    );
    let header = ["--header", "time,shoulder_rad,shoulder_command_rad,"];
    let checked = realgap()
        .arg("check")
        .arg(&log)
        .args(header)
        .output()
        .unwrap();
    let said = text(&checked.stderr) + &text(&checked.stdout);
    assert!(checked.status.success(), "{said}");
    let study = folder.path().join("mine.ron");
    let (code, said) = start(&header, &[log, robot], &study);
    assert_eq!(code, 0, "{said}");
    let written = std::fs::read_to_string(&study).unwrap();
    assert!(written.contains("header: ["), "{written}");
    let checked = realgap().arg("check").arg(&study).output().unwrap();
    assert!(checked.status.success(), "{}", text(&checked.stderr));
}

#[test]
fn joints_of_topic_echo_without_names_are_read_by_their_layout() {
    let folder = tempfile::tempdir().unwrap();
    let rows = followed();
    let rows = rows.iter().map(|[t, at, _]| {
        let nanoseconds = (1e9 * t).round() as u64;
        let (s, ns) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        format!("{},{ns},,shoulder,{at:.5}\n", 1_700_000_000 + s)
    });
    let log = put(folder.path(), "joint_states.csv", &rows.collect::<String>());
    let robot = put(folder.path(), "arm.urdf", ARM);
    let checked = realgap().arg("check").arg(&log).output().unwrap();
    let said = text(&checked.stderr) + &text(&checked.stdout);
    assert!(checked.status.success(), "{said}");
    assert!(
        said.contains("JointState") && said.contains("shoulder"),
        "{said}"
    );
    // Angles alone drive nothing: the robot needs commands.
    let (code, said) = start(&[], &[log, robot], &folder.path().join("mine.ron"));
    assert!(code != 0 && said.contains("command"), "{said}");
}
