//! Estimates friction and restitution by an optimizer, for a study in a file. `cargo run --release --example tune`

#![allow(clippy::print_stdout)]

use realgap::calibration::{Overrides, Study, TuneOptions};
use realgap::optimization::optimizer_by_name;
use realgap::{Result, RunOptions, comparison};

/// Tunes friction and restitution and prints each verdict.
pub fn main() -> Result<()> {
    let overrides = Overrides {
        metric: Some(comparison::by_name("rms")?),
        limit_recordings: Some(3),
        ..Overrides::default()
    };
    let study = Study::read("sweeps/tripod_self.ron", &overrides)?;
    let options = TuneOptions {
        optimizer: optimizer_by_name("nelder-mead")?,
        budget: 30,
        ..TuneOptions::default()
    };
    let answer = study.tune(&options, &RunOptions::default())?;
    for verdict in &answer.report.verdicts {
        println!("{verdict}");
    }
    Ok(())
}
