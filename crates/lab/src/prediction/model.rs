//! How much of a prediction belongs to the model: numerics, joints, what tuning left open, and the engine itself.
//!
//! Repeats under noise say how sure a prediction is if the model is right. Other models are as right: other steps, other
//! joints, other values that fit the recordings as well. They are simulated with the same draws as the first repeats
//! (common random numbers), and what they change is laid on all repeats.

use std::fmt;

use rayon::prelude::*;
use serde::Serialize;

use super::ensemble::{self, Ensemble, Forecast, Motion, rms_m};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, quantile};
use realgap_core::unit::{Unit, quantity};
use realgap_engine::parameter::ParameterSet;
use realgap_engine::{Experiment, Outcome};
use realgap_optimize::RunOptions;
use realgap_path::trajectory::{Prepared, prepare};

/// Numbers of the equally valid numerics that are tried: twice the substeps, half the step, and less of either.
const NUMERICS: u64 = 4;
/// Points of the indistinguishable set that are tried, at most.
const POINTS: usize = 8;
/// One repeat of a model stands for so many of the ensemble.
const REPEATS_A_REPEAT: usize = 25;
/// A model has no fewer and no more repeats than this.
const REPEATS: std::ops::RangeInclusive<usize> = 4..=40;
/// A robot that gets less far than this share of its body length goes nowhere.
const NOWHERE_BODY_LENGTHS: f64 = 0.1;
/// Name of the model at the limit of rigid contact, with the experiment's own kind of joint.
const LIMIT: &str = "limit of hard contact";
/// So many displacements stand for those of all repeats.
const FURTHER: usize = 200;
/// Level of the ranges that another engine is part of.
pub const LEVEL: f64 = 0.9;
/// |Difference| of mean net displacements in MuJoCo and here, as a share of the path's length, of 19 random robots
/// (tools/engine_spread.py; docs/fidelity/ensembles.md). None of the shipped stand-ins was among them.
const ENGINE_SHARES: [f64; 19] = [
    0.001, 0.002, 0.017, 0.017, 0.018, 0.023, 0.025, 0.028, 0.029, 0.031, 0.039, 0.042, 0.051,
    0.100, 0.121, 0.147, 0.169, 0.171, 0.184,
];

/// What a model varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Timestep, substeps, hardness of contact.
    Numerics,
    /// The kind of joint.
    Joints,
    /// Parameter values that recordings cannot tell apart.
    Indistinguishable,
}

impl Source {
    /// In the order of the table.
    const ALL: [Self; 3] = [Self::Numerics, Self::Joints, Self::Indistinguishable];

    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Numerics => "numerics",
            Self::Joints => "joint kind",
            Self::Indistinguishable => "indistinguishable set",
        }
    }
}

/// A model that is as valid as the one that was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Model {
    /// What it is.
    pub name: String,
    /// What it varies.
    pub source: Source,
    /// Mean net displacement over that of the same repeats in the model that was asked for; for the other joint kind over that
    /// at the limit of hard contact, where it is tried, so that a combination does not count the limit twice. `None` where a
    /// repeat diverged.
    pub ratio: Option<f64>,
    /// Shares of its repeats that show each behaviour, in the forecast's order.
    pub behaviours: Vec<f64>,
}

/// From here to there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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

    fn central(values: &[f64], level: f64) -> Self {
        let tail = 0.5 - 0.5 * level;
        Self {
            low: quantile(values, tail),
            high: quantile(values, 1.0 - tail),
        }
    }

    /// Whether a value lies in it.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// How far models that are as valid part.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelError {
    /// The models, beside the one that was asked for.
    pub models: Vec<Model>,
    /// Repeats of each.
    pub repeats: usize,
    /// By which factors displacements differ: every combination of one model (or the one asked for) a source.
    #[serde(skip)]
    factors: Vec<f64>,
    /// 5 %, 50 % and 95 % quantile of the net displacement over the models, metres.
    pub quantiles_m: [Range; 3],
    /// Probability of each behaviour over the models, in the forecast's order; a share of few repeats.
    pub behaviours: Vec<Range>,
    /// Net displacement of half of the further runs, metres, the models and another engine included.
    pub half_of_runs_m: Range,
    /// This is the range that holds 90 % of further runs, metres.
    pub further_run_m: Range,
}

/// A probability of success, and how far the models part over it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuccessRange {
    /// This is the range over the models.
    pub models: Range,
    /// 90 % of what another engine would say, the models included.
    pub other_engine: Range,
}

impl ModelError {
    /// Simulates the models of an ensemble's experiment. `points` are sets of values that cannot be told apart; the first of them, some of the
    /// others and the last take part. `None` where the run is stopped, one of the first repeats diverged, or the robot gets less far than a
    /// tenth of its body length: a share of nothing says nothing.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn new(
        experiment: &Experiment,
        ensemble: &Ensemble,
        forecast: &Forecast,
        points: &[ParameterSet],
        run: &RunOptions<'_>,
    ) -> Result<Option<Self>> {
        let repeats = (ensemble.asked / REPEATS_A_REPEAT)
            .clamp(*REPEATS.start(), *REPEATS.end())
            .min(ensemble.asked);
        // What repeats draw is in all of them, and would count twice as models.
        let points = if ensemble.uncertain.is_empty() {
            points
        } else {
            &[]
        };
        let tried = models(experiment, points);
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
            Ok(Some(match run.outcome {
                Outcome::Completed(motion) => Outcome::Completed(prepare(&motion)?),
                Outcome::Diverged(divergence) => Outcome::Diverged(divergence),
            }))
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
                let far_m: Vec<f64> = paths.iter().map(|p| p.net_displacement_m()).collect();
                Model {
                    name,
                    source,
                    ratio: (paths.len() == repeats).then(|| mean(&far_m) / own_m),
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
        Ok(Some(Self::of(ensemble, forecast, models, repeats)))
    }

    fn of(ensemble: &Ensemble, forecast: &Forecast, models: Vec<Model>, repeats: usize) -> Self {
        let mut factors = vec![1.0];
        for source in Source::ALL {
            let of_source = models.iter().filter(|model| model.source == source);
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
        let further = further_m(&far_m, &factors, path_length_m(ensemble));
        let central = |level: f64| Range::central(&further, level);
        Self {
            behaviours: behaviours.collect(),
            quantiles_m,
            half_of_runs_m: central(0.5),
            further_run_m: central(LEVEL),
            factors,
            models,
            repeats,
        }
    }

    /// Lowest and highest probability of each behaviour over the models.
    pub(super) fn behaviour_shares(&self) -> Vec<(f64, f64)> {
        self.behaviours.iter().map(|r| (r.low, r.high)).collect()
    }

    /// How the models part over the probability to get at least `least_m` far.
    pub fn success(&self, ensemble: &Ensemble, least_m: f64) -> SuccessRange {
        let far_m = displacements_m(ensemble);
        let share = |factor: f64, more_m: f64| {
            let far = (far_m.iter()).filter(|far_m| factor * **far_m + more_m >= least_m);
            far.count() as f64 / ensemble.repeats.len() as f64
        };
        let models = Range::of(self.factors.iter().map(|factor| share(*factor, 0.0)));
        let path_m = path_length_m(ensemble);
        let all: Vec<f64> = (self.factors.iter())
            .flat_map(|factor| engines(path_m).map(move |more_m| share(*factor, more_m)))
            .collect();
        SuccessRange {
            models: models.unwrap_or(Range {
                low: share(1.0, 0.0),
                high: share(1.0, 0.0),
            }),
            other_engine: Range::central(&all, LEVEL),
        }
    }
}

/// By how much farther a robot with this path may get in another engine, metres, each as likely.
fn engines(path_m: f64) -> impl Iterator<Item = f64> {
    let both = move |share: f64| [-share * path_m, share * path_m];
    ENGINE_SHARES.into_iter().flat_map(both)
}

/// Displacements of further runs, metres: those of the repeats in every model and engine. Many repeats are thinned to evenly
/// spaced quantiles.
fn further_m(far_m: &[f64], factors: &[f64], path_m: f64) -> Vec<f64> {
    let thinned: Vec<f64> = (0..FURTHER)
        .map(|k| quantile(far_m, (k as f64 + 0.5) / FURTHER as f64))
        .collect();
    let far_m = if far_m.len() > FURTHER {
        &thinned
    } else {
        far_m
    };
    let mut further = Vec::new();
    for factor in factors {
        for more_m in engines(path_m) {
            further.extend(far_m.iter().map(|far_m| (factor * far_m + more_m).max(0.0)));
        }
    }
    further
}

/// Length of the path of the run without noise, which no camera has roughened; of the repeats where that diverged.
fn path_length_m(ensemble: &Ensemble) -> f64 {
    let length_m = |motion: &Motion| motion.path.path_length_m();
    ensemble.noise_free.get().map_or_else(
        || {
            mean(
                &ensemble
                    .motions()
                    .map(|(_, m)| length_m(m))
                    .collect::<Vec<_>>(),
            )
        },
        length_m,
    )
}

fn displacements_m(ensemble: &Ensemble) -> Vec<f64> {
    let motions = ensemble.motions();
    motions.map(|(_, m)| m.net_displacement_m()).collect()
}

/// What a model makes of an experiment.
type Change = Box<dyn Fn(&Experiment) -> Experiment + Sync + Send>;

/// The models of an experiment: name, what they vary, and how.
fn models(experiment: &Experiment, points: &[ParameterSet]) -> Vec<(String, Source, Change)> {
    let mut models: Vec<(String, Source, Change)> = Vec::new();
    for number in 1..=NUMERICS {
        let changed = experiment.with_numerics(number);
        let solver = &changed.solver;
        let name = format!("{:.3e} s x {} substeps", solver.timestep_s, solver.substeps);
        let change: Change = Box::new(move |own| own.with_numerics(number));
        models.push((name, Source::Numerics, change));
    }
    let kind = experiment.joint_kind();
    models.push((
        LIMIT.to_owned(),
        Source::Numerics,
        Box::new(move |own| own.at_limit(kind)),
    ));
    if !experiment.assembly.hinges.is_empty() {
        models.push((
            format!("{:?} joints at their limit", kind.other()).to_lowercase(),
            Source::Joints,
            Box::new(move |own| own.at_limit(kind.other())),
        ));
    }
    let taken = points.len().min(POINTS);
    for index in 0..taken {
        // Spread over the set, both ends included.
        let point = points[index * (points.len() - 1) / taken.saturating_sub(1).max(1)].clone();
        models.push((
            point.to_string(),
            Source::Indistinguishable,
            Box::new(move |own| point.apply(own)),
        ));
    }
    models
}

/// Share of a model's repeats that are nearest to each behaviour's and no further off than behaviours are from each other.
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
    format!("{:.0} to {:.0} %", 100.0 * range.low, 100.0 * range.high)
}

impl fmt::Display for ModelError {
    /// What the models change, source by source, each line begun with a line feed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, middle, high] = self.quantiles_m.each_ref().map(metres);
        write!(
            f,
            "\n  model error       {} other models, {} repeats each\
             \n    quantiles       5 %: {low}, 50 %: {middle}, 95 %: {high}",
            self.models.len(),
            self.repeats
        )?;
        for source in Source::ALL {
            let of_source = || self.models.iter().filter(|m| m.source == source);
            if let Some(range) = Range::of(of_source().filter_map(|model| model.ratio)) {
                let [low, high] = [range.low, range.high].map(|ratio| 100.0 * (ratio - 1.0));
                write!(
                    f,
                    "\n    {:<15} {low:+.0} to {high:+.0} % of the displacement",
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
        write!(
            f,
            "\n    further runs    50 %: {}, 90 %: {} (another engine included)",
            metres(&self.half_of_runs_m),
            metres(&self.further_run_m)
        )
    }
}
