//! Two sets of recorded runs: do they move alike? No simulator is asked.
//!
//! Runs that repeat one experiment are compared whole, by an energy test that exchanges runs.

use std::fmt;

use rand::seq::SliceRandom;
use rayon::prelude::*;
use serde::Serialize;

use super::floor::{Pairs, pairs_of};
use super::{Sample, Scoring};
use crate::claim::SIGNIFICANT;
use realgap_core::random::Once;
use realgap_core::statistics::{EnergyTest, energy_test};
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::{Unit, counted, number, quantity};
use realgap_core::{Error, Result, Warning};
use realgap_path::trajectory::Trajectory;

/// Fewer runs in a set than this cannot be told apart by exchanging runs: 4 and 4 have 70 divisions.
pub const LEAST_REPEATS: usize = 4;
/// Random divisions of all runs behind a power.
const POWER_DRAWS: usize = 40;
/// Factors by which the second set is longer in the power of the test.
const LONGER: [f64; 6] = [1.02, 1.05, 1.1, 1.2, 1.5, 2.0];
/// Share of draws in which a difference has to be found, so that it counts as one that the test finds.
const POWER: f64 = 0.8;

/// What the comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Alike {
    /// The sets differ by more than their own spread.
    Differ,
    /// No difference is found; the least difference that would be found is stated.
    NoneFound,
    /// The recordings cannot tell.
    CannotTell,
}

/// The energy test of whole runs by one metric.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RepeatsTest {
    /// Name of the metric.
    pub metric: &'static str,
    /// Unit of the distances.
    pub unit: Unit,
    /// The test.
    #[serde(flatten)]
    pub test: EnergyTest,
    /// The least factor, of those tried, by which all paths of the second set would have to be longer, so that 8 of 10 such pairs of sets
    /// are told apart; `None` where even twice as long is not found.
    pub finds_longer: Option<f64>,
}

/// Two sets of runs, compared; its `Display` is a text for readers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Between {
    /// Version of this crate.
    pub version: &'static str,
    /// The answer.
    pub answer: Alike,
    /// The answer as a sentence, with its numbers.
    pub text: String,
    /// Numbers of runs in the two sets.
    pub runs: [usize; 2],
    /// Tests of whole runs, the deciding metric first.
    pub repeats: Vec<RepeatsTest>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Between {
    /// Compares two sets of whole runs.
    ///
    /// # Errors
    /// Fewer than four runs in a set, the same run in both sets, a metric that cannot compare the runs.
    pub fn repeats(first: &[Sample], second: &[Sample], scoring: &Scoring) -> Result<Self> {
        let runs = checked(first, second)?;
        if runs.iter().any(|runs| *runs < LEAST_REPEATS) {
            return Err(Error::invalid("too few repeats to be exchanged")
                .found(format!("{} and {}", runs[0], counted(runs[1], "run")))
                .allowed(format!("{LEAST_REPEATS} or more runs in each set"))
                .hint("record more repeats of the same run"));
        }
        let all: Vec<&Sample> = first.iter().chain(second).collect();
        Self::of_repeats(runs, &all, scoring)
    }

    fn of_repeats(runs: [usize; 2], all: &[&Sample], scoring: &Scoring) -> Result<Self> {
        let basis = scoring.basis(all.iter().copied())?;
        let context = scoring.context(basis.as_ref());
        let mut repeats = Vec::new();
        let mut warnings = Vec::new();
        for (index, metric) in scoring.metrics.iter().enumerate() {
            let (pairs, heard) = Pairs::measure(*metric, &context, all)?;
            warnings.extend(heard.into_warnings("two sets"));
            let test = energy_test(&pairs.values, runs[0], scoring.seed)?;
            // Only the first metric decides, so that several metrics do not raise the share of false alarms.
            let finds_longer = match index {
                0 => longer(all, runs, scoring)?,
                _ => None,
            };
            repeats.push(RepeatsTest {
                metric: metric.name(),
                unit: metric.unit(),
                test,
                finds_longer,
            });
        }
        let Some(first) = repeats.first() else {
            return Err(Error::invalid("no metric compares the sets"));
        };
        let p = number(first.test.p_value);
        let by = format!("energy test by {}, p = {p}", first.metric);
        let differ = first.test.p_value <= SIGNIFICANT;
        let (answer, text) = match first.finds_longer {
            _ if differ => (
                Alike::Differ,
                format!(
                    "The two sets differ ({by}). Whether the floor, the robot or the starts differ, the test does not say."
                ),
            ),
            Some(factor) => (
                Alike::NoneFound,
                format!(
                    "No difference is found ({by}); paths longer by {} % would be found in 8 of 10 cases.",
                    number(100.0 * (factor - 1.0))
                ),
            ),
            None => (
                Alike::CannotTell,
                format!(
                    "These runs cannot tell ({by}): even paths of twice the length would not be found in 8 of 10 cases."
                ),
            ),
        };
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            answer,
            text,
            runs,
            repeats,
            warnings,
        })
    }
}

/// The numbers of runs in two sets, neither of which is empty, and which share no run.
fn checked(first: &[Sample], second: &[Sample]) -> Result<[usize; 2]> {
    for (set, name) in [(first, "first"), (second, "second")] {
        if set.is_empty() {
            return Err(Error::invalid(format!("the {name} set has no run")));
        }
    }
    let twin = |run: &&Sample| second.iter().any(|other| other.motion == run.motion);
    if let Some(run) = first.iter().find(twin) {
        return Err(Error::invalid("one run is in both sets")
            .found(&run.name)
            .hint("give each run to one set: a run is always like itself"));
    }
    Ok([first.len(), second.len()])
}

/// The least factor of [`LONGER`] that the test finds with a probability of [`POWER`], by the first metric.
///
/// All runs are divided at random, so that both sets have one distribution; then the paths of the second are stretched.
fn longer(all: &[&Sample], runs: [usize; 2], scoring: &Scoring) -> Result<Option<f64>> {
    let Some(metric) = scoring.metrics.first() else {
        return Ok(None);
    };
    let count = all.len();
    let mut rng = Once::Resampling.generator(scoring.seed);
    let divisions: Vec<Vec<usize>> = (0..POWER_DRAWS)
        .map(|_| {
            let mut order: Vec<usize> = (0..count).collect();
            order.shuffle(&mut rng);
            let second = order.iter().skip(runs[0]).map(|run| run + count);
            order.iter().take(runs[0]).copied().chain(second).collect()
        })
        .collect();
    for factor in LONGER {
        let stretched = all
            .iter()
            .map(|run| Sample::new(run.name.clone(), stretched(&run.motion, factor)?))
            .collect::<Result<Vec<_>>>()?;
        let both: Vec<&Sample> = all.iter().copied().chain(&stretched).collect();
        let basis = scoring.basis(both.iter().copied())?;
        let (pairs, _) = Pairs::measure(*metric, &scoring.context(basis.as_ref()), &both)?;
        let found = divisions.par_iter().enumerate().map(|(draw, chosen)| {
            let pairs = pairs_of(count).map(|(i, j)| pairs.of(chosen[i], chosen[j]));
            let pairs: Vec<f64> = pairs.collect();
            let seed = scoring.seed.wrapping_add(draw as u64);
            Ok(energy_test(&pairs, runs[0], seed)?.p_value <= SIGNIFICANT)
        });
        let found = found.collect::<Result<Vec<bool>>>()?;
        let share = found.iter().filter(|found| **found).count() as f64 / POWER_DRAWS as f64;
        if share >= POWER {
            return Ok(Some(factor));
        }
    }
    Ok(None)
}

/// The path, with every point so much farther from the start.
fn stretched(motion: &Trajectory, factor: f64) -> Result<Trajectory> {
    let Some(start) = motion.positions_world_m().first().copied() else {
        return Ok(motion.clone());
    };
    let points = motion.positions_world_m().iter();
    motion.clone().with_positions(
        points
            .map(|point| start + (point - start) * factor)
            .collect(),
    )
}

impl fmt::Display for Between {
    /// Writes the answer, then a row for each metric.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)?;
        if !self.repeats.is_empty() {
            let mut table = TextTable::new([
                ("metric", Side::Left),
                ("energy distance", Side::Left),
                ("energy ratio", Side::Right),
                ("same distribution? p", Side::Right),
            ]);
            for row in &self.repeats {
                let ratio = row.test.ratio.map_or("-".to_owned(), number);
                table.push([
                    row.metric.to_owned(),
                    quantity(row.test.distance, row.unit),
                    ratio,
                    number(row.test.p_value),
                ]);
            }
            write!(f, "\n{}", table.render(false).trim_end())?;
        }
        Ok(())
    }
}
