#![allow(clippy::print_stdout)]
//! Shows how to control a robot by a function: it walks until its sensor reads less than 20 cm, and then stands still.
//!
//! `cargo run --release --example own_feedback`

use realgap::robot::morphology::Morphology;
use realgap::simulation::{Controller, Experiment, Sensed, Steer, steer};

/// Prints when the robot saw the box and where it stands then.
pub fn main() -> realgap::Result<()> {
    let robot = Morphology::read("morphologies/tripod.ron")?;
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 15.0;
    // With a seed and a number of the repeat, readings have noise; without them, every reading is the mean.
    experiment.perturbation.draw = Some((1, 0));
    let mut controller = Controller::read("controllers/tripod_avoid.ron", &experiment)?;
    controller.rules.clear();
    let experiment = experiment.with_controller(controller)?;
    let mut seen_s = None;
    let mut feedback = |sensed: &Sensed, steering: &mut [Steer]| {
        if sensed.readings[0].is_some_and(|reading_cm| reading_cm < 20.0) {
            seen_s.get_or_insert(sensed.time_s);
        }
        if seen_s.is_some() {
            for (steer, angle_rad) in steering.iter_mut().zip(&sensed.angles_rad) {
                *steer = Steer::Hold(*angle_rad);
            }
        }
        Ok(())
    };
    let (run, log) = steer(&experiment, None, Some(&mut feedback))?;
    assert!(run.outcome.is_completed());
    let last = &log.decisions[log.decisions.len() - 1].sensed;
    println!(
        "it saw the box after {:.1} s and stands at x = {:.3} m in the arena",
        seen_s.unwrap_or(f64::NAN),
        last.position_m[0]
    );
    Ok(())
}
