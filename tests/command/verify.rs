//! The command that checks closed forms.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

fn realgap(arguments: &[&str]) -> std::process::Output {
    assert_cmd::Command::cargo_bin("realgap")
        .unwrap()
        .arg("verify")
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn the_command_prints_every_check_and_says_by_its_exit_code_whether_all_passed() {
    let output = realgap(&["--joint", "impulse", "--format", "json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let failed = report["failed"].as_u64().unwrap();
    let known = report["known_limits"].as_array().unwrap();
    let unexpected = failed - known.len() as u64;
    assert_eq!(output.status.code(), Some(i32::from(unexpected > 0)));
    let strict = realgap(&["--joint", "impulse", "--strict"]);
    assert_eq!(strict.status.code(), Some(i32::from(failed > 0)));
    let text = String::from_utf8(strict.stdout).unwrap();
    for limit in known {
        assert!(text.contains(limit["why"].as_str().unwrap()), "{limit}");
    }
    let checks = report["checks"].as_array().unwrap();
    assert_eq!(
        checks.len() as u64,
        failed + report["passed"].as_u64().unwrap()
    );
    for key in [
        "name",
        "what",
        "expected",
        "measured",
        "error",
        "unit",
        "tolerance",
        "verdict",
    ] {
        assert!(checks.iter().all(|c| c.get(key).is_some()), "{key}");
    }
    let table = realgap(&["--joint", "impulse"]);
    let text = String::from_utf8(table.stdout).unwrap();
    assert!(!text.contains('\u{1b}'), "colour without a terminal");
    assert!(
        checks
            .iter()
            .all(|c| text.contains(c["name"].as_str().unwrap()))
    );
}

#[test]
fn parameters_that_the_checks_set_themselves_are_refused() {
    let output = realgap(&["--set", "floor.friction=0.4"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("floor.friction") && message.contains("contact.*"),
        "{message}"
    );
}
