//! Tests that the closed-form checks pass at the default settings, apart from the known limits.

#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::sync::LazyLock;

use realgap_core::unit::Unit;
use realgap_simulation::{EngineChoice, JointFormulation, Solver, engine_by_name};
use realgap_verification::{Check, CheckResult, LIMITS, Limit, Settings, Tolerance, run};

/// Every check at the default settings, run once.
static DEFAULT: LazyLock<Vec<Check>> = LazyLock::new(|| run(&Settings::default()).unwrap());

fn names(checks: &[Check], verdict: CheckResult) -> Vec<&str> {
    checks
        .iter()
        .filter(|c| c.verdict == verdict)
        .map(|c| c.name.as_str())
        .collect()
}

#[test]
fn the_default_settings_pass_every_check_but_the_documented_ones() {
    fails_as_known(&DEFAULT, EngineChoice::default());
}

#[test]
fn the_tree_solver_passes_every_check_but_the_documented_ones() {
    let engine = engine_by_name("tree").unwrap();
    let solver = Solver {
        engine,
        ..Solver::default()
    };
    let checks = run(&Settings {
        solver,
        ..Settings::default()
    });
    fails_as_known(&checks.unwrap(), engine);
}

/// Asserts that exactly the checks with a known limit fail, and that their errors are within the known ranges.
fn fails_as_known(checks: &[Check], engine: EngineChoice) {
    let limits = LIMITS.iter().filter(|l| l.engine == engine.get().name());
    let known: Vec<&str> = limits.map(|limit| limit.name).collect();
    assert_eq!(names(checks, CheckResult::Fail), known);
    for check in checks.iter().filter(|c| c.verdict == CheckResult::Fail) {
        assert!(Limit::of(check, engine).is_some(), "{check:?}");
    }
}

#[test]
fn names_are_unique_and_every_check_fails_just_beyond_its_tolerance() {
    let checks = &*DEFAULT;
    let mut seen = std::collections::BTreeSet::new();
    for check in checks {
        assert!(seen.insert(&check.name), "{} occurs twice", check.name);
        let (Tolerance::Relative(limit) | Tolerance::Absolute(limit)) = check.tolerance;
        assert!(limit > 0.0 && limit.is_finite(), "{}", check.name);
        // A tolerance relative to an expected value of zero would let no value pass.
        let unit = match check.tolerance {
            Tolerance::Relative(_) => check.expected.abs(),
            Tolerance::Absolute(_) => 1.0,
        };
        assert!(unit > 0.0, "{}", check.name);
        for (share, verdict) in [(0.99, CheckResult::Pass), (1.01, CheckResult::Fail)] {
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
        joints: vec![JointFormulation::Impulse],
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
fn a_coarse_timestep_makes_more_checks_fail() {
    let coarse = run(&Settings {
        solver: Solver {
            timestep_s: 1.0 / 30.0,
            substeps: 1,
            ..Solver::default()
        },
        ..Settings::default()
    })
    .unwrap();
    assert!(names(&coarse, CheckResult::Fail).len() > LIMITS.len());
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

#[test]
fn an_error_outside_the_range_of_a_known_limit_counts_as_a_failure() {
    let limit = &LIMITS[0];
    let check = |error: f64| Check {
        error,
        verdict: CheckResult::Fail,
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
    let of = |check: &Check| Limit::of(check, EngineChoice::default());
    assert_eq!(of(&check(0.5 * (low + high))), Some(limit));
    assert_eq!(of(&check(1.01 * high)), None);
    assert_eq!(of(&check(0.99 * low)), None);
    assert_eq!(of(&check(f64::NAN)), None);
    let passed = Check {
        verdict: CheckResult::Pass,
        ..check(low)
    };
    assert_eq!(of(&passed), None);
}
