//! The shipped stand-in was simulated with known floor parameters: the sweep must find the friction, and must report the
//! restitution, which the recordings do not determine, as not determined.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use realgap_lab::calibration::{Definition, INTERVAL_LEVEL, Overrides, Study};
use realgap_optimization::RunOptions;

const FRICTION: f64 = 0.43;
const RESTITUTION: f64 = 0.36;

#[test]
fn the_true_floor_parameters_lie_in_the_indistinguishable_set() {
    if !common::is_long_run("a sweep for known floor parameters") {
        return;
    }
    // Every second point of the shipped grid, which includes the true values.
    let overrides = Overrides {
        points: Some(11),
        ..Overrides::default()
    };
    let definition =
        Definition::read(common::project().join("sweeps/tripod_self.ron"), &overrides).unwrap();
    assert_eq!(definition.truth.value("floor.friction"), Some(FRICTION));
    assert_eq!(
        definition.truth.value("floor.restitution"),
        Some(RESTITUTION)
    );
    let study = Study::new(definition).unwrap();
    let result = study.sweep(&RunOptions::default()).unwrap();
    let uncertainty = result.uncertainty.as_ref().unwrap();
    let truth = result
        .scores
        .points
        .iter()
        .position(|point| point.values == [FRICTION, RESTITUTION])
        .expect("the true values are a point of the grid");
    let best = &result.scores.points[result.scores.best.unwrap()];
    assert!(
        uncertainty.indistinguishable[truth],
        "the true values score {:?}, best {:?} at {:?}",
        result.scores.points[truth].score, best.score, best.values
    );
    // The set is informative: it contains less than a third of the grid. (It was less than a fifth while it held the points of the
    // mean over both engines; now it holds those of either engine.)
    let size = uncertainty
        .indistinguishable
        .iter()
        .take(121)
        .filter(|is_in| **is_in)
        .count();
    assert!(size < 40, "{size} of 121");
    // Friction is found to within a step of this coarse grid, and its interval holds the truth. Its length of 0.483 is just over half
    // of the range, so that friction is not called determined here. (It was 0.41 while scores were means over both engines, which
    // left the power of other studies too low; an earlier method came to less than 0.32, but it also called parameters without
    // effect determined.) Restitution is reported as not determined.
    assert!(
        (best.values[0] - FRICTION).abs() <= 0.095 + 1e-12,
        "{:?}",
        best.values
    );
    let draws = result.draws.as_ref().unwrap();
    let (low, high) = draws.interval(0, INTERVAL_LEVEL);
    assert!(
        low <= FRICTION && FRICTION <= high && high - low < 0.5,
        "{low} to {high}"
    );
    let verdicts = &result.report.verdicts;
    assert!(!verdicts[1].identified, "{}", verdicts[1].text);
    assert!(verdicts[1].text.contains("not determined"));
}
