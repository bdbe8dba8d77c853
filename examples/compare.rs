//! Loads a recording, simulates its robot, and compares the two. `cargo run --release --example compare`

#![allow(clippy::print_stdout)]

use realgap::comparison::compare;
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, run};
use realgap::{Result, trajectory, unit::LengthUnit};

/// Compares a recorded run of the tripod with a simulated one, by three metrics.
pub fn main() -> Result<()> {
    let file = "real_trajectories/tripod_mujoco/run_00.csv";
    let real = trajectory::read(file, LengthUnit::Metre)?.trajectory;

    let mut experiment = Experiment::new(Morphology::read("morphologies/tripod.ron")?.assemble());
    experiment.duration_s = real.duration_s();
    let simulated = run(&experiment)?.outcome.into_result()?;

    for metric in ["pca", "rms", "displacement"] {
        println!("{metric:<13} {}", compare(&real, &simulated, metric)?);
    }
    Ok(())
}
