//! Runs before a fit show whether a shorter timestep changes the joints by more than a fit overlooks.

use realgap_lab::calibration::{Overrides, PriorRuns, Study};
use realgap_optimization::RunOptions;
use realgap_simulation::Quantity;

use crate::joint_log::{POSITIONS, record, robot};

/// A stiff servo with little damping: with its link of 0.2 kg it swings at over 10 Hz.
const STIFF: &str = "Torque(stiffness_nm_rad: 60, damping_nm_s_rad: 0.3)";

fn runs(timestep_s: f64) -> PriorRuns {
    let folder = tempfile::tempdir().unwrap();
    let motion = (Quantity::Position, [1.0; 2]);
    // The recorded joints have more friction than the robot's file says, so that something is left to fit.
    let truth = [("hinge.viscous_nm_s_rad", 0.1)];
    record(
        folder.path(),
        "log.csv",
        &robot(STIFF),
        motion,
        &truth,
        POSITIONS,
    );
    let path = folder.path().join("study.ron");
    let text = format!(
        r#"Study(morphology: "arm.ron", recordings: ["log.csv"], start: FromRecording, timestep_s: {timestep_s},
            metric: "joints", score: Single, commands: Commands(), set: {{"solver.engine": 1}},
            parameters: [(name: "hinge.viscous_nm_s_rad", from: 0, to: 0.5)])"#
    );
    std::fs::write(&path, text).unwrap();
    let study = Study::read(path, &Overrides::default()).unwrap();
    study.prior_runs(1, &RunOptions::default()).unwrap()
}

#[test]
fn a_stiff_servo_needs_a_shorter_timestep_and_with_a_short_one_nothing_is_said() {
    let (change_rad, most_rad) = runs(0.02).coarse_step_rad().unwrap();
    assert!(change_rad > 2.0 * most_rad, "{change_rad} {most_rad}");
    let fine = runs(0.0005);
    assert_eq!(fine.coarse_step_rad(), None, "{:?}", fine.runs);
}
