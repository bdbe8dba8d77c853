//! Tests of calling another program: its output, and the errors if it is missing, fails, hangs or writes no text.
#![cfg(unix)]

use std::time::{Duration, Instant};

use realgap_vision::Program;

/// The output of a shell script for an input.
fn asked(script: &'static [&'static str], input: &[u8]) -> realgap_core::Result<String> {
    Program::new("sh", script, "install sh").read(input)
}

#[test]
fn a_program_receives_all_input_and_its_whole_output_is_read() {
    let heard = asked(&["-c", "tr a-z A-Z"], b"room 42\nexit").unwrap();
    assert_eq!(heard, "ROOM 42\nEXIT");
    // More data than a pipe can buffer, in both directions at once, and as much on the standard error.
    let input = vec![b'x'; 900_000];
    let heard = asked(&["-c", "tee /dev/stderr"], &input).unwrap();
    assert_eq!(heard.len(), input.len());
    // A program that does not read its input is not an error.
    assert_eq!(asked(&["-c", "echo EXIT"], &input).unwrap(), "EXIT\n");
}

#[test]
fn the_error_for_a_program_that_is_missing_fails_or_writes_no_text_has_a_hint() {
    let refused = |program: &Program, expected: &[&str]| {
        let said = program.read(b"picture").unwrap_err().to_string();
        for word in expected {
            assert!(said.contains(word), "{word} is missing in {said}");
        }
    };
    let missing = Program::new(
        "realgap-no-such-program",
        &[],
        "install it, or leave it out",
    );
    let expected = [
        "realgap-no-such-program is not installed",
        "install it, or leave it out",
    ];
    refused(&missing, &expected);
    let said = missing.version().unwrap_err().to_string();
    assert!(expected.iter().all(|word| said.contains(word)), "{said}");
    let folder = Program::new("/", &[], "install it");
    refused(&folder, &["/ cannot be started", "install it"]);
    let sh = |script: &'static [&'static str]| Program::new("sh", script, "");
    refused(
        &sh(&["-c", "echo no letters >&2; echo >&2; exit 3"]),
        &["sh failed", "exit status: 3: no letters", "sh -c"],
    );
    refused(&sh(&["-c", "kill -9 $$"]), &["sh failed", "signal: 9"]);
    refused(
        &sh(&["-c", r"printf 'ab\377c'"]),
        &["wrote no text", "behind the first 2", "UTF-8"],
    );
    refused(&sh(&["-c", "yes"]), &["wrote too much", "1048576 bytes"]);
}

#[test]
fn a_program_that_hangs_is_killed_at_the_time_limit_and_leaves_no_process() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    for (name, rest) in [
        ("silent", "exec sleep 60"),
        // It closes its output but does not end.
        ("closed", "exec >&- 2>&-; exec sleep 60"),
        // It leaves a child process that holds its pipes open.
        ("forked", "sleep 3 & exec sleep 60"),
    ] {
        let script = format!("echo $$ > {}; {rest}", at(name));
        let script: &'static str = Box::leak(script.into_boxed_str());
        let script: &'static [&'static str] = Box::leak(Box::new(["-c", script]));
        let hangs = Program::new("sh", script, "").with_limit(Duration::from_millis(700));
        let begun = Instant::now();
        let said = hangs.read(&[0; 200_000]).unwrap_err().to_string();
        assert!(
            said.contains("sh took too long") && said.contains("700ms"),
            "{said}"
        );
        assert!(begun.elapsed() < Duration::from_secs(10), "{name}");
        let process = std::fs::read_to_string(at(name)).unwrap();
        // A process that was killed but not waited for would still be listed.
        let is_left = std::path::Path::new("/proc").join(process.trim()).exists();
        assert!(!is_left, "{name}: {process}");
    }
}

#[test]
fn the_version_is_the_first_line_of_output() {
    let bash = Program::new("bash", &[], "");
    let version = bash.version().unwrap();
    assert!(version.starts_with("GNU bash, version"), "{version}");
    assert_eq!(version.lines().count(), 1);
    assert_eq!(bash.version().unwrap(), version);
}
