//! Estimates the friction that explains three recordings best, with its interval. `cargo run --release --example sweep`

#![allow(clippy::print_stdout)]

use realgap::calibration::Study;
use realgap::robot::morphology::Morphology;
use realgap::unit::LengthUnit;
use realgap::{Result, RunOptions, comparison, trajectory};

/// Sweeps friction and prints the report.
pub fn main() -> Result<()> {
    let mut study = Study::builder("friction", Morphology::read("morphologies/tripod.ron")?)
        .duration_s(5.0)
        .vary("floor.friction", 0.1, 0.9, 9)
        .metric(comparison::by_name("rms")?);
    for run in ["run_00", "run_01", "run_02"] {
        let path = format!("real_trajectories/tripod_standin/{run}.csv");
        study = study.recording(trajectory::read(path, LengthUnit::Metre)?);
    }
    let answer = study.build()?.sweep(&RunOptions::default())?;
    println!("{answer}");
    Ok(())
}
