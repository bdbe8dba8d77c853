//! Claims: every sentence that states something about reality is made in this module, together with the numbers that it rests on.
//! Other modules only show claims.
//!
//! A report holds its claims: terminal, pages, JSON and Python show their texts, tables their words. So no two places can say
//! different things, and no sentence is stronger than the numbers beside it (crates/page/src/report/contradiction/mod.rs looks for
//! both).

mod difference;
mod ensemble;
mod fit;
mod flight;
mod forecast;
mod gap;
mod given;
mod headline;
mod least_squares;
mod parameter;
mod residual;
mod search;
mod verdict;

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

pub(crate) use difference::difference;
pub(crate) use ensemble::{contradictions, recorded, region};
pub(crate) use fit::{engines, model, nearest, set};
pub use flight::flights;
pub(crate) use forecast::{reach, success};
pub(crate) use gap::{called, distance, floor, likeness, over_time, tests};
pub(crate) use given::{Comparison, FEW, beside, measured, told, trust_of, values};
pub(crate) use headline::{Ground, gap, trust};
pub(crate) use least_squares::least_squares;
pub(crate) use parameter::{Found, NAMED, parameter, summary};
pub use search::{BestOfSearch, search};
pub use verdict::{VERDICT, evidence, verdict, verdict_lines};

/// Significance level: below this p-value two samples are said to have different distributions.
pub(crate) const SIGNIFICANT: f64 = 0.05;

/// What a claim is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum About {
    /// How far the simulation is from reality, in a unit that people use: the first part of the verdict.
    Gap,
    /// Whether the answer may be trusted: the last part of the verdict.
    Trust,
    /// The best robot of a search.
    Winner,
    /// Whether any parameters of the model explain the recordings.
    Model,
    /// Where the simulation is nearest to reality.
    Best,
    /// Whether neither of two engines rejects that point.
    Engines,
    /// The confidence set of points.
    Set,
    /// One parameter.
    Parameter,
    /// The difference of one parameter between two sets of recordings.
    Difference,
    /// All parameters, in short.
    Parameters,
    /// Whether simulated repeats have the distribution of the recordings.
    Likeness,
    /// How many noise floors the simulation is away from the recordings.
    Distance,
    /// For how long the recordings stay in the regions of the repeats.
    OverTime,
    /// The noise floor: the distance between repeats of a recorded run.
    Floor,
    /// One region of an ensemble.
    Region,
    /// All regions of an ensemble, and the energy test.
    Ensemble,
    /// How far the robot moves, and by which behaviour.
    Reach,
    /// How likely the robot moves far enough.
    Success,
}

/// What the evidence of a claim says about its statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Conclusion {
    /// The evidence supports the statement, or nothing contradicts it.
    #[serde(rename = "holds")]
    Supported,
    /// The evidence contradicts the statement.
    #[serde(rename = "fails")]
    Rejected,
    /// The evidence does not decide.
    #[serde(rename = "open")]
    Inconclusive,
}

/// A statement about reality, with what it rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Claim {
    /// The subject of the claim.
    pub about: About,
    /// Which of several, e.g. a parameter or a level; empty where there is only one.
    pub name: String,
    /// What the evidence says of it.
    #[serde(rename = "says")]
    pub conclusion: Conclusion,
    /// The same for the cell of a table.
    pub word: String,
    /// The same as a sentence.
    pub text: String,
    /// Numbers that it rests on, by name; those that are not finite are left out.
    pub numbers: BTreeMap<String, f64>,
    /// Confidence level of its interval or region; `None` where it has none.
    pub level: Option<f64>,
    /// Recordings that it rests on, or simulated runs where it is about these.
    pub count: usize,
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Claim {
    fn new(about: About, conclusion: Conclusion, word: impl Into<String>, text: String) -> Self {
        Self {
            about,
            name: String::new(),
            conclusion,
            word: word.into(),
            text,
            numbers: BTreeMap::new(),
            level: None,
            count: 0,
        }
    }

    /// The part of the word before its reason, without "narrowed down to": for a row whose bar shows the interval.
    pub fn brief(&self) -> &str {
        let word = self.word.as_str();
        let word = word.strip_prefix("narrowed down to ").unwrap_or(word);
        let marks = [": ", ", but ", ", no closer"].into_iter();
        let end = marks.filter_map(|mark| word.find(mark)).min();
        &word[..end.unwrap_or(word.len())]
    }

    fn of(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The same claim with the ends of these intervals among its numbers, in order.
    fn with_intervals(mut self, intervals: &[(f64, f64)]) -> Self {
        for (index, (low, high)) in intervals.iter().enumerate() {
            let part = index + 1;
            let ends = [
                (format!("interval_{part}_low"), *low),
                (format!("interval_{part}_high"), *high),
            ];
            self.numbers.extend(ends);
        }
        self
    }

    fn resting_on(mut self, count: usize, numbers: &[(&str, f64)]) -> Self {
        self.count = count;
        let finite = numbers.iter().filter(|(_, value)| value.is_finite());
        self.numbers
            .extend(finite.map(|(name, value)| ((*name).to_owned(), *value)));
        self
    }

    fn at_level(mut self, level: f64) -> Self {
        self.level = Some(level);
        self
    }
}

/// `a`, `a and b`, `a, b and c`.
fn listed(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brief_word_is_the_interval_or_that_there_is_none() {
        let short = [
            (
                "narrowed down to 0.17 to 0.20 (90 %)",
                "0.17 to 0.20 (90 %)",
            ),
            (
                "not determined: the 90 % interval 0 to 1 covers half",
                "not determined",
            ),
            (
                "narrowed down to 1 to 2 (90 %), but values from 1",
                "1 to 2 (90 %)",
            ),
            (
                "narrowed down to 1 to 2 (90 %), no closer: numerical",
                "1 to 2 (90 %)",
            ),
            ("at most 0.3", "at most 0.3"),
        ];
        for (whole, expected) in short {
            let claim = Claim::new(
                About::Parameter,
                Conclusion::Supported,
                whole,
                String::new(),
            );
            assert_eq!(claim.brief(), expected);
        }
    }
}
