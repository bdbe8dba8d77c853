//! The noise floor of the real two-wheel robot.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use serde_json::Value;

/// Means over all pairs by numpy: 182 points by linear interpolation, first point subtracted, net displacement turned onto +x.
const TWO_WHEEL: [(&str, usize, f64, f64); 4] = [
    ("ir", 21, 0.038633621332648874, 0.04012940800228351),
    ("ir_bayesian", 17, 0.039341011293923485, 0.0414886530117384),
    ("us1", 18, 0.026071724453999467, 0.011986270239268768),
    ("us_bayesian", 18, 0.09235565227403321, 0.14266132417489255),
];

#[test]
fn the_noise_floor_of_a_real_robot_is_that_of_numpy() {
    let Some(folder) = common::shared_data("two_wheel_runs") else {
        return;
    };
    let file = folder.join("runs.csv").display().to_string();
    let run = |more: &[&str]| -> Value {
        let mut command = common::realgap();
        command.args(["gap", "--recordings", &file, "--format", "json"]);
        command
            .args(["--metric", "rms", "--metric", "displacement"])
            .args(more);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let found = run(&["--group", "condition"]);
    let sets = found["sets"].as_array().unwrap();
    assert_eq!(sets.len(), TWO_WHEEL.len());
    for (set, (name, runs, rms_m, displacement_m)) in sets.iter().zip(TWO_WHEEL) {
        assert_eq!(set["set"], name);
        assert_eq!(set["recordings"], runs);
        for (index, expected) in [rms_m, displacement_m].into_iter().enumerate() {
            let floor = &set["metrics"][index]["floor"];
            let value = floor["value"].as_f64().unwrap();
            assert!(
                (value - expected).abs() < 1e-9,
                "{name}: {value} {expected}"
            );
            assert!(floor["low"].as_f64().unwrap() < value);
            assert!(value < floor["high"].as_f64().unwrap());
        }
    }
    // `condition` is what is taken where no column is named, and threads change nothing.
    assert_eq!(run(&["--jobs", "1"]), found);
}
