//! Tests of sensorgraphs: forward regression against SysIdentPy, recovery of known polynomials, and logs of a real scanner.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/validation/sensing.md"
)]

use crate::common;
use crate::room::room;
mod export;
mod log;
mod regression;
mod walk;

use realgap_sensing::graph::{Evaluation, Frame, GraphOptions, ScanLog, fit};

#[test]
fn scans_of_a_room_are_predicted_on_a_part_of_the_path_that_was_left_out() {
    for all_round in [true, false] {
        let log = ScanLog::parse("room.csv", &room(900, all_round)).unwrap();
        assert_eq!(log.is_all_round(), all_round);
        let (first, rest) = (log.part(0.0, 0.75), log.part(0.75, 1.0));
        for frame in [Frame::Robot, Frame::World] {
            let options = GraphOptions {
                frame: Some(frame),
                ..GraphOptions::default()
            };
            let found = fit(&first, &options).unwrap();
            assert_eq!(
                found.model.segments_deg.len(),
                if all_round { 12 } else { 6 }
            );
            let held = Evaluation::new(&found.model, &rest, None, 1).unwrap();
            assert!(
                held.mean_absolute_error_m < held.baseline_constant_m,
                "{frame:?}: {held}"
            );
            assert!(
                held.mann_whitney_p < 0.01 && held.spearman.unwrap() > 0.3,
                "{frame:?}: {held}"
            );
        }
        let auto = fit(&first, &GraphOptions::default()).unwrap();
        assert_eq!(auto.frame, Frame::World, "walls do not turn with the robot");
        assert!(auto.world_frame_error_m < auto.robot_frame_error_m);
        assert_eq!(
            auto.model,
            fit(&first, &GraphOptions::default()).unwrap().model
        );
    }
}

/// Real scans of a furnished flat: a model is fitted to a part of the path and evaluated on the rest.
#[test]
fn scans_of_a_real_flat_are_predicted_better_than_by_constants() {
    let Some(folder) = common::shared_data("radio_flat") else {
        return;
    };
    let log = ScanLog::read(folder.join("scans.csv")).unwrap();
    let mut better_than_constant = 0;
    println!(
        "| fitted | tested | error | constant | nearest pose | nearest turned | rank |\n|---|---|---|---|---|---|---|"
    );
    for (fitted, tested) in [
        ((0.0, 0.7), (0.7, 1.0)),
        ((0.3, 1.0), (0.0, 0.3)),
        ((0.0, 0.5), (0.5, 1.0)),
        ((0.5, 1.0), (0.0, 0.5)),
    ] {
        let model = fit(&log.part(fitted.0, fitted.1), &GraphOptions::default()).unwrap();
        let held = Evaluation::new(&model.model, &log.part(tested.0, tested.1), None, 1).unwrap();
        println!(
            "| {fitted:?} | {tested:?} | {:.3} ± {:.3} m | {:.3} m | {:.3} m | {:.3} m | {:.2} |",
            held.mean_absolute_error_m,
            held.standard_error_m,
            held.baseline_constant_m,
            held.baseline_nearest_m.unwrap(),
            held.baseline_nearest_turned_m.unwrap(),
            held.spearman.unwrap()
        );
        assert_eq!(model.frame, Frame::World);
        assert!(held.mann_whitney_p < 0.05 && held.p.unwrap() < 0.05);
        better_than_constant += usize::from(held.mean_absolute_error_m < held.baseline_constant_m);
    }
    assert!(better_than_constant >= 3, "{better_than_constant} of 4");
}
