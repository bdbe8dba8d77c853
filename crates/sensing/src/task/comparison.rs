//! Real against simulated task times, condition by condition and in their order.

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

/// Trials of one condition in one of the two worlds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SideReport {
    /// How many trials there are.
    pub trials: usize,
    /// How many of them were finished.
    pub finished: usize,
    /// When half was finished, seconds (Kaplan and Meier); `None` where it never was.
    pub median_s: Option<f64>,
    /// The lower end of its 90 % interval; `None` where the trials do not bound it.
    pub median_low_s: Option<f64>,
    /// The upper end of that interval.
    pub median_high_s: Option<f64>,
    /// When a quarter was finished, seconds.
    pub quartile_low_s: Option<f64>,
    /// When three quarters were finished, seconds.
    pub quartile_high_s: Option<f64>,
    /// The share that was not finished, over time.
    #[serde(skip)]
    pub curve: KaplanMeier,
}

/// One condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ConditionReport {
    /// `robot=PER, mode=teleoperation`.
    pub condition: String,
    /// The real trials.
    pub real: SideReport,
    /// The simulated trials.
    pub simulated: SideReport,
    /// Simulated over real median.
    pub median_ratio: Option<f64>,
    /// `mann-whitney`, or `log-rank` where trials were given up.
    pub test: &'static str,
    /// Its p value; `None` where too little was finished.
    pub p: Option<f64>,
    /// Cliff's δ: how much likelier a simulated trial takes longer than a real one than the reverse, −1 to 1; pairs of which nobody
    /// knows are neither (Gehan).
    pub effect: f64,
    /// Where its 90 % interval over resampled trials begins.
    pub effect_low: f64,
    /// Where that interval ends.
    pub effect_high: f64,
}

/// One factor: do real and simulated trials put its levels into the same order?
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactorReport {
    /// Its name.
    pub factor: String,
    /// Levels by their real median, fastest first.
    pub real: Vec<String>,
    /// They are ordered by their simulated median.
    pub simulated: Vec<String>,
    /// Whether they are the same.
    pub same_order: bool,
    /// How often they are if trials are resampled in both worlds.
    pub same_order_share: f64,
}

/// Task times, real against simulated.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TaskComparison {
    /// Every condition of both logs.
    pub conditions: Vec<ConditionReport>,
    /// Every factor of both logs with more than one level.
    pub factors: Vec<FactorReport>,
    /// Spearman's rank correlation of the conditions' medians; `None` for fewer than three.
    pub spearman: Option<f64>,
    /// Its p value.
    pub spearman_p: Option<f64>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

const RESAMPLES: usize = 1000;
const LEVEL: f64 = 0.9;
/// Fewer trials of a condition say little.
const FEW: usize = 5;

impl TaskComparison {
    /// Compares two logs; the seed is that of the intervals.
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
                "in one of the two logs only, and not used: {}",
                only.join(", ")
            )));
        }
        let (conditions, lonely) = conditions(real, simulated, &factors);
        if conditions.is_empty() {
            return Err(Error::invalid("the two logs have no condition in common")
                .found(lonely.join("; "))
                .hint("columns and their values must be called alike in both"));
        }
        if !lonely.is_empty() {
            warnings.push(Code::UnmatchedConditions.warning(format!(
                "in one of the two logs only, and left out: {}",
                lonely.join("; ")
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

/// Factors with the level that each of them has.
type Levels<'a> = Vec<(&'a str, &'a str)>;

/// Levels of every condition that both logs have, in the order of the real one, and names of those that one has alone.
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
    let lonely = real
        .iter()
        .filter(|levels| !simulated.contains(levels))
        .chain(simulated.iter().filter(|levels| !real.contains(levels)))
        .map(|levels| name(levels))
        .collect();
    real.retain(|levels| simulated.contains(levels));
    (real, lonely)
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

/// Share of pairs whose simulated trial surely took longer minus the share whose real one did.
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

/// Levels by their median, fastest first; a level that was never half finished comes last.
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
    // Every level of every world is resampled with numbers of its own.
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
            None => "not half finished".to_owned(),
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
                "another order"
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
                "\nranks of the conditions' medians: {rho:+.2} (Spearman, p = {p:.3})"
            )?;
        }
        Ok(())
    }
}
