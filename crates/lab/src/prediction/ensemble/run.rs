//! Simulation of the repeats.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use rayon::prelude::*;

use crate::prediction::UncertainParameters;
use realgap_core::{Code, Error, ErrorKind, Result, Warning};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{Prepared, prepare};
use realgap_simulation::{
    EnergyBalance, Experiment, Noise, Outcome, Perturbation, Run, RunHooks, run_with,
};

/// Gives the run with a number where it is known already, so that it is not simulated again.
pub type Recall<'a> = &'a (dyn Fn(usize) -> Result<Option<Run>> + Sync);

/// With fewer repeats than this, tails and rare behaviours are not estimated reliably.
const FEW_REPEATS: usize = 20;

/// The result of a repeat that was completed.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The prepared path.
    pub path: Prepared,
    /// Accumulated change of the tracked module's heading about the world z axis, radians.
    pub turned_rad: f64,
    /// Root mean square servo error, radians.
    pub servo_rms_rad: f64,
    /// Its energy balance, where the experiment asks for it.
    pub energy: Option<EnergyBalance>,
}

impl Motion {
    /// Distance from first to last point in the plane, metres.
    pub fn net_displacement_m(&self) -> f64 {
        self.path.net_displacement_m()
    }
}

/// One repeat.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// Its number, from 0: with the ensemble's seed it can be replayed.
    pub number: u64,
    /// The random draws.
    pub perturbation: Perturbation,
    /// The motion, or why the repeat diverged.
    pub outcome: Outcome<Motion>,
}

/// Repeats of one experiment under noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    /// How the repeats differ.
    pub noise: Noise,
    /// Parameters that differ from repeat to repeat.
    pub uncertain: UncertainParameters,
    /// Seed of all draws.
    pub seed: u64,
    /// Requested number of repeats; fewer were simulated where the run was stopped.
    pub asked: usize,
    /// The repeats that were simulated, in order of their numbers.
    pub repeats: Vec<Repeat>,
    /// The run without noise: the prediction that a single simulation gives.
    pub noise_free: Outcome<Motion>,
    /// Length of each run, seconds.
    pub duration_s: f64,
    /// Edge length of the tracked module, metres.
    pub body_length_m: f64,
    /// CPU time of all runs.
    pub cpu: Duration,
    /// Engine and its version.
    pub engine: &'static str,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Ensemble {
    /// Whether all requested repeats were simulated.
    pub fn is_complete(&self) -> bool {
        self.repeats.len() == self.asked
    }

    /// The completed repeats, with their motions.
    pub fn motions(&self) -> impl Iterator<Item = (&Repeat, &Motion)> {
        self.repeats
            .iter()
            .filter_map(|repeat| Some((repeat, repeat.outcome.get()?)))
    }
}

/// Simulates `repeats` repeats of `experiment` under `noise`; all have the experiment's parameters.
///
/// The result does not depend on the number of threads. After a request to stop, no further repeat begins, and the finished ones
/// are returned ([`Ensemble::is_complete`]). A perturbation that the experiment already has is replaced by each draw.
///
/// # Errors
/// Noise or settings that cannot be simulated, no repeats at all. Diverged repeats are outcomes, not errors.
pub fn run(
    experiment: &Experiment,
    noise: &Noise,
    seed: u64,
    repeats: usize,
    run: &RunOptions<'_>,
) -> Result<Ensemble> {
    let draws = Draws {
        noise,
        uncertain: &UncertainParameters::default(),
        seed,
        repeats,
        recall: &|_| Ok(None),
    };
    run.install(|| run_each(experiment, &draws, run))?
}

/// How the repeats of an ensemble are drawn.
#[derive(Clone, Copy)]
pub struct Draws<'a> {
    /// How they differ.
    pub noise: &'a Noise,
    /// Parameters that also differ.
    pub uncertain: &'a UncertainParameters,
    /// Seed of all draws.
    pub seed: u64,
    /// How many there are.
    pub repeats: usize,
    /// Gives the runs that are known already.
    pub recall: Recall<'a>,
}

/// As [`run`] on the current rayon pool, with parameters of its own for every repeat. `experiment` is the one without noise.
///
/// # Errors
/// As [`run`], and those of the recall.
pub fn run_each(
    experiment: &Experiment,
    draws: &Draws<'_>,
    run: &RunOptions<'_>,
) -> Result<Ensemble> {
    let Draws {
        noise,
        uncertain,
        seed,
        repeats,
        recall,
    } = *draws;
    noise.check()?;
    must_repeat(repeats)?;
    let intended = Experiment {
        perturbation: Perturbation::default(),
        ..experiment.clone()
    };
    // This run is always simulated, even after a request to stop.
    let intended = realgap_simulation::run(&intended)?;
    let run_warnings = intended.warnings.clone();
    let (noise_free, first_cpu) = outcome(intended)?;
    let done = AtomicUsize::new(0);
    let all: Vec<Option<(Repeat, Duration)>> = (0..repeats as u64)
        .into_par_iter()
        .map(|number| {
            if run.is_stopped() {
                return Ok(None);
            }
            let own = uncertain.apply(experiment, seed, number)?;
            let drawn = noise.perturb(&own, seed, number);
            let simulated = match recall(number as usize)? {
                Some(known) => known,
                None => match unless_stopped(&drawn, run)? {
                    Some(run) => recorded(run, noise, seed, number)?,
                    None => return Ok(None),
                },
            };
            let (outcome, cpu) = outcome(simulated)?;
            run.tell(done.fetch_add(1, Ordering::Relaxed) + 1, repeats, None);
            let repeat = Repeat {
                number,
                perturbation: drawn.perturbation,
                outcome,
            };
            Ok(Some((repeat, cpu)))
        })
        .collect::<Result<_>>()?;
    let cpu = first_cpu + all.iter().flatten().map(|(_, cpu)| *cpu).sum::<Duration>();
    let mut ensemble = Ensemble {
        noise: *noise,
        uncertain: uncertain.clone(),
        seed,
        asked: repeats,
        repeats: all
            .into_iter()
            .flatten()
            .map(|(repeat, _)| repeat)
            .collect(),
        noise_free,
        duration_s: experiment.duration_s,
        body_length_m: experiment.assembly.body_length_m,
        cpu,
        engine: experiment.engine_version(),
        warnings: run_warnings,
    };
    let own = warnings(&ensemble);
    ensemble.warnings.extend(own);
    ensemble.warnings.extend(uncertain.warning());
    Ok(ensemble)
}

/// One run; `None` where the work is stopped before its end.
fn unless_stopped(experiment: &Experiment, run: &RunOptions<'_>) -> Result<Option<Run>> {
    let mut clock = |_| run.go_on();
    let hooks = RunHooks {
        clock: Some(&mut clock),
        ..RunHooks::default()
    };
    match run_with(experiment, hooks) {
        Err(error) if run.is_stopped() && error.kind() == ErrorKind::Interrupted => Ok(None),
        simulated => simulated.map(|(run, _)| Some(run)),
    }
}

/// Refuses an ensemble without repeats.
pub(in crate::prediction) fn must_repeat(repeats: usize) -> Result<()> {
    if repeats > 0 {
        return Ok(());
    }
    Err(Error::invalid("an ensemble needs repeats")
        .field("repeats")
        .found(0)
        .allowed("1 or more"))
}

/// Simulates one repeat of an ensemble in full, as the noise's camera records it: the same run as repeat `number` of [`run`].
///
/// # Errors
/// As [`run`].
pub fn repeat(experiment: &Experiment, noise: &Noise, seed: u64, number: u64) -> Result<Run> {
    noise.check()?;
    let run = realgap_simulation::run(&noise.perturb(experiment, seed, number))?;
    recorded(run, noise, seed, number)
}

/// The run as the camera of the noise records it.
fn recorded(run: Run, noise: &Noise, seed: u64, number: u64) -> Result<Run> {
    let outcome = run
        .outcome
        .try_map(|motion| noise.record(motion, seed, number))?;
    Ok(Run { outcome, ..run })
}

/// A warning where the noise has no camera: repeats without camera noise are nearer to each other than recordings can be.
pub(crate) fn no_camera(noise: &Noise) -> Option<Warning> {
    (noise.camera.is_zero() && !noise.is_zero()).then(|| {
        Code::NoCamera.warning(
            "the noise has no camera, but recordings were seen by one: where repeats differ by less than it does (at first),              regions are too narrow; add e.g. camera: (position_m: Normal(0.001))",
        )
    })
}

fn outcome(run: Run) -> Result<(Outcome<Motion>, Duration)> {
    let outcome = run.outcome.try_map(|motion| {
        Ok(Motion {
            path: prepare(&motion)?,
            turned_rad: motion.turned_rad().unwrap_or(0.0),
            servo_rms_rad: run.servo_rms_rad,
            energy: run.energy,
        })
    })?;
    Ok((outcome, run.cpu))
}

fn warnings(ensemble: &Ensemble) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let count = ensemble.repeats.len();
    let motions = ensemble.motions();
    let mut nets_m = motions.map(|(_, motion)| motion.net_displacement_m());
    let first_m = nets_m.next();
    // Draws of a fit, and simulators with random numbers of their own, differ without any noise.
    let is_one_run = nets_m.all(|net_m| Some(net_m) == first_m);
    if ensemble.noise.is_zero() && is_one_run {
        warnings.push(Code::NoNoise.warning(
            "the noise is zero, so all repeats are the same run: nothing follows from this about how sure the prediction is",
        ));
    }
    if !ensemble.is_complete() {
        warnings.push(Code::Incomplete.warning(format!(
            "stopped after {count} of {} repeats",
            ensemble.asked
        )));
    } else if count < FEW_REPEATS {
        warnings.push(Code::FewRepeats.warning(format!(
            "{count} repeats say little about tails and rare behaviours; {FEW_REPEATS} are the least, 200 are usual"
        )));
    }
    let diverged = count - ensemble.motions().count();
    if diverged > 0 {
        warnings.push(Code::Diverged.warning(format!(
            "{diverged} of {count} repeats diverged; they count as failures and are in no other number"
        )));
    }
    if let Some(divergence) = ensemble.noise_free.divergence() {
        warnings
            .push(Code::Diverged.warning(format!("the run without noise diverged {divergence}")));
    }
    warnings
}
