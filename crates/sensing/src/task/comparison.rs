//! Compares real with simulated task times for each condition, and compares the order of the conditions.

use std::fmt;

use serde::Serialize;

use super::log::TaskLog;
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{
    Duration, KaplanMeier, SampleTest, log_rank, mann_whitney, percentile_interval, resamples,
    spearman,
};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::warning::{Code, Warning};

/// The real or the simulated trials of one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SideReport {
    /// Number of trials.
    pub trials: usize,
    /// Number of trials that were finished.
    pub finished: usize,
    /// Median duration, seconds (Kaplan and Meier); `None` if less than half of the trials were finished.
    pub median_s: Option<f64>,
    /// Lower end of the 90 % interval of the median, seconds; `None` if the trials do not bound it.
    pub median_low_s: Option<f64>,
    /// Upper end of the 90 % interval of the median, seconds; `None` if the trials do not bound it.
    pub median_high_s: Option<f64>,
    /// Time at which a quarter of the trials was finished, seconds.
    pub quartile_low_s: Option<f64>,
    /// Time at which three quarters of the trials were finished, seconds.
    pub quartile_high_s: Option<f64>,
    /// Share of the trials that are not finished, as a function of time.
    #[serde(skip)]
    pub curve: KaplanMeier,
}

/// The comparison of real and simulated trials of one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ConditionReport {
    /// The levels of all factors, for example `robot=PER, mode=teleoperation`.
    pub condition: String,
    /// The real trials.
    pub real: SideReport,
    /// The simulated trials.
    pub simulated: SideReport,
    /// Simulated median divided by real median.
    pub median_ratio: Option<f64>,
    /// The test: `mann-whitney`, or `log-rank` if trials were given up.
    pub test: &'static str,
    /// p value of the test; `None` if too few trials were finished.
    pub p: Option<f64>,
    /// Cliff's δ, from −1 to 1: the probability that a simulated trial takes longer than a real one minus the probability of the
    /// reverse. Pairs whose order is unknown because a trial was given up count for neither (Gehan).
    pub effect: f64,
    /// Lower end of the 90 % interval of the effect, over resampled trials.
    pub effect_low: f64,
    /// Upper end of the 90 % interval of the effect, over resampled trials.
    pub effect_high: f64,
}

/// The order of the levels of one factor in the real and in the simulated trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactorReport {
    /// Name of the factor.
    pub factor: String,
    /// Levels ordered by their real median, fastest first.
    pub real: Vec<String>,
    /// Levels ordered by their simulated median, fastest first.
    pub simulated: Vec<String>,
    /// Whether both orders are the same.
    pub same_order: bool,
    /// Share of resamples of the real and the simulated trials in which both orders are the same.
    pub same_order_share: f64,
}

/// The comparison of real with simulated task times.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TaskComparison {
    /// Every condition of both logs.
    pub conditions: Vec<ConditionReport>,
    /// Every factor of both logs with more than one level.
    pub factors: Vec<FactorReport>,
    /// Spearman's rank correlation of the conditions' medians; `None` for fewer than three conditions.
    pub spearman: Option<f64>,
    /// p value of the rank correlation.
    pub spearman_p: Option<f64>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

const RESAMPLES: usize = 1000;
const LEVEL: f64 = 0.9;
/// A condition with fewer trials than this gives a warning.
const FEW: usize = 5;

impl TaskComparison {
    /// Compares two logs; the seed is used for the resampling of the intervals.
    ///
    /// # Errors
    /// Logs without a condition in common.
    pub fn new(real: &TaskLog, simulated: &TaskLog, seed: u64) -> Result<Self> {
        let mut warnings: Vec<Warning> = real
            .warnings
            .iter()
            .chain(&simulated.warnings)
            .cloned()
            .collect();
        let factors: Vec<&str> = real
            .factors
            .iter()
            .filter(|name| simulated.factors.contains(name))
            .map(String::as_str)
            .collect();
        let only: Vec<&str> = real
            .factors
            .iter()
            .chain(&simulated.factors)
            .map(String::as_str)
            .filter(|name| !factors.contains(name))
            .collect();
        if !only.is_empty() {
            warnings.push(Code::ColumnsIgnored.warning(format!(
                "columns that only one of the two logs has are not used: {}",
                only.join(", ")
            )));
        }
        let (conditions, unmatched) = conditions(real, simulated, &factors);
        if conditions.is_empty() {
            return Err(Error::invalid("the two logs have no condition in common")
                .found(unmatched.join("; "))
                .hint("columns and their values must have the same names in both logs"));
        }
        if !unmatched.is_empty() {
            warnings.push(Code::UnmatchedConditions.warning(format!(
                "conditions that only one of the two logs has are left out: {}",
                unmatched.join("; ")
            )));
        }
        let conditions = conditions
            .iter()
            .map(|levels| {
                let (real, simulated) = (real.durations(levels), simulated.durations(levels));
                condition(name(levels), &real, &simulated, seed)
            })
            .collect::<Result<Vec<_>>>()?;
        let few: Vec<&str> = conditions
            .iter()
            .filter(|c| c.real.trials.min(c.simulated.trials) < FEW)
            .map(|c| c.condition.as_str())
            .collect();
        if !few.is_empty() {
            warnings.push(
                Code::FewRepeats.warning(format!("fewer than {FEW} trials: {}", few.join("; "))),
            );
        }
        let medians: (Vec<f64>, Vec<f64>) = conditions
            .iter()
            .filter_map(|c| Some((c.real.median_s?, c.simulated.median_s?)))
            .unzip();
        let ranks = spearman(&medians.0, &medians.1).ok();
        Ok(Self {
            factors: factors
                .iter()
                .filter_map(|name| factor(name, real, simulated, seed))
                .collect(),
            conditions,
            spearman: ranks.map(|r| r.statistic),
            spearman_p: ranks.map(|r| r.p_value),
            warnings,
        })
    }
}

fn name(wanted: &[(&str, &str)]) -> String {
    if wanted.is_empty() {
        return "all trials".to_owned();
    }
    let parts: Vec<String> = wanted
        .iter()
        .map(|(factor, level)| format!("{factor}={level}"))
        .collect();
    parts.join(", ")
}

/// Pairs of a factor and its level.
type Levels<'a> = Vec<(&'a str, &'a str)>;

/// The levels of every condition that occurs in both logs, in the order of the real log, and the names of the conditions that
/// occur in one log only.
fn conditions<'a>(
    real: &'a TaskLog,
    simulated: &'a TaskLog,
    factors: &[&'a str],
) -> (Vec<Levels<'a>>, Vec<String>) {
    let of = |log: &'a TaskLog| {
        let mut known: Vec<Levels<'a>> = Vec::new();
        for trial in &log.trials {
            let level = |name: &&'a str| {
                let column = log.factors.iter().position(|own| own == name)?;
                Some((*name, trial.levels[column].as_str()))
            };
            let levels = factors.iter().filter_map(level).collect();
            if !known.contains(&levels) {
                known.push(levels);
            }
        }
        known
    };
    let (mut real, simulated) = (of(real), of(simulated));
    let unmatched = real
        .iter()
        .filter(|levels| !simulated.contains(levels))
        .chain(simulated.iter().filter(|levels| !real.contains(levels)))
        .map(|levels| name(levels))
        .collect();
    real.retain(|levels| simulated.contains(levels));
    (real, unmatched)
}

fn side(durations: &[Duration]) -> Result<SideReport> {
    let curve = KaplanMeier::new(durations)?;
    let (median_low_s, median_high_s) = curve.median_interval_s(LEVEL);
    Ok(SideReport {
        trials: durations.len(),
        finished: durations.iter().filter(|d| d.finished).count(),
        median_s: curve.median_s(),
        median_low_s,
        median_high_s,
        quartile_low_s: curve.quantile_s(0.25),
        quartile_high_s: curve.quantile_s(0.75),
        curve,
    })
}

fn condition(
    name: String,
    real: &[Duration],
    simulated: &[Duration],
    seed: u64,
) -> Result<ConditionReport> {
    let is_whole = real.iter().chain(simulated).all(|d| d.finished);
    let (test, result): (&str, Result<SampleTest>) = if is_whole {
        let times = |of: &[Duration]| of.iter().map(|d| d.time_s).collect::<Vec<_>>();
        (
            "mann-whitney",
            mann_whitney(&times(real), &times(simulated)),
        )
    } else {
        ("log-rank", log_rank(real, simulated))
    };
    let draws = resamples(real.len(), RESAMPLES, seed);
    let others = resamples(simulated.len(), RESAMPLES, seed.wrapping_add(1));
    let effects: Vec<f64> = draws
        .iter()
        .zip(&others)
        .map(|(a, b)| effect(real, a.weights(), simulated, b.weights()))
        .collect();
    let (effect_low, effect_high) =
        percentile_interval(&effects, 0.5 * (1.0 - LEVEL)).unwrap_or((-1.0, 1.0));
    let even = |of: &[Duration]| vec![1.0 / of.len() as f64; of.len()];
    let (real_side, simulated_side) = (side(real)?, side(simulated)?);
    Ok(ConditionReport {
        condition: name,
        median_ratio: real_side
            .median_s
            .and_then(|real| Some(simulated_side.median_s? / real)),
        real: real_side,
        simulated: simulated_side,
        test,
        p: result.ok().map(|r| r.p_value),
        effect: effect(real, &even(real), simulated, &even(simulated)),
        effect_low,
        effect_high,
    })
}

/// Share of pairs in which the simulated trial certainly took longer minus the share in which the real trial certainly did.
fn effect(real: &[Duration], real_weights: &[f64], simulated: &[Duration], weights: &[f64]) -> f64 {
    let surely_longer = |a: &Duration, b: &Duration| {
        b.finished && (a.time_s > b.time_s || (!a.finished && a.time_s == b.time_s))
    };
    let mut sum = 0.0;
    for (r, real_weight) in real.iter().zip(real_weights) {
        for (s, weight) in simulated.iter().zip(weights) {
            if surely_longer(s, r) {
                sum += real_weight * weight;
            } else if surely_longer(r, s) {
                sum -= real_weight * weight;
            }
        }
    }
    sum
}

/// Levels ordered by their median, fastest first; a level of which less than half of the trials were finished comes last.
fn order(levels: &[String], durations: &[Vec<Duration>]) -> Vec<String> {
    let median = |own: &Vec<Duration>| {
        let curve = KaplanMeier::new(own).ok();
        curve
            .and_then(|curve| curve.median_s())
            .unwrap_or(f64::INFINITY)
    };
    let mut ranked: Vec<(f64, &String)> = durations.iter().map(median).zip(levels).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.into_iter().map(|(_, level)| level.clone()).collect()
}

fn factor(name: &str, real: &TaskLog, simulated: &TaskLog, seed: u64) -> Option<FactorReport> {
    let column = real.factors.iter().position(|own| own == name)?;
    let mut levels: Vec<String> = Vec::new();
    for trial in &real.trials {
        if !levels.contains(&trial.levels[column]) {
            levels.push(trial.levels[column].clone());
        }
    }
    levels.retain(|level| !simulated.durations(&[(name, level)]).is_empty());
    if levels.len() < 2 {
        return None;
    }
    let of = |log: &TaskLog| -> Vec<Vec<Duration>> {
        levels
            .iter()
            .map(|level| log.durations(&[(name, level)]))
            .collect()
    };
    let worlds = [of(real), of(simulated)];
    let [real, simulated] = [0, 1].map(|world| order(&levels, &worlds[world]));
    // Every level of the real and of the simulated trials is resampled with its own stream of random numbers.
    let mut drawn: Vec<[Vec<Vec<Duration>>; 2]> = vec![Default::default(); RESAMPLES];
    for (world, own) in worlds.iter().enumerate() {
        for (index, durations) in own.iter().enumerate() {
            let stream = seed.wrapping_add((2 * index + world) as u64);
            for (draw, resample) in
                drawn
                    .iter_mut()
                    .zip(resamples(durations.len(), RESAMPLES, stream))
            {
                let repeated = durations
                    .iter()
                    .zip(resample.counts())
                    .flat_map(|(duration, count)| std::iter::repeat_n(*duration, count as usize));
                draw[world].push(repeated.collect());
            }
        }
    }
    let same = drawn
        .iter()
        .filter(|[a, b]| order(&levels, a) == order(&levels, b))
        .count();
    Some(FactorReport {
        factor: name.to_owned(),
        same_order: real == simulated,
        same_order_share: same as f64 / RESAMPLES as f64,
        real,
        simulated,
    })
}

fn seconds(value: Option<f64>) -> String {
    value.map_or("?".to_owned(), |v| format!("{v:.1}"))
}

impl SideReport {
    /// `12.3 s (10.1 to 15.0)`.
    fn median(&self) -> String {
        match self.median_s {
            Some(median) => format!(
                "{median:.1} s ({} to {})",
                seconds(self.median_low_s),
                seconds(self.median_high_s)
            ),
            None => "fewer than half finished".to_owned(),
        }
    }
}

impl fmt::Display for TaskComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let finished = |side: &SideReport| format!("{} of {}", side.finished, side.trials);
        let table = TextTable::of(
            &self.conditions,
            &[
                ("condition", Left, &|c| c.condition.clone()),
                ("finished", Right, &|c| finished(&c.real)),
                ("real median", Right, &|c| c.real.median()),
                ("finished", Right, &|c| finished(&c.simulated)),
                ("simulated median", Right, &|c| c.simulated.median()),
                ("ratio", Right, &|c| {
                    c.median_ratio.map_or(String::new(), |r| format!("{r:.2}"))
                }),
                ("effect", Right, &|c| {
                    format!(
                        "{:+.2} ({:+.2} to {:+.2})",
                        c.effect, c.effect_low, c.effect_high
                    )
                }),
                ("p", Right, &|c| {
                    c.p.map_or("?".to_owned(), |p| format!("{p:.3}"))
                }),
                ("test", Left, &|c| c.test.to_owned()),
            ],
        );
        write!(f, "{}", table.render(false))?;
        for factor in &self.factors {
            let order = if factor.same_order {
                "the same order"
            } else {
                "a different order"
            };
            write!(
                f,
                "\n{}: real {}, simulated {}: {order} ({:.0} % of resamples agree)",
                factor.factor,
                factor.real.join(" < "),
                factor.simulated.join(" < "),
                100.0 * factor.same_order_share
            )?;
        }
        if let (Some(rho), Some(p)) = (self.spearman, self.spearman_p) {
            write!(
                f,
                "\nrank correlation of the conditions' medians: {rho:+.2} (Spearman, p = {p:.3})"
            )?;
        }
        Ok(())
    }
}
