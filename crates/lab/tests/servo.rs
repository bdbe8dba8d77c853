//! Compares the shipped model of a servo with recordings of the real servo.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use realgap_lab::calibration::{Definition, Overrides, Study, read_best};
use realgap_optimization::RunOptions;
use realgap_simulation::parameter::ParameterSet;

#[test]
fn the_shipped_servo_follows_the_recorded_one_at_every_gain() {
    let Some(data) = common::shared_data("servo_pendulum") else {
        return;
    };
    let sweeps = common::project().join("sweeps");
    let values = read_best(sweeps.join("servo_xl330_best.ron"))
        .unwrap()
        .values;
    for gain in [100, 200, 800] {
        let overrides = Overrides {
            recordings: vec![format!("{}/kp{gain}_*.csv", data.display())],
            set: values.clone(),
            ..Overrides::default()
        };
        let definition = Definition::read(sweeps.join("servo_xl330_fit.ron"), &overrides).unwrap();
        let study = Study::new(definition).unwrap();
        let result = study.evaluate_joints(&ParameterSet::new(), &RunOptions::default());
        let angle_mrad = result.unwrap().angle_mrad.mean;
        assert!(angle_mrad < 33.0, "gain {gain}: {angle_mrad} mrad");
    }
}
