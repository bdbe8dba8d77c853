//! Reproduction: in how many robots of a study of many the shared answer does what was recorded. The categories are those of
//! paper 003, with robots in place of trials.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::calibration::numerics::setting::Setting;
use crate::calibration::{Member, Scores, Study};
use crate::prediction::ensemble::cut_m;
use realgap_core::Result;
use realgap_core::statistics::{
    Proportion, ends_of, mean, mean_of_any, median, standard_deviation,
};
use realgap_core::unit::counted;
use realgap_optimization::{RunOptions, Step};
use realgap_path::comparison::{Context, METRICS, Metric, Needs, Pair, Rms};
use realgap_path::trajectory::{Prepared, Trajectory};
use realgap_simulation::Experiment;

/// How the runs of one robot at the shared answer compare with its recordings; the first category that applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Likeness {
    /// Its runs are as near to its recordings as these are to one another.
    WithinFloor,
    /// Its runs are nearer than two behaviours of an ensemble are to one another.
    Alike,
    /// Its runs go nowhere.
    GoesNowhere,
    /// Its runs take another path.
    OtherPath,
}

/// How the shared answer reproduces all robots, each simulated once with every equally valid setting. The shares are of all
/// robots, with 95 % Wilson intervals; distances are those of the metric `rms`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reproduction {
    /// Runs of each robot.
    pub runs: usize,
    /// Robots whose runs are, on average, as near to their recordings as two of these are to one another: the noise floor.
    pub within_floor: Proportion,
    /// Robots beyond their floor that are nearer than half a body length, or than a quarter of the recorded net displacement where
    /// that is more.
    pub alike: Proportion,
    /// Robots beyond both whose median run ends less than half a body length, or than a tenth of its path, from where it began.
    pub goes_nowhere: Proportion,
    /// All others.
    pub other_path: Proportion,
    /// How many robots are within their noise floor when other metrics measure both.
    pub metrics: Vec<MetricFloors>,
    /// Robots whose mean recorded net displacement lies between the least and the largest of their runs'; `None` for one run.
    pub displacement_held: Option<Proportion>,
    /// The least expected share of such robots, if the recordings were further runs.
    pub displacement_promise: f64,
    /// The robots, in the order of the study.
    pub robots: Vec<RobotReproduction>,
}

/// How many robots are within their noise floor by one metric.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MetricFloors {
    /// Name of the metric.
    pub metric: String,
    /// Robots whose runs are within the noise floor, of those that have one.
    pub within_floor: Proportion,
    /// Median over these robots of the distance in noise floors; `None` where no robot has one.
    pub median_noise_floors: Option<f64>,
}

/// How the shared answer reproduces one robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotReproduction {
    /// Its name.
    pub robot: String,
    /// Its category.
    pub likeness: Likeness,
    /// Mean distance of its runs to its recordings, metres.
    pub distance_m: f64,
    /// Mean distance of its recordings to one another, metres; `None` where no two share a start.
    pub floor_m: Option<f64>,
    /// The distance below which a run counts as alike, metres.
    pub alike_m: f64,
    /// Mean net displacement of its recordings, metres.
    pub recorded_m: f64,
    /// Their standard deviation, metres; 0 for one.
    pub recorded_sd_m: f64,
    /// Mean net displacement of its runs, metres.
    pub simulated_m: f64,
    /// Their standard deviation, metres; 0 for one.
    pub simulated_sd_m: f64,
    /// Whether the mean recorded net displacement lies between the least and the largest of its runs'.
    pub held: bool,
}

/// Confidence level of the shares' intervals.
const INTERVAL: f64 = 0.95;
/// A run goes nowhere where it ends less than this share of the body length from where it began, or
const NOWHERE_BODY_LENGTHS: f64 = 0.5;
/// less than this share of its path.
const NOWHERE_PATHS: f64 = 0.1;

impl Reproduction {
    /// Simulates the best point with all settings, every robot for itself; `None` for a study of one robot, where nothing has a score,
    /// and for recordings of joints alone, which have no path.
    ///
    /// # Errors
    /// As [`Study::simulate`].
    pub(in crate::calibration) fn new(
        (study, run): (&Study, &RunOptions<'_>),
        scores: &Scores,
    ) -> Result<Option<Self>> {
        let definition = study.definition();
        let Some(best) = scores.best.map(|best| &scores.points[best]) else {
            return Ok(None);
        };
        if definition.robots.len() < 2 || definition.metric.needs().joints {
            return Ok(None);
        }
        let mut robots = Vec::new();
        let runs = study.cases().len() * study.settings().count;
        let step = run.step("running the answer on every robot", runs);
        for member in &definition.robots {
            robots.extend(Seen::new((study, &step), member, &best.values)?);
        }
        Ok((!robots.is_empty()).then(|| Self::of(&robots, study.settings().count)))
    }

    fn of(seen: &[Seen], runs: usize) -> Self {
        let robots: Vec<RobotReproduction> = seen.iter().map(Seen::told).collect();
        let share = |is: &dyn Fn(&RobotReproduction) -> bool| {
            Proportion::of(robots.iter().map(is), INTERVAL)
        };
        let like = |likeness| share(&|robot| robot.likeness == likeness);
        let metrics = (0..seen[0].distances.len()).map(|metric| {
            let floors = seen.iter().filter_map(|robot| robot.noise_floors(metric));
            let floors: Vec<f64> = floors.collect();

            MetricFloors {
                metric: seen[0].distances[metric].metric.name().to_owned(),
                within_floor: Proportion::of(floors.iter().map(|f| *f <= 1.0), INTERVAL),
                median_noise_floors: (!floors.is_empty()).then(|| median(&floors)),
            }
        });
        Self {
            runs,
            within_floor: like(Likeness::WithinFloor),
            alike: like(Likeness::Alike),
            goes_nowhere: like(Likeness::GoesNowhere),
            other_path: like(Likeness::OtherPath),
            metrics: metrics.collect(),
            displacement_held: (runs > 1).then(|| share(&|robot| robot.held)),
            displacement_promise: (runs as f64 - 1.0) / (runs as f64 + 1.0),
            robots,
        }
    }
}

impl fmt::Display for Reproduction {
    /// Writes the shares of robots in each category, and the results of other metrics.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |of: &Proportion| {
            let [share, low, high] = [of.share, of.low, of.high].map(|part| 100.0 * part);
            format!(
                "{} of {} ({share:.0} %, 95 %: {low:.0} to {high:.0})",
                of.count, of.trials
            )
        };
        write!(
            f,
            "paths at the shared answer, {} a robot: {} within the robot's noise floor, {} within half a body length or a quarter of the way, {} go nowhere, {} another way",
            counted(self.runs, "run"),
            share(&self.within_floor),
            share(&self.alike),
            share(&self.goes_nowhere),
            share(&self.other_path),
        )?;
        let metrics = self.metrics.iter().map(|of| {
            let within = &of.within_floor;
            format!("{} {} of {}", of.metric, within.count, within.trials)
        });
        let metrics: Vec<String> = metrics.collect();
        write!(f, "\n  within the noise floor by {}", metrics.join(", "))?;
        if let Some(held) = &self.displacement_held {
            write!(
                f,
                "\n  mean recorded displacement among those of the runs: {}; at least {:.0} % if recordings were runs",
                share(held),
                100.0 * self.displacement_promise
            )?;
        }
        Ok(())
    }
}

/// Distances of one robot by one metric.
struct Distances {
    metric: &'static dyn Metric,
    /// Of every run to every recording of its start.
    runs: Vec<f64>,
    /// Of every two recordings of one start.
    recordings: Vec<f64>,
}

/// A motion in the form that metrics need.
struct Moved {
    motion: Trajectory,
    prepared: Prepared,
}

/// One robot's runs at the shared answer beside its recordings.
struct Seen {
    robot: String,
    body_length_m: f64,
    distances: Vec<Distances>,
    recorded_m: Vec<f64>,
    /// Net displacements of its runs and the lengths of their paths, metres.
    simulated_m: Vec<(f64, f64)>,
}

impl Seen {
    /// `None` where every run diverged.
    fn new(
        (study, step): (&Study, &Step<'_>),
        member: &Member,
        values: &[f64],
    ) -> Result<Option<Self>> {
        let metrics = METRICS.iter().filter(|m| m.needs() == Needs::POINTS);
        let mut seen = Self {
            robot: member.morphology.name().to_owned(),
            body_length_m: 0.0,
            distances: metrics.copied().map(Distances::of).collect(),
            recorded_m: Vec::new(),
            simulated_m: Vec::new(),
        };
        for (index, case) in study.cases().iter().enumerate() {
            if member.recordings.contains(&case.targets[0].recording) {
                seen.add((study, step), index, values)?;
            }
        }
        Ok((!seen.simulated_m.is_empty()).then_some(seen))
    }

    /// Simulates a case with every setting, and measures runs and recordings.
    fn add(
        &mut self,
        (study, step): (&Study, &Step<'_>),
        case: usize,
        values: &[f64],
    ) -> Result<()> {
        let experiment = study.experiment(case, values)?;
        self.body_length_m = experiment.assembly.body_length_m;
        let settings = study.settings();
        // Collected in order, so that the bits do not depend on the threads.
        let runs = (0..settings.count)
            .into_par_iter()
            .map(|number| {
                let run = run_of(study, &settings.apply(Setting::new(number), &experiment));
                step.count();
                run
            })
            .collect::<Result<Vec<Option<Moved>>>>()?;
        let runs: Vec<Moved> = runs.into_iter().flatten().collect();
        let targets = study.cases()[case].targets.iter();
        let recorded = targets
            .map(|target| target.in_true_lengths(experiment.recording_length_scale))
            .collect::<Result<Vec<_>>>()?;
        let recorded: Vec<(&Trajectory, &Prepared)> = (recorded.iter())
            .map(|target| (&target.motion, &target.prepared))
            .collect();
        for distances in &mut self.distances {
            for (number, real) in recorded.iter().enumerate() {
                for other in &recorded[..number] {
                    let apart = distances.metric_of(*other, *real)?;
                    distances.recordings.push(apart);
                }
                for run in &runs {
                    let apart = distances.metric_of(*real, (&run.motion, &run.prepared))?;
                    distances.runs.push(apart);
                }
            }
        }
        let prepared = runs.iter().map(|run| &run.prepared);
        self.simulated_m
            .extend(prepared.map(|path| (path.net_displacement_m(), path.path_length_m())));
        let paths = recorded.iter().map(|(_, path)| path.net_displacement_m());
        self.recorded_m.extend(paths);
        Ok(())
    }

    /// Distance of the runs by a metric, in noise floors; `None` where the robot has no noise floor.
    fn noise_floors(&self, metric: usize) -> Option<f64> {
        let distances = &self.distances[metric];
        let floor = distances.floor()?;
        Some(mean(&distances.runs) / floor)
    }

    fn told(&self) -> RobotReproduction {
        let mut distances = self.distances.iter();
        let rms = distances.find(|d| d.metric.name() == Rms.name());
        let distance_m = rms.map_or(f64::NAN, |rms| mean(&rms.runs));
        let floor_m = rms.and_then(Distances::floor);
        let alike_m = cut_m(self.body_length_m, &self.recorded_m);
        let (simulated_m, paths_m): (Vec<f64>, Vec<f64>) = self.simulated_m.iter().copied().unzip();
        let net_m = median(&simulated_m);
        let nowhere = net_m < NOWHERE_BODY_LENGTHS * self.body_length_m
            || net_m < NOWHERE_PATHS * median(&paths_m);
        let (least, largest) = ends_of(simulated_m.iter().copied());
        let recorded_m = mean(&self.recorded_m);
        RobotReproduction {
            robot: self.robot.clone(),
            likeness: match () {
                () if floor_m.is_some_and(|floor_m| distance_m <= floor_m) => Likeness::WithinFloor,
                () if distance_m <= alike_m => Likeness::Alike,
                () if nowhere => Likeness::GoesNowhere,
                () => Likeness::OtherPath,
            },
            distance_m,
            floor_m,
            alike_m,
            recorded_m,
            recorded_sd_m: standard_deviation(&self.recorded_m),
            simulated_m: mean(&simulated_m),
            simulated_sd_m: standard_deviation(&simulated_m),
            held: (least..=largest).contains(&recorded_m),
        }
    }
}

impl Distances {
    fn of(metric: &'static dyn Metric) -> Self {
        Self {
            metric,
            runs: Vec::new(),
            recordings: Vec::new(),
        }
    }

    /// Distance of two motions by a metric.
    fn metric_of(
        &self,
        real: (&Trajectory, &Prepared),
        other: (&Trajectory, &Prepared),
    ) -> Result<f64> {
        let pair = Pair::new(real, other);
        Ok(self.metric.compare(&pair, &Context::default())?.value)
    }

    /// The noise floor of the robot; `None` where no two recordings share a start, or none differ.
    fn floor(&self) -> Option<f64> {
        mean_of_any(self.recordings.iter().copied()).filter(|floor| *floor > 0.0)
    }
}

/// A run; `None` where it diverged.
fn run_of(study: &Study, experiment: &Experiment) -> Result<Option<Moved>> {
    let Some(motion) = realgap_simulation::run(experiment)?.outcome.completed() else {
        return Ok(None);
    };
    let prepared = study.prepared(&motion)?;
    Ok(Some(Moved { motion, prepared }))
}
