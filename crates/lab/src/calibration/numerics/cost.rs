//! An estimate of the CPU time of a study, from a short slice of one run: it takes a second or two for any study.

use realgap_core::Result;
use realgap_simulation::{self as simulation, Experiment};

use crate::calibration::{StartRule, Study};

/// Longest slice, simulated seconds.
const SLICE_S: f64 = 0.2;
/// Timestep of a first, coarse measurement, which takes few steps for any study.
const COARSE_STEP_S: f64 = 0.05;
/// Timestep of a second measurement, which is made where the first shows that it is short.
const FINE_STEP_S: f64 = 1.0 / 240.0;
/// Most CPU seconds of the second measurement, and its most steps (settling included).
const FINE_CPU_S: f64 = 0.7;
const FINE_STEPS: f64 = 800.0;
/// More substeps than this are not run; their cost is extrapolated.
const SUBSTEPS: usize = 8;

impl Study {
    /// CPU seconds of one run in the middle of the grid, a mean over the equally valid settings, settling included. A slice is
    /// run now in each engine.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn cpu_s_per_point(&self) -> Result<f64> {
        let grid = &self.definition().grid;
        let mut whole = self.experiment(0, &grid.values(grid.len() / 2))?;
        if !whole.simulator.is_built_in() {
            // Nothing is known about the steps of somebody else's simulator, so a whole run is made.
            let run_s = simulation::run(&whole)?.cpu.as_secs_f64();
            return Ok(run_s / whole.duration_s * self.simulated_s());
        }
        let settings = self.settings();
        let [own, other] = settings.mean_costs(&self.cases()[0].experiment);
        let mut cpu_s = own * self.cpu_s_of(&whole)?;
        if let Some(second) = settings.second {
            whole.solver.engine = second;
            cpu_s += other * self.cpu_s_of(&whole)?;
        }
        Ok(cpu_s)
    }

    fn cpu_s_of(&self, whole: &Experiment) -> Result<f64> {
        let mut step_s = slice(whole, COARSE_STEP_S)?;
        if step_s.cpu_s * FINE_STEPS < FINE_CPU_S {
            step_s = slice(whole, FINE_STEP_S)?;
        }
        let cases = match self.definition().start {
            StartRule::Settled => 1,
            StartRule::FromRecording => self.cases().len(),
        };
        let simulated_s = self.simulated_s() + cases as f64 * step_s.settled_s;
        Ok(step_s.cpu_s * simulated_s / whole.solver.timestep_s)
    }
}

/// What was measured in a slice.
struct Slice {
    /// CPU seconds of one step at the study's own substeps.
    cpu_s: f64,
    /// Simulated seconds until the robot was at rest.
    settled_s: f64,
}

fn slice(whole: &Experiment, least_step_s: f64) -> Result<Slice> {
    let mut some = whole.clone();
    some.duration_s = whole.duration_s.min(SLICE_S);
    some.sampling = simulation::Sampling::Rate(1.0 / some.duration_s);
    // The cost of a step does not depend on its length.
    some.solver.timestep_s = whole.solver.timestep_s.max(least_step_s);
    some.solver.substeps = whole.solver.substeps.min(SUBSTEPS);
    let run = simulation::run(&some)?;
    let steps = (run.steps + run.settle_steps).max(1) as f64;
    let substeps = whole.solver.substeps as f64 / some.solver.substeps as f64;
    Ok(Slice {
        cpu_s: substeps * run.cpu.as_secs_f64() / steps,
        settled_s: run.settle_steps as f64 * some.solver.timestep_s,
    })
}
