//! The closed-form checks at the default settings.

#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::sync::LazyLock;

use realgap::simulation::verification::{Check, LIMITS, Limit, Settings, Tolerance, Verdict, run};
use realgap::simulation::{JointKind, Solver};
use realgap::unit::Unit;

/// Every check at the default settings, run once.
static DEFAULT: LazyLock<Vec<Check>> = LazyLock::new(|| run(&Settings::default()).unwrap());

fn names(checks: &[Check], verdict: Verdict) -> Vec<&str> {
    checks
        .iter()
        .filter(|c| c.verdict == verdict)
        .map(|c| c.name.as_str())
        .collect()
}

#[test]
fn the_default_settings_pass_every_check_but_the_documented_ones() {
    let checks = &*DEFAULT;
    let known: Vec<&str> = LIMITS.iter().map(|limit| limit.name).collect();
    assert_eq!(names(checks, Verdict::Fail), known);
    // As far as is known, and no farther.
    for check in checks.iter().filter(|c| c.verdict == Verdict::Fail) {
        assert!(Limit::of(check).is_some(), "{check:?}");
    }
}

#[test]
fn names_are_unique_and_every_check_fails_just_beyond_its_tolerance() {
    let checks = &*DEFAULT;
    let mut seen = std::collections::BTreeSet::new();
    for check in checks {
        assert!(seen.insert(&check.name), "{} stands twice", check.name);
        let (Tolerance::Relative(limit) | Tolerance::Absolute(limit)) = check.tolerance;
        assert!(limit > 0.0 && limit.is_finite(), "{}", check.name);
        // Relative to zero nothing could ever pass.
        let unit = match check.tolerance {
            Tolerance::Relative(_) => check.expected.abs(),
            Tolerance::Absolute(_) => 1.0,
        };
        assert!(unit > 0.0, "{}", check.name);
        for (share, verdict) in [(0.99, Verdict::Pass), (1.01, Verdict::Fail)] {
            for side in [-1.0, 1.0] {
                let measured = check.expected + side * share * limit * unit;
                let moved = Check::new(
                    check.name.clone(),
                    "",
                    check.expected,
                    measured,
                    check.unit,
                    check.tolerance,
                );
                assert_eq!(moved.verdict, verdict, "{} at {measured}", check.name);
            }
        }
    }
}

#[test]
fn both_joint_kinds_are_covered_unless_one_is_chosen() {
    let both = &*DEFAULT;
    let one = run(&Settings {
        joints: vec![JointKind::Impulse],
        ..Settings::default()
    })
    .unwrap();
    let of =
        |checks: &[Check], kind: &str| checks.iter().filter(|c| c.name.ends_with(kind)).count();
    assert!(of(both, ".impulse") > 10);
    assert_eq!(of(both, ".impulse"), of(both, ".multibody"));
    assert_eq!(of(&one, ".multibody"), 0);
}

#[test]
fn a_coarse_timestep_is_seen() {
    let coarse = run(&Settings {
        solver: Solver {
            timestep_s: 1.0 / 30.0,
            substeps: 1,
            ..Solver::default()
        },
        ..Settings::default()
    })
    .unwrap();
    assert!(names(&coarse, Verdict::Fail).len() > LIMITS.len());
}

#[test]
fn settings_that_cannot_be_simulated_are_refused() {
    let settings = Settings {
        solver: Solver {
            timestep_s: 0.0,
            ..Solver::default()
        },
        ..Settings::default()
    };
    let error = run(&settings).unwrap_err().to_string();
    assert!(error.contains("timestep_s"), "{error}");
}

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
fn an_error_beyond_what_is_known_counts_as_a_failure() {
    let limit = &LIMITS[0];
    let check = |error: f64| Check {
        error,
        verdict: Verdict::Fail,
        ..Check::new(
            limit.name,
            "",
            1.0,
            1.0,
            Unit::One,
            Tolerance::Relative(0.01),
        )
    };
    let (low, high) = limit.error;
    assert_eq!(Limit::of(&check(0.5 * (low + high))), Some(limit));
    assert_eq!(Limit::of(&check(1.01 * high)), None);
    assert_eq!(Limit::of(&check(0.99 * low)), None);
    assert_eq!(Limit::of(&check(f64::NAN)), None);
    let passed = Check {
        verdict: Verdict::Pass,
        ..check(low)
    };
    assert_eq!(Limit::of(&passed), None);
}

#[test]
fn what_the_checks_decide_themselves_cannot_be_set() {
    let output = realgap(&["--set", "floor.friction=0.4"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("floor.friction") && message.contains("contact.*"),
        "{message}"
    );
}
