//! The gap of a study: its simulations, with and without noise, against its recordings.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::{CaseRuns, Confidence, Fitness, MetricGap, OverTime, Sample, Scoring, distances};
use crate::calibration::{Study, by_name};
use crate::claim::{self, Claim};
use crate::prediction::UncertainParameters;
use crate::prediction::ensemble::{self, Recall};
use crate::prediction::kept::{row_of, runs_in};
use realgap_core::statistics::ends_of;
use realgap_core::{Code, Error, Result, Warning};
use realgap_optimization::{Batch, Ending, RunOptions, drive};
use realgap_path::comparison::{self, Metric};
use realgap_path::trajectory::Source;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Experiment, Noise, Run};
use realgap_store::{Fingerprint, RunRow, Storage};

/// Options of a gap: metrics, noise and repeats.
#[derive(Debug, Clone)]
pub struct GapOptions {
    /// The metrics.
    pub metrics: Vec<&'static dyn Metric>,
    /// Noise of the repeats; with `None` or zero noise there is no ensemble and so no confidence.
    pub noise: Option<Noise>,
    /// Repeats under noise of each start.
    pub repeats: usize,
    /// Seed of noise and permutations.
    pub seed: u64,
}

/// The distance of a study's simulation to its recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudyGap {
    /// Name of the study.
    pub study: String,
    /// Name of the robot.
    pub morphology: String,
    /// Fixed values of the simulation.
    pub parameters: BTreeMap<String, f64>,
    /// Whether all requested runs are part of these numbers.
    pub complete: bool,
    /// Number of recordings.
    pub recordings: usize,
    /// Where they come from.
    pub source: Source,
    /// Starts that were simulated: 1 where the recordings share it.
    pub starts: usize,
    /// Repeats under noise of each start; 0 without an ensemble.
    pub repeats: usize,
    /// Seed of noise and permutations.
    pub seed: u64,
    /// Noise floor, gap and ratio by metric.
    pub metrics: Vec<MetricGap>,
    /// Net displacement of the robot, real and simulated.
    pub displacement: Option<Fitness>,
    /// Errors over time.
    pub over_time: OverTime,
    /// Simulation confidence over time; `None` without an ensemble.
    pub confidence: Option<Confidence>,
    /// Every claim about reality, the most important first.
    pub claims: Vec<Claim>,
    /// How repeats differ.
    pub noise: Option<Noise>,
    /// Engine and its version.
    pub engine: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
    /// How many of the recordings the values were fitted on; `None` where no fit is known.
    #[serde(skip)]
    pub seen_by_fit: Option<usize>,
}

/// The metric of the claim whether repeats and recordings have the same distribution.
const LIKENESS: &str = "rms";

impl GapOptions {
    /// The study's own metric, and two that are easy to understand; the study's noise and seed; 200 repeats.
    ///
    /// # Errors
    /// None: the metrics are known.
    pub fn of(study: &Study) -> Result<Self> {
        let definition = study.definition();
        let mut metrics = vec![definition.metric];
        for name in ["rms", "displacement"] {
            let metric = comparison::by_name(name)?;
            if metrics.iter().all(|known| known.name() != name) {
                metrics.push(metric);
            }
        }
        Ok(Self {
            metrics,
            noise: definition.noise,
            repeats: 200,
            seed: definition.seed,
        })
    }
}

impl StudyGap {
    /// Simulates a study's starts, without noise and under it, and compares the runs with its recordings. Repeat k is repeat k of
    /// an [ensemble](crate::prediction::ensemble::run()). After a request to stop, no further repeat begins; finished ones are
    /// reported as incomplete.
    ///
    /// # Errors
    /// Every run diverged, a metric that cannot compare the runs, or no requested repeats.
    pub fn new(study: &Study, options: &GapOptions, run: &RunOptions<'_>) -> Result<Self> {
        run.install(|| study_gap(study, options, &|_| Ok(None), run))?
    }

    /// As [`StudyGap::new`], from runs that several workers have simulated ([`StudyGap::part`]); runs that the store does not
    /// have are simulated.
    ///
    /// # Errors
    /// As [`StudyGap::new`]; a store that cannot be read, or that holds other runs.
    pub fn of_store(
        study: &Study,
        options: &GapOptions,
        folder: &Path,
        run: &RunOptions<'_>,
    ) -> Result<Self> {
        let known = runs_in(folder, &Self::fingerprint(study, options))?;
        run.install(|| study_gap(study, options, &known, run))?
    }

    /// The gap with the claims that follow from its numbers. The claim about the distribution is by the metric `rms`, where that
    /// is among the metrics, as for an ensemble.
    #[must_use]
    pub fn with_claims(mut self) -> Self {
        let seen = (self.source, self.recordings);
        let rows = || self.metrics.iter();
        let tested = rows().find(|row| row.metric == LIKENESS).or(rows().next());
        let alike = tested.and_then(|row| Some(claim::likeness(row.metric, &row.alike?, seen)));
        let told = claim::told(&self.metrics);
        let distance = told.and_then(|row| claim::distance(row, seen));
        let over_time = self.confidence.as_ref().map(claim::over_time);
        let reality = (claim::called(self.source), self.recordings);
        let gap = told.and_then(|row| claim::measured(row, reality));
        let values = claim::values(&self.parameters, self.seen_by_fit, self.recordings);
        let trust = claim::trust_of(&self.comparison(alike.as_ref(), over_time.as_ref()));
        let verdict = gap.into_iter().chain([values, trust]);
        let evidence = [alike, distance, over_time].into_iter().flatten();
        self.claims = verdict.chain(evidence).collect();
        self
    }

    /// What the claims about distribution and regions say on whether to trust the simulation.
    fn comparison(&self, alike: Option<&Claim>, over_time: Option<&Claim>) -> claim::Comparison {
        let (against, passed) = claim::tests(alike, over_time, claim::called(self.source));
        let is_enough = self.recordings >= claim::FEW && !passed.is_empty();
        let would_tell = match self.repeats {
            0 => "nothing says how repeats of a run differ; state `noise` in the study",
            _ => "there are too few recordings; record the same run again, at least five times",
        };
        claim::Comparison {
            complete: self.complete,
            against,
            tested: is_enough.then(|| passed.join(", and ")),
            would_tell: would_tell.to_owned(),
            seen_by_fit: self.seen_by_fit,
            recordings: self.recordings,
        }
    }

    /// Everything that decides the runs.
    pub fn fingerprint(study: &Study, options: &GapOptions) -> Fingerprint {
        let definition = study.definition();
        definition
            .with_draws(study.fingerprint())
            .with("noise", format!("{:?}", options.noise))
            .with("repeats", options.repeats)
            .with("seed of the noise", options.seed)
    }

    /// Number of requested runs: without noise and under it, of every start.
    pub fn runs(study: &Study, options: &GapOptions) -> usize {
        study.cases().len() * runs_a_start(options)
    }

    /// Simulates one worker's share of the runs.
    ///
    /// # Errors
    /// As [`StudyGap::new`]; a full disk.
    pub fn part(
        study: &Study,
        options: &GapOptions,
        part: &mut impl Storage<RunRow>,
        run: &RunOptions<'_>,
    ) -> Result<Ending> {
        let total = Self::runs(study, options);
        let batch = Batch::new(total, run);
        let make = |index| Self::simulate(study, options, index);
        drive(&batch, part, make, |done| run.tell(done, total, None))
    }

    /// One run, counted over all starts.
    ///
    /// # Errors
    /// As [`StudyGap::new`].
    pub fn simulate(study: &Study, options: &GapOptions, index: usize) -> Result<RunRow> {
        let runs = runs_a_start(options);
        let experiment = study.experiment_with(index / runs, &ParameterSet::new())?;
        let noise = usable_noise(options.noise, &mut Vec::new())?;
        let draws = (noise, options.seed, (index % runs) as u64);
        row_of(index, &one(study, &experiment, draws)?)
    }
}

/// Runs of every start; number 0 is the run without noise.
fn runs_a_start(options: &GapOptions) -> usize {
    match options.noise {
        Some(noise) if !noise.is_zero() => options.repeats + 1,
        _ => 1,
    }
}

/// Run number `number` of a start.
fn one(
    study: &Study,
    experiment: &Experiment,
    (noise, seed, number): (Option<Noise>, u64, u64),
) -> Result<Run> {
    match (number.checked_sub(1), &noise) {
        (Some(repeat), Some(noise)) => {
            let uncertain = UncertainParameters::of_draws(&study.definition().draws);
            let own = uncertain.apply(experiment, seed, repeat)?;
            ensemble::repeat(&own, noise, seed, repeat)
        }
        _ => realgap_simulation::run(experiment),
    }
}

fn study_gap(
    study: &Study,
    options: &GapOptions,
    recall: Recall<'_>,
    run: &RunOptions<'_>,
) -> Result<StudyGap> {
    let definition = study.definition();
    ensemble::must_repeat(options.repeats)?;
    let mut warnings = study.warnings().to_vec();
    let noise = usable_noise(options.noise, &mut warnings)?;
    let uncertain = UncertainParameters::of_draws(&definition.draws);
    warnings.extend(noise.and_then(|_| uncertain.warning()));
    let repeats = noise.map_or(0, |_| options.repeats);
    let total = study.cases().len() * (repeats + 1);
    let Simulated {
        real,
        cases,
        begun,
        diverged,
    } = simulated(study, options, noise, recall, run)?;
    if diverged == begun {
        return Err(
            definition.at_file(Error::invalid("every run diverged").hint(
                "simulate the robot alone first, then try a shorter timestep or more substeps",
            )),
        );
    }
    if diverged > 0 {
        warnings.push(Code::Diverged.warning(format!(
            "{diverged} of {begun} runs diverged; they are in no number here"
        )));
    }
    if begun < total {
        warnings.push(Code::Incomplete.warning(format!("stopped after {begun} of {total} runs")));
    }
    warnings.extend(different_durations(&real));
    let body_length_m = definition.morphology.assemble().body_length_m;
    let scoring = Scoring {
        metrics: options.metrics.clone(),
        components: definition.components,
        body_length_m: Some(body_length_m),
        channels: Some(definition.channels.clone()),
        seed: options.seed,
    };
    let found = distances(&real, &cases, &scoring)?;
    warnings.extend(found.warnings);
    warnings.sort();
    warnings.dedup();
    let found = StudyGap {
        study: definition.name.clone(),
        morphology: definition.morphology.name().to_owned(),
        parameters: by_name(&definition.set),
        complete: begun == total,
        recordings: real.len(),
        source: definition.source(),
        starts: cases.len(),
        repeats,
        seed: options.seed,
        metrics: found.metrics,
        displacement: Fitness::new(&real, &cases)?,
        over_time: OverTime::new(&real, &cases),
        confidence: Confidence::new(&real, &cases, body_length_m)?,
        claims: Vec::new(),
        noise,
        engine: study.cases()[0].experiment.engine_version(),
        version: env!("CARGO_PKG_VERSION"),
        warnings,
        seen_by_fit: definition.seen_by_fit,
    };
    Ok(found.with_claims())
}

/// The runs of a study that were begun.
struct Simulated {
    real: Vec<Sample>,
    cases: Vec<CaseRuns>,
    begun: usize,
    diverged: usize,
}

fn simulated(
    study: &Study,
    options: &GapOptions,
    noise: Option<Noise>,
    recall: Recall<'_>,
    run: &RunOptions<'_>,
) -> Result<Simulated> {
    let repeats = noise.map_or(0, |_| options.repeats);
    let mut real: Vec<Option<Sample>> = vec![None; study.definition().recordings.len()];
    let mut cases = Vec::new();
    let total = study.cases().len() * (repeats + 1);
    let done = AtomicUsize::new(0);
    let (mut begun, mut diverged) = (0, 0);
    for (index, case) in study.cases().iter().enumerate() {
        let experiment = study.experiment_with(index, &ParameterSet::new())?;
        for target in &case.targets {
            let there = target.in_true_lengths(experiment.recording_length_scale)?;
            real[target.recording] = Some(Sample {
                name: study.definition().recordings[target.recording].name.clone(),
                motion: there.motion.clone(),
                prepared: there.prepared.clone(),
            });
        }
        // Number 0 is the run without noise. After a request to stop no further run begins, but the first one is always
        // simulated, because it alone has a result.
        let runs: Vec<Option<Option<Sample>>> = (0..=repeats as u64)
            .into_par_iter()
            .map(|number| {
                if run.is_stopped() && (index, number) != (0, 0) {
                    return Ok(None);
                }
                let simulated = match recall(index * (repeats + 1) + number as usize)? {
                    Some(run) => run,
                    None => one(study, &experiment, (noise, options.seed, number))?,
                };
                run.tell(done.fetch_add(1, Ordering::Relaxed) + 1, total, None);
                completed(study, simulated, number).map(Some)
            })
            .collect::<Result<_>>()?;
        let begun_here = runs.iter().flatten().count();
        if begun_here == 0 {
            for target in &case.targets {
                real[target.recording] = None;
            }
            break;
        }
        begun += begun_here;
        let mut runs = runs.into_iter();
        let ideal = runs.next().flatten().flatten();
        let ended: Vec<Sample> = runs.flatten().flatten().collect();
        diverged += begun_here - ended.len() - usize::from(ideal.is_some());
        cases.push(CaseRuns {
            recordings: case.targets.iter().map(|t| t.recording).collect(),
            ideal,
            repeats: ended,
        });
    }
    Ok(Simulated {
        real: real.into_iter().flatten().collect(),
        cases,
        begun,
        diverged,
    })
}

fn usable_noise(noise: Option<Noise>, warnings: &mut Vec<Warning>) -> Result<Option<Noise>> {
    let message = match noise {
        None => {
            "the study does not say how repeats differ: there is no ensemble, and no simulation confidence"
        }
        Some(noise) if noise.is_zero() => {
            "the noise is zero, so that all repeats are the same run: there is no ensemble, and no simulation confidence"
        }
        Some(noise) => {
            noise.check()?;
            warnings.extend(ensemble::no_camera(&noise));
            return Ok(Some(noise));
        }
    };
    warnings.push(Code::NoNoise.warning(message));
    Ok(None)
}

fn completed(study: &Study, run: Run, number: u64) -> Result<Option<Sample>> {
    let name = match number.checked_sub(1) {
        Some(repeat) => format!("repeat {repeat}"),
        None => "without noise".to_owned(),
    };
    let motion = run.outcome.completed();
    let Some(motion) = motion else {
        return Ok(None);
    };
    Ok(Some(Sample {
        name,
        prepared: study.prepared(&motion)?,
        motion,
    }))
}

/// A warning for runs of different lengths, for which an axis of seconds means little.
fn different_durations(real: &[Sample]) -> Option<Warning> {
    let (shortest_s, longest_s) = ends_of(real.iter().map(|run| run.motion.duration_s()));
    (longest_s > 1.01 * shortest_s).then(|| {
        Code::DifferentDurations.warning(format!(
            "recordings last {shortest_s:.2} to {longest_s:.2} s: curves over time are over the share of each run, drawn in seconds of the mean one"
        ))
    })
}
