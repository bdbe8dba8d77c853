//! Compares all engines on one robot: the end position, and the CPU time per simulated second.
//!
//! `cargo run --release -p realgap-simulation --example engines -- morphologies/tripod.ron 10`
#![allow(clippy::print_stdout, reason = "an example prints")]

use realgap_core::error::{Error, Result};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{ENGINES, Experiment, run};

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [path, duration_s] = words.as_slice() else {
        return Err(Error::usage(
            "give a robot's file and a duration in seconds",
        ));
    };
    let mut experiment = Experiment::new(Morphology::read(path)?.assemble());
    experiment.duration_s = duration_s
        .parse()
        .map_err(|_| Error::usage("the duration is not a number"))?;
    for engine in ENGINES {
        experiment.solver.engine = *engine;
        let done = run(&experiment)?;
        let simulated_s = done.steps.max(1) as f64 * experiment.solver.timestep_s
            + done.settle_steps as f64 * experiment.solver.timestep_s;
        let cpu_ms = 1e3 * done.cpu.as_secs_f64() / simulated_s;
        let motion = done.outcome.into_result()?;
        let end_m = motion.positions_world_m()[motion.len() - 1];
        println!("{engine:?}: {cpu_ms:.2} ms a simulated second, ends at {end_m:.4?}");
    }
    Ok(())
}
