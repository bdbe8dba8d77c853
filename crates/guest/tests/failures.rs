//! Simulators that end, hang, and answer what is none: each costs one run and is named, and nothing is left behind.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::{HELLO, answer, command, experiment, guest, script};

/// Why a simulator that answers like this fails.
fn failure(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut command = command(folder.path(), &script(text));
    command.answer_limit = Duration::from_millis(500);
    let guest = Arc::new(guest(command).unwrap());
    answer(&experiment(guest)).unwrap_err()
}

#[test]
fn what_a_simulator_does_wrong_is_named_with_its_last_words() {
    let ended = failure("echo 'no such joint' >&2; exit 3");
    assert!(ended.contains("ended (exit status: 3)"), "{ended}");
    assert!(ended.contains("no such joint"), "{ended}");
    let hung = failure("echo 'still loading' >&2; sleep 30");
    assert!(
        hung.contains("no answer within 0.5 s") && hung.contains("still loading"),
        "{hung}"
    );
    let named = [
        (
            r#"echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,NaN]}}""#,
            "answered NaN",
        ),
        (
            r#"echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,null]}}""#,
            "null is no number",
        ),
        (r#"echo "{\"id\":$id,\"chanels\":{}}""#, "chanels"),
        (
            r#"echo "{\"id\":$id,\"channels\":{\"a_rad\":[0]}}""#,
            "1 values of `a_rad` at 2 times",
        ),
        (
            r#"echo "{\"channels\":{\"a_rad\":[0,1]}}""#,
            "without the `id`",
        ),
        (
            r#"echo "{\"id\":$id,\"failed\":\"out of torque\"}""#,
            "out of torque",
        ),
        (
            r#"echo "{\"id\":$id,\"file\":\"nowhere.csv\"}""#,
            "nowhere.csv",
        ),
        ("echo '{ bad'", "answered no JSON"),
    ];
    for (text, why) in named {
        let found = failure(text);
        assert!(found.contains(why), "{text}: {found}");
    }
}

#[test]
fn a_failed_run_costs_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let touchy = r#"case "$line" in *'"k":5'*) exit 1;; *) echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,1]}}";; esac"#;
    let guest = Arc::new(guest(command(folder.path(), &script(touchy))).unwrap());
    let mut experiment = experiment(guest);
    for k in [1.0, 5.0, 6.0] {
        experiment.foreign.values.insert("k".to_owned(), k);
        assert_eq!(answer(&experiment).is_ok(), k != 5.0, "k = {k}");
    }
}

#[test]
fn a_process_that_ends_between_two_questions_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let weary = r#"echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,1]}}"; exit 0"#;
    let guest = Arc::new(guest(command(folder.path(), &script(weary))).unwrap());
    let experiment = experiment(guest);
    for _ in 0..3 {
        assert_eq!(answer(&experiment), Ok(vec![0.0, 1.0]));
    }
}

#[test]
fn a_simulator_that_does_not_say_who_it_is_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str| guest(command(folder.path(), text)).unwrap_err().to_string();
    let crashed = refused("echo 'cannot import mujoco' >&2; exit 1");
    assert!(crashed.contains("cannot import mujoco"), "{crashed}");
    let newer = refused(&format!(
        "read -r line; echo '{}'",
        HELLO.replace("\"realgap\":1", "\"realgap\":2")
    ));
    assert!(newer.contains("another version"), "{newer}");
    let empty = refused(&format!(
        "read -r line; echo '{}'",
        HELLO.replace("\"to\":10", "\"to\":0")
    ));
    assert!(empty.contains("range"), "{empty}");
}

/// Whether a process of this number runs.
#[cfg(target_os = "linux")]
fn runs(process: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/stat", process.trim()));
    status.is_ok_and(|status| !status.contains(") Z "))
}

#[test]
#[cfg(target_os = "linux")]
fn nothing_that_a_simulator_has_started_is_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let parent =
        r#"sleep 300 & echo $! > child; echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,1]}}""#;
    let guest = Arc::new(guest(command(folder.path(), &script(parent))).unwrap());
    answer(&experiment(guest)).unwrap();
    let child = std::fs::read_to_string(folder.path().join("child")).unwrap();
    let end = Instant::now() + Duration::from_secs(10);
    while runs(&child) && Instant::now() < end {
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(!runs(&child), "process {child} still runs");
}
