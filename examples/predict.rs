//! Predicts the behaviour of a robot that has not been built, with probabilities. `cargo run --release --example predict`

#![allow(clippy::print_stdout)]

use realgap::prediction::{Card, SuccessRule, ensemble};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, Noise};
use realgap::{Result, RunOptions};

/// Prints the prediction card of the tripod.
pub fn main() -> Result<()> {
    let robot = Morphology::read("morphologies/tripod.ron")?;
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 5.0;
    let noise = Noise::unmeasured_robot();
    let repeats = ensemble::run(&experiment, &noise, 1, 40, &RunOptions::default())?;
    let card = Card::new(robot.name(), &repeats, SuccessRule::AtLeast(0.05))?;
    println!("{card}");
    Ok(())
}
