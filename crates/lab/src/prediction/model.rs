//! Model error of a prediction: how much it depends on numerics, joints, the values that tuning left open, and the engine.
//!
//! Repeats under noise show how uncertain a prediction is if the model is right. Other models are as right: other timesteps,
//! other joints, other values that fit the recordings as well. They are simulated with the same random draws as the first repeats
//! (common random numbers), and their changes are applied to all repeats. What an engine outside of the program would do is
//! asked of MuJoCo, or learned from what it did with other robots ([`super::third_opinion`]), and contains all of these changes once.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::alternative::{LIMIT, alternatives};
use super::ensemble::{self, Ensemble, Forecast, Motion, rms_m};
use super::{OpinionSource, OtherEngine, OwnEngines, Teller, ThirdOpinion};
use realgap_core::Result;
use realgap_core::statistics::{mean, mean_of, quantile, standard_deviation};
use realgap_core::unit::{Unit, percent_change_range, percent_range, quantity};
use realgap_core::warning::{Code, Warning};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{Prepared, prepare};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Experiment, Noise, Outcome};

/// One repeat of a model stands for so many repeats of the ensemble.
const REPEATS_A_REPEAT: usize = 25;
/// Least and most repeats of a model.
const REPEATS: std::ops::RangeInclusive<usize> = 4..=40;
/// Repeats from which the sensitivity of a robot to unmeasured noise is estimated, as many as for the robots from which was
/// learned.
const SENSITIVITY_REPEATS: u64 = 32;
/// Interquartile range of a standard normal distribution.
const NORMAL_QUARTILES: f64 = 1.349;
/// A robot that moves less far than this share of its body length goes nowhere.
const NOWHERE_BODY_LENGTHS: f64 = 0.1;
/// Level of the ranges that contain another engine.
pub const LEVEL: f64 = 0.9;

realgap_core::labelled_enum! {
    /// What a model varies.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "snake_case")]
    Source.label;
    /// Timestep, substeps, hardness of contact.
    Numerics "numerics";
    /// The kind of joint.
    Joints "joint kind";
    /// The engine: the second one of the program.
    Engine "second engine";
    /// The friction cone: relaxed, as in other engines.
    Contact "relaxed contact";
    /// Parameter values that recordings cannot tell apart.
    Indistinguishable "confidence set";
}

impl Source {
    /// Sources that are part of the expected difference to another engine; they are not combined with the other sources again.
    const OTHERS: [Self; 2] = [Self::Engine, Self::Contact];
}

/// A model that is as valid as the requested one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Model {
    /// Name of the model.
    pub name: String,
    /// What it varies.
    pub source: Source,
    /// Mean net displacement over that of the same repeats in the requested model. For the other joint kind it is relative to the
    /// limit of hard contact, where that is tried, so that a combination does not contain the limit twice. `None` where a repeat
    /// diverged.
    pub ratio: Option<f64>,
    /// Shares of its repeats that show each behaviour, in the forecast's order.
    pub behaviours: Vec<f64>,
}

/// A range of values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        values.fold(None, |range, value| {
            let (low, high) = range.map_or((value, value), |r: Self| (r.low, r.high));
            Some(Self {
                low: low.min(value),
                high: high.max(value),
            })
        })
    }

    /// Whether a value lies in the range.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// What the model error of a prediction is computed from, besides the repeats.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelOptions {
    /// Values of the confidence set that take part (there may be none): the first of them, some of the others and the last.
    pub points: Vec<ParameterSet>,
    /// Who says what another engine would do.
    pub third_opinion: ThirdOpinion,
}

/// How far models that are as valid differ from each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelError {
    /// The models beside the requested one.
    pub models: Vec<Model>,
    /// Repeats of each.
    pub repeats: usize,
    /// Factors on the displacement: one for every combination of one model per source (the requested model included). The second
    /// engine and relaxed contacts are left out, because the range for another engine contains them already.
    #[serde(skip)]
    factors: Vec<f64>,
    /// Expected displacements in another engine; `None` for a vehicle, which no engine simulates.
    #[serde(skip)]
    other_engine: Option<OtherEngine>,
    /// 5 %, 50 % and 95 % quantile of the net displacement over the models, metres.
    pub quantiles_m: [Range; 3],
    /// Range of the probability of each behaviour over the models, in the forecast's order; each is a share of few repeats.
    pub behaviours: Vec<Range>,
    /// Who says what another engine would do; `None`, as for the three fields below, where no engine simulates the robot.
    pub third_opinion: Option<OpinionSource>,
    /// Range that holds half of further runs in another engine, net displacement in metres.
    pub half_of_runs_m: Option<Range>,
    /// Range that holds 90 % of them, metres.
    pub further_run_m: Option<Range>,
    /// By how much these 90 % move farther than the mean of the repeats, metres; negative where they move less far.
    pub other_engine_adds_m: Option<Range>,
}

/// A probability of success, and how far the models differ about it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuccessRange {
    /// Range over the models.
    pub models: Range,
    /// Probability in an engine outside of the program. It is one number: where repeats hardly differ, an engine gives 0 or 1,
    /// and a range over engines would hold both.
    pub other_engine: f64,
}

impl ModelError {
    /// Simulates the models of an ensemble's experiment. `None` where the run is stopped, where one of the first repeats diverged,
    /// or where the robot moves less than a tenth of its body length, because a share of almost no displacement means nothing.
    ///
    /// # Errors
    /// Settings that cannot be simulated; MuJoCo alone may say what another engine would do, and cannot.
    pub fn new(
        experiment: &Experiment,
        ensemble: &Ensemble,
        forecast: &Forecast,
        options: &ModelOptions,
        run: &RunOptions<'_>,
    ) -> Result<Option<Self>> {
        let repeats = (ensemble.asked / REPEATS_A_REPEAT)
            .clamp(*REPEATS.start(), *REPEATS.end())
            .min(ensemble.asked);
        // Values that the repeats draw are part of all models already, and would count twice as models of their own.
        let points = if ensemble.uncertain.is_empty() {
            options.points.as_slice()
        } else {
            &[]
        };
        let tried = alternatives(experiment, points);
        let own: Option<Vec<f64>> = (ensemble.repeats.iter().take(repeats))
            .map(|repeat| repeat.outcome.get().map(Motion::net_displacement_m))
            .collect();
        let nowhere_m = NOWHERE_BODY_LENGTHS * ensemble.body_length_m;
        let own = own.map(|far_m| mean(&far_m));
        let Some(own_m) = own.filter(|far_m| *far_m >= nowhere_m) else {
            return Ok(None);
        };
        if tried.is_empty() || !ensemble.is_complete() {
            return Ok(None);
        }
        let jobs: Vec<(usize, u64)> = (0..tried.len())
            .flat_map(|model| (0..repeats as u64).map(move |repeat| (model, repeat)))
            .collect();
        let simulate = |(model, repeat): &(usize, u64)| -> Result<Option<Outcome<Prepared>>> {
            if run.is_stopped() {
                return Ok(None);
            }
            let (seed, change) = (ensemble.seed, &tried[*model].2);
            let own = ensemble.uncertain.apply(experiment, seed, *repeat)?;
            let run = ensemble::repeat(&change(&own), &ensemble.noise, seed, *repeat)?;
            run.outcome.try_map(|motion| prepare(&motion)).map(Some)
        };
        let outcomes: Option<Vec<Outcome<Prepared>>> =
            run.install(|| jobs.par_iter().map(simulate).collect::<Result<_>>())??;
        let Some(outcomes) = outcomes else {
            return Ok(None);
        };
        let mut models: Vec<Model> = tried
            .into_iter()
            .zip(outcomes.chunks(repeats))
            .map(|((name, source, _), outcomes)| {
                let paths: Vec<&Prepared> = outcomes.iter().filter_map(Outcome::get).collect();
                let far_m = mean_of(paths.iter().map(|p| p.net_displacement_m()));
                Model {
                    name,
                    source,
                    ratio: (paths.len() == repeats).then(|| far_m / own_m),
                    behaviours: shares(ensemble, forecast, &paths, repeats),
                }
            })
            .collect();
        let limit = models.iter().find(|model| model.name == LIMIT);
        if let Some(limit) = limit.and_then(|limit| limit.ratio).filter(|r| *r > 0.0) {
            for model in models.iter_mut().filter(|m| m.source == Source::Joints) {
                model.ratio = model.ratio.map(|ratio| ratio / limit);
            }
        }
        let other_engine = if !experiment.has_engine() {
            None
        } else {
            let Some(sensitivity_m) = sensitivity_m(experiment, ensemble.seed, run)? else {
                return Ok(None);
            };
            let known = own_engines(ensemble, &models, sensitivity_m);
            match (options.third_opinion).of(experiment, ensemble, &known, run) {
                Err(_) if run.is_stopped() => return Ok(None),
                said => Some(said?),
            }
        };
        Ok(Some(Self::of(
            ensemble,
            forecast,
            models,
            repeats,
            other_engine,
        )))
    }

    /// The warning of an answer that was stopped before other models and engines had been asked.
    pub fn unasked() -> Warning {
        Code::Incomplete.warning(
            "stopped before other models and engines had answered: the ranges are those of this model alone",
        )
    }

    fn of(
        ensemble: &Ensemble,
        forecast: &Forecast,
        models: Vec<Model>,
        repeats: usize,
        third_opinion: Option<(OtherEngine, OpinionSource)>,
    ) -> Self {
        let (other_engine, third_opinion) = third_opinion.unzip();
        let mut factors = vec![1.0];
        for source in Source::ALL.iter().filter(|s| !Source::OTHERS.contains(s)) {
            let of_source = models.iter().filter(|model| model.source == *source);
            let ratios: Vec<f64> = std::iter::once(1.0)
                .chain(of_source.filter_map(|model| model.ratio))
                .collect();
            factors = (factors.iter())
                .flat_map(|factor| ratios.iter().map(move |ratio| factor * ratio))
                .collect();
        }
        let far_m = displacements_m(ensemble);
        let ends = Range::of(factors.iter().copied()).unwrap_or(Range {
            low: 1.0,
            high: 1.0,
        });
        let quantiles_m = [0.05, 0.5, 0.95].map(|level| {
            let value = quantile(&far_m, level);
            Range {
                low: value * ends.low,
                high: value * ends.high,
            }
        });
        let behaviours = forecast.behaviours.list.iter().enumerate();
        let behaviours = behaviours.filter_map(|(index, behaviour)| {
            let shares = models.iter().map(|model| model.behaviours[index]);
            Range::of(shares.chain([behaviour.probability.share]))
        });
        let of_runs_m = |level| other_engine.as_ref().map(|other| other.central(level));
        let further_run_m = of_runs_m(LEVEL);
        let own_m = mean(&far_m);
        Self {
            behaviours: behaviours.collect(),
            quantiles_m,
            third_opinion,
            half_of_runs_m: of_runs_m(0.5),
            further_run_m,
            other_engine_adds_m: further_run_m.map(|range| Range {
                low: range.low - own_m,
                high: range.high - own_m,
            }),
            other_engine,
            factors,
            models,
            repeats,
        }
    }

    /// Lowest and highest probability of each behaviour over the models.
    pub(super) fn behaviour_shares(&self) -> Vec<(f64, f64)> {
        self.behaviours.iter().map(|r| (r.low, r.high)).collect()
    }

    /// Who says what another engine would do, in brackets; the table judges a robot that the program's second engine did not run
    /// by less.
    fn opinion(&self) -> String {
        let has_run = |model: &Model| model.source == Source::Engine && model.ratio.is_some();
        match &self.third_opinion {
            None => String::new(),
            Some(source) if source.by == Teller::Table && !self.models.iter().any(has_run) => {
                format!(" ({source}; by this engine alone: the second one cannot run this)")
            }
            Some(source) => format!(" ({source})"),
        }
    }

    /// How far the models differ about the probability of moving at least `least_m`; `None` where no engine simulates the robot.
    pub fn success(&self, ensemble: &Ensemble, least_m: f64) -> Option<SuccessRange> {
        let other_engine = self.other_engine.as_ref()?;
        let far_m = displacements_m(ensemble);
        let share = |factor: &f64| {
            let far = far_m.iter().filter(|far_m| factor * **far_m >= least_m);
            far.count() as f64 / ensemble.repeats.len() as f64
        };
        let own = share(&1.0);
        let models = Range::of(self.factors.iter().map(share));
        let completed = far_m.len() as f64 / ensemble.repeats.len() as f64;
        Some(SuccessRange {
            models: models.unwrap_or(Range {
                low: own,
                high: own,
            }),
            other_engine: completed * other_engine.reaches(least_m),
        })
    }
}

/// What the repeats and the models show about the robot. No robot from which was learned had open parameter values, so the effect
/// of such values is added to the sensitivity.
fn own_engines(ensemble: &Ensemble, models: &[Model], sensitivity_m: f64) -> OwnEngines {
    let far_m = displacements_m(ensemble);
    let own_m = mean(&far_m);
    let ratios = |source: Source| {
        let of_source = models.iter().filter(move |model| model.source == source);
        of_source.filter_map(|model| model.ratio)
    };
    let spread_m = standard_deviation(&far_m);
    // The open values are drawn with the repeats, or they are models of their own.
    let of_values_m = if ensemble.uncertain.is_empty() {
        let of_points: Vec<f64> = ratios(Source::Indistinguishable).collect();
        own_m * standard_deviation(&of_points)
    } else {
        spread_m
    };
    OwnEngines {
        own_m,
        second_m: ratios(Source::Engine).next().map(|ratio| ratio * own_m),
        relaxed_m: ratios(Source::Contact).next().map(|ratio| ratio * own_m),
        spread_m,
        sensitivity_m: sensitivity_m.hypot(of_values_m),
        body_length_m: ensemble.body_length_m,
    }
}

/// Sensitivity of the robot to unmeasured noise: the spread of its net displacement (from the quartiles) under the noise of an
/// unmeasured robot, metres. It is simulated in the second engine, which is cheap, or else in the robot's own. `None` where the
/// run is stopped or no repeat is completed.
fn sensitivity_m(experiment: &Experiment, seed: u64, run: &RunOptions<'_>) -> Result<Option<f64>> {
    let mut own = experiment.clone();
    own.solver.engine = experiment.second_engine().unwrap_or(own.solver.engine);
    let noise = Noise::unmeasured_robot();
    let far_m = |number: u64| -> Result<Option<f64>> {
        if run.is_stopped() {
            return Ok(None);
        }
        let run = ensemble::repeat(&own, &noise, seed, number)?;
        let path = run.outcome.get().map(prepare).transpose()?;
        Ok(path.map(|path| path.net_displacement_m()))
    };
    let all = run.install(|| {
        let numbers = (0..SENSITIVITY_REPEATS).into_par_iter();
        numbers.map(far_m).collect::<Result<Vec<Option<f64>>>>()
    })??;
    let far_m: Vec<f64> = all.into_iter().flatten().collect();
    let range_m = || quantile(&far_m, 0.75) - quantile(&far_m, 0.25);
    Ok((!run.is_stopped() && !far_m.is_empty()).then(|| range_m() / NORMAL_QUARTILES))
}

fn displacements_m(ensemble: &Ensemble) -> Vec<f64> {
    let motions = ensemble.motions();
    motions.map(|(_, m)| m.net_displacement_m()).collect()
}

/// Share of a model's repeats that are nearest to each behaviour and not farther from it than behaviours are from each other.
fn shares(
    ensemble: &Ensemble,
    forecast: &Forecast,
    paths: &[&Prepared],
    repeats: usize,
) -> Vec<f64> {
    let mut counts = vec![0; forecast.behaviours.list.len()];
    for path in paths {
        let repeats = ensemble.motions();
        let distances_m: Vec<(u64, f64)> = repeats
            .map(|(repeat, motion)| (repeat.number, rms_m(&motion.path, path)))
            .collect();
        if let Some((distance_m, index)) = forecast.behaviours.nearest(&distances_m)
            && distance_m <= forecast.behaviours.cut_m
        {
            counts[index] += 1;
        }
    }
    counts
        .into_iter()
        .map(|count: usize| count as f64 / repeats as f64)
        .collect()
}

/// `0.72 to 0.81 m`.
fn metres(range: &Range) -> String {
    let [low, high] = [range.low, range.high].map(|m| quantity(m, Unit::Metre));
    format!("{low} to {high}")
}

/// `40 to 85 %`.
pub(super) fn percent(range: &Range) -> String {
    percent_range(range.low, range.high)
}

impl fmt::Display for ModelError {
    /// Writes the effects of the models by source, each line after a line feed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, middle, high] = self.quantiles_m.each_ref().map(metres);
        write!(
            f,
            "\n  model error       {} other models, {} repeats each\
             \n    quantiles       5 %: {low}, 50 %: {middle}, 95 %: {high}",
            self.models.len(),
            self.repeats
        )?;
        for &source in Source::ALL {
            let of_source = || self.models.iter().filter(|m| m.source == source);
            if let Some(range) = Range::of(of_source().filter_map(|model| model.ratio)) {
                let change = percent_change_range(range.low - 1.0, range.high - 1.0);
                write!(
                    f,
                    "\n    {:<15} {change} of the displacement",
                    source.label()
                )?;
            }
            let lost: Vec<&str> = of_source()
                .filter(|model| model.ratio.is_none())
                .map(|model| model.name.as_str())
                .collect();
            if !lost.is_empty() {
                write!(f, "\n    diverged        {}", lost.join(", "))?;
            }
        }
        let (Some(half), Some(most)) = (&self.half_of_runs_m, &self.further_run_m) else {
            return Ok(());
        };
        write!(
            f,
            "\n    another engine  50 %: {}, 90 %: {}{}",
            metres(half),
            metres(most),
            self.opinion()
        )
    }
}
