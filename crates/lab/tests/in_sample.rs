//! Held-out recordings influence neither the audit nor the uncertainty of a fit.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::project;
use realgap_core::unit::LengthUnit;
use realgap_lab::calibration::{Answer, Split, Study};
use realgap_optimization::RunOptions;
use realgap_path::comparison::by_name;
use realgap_path::trajectory::{self, Recording};
use realgap_robot::morphology::Morphology;

/// The answer of a study of four recordings, one of them held out and scaled by `scale`.
fn answer(scale: f64) -> Answer {
    let recordings = (0..4).map(|number| {
        let file = format!("real_trajectories/tripod_standin/run_0{number}.csv");
        trajectory::read(project().join(file), LengthUnit::Metre).unwrap()
    });
    let recordings: Vec<Recording> = recordings.collect();
    let build = |recordings: &[Recording]| {
        let robot = Morphology::read(project().join("morphologies/tripod.ron")).unwrap();
        let mut study = Study::builder("held_out", robot)
            .duration_s(0.5)
            .vary("floor.friction", 0.2, 0.8, 3)
            .set("timestep_s", 1.0 / 240.0)
            .set("solver.sweeps", 1.0)
            .set("solver.joint", 0.0)
            .metric(by_name("rms").unwrap())
            .split(Split::HoldOut(0.25));
        for recording in recordings {
            study = study.recording(recording.clone());
        }
        study.build().unwrap()
    };
    let plain = build(&recordings);
    let held_out = (0..4).find(|index| plain.is_held_out(*index)).unwrap();
    let mut changed = recordings;
    changed[held_out].trajectory = changed[held_out].trajectory.scaled(scale).unwrap();
    build(&changed).sweep(&RunOptions::default()).unwrap()
}

#[test]
fn audit_and_uncertainty_do_not_depend_on_held_out_recordings() {
    let (truth, spoilt) = (answer(1.0), answer(50.0));
    assert_ne!(
        truth.scores.points[0].held_out,
        spoilt.scores.points[0].held_out
    );
    assert!(truth.report.audit.as_ref().unwrap().rows.len() >= 4);
    assert_eq!(truth.report.audit, spoilt.report.audit);
    assert_eq!(truth.uncertainty, spoilt.uncertainty);
}
