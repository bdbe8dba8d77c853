//! Odds of resting poses: the probability of each pose in which a toss can end and of the place where it ends, and whether these
//! probabilities are calibrated.
//!
//! Every recording that ends at rest is simulated many times: starts and frictions are drawn from the noise, timesteps and
//! substeps are as valid as the study's own. The share of the runs that end in a pose is its probability.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::fmt;

use serde::Serialize;

use super::UncertainParameters;
use super::ensemble::{LEVELS, Region};
use crate::calibration::Study;
use realgap_core::statistics::{
    Proportion, ReliabilityBin, brier, mean, mean_of, mean_of_any, percentile_interval,
    reliability, resamples,
};
use realgap_core::{Code, Error, Result, Warning};
use realgap_identification::face_down;
use realgap_optimization::RunOptions;
use realgap_path::comparison::{PoseErrors, pose_errors};
use realgap_path::trajectory::Trajectory;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Experiment, Noise};

/// Faces of a cube that may be down.
const FACES: usize = 6;
/// Positions of a hinge: quarter turns.
const QUARTERS: usize = 4;
/// Bootstrap resamples of an interval.
const RESAMPLES: usize = 2000;
const INTERVAL_LEVEL: f64 = 0.95;

/// Options of the computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OddsOptions {
    /// Noise of the runs of one recording, beside their numerical settings.
    pub noise: Noise,
    /// Runs of every recording.
    pub runs: usize,
    /// Seed of all draws.
    pub seed: u64,
}

/// A mean over recordings with its 95 % bootstrap interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scored {
    /// The mean.
    pub mean: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// The odds of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingOdds {
    /// Name of the recording.
    pub recording: String,
    /// The pose that it ended in.
    pub real: String,
    /// The pose of the run without noise; `None` where that diverged.
    pub one_run: Option<String>,
    /// Probability of every pose that a run ended in, and of the real one.
    pub probabilities: BTreeMap<String, f64>,
    /// Brier score of these probabilities, summed over poses.
    pub brier: f64,
    /// Whether the real end lies in the regions of 50, 80 and 90 % of the runs' ends.
    pub end_inside: [bool; LEVELS.len()],
}

/// Errors of the runs against their recordings: means over the runs of a recording, then over recordings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunErrors {
    /// Position, percent of the body length, mean over the samples.
    pub position_percent: Scored,
    /// Rotation, degrees, mean over the samples.
    pub rotation_deg: Scored,
    /// Joints, degrees, mean over the samples; missing without joints.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hinge_deg: Option<Scored>,
}

/// How often the real end lies in a region of the ends of the runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EndCoverage {
    /// Stated probability of the region.
    pub level: f64,
    /// Share of the real ends that the region holds.
    pub observed: Proportion,
}

/// The odds of all recordings that end at rest, with their scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Odds {
    /// Recordings that end at rest.
    pub recordings: usize,
    /// Runs of each.
    pub runs: usize,
    /// Runs that diverged; they have no end.
    pub diverged: usize,
    /// Brier score, summed over poses (0 to 2), mean over recordings.
    pub brier: Scored,
    /// Brier score of one run without noise, which is certain of its end.
    pub brier_one_run: Scored,
    /// Mean logarithm of the probability of what happened; it would be 0 for certain and right predictions.
    pub log_score: f64,
    /// Mean errors of the runs; a single run may be near by chance.
    pub run_errors: Option<RunErrors>,
    /// How often regions of the ends' places in the plane hold the real end.
    pub end_coverage: [EndCoverage; LEVELS.len()],
    /// Predicted probabilities, and how often the predicted pose occurred.
    pub reliability: Vec<ReliabilityBin>,
    /// How the runs differ: fields of the noise that are not zero.
    pub noise: Noise,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
    /// One row a recording.
    pub rows: Vec<RecordingOdds>,
}

/// Where one run, or the recording, ends.
struct End {
    pose: String,
    place_m: [f64; 2],
}

impl End {
    /// The end of a motion; `None` without orientations.
    fn of(motion: &Trajectory, experiment: &Experiment) -> Option<Self> {
        let turned = motion.orientations_world_from_body()?.last()?;
        let place_m = motion.positions_world_m().last()?;
        let mut pose = face_down(turned, &experiment.floor.normal_world())
            .name()
            .to_owned();
        for joint in motion.joints() {
            let quarters = (joint.angles_rad.last()? / FRAC_PI_2).round() as i64;
            pose += &format!(" {} {}/4", joint.name, quarters.rem_euclid(QUARTERS as i64));
        }
        Some(Self {
            pose,
            place_m: [place_m.x, place_m.y],
        })
    }
}

/// Probability of a pose that occurred `count` times in `runs` runs, of `poses` possible poses. One run is added and spread
/// evenly over the poses, so that a pose that never occurred is unlikely but not impossible.
fn probability(count: usize, runs: usize, poses: usize) -> f64 {
    (count as f64 + 1.0 / poses as f64) / (runs as f64 + 1.0)
}

impl Odds {
    /// The odds of every recording of a study that ends at rest, with the study's fixed values and then `set`.
    ///
    /// # Errors
    /// A study whose runs do not start from recordings, no recording that ends at rest, no run at all, or the run was stopped.
    pub fn new(
        study: &Study,
        set: &ParameterSet,
        options: &OddsOptions,
        run: &RunOptions<'_>,
    ) -> Result<Self> {
        let definition = study.definition();
        let at_rest = definition.at_rest()?;
        if options.runs == 0 {
            return Err(Error::invalid("odds need runs").field("runs").found(0));
        }
        options.noise.check()?;
        let cases = 0..study.cases().len();
        let resting: Vec<usize> = cases
            .filter(|case| at_rest.contains(&study.cases()[*case].targets[0].recording))
            .collect();
        let found = run.each(resting.len(), |index| {
            odds_of(study, resting[index], set, options)
        })?;
        let drawn = UncertainParameters::of_draws(&definition.draws).warning();
        let warnings = study.warnings().iter().cloned().chain(drawn);
        Ok(Self::over(found, options, warnings.collect()))
    }

    fn over(found: Vec<Found>, options: &OddsOptions, mut warnings: Vec<Warning>) -> Self {
        let diverged: usize = found.iter().map(|found| found.diverged).sum();
        if diverged > 0 {
            warnings.push(Code::Diverged.warning(format!(
                "{diverged} runs diverged; they have no end and are left out"
            )));
        }
        let scored = |values: Vec<f64>| {
            let again = resamples(values.len(), RESAMPLES, options.seed);
            let means: Vec<f64> = again.iter().map(|sample| sample.mean(&values)).collect();
            let all = mean(&values);
            let (low, high) =
                percentile_interval(&means, 0.5 * (1.0 - INTERVAL_LEVEL)).unwrap_or((all, all));
            Scored {
                mean: all,
                low,
                high,
            }
        };
        let one_run = |row: &RecordingOdds| match row.one_run.as_ref() == Some(&row.real) {
            true => 0.0,
            false => 2.0,
        };
        let forecasts: Vec<(f64, bool)> = found.iter().flat_map(Found::forecasts).collect();
        let log_score = mean_of(found.iter().map(Found::log_probability));
        let run_errors = RunErrors::over(&found, &scored);
        let rows: Vec<RecordingOdds> = found.into_iter().map(|found| found.row).collect();
        let end_coverage = std::array::from_fn(|level| EndCoverage {
            level: LEVELS[level],
            observed: Proportion::of(rows.iter().map(|row| row.end_inside[level]), INTERVAL_LEVEL),
        });
        Self {
            recordings: rows.len(),
            runs: options.runs,
            diverged,
            brier: scored(rows.iter().map(|row| row.brier).collect()),
            brier_one_run: scored(rows.iter().map(one_run).collect()),
            log_score,
            run_errors,
            end_coverage,
            reliability: reliability(&forecasts),
            noise: options.noise,
            warnings,
            rows,
        }
    }
}

impl RunErrors {
    /// The mean errors; `None` where no run has an end.
    fn over(found: &[Found], scored: &impl Fn(Vec<f64>) -> Scored) -> Option<Self> {
        let over_runs = |of: &dyn Fn(&PoseErrors) -> Option<f64>| {
            let each = found.iter();
            let known = each.filter_map(|found| mean_of_any(found.errors.iter().filter_map(of)));
            let known: Vec<f64> = known.collect();
            (!known.is_empty()).then(|| scored(known))
        };
        Some(Self {
            position_percent: over_runs(&|e| Some(100.0 * e.position_fraction_mean))?,
            rotation_deg: over_runs(&|e| Some(e.rotation_rad_mean.to_degrees()))?,
            hinge_deg: over_runs(&|e| e.joint_rad_mean.map(f64::to_degrees)),
        })
    }
}

/// The odds of one recording, with the data that are needed to score them.
struct Found {
    row: RecordingOdds,
    diverged: usize,
    /// Errors of each run.
    errors: Vec<PoseErrors>,
    /// Number of possible poses.
    poses: usize,
    /// Probability of each pose that has no entry in the row.
    rest: f64,
}

impl Found {
    fn log_probability(&self) -> f64 {
        libm::log(self.row.probabilities[&self.row.real])
    }

    fn forecasts(&self) -> Vec<(f64, bool)> {
        let named = self.row.probabilities.iter();
        let mut all: Vec<(f64, bool)> = named
            .map(|(pose, probability)| (*probability, *pose == self.row.real))
            .collect();
        all.resize(self.poses, (self.rest, false));
        all
    }
}

fn odds_of(study: &Study, case: usize, set: &ParameterSet, options: &OddsOptions) -> Result<Found> {
    let experiment = study.experiment_with(case, set)?;
    let target = &study.cases()[case].targets[0];
    let target = target.in_true_lengths(experiment.recording_length_scale)?;
    let recording = &study.definition().recordings[target.recording];
    let faceless = || {
        Error::invalid("a recording without orientations has no pose that it ends in")
            .at_file(&recording.path)
    };
    let real = End::of(&target.motion, &experiment).ok_or_else(faceless)?;
    let body_length_m = experiment.assembly.body_length_m;
    let simulated = |experiment: &Experiment| -> Result<Option<Trajectory>> {
        Ok(realgap_simulation::run(experiment)?.outcome.completed())
    };
    let one_run = simulated(&experiment)?.and_then(|motion| End::of(&motion, &experiment));
    let (mut ends, mut errors) = (Vec::with_capacity(options.runs), Vec::new());
    let uncertain = UncertainParameters::of_draws(&study.definition().draws);
    for number in 0..options.runs as u64 {
        // Every recording has random draws of its own, because otherwise the deviations of all recordings would be the same.
        let draw = number + case as u64 * (1 << 32);
        let own = uncertain.apply(&experiment, options.seed, number)?;
        let other = options.noise.perturb(&own, options.seed, draw);
        let other = other.with_numerics(number);
        if let Some(motion) = simulated(&other)? {
            let off = pose_errors(&target.motion, &motion, body_length_m);
            errors.push(off.map_err(|e| e.at_file(&recording.path))?);
            ends.extend(End::of(&motion, &other));
        }
    }
    let joints = target.motion.joints().len() as u32;
    let poses = FACES * QUARTERS.pow(joints);
    let count = |pose: &str| ends.iter().filter(|end| end.pose == pose).count();
    let probabilities: BTreeMap<String, f64> = ends
        .iter()
        .map(|end| &end.pose)
        .chain([&real.pose])
        .map(|pose| (pose.clone(), probability(count(pose), ends.len(), poses)))
        .collect();
    let rest = probability(0, ends.len(), poses);
    let places_m: Vec<[f64; 2]> = ends.iter().map(|end| end.place_m).collect();
    let end_inside = if places_m.is_empty() {
        [false; LEVELS.len()]
    } else {
        let region = Region::of_places(&places_m, body_length_m);
        std::array::from_fn(|level| region.contains(level, real.place_m))
    };
    let mut found = Found {
        diverged: options.runs - ends.len(),
        errors,
        poses,
        rest,
        row: RecordingOdds {
            recording: recording.name.clone(),
            one_run: one_run.map(|end| end.pose),
            real: real.pose,
            probabilities,
            brier: 0.0,
            end_inside,
        },
    };
    let forecasts = found.forecasts();
    let happened = forecasts.iter().position(|forecast| forecast.1);
    let given: Vec<f64> = forecasts.iter().map(|forecast| forecast.0).collect();
    found.row.brier = brier(&given, happened.unwrap_or(given.len()));
    Ok(found)
}

impl fmt::Display for Odds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scored = |s: &Scored| format!("{:.3} ({:.3} to {:.3})", s.mean, s.low, s.high);
        write!(
            f,
            "odds: {} recordings that end at rest, {} runs each\n  Brier score       {}, summed over poses; one run without noise {}\n  log score         {:.3}",
            self.recordings,
            self.runs,
            scored(&self.brier),
            scored(&self.brier_one_run),
            self.log_score
        )?;
        if let Some(off) = &self.run_errors {
            let within = |s: &Scored, unit: &str| {
                format!("{:.1}{unit} ({:.1} to {:.1})", s.mean, s.low, s.high)
            };
            write!(
                f,
                "\n  a run is off by    {}, {}",
                within(&off.position_percent, " % of the body"),
                within(&off.rotation_deg, " deg")
            )?;
            if let Some(hinge) = &off.hinge_deg {
                write!(f, ", joints {}", within(hinge, " deg"))?;
            }
            write!(f, ", mean over the runs")?;
        }
        for coverage in &self.end_coverage {
            let Proportion {
                share, low, high, ..
            } = coverage.observed;
            write!(
                f,
                "\n  {:.0} % region of the end holds {:.1} % ({:.1} to {:.1})",
                100.0 * coverage.level,
                100.0 * share,
                100.0 * low,
                100.0 * high
            )?;
        }
        for bin in &self.reliability {
            write!(
                f,
                "\n  given {:>5.1} %: happened {:.1} % ({:.1} to {:.1}) of {}",
                100.0 * bin.probability,
                100.0 * bin.observed.share,
                100.0 * bin.observed.low,
                100.0 * bin.observed.high,
                bin.observed.trials
            )?;
        }
        Ok(())
    }
}
