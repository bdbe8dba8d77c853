//! Displacement of a robot in an engine outside of the program: a conformal prediction that is learned from MuJoCo's runs of
//! random robots, or a prediction about MuJoCo's runs of this robot.
//!
//! The own engines give the expected displacement in another engine and its typical error. The error depends on what the own
//! engines do with relaxed contacts, on the difference between them, on the spread of the repeats, and on the sensitivity of the
//! robot to unmeasured noise. The distribution of MuJoCo's errors in these units, robot by robot, is taken as that of further
//! robots (split conformal prediction with a normalised score: Lei et al. 2018). The uncertainty of numerics is part of the error
//! already, and is not multiplied on it again.

use super::Range;
use realgap_core::statistics::{mean, standard_deviation, student_quantile};

/// MuJoCo's displacements of random robots: tools/engine_spread.py, docs/validation/ensembles.md.
const LEARNED: &str = include_str!("engines.csv");
/// Expected displacement as a share of that with relaxed contacts; for a robot that was not run with these, as a share of the
/// geometric mean of both own engines.
const SHARE: f64 = 0.95;
const SHARE_OF_EXACT: f64 = 0.9;
/// Weights of the expected error, which is a root of a sum of squares: half of the repeats' spread, the sensitivity, a tenth of
/// the expected displacement, and a fifth of the difference between the own engines and of the change by relaxed contacts. All of
/// these weights were chosen on the learned robots by leaving out one at a time.
const TENTH: f64 = 0.1;
const FIFTH: f64 = 0.2;
/// Typical difference between MuJoCo, asked about a robot, and further engines and contacts, as a multiple of the typical error that
/// the own engines show: chosen on the first 12 robots of tools/engine_opinions.py, so that 90 % ranges hold 90 % of their runs
/// elsewhere, and judged on the others (docs/validation/ensembles.md).
const BEYOND: f64 = 1.5;
/// Quantiles by which a distribution is kept.
const QUANTILES: usize = 999;

/// The results of the own engines for a robot; all in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnEngines {
    /// Mean net displacement of the repeats.
    pub own_m: f64,
    /// The same in the second engine; `None` where it cannot run the robot.
    pub second_m: Option<f64>,
    /// Mean net displacement in the second engine with relaxed contacts, as in other engines; `None` where it cannot run the
    /// robot.
    pub relaxed_m: Option<f64>,
    /// Standard deviation of the repeats' net displacements.
    pub spread_m: f64,
    /// Spread of the repeats in the second engine under the noise of an unmeasured robot: their interquartile range over that of
    /// a standard normal distribution, so that a single repeat that falls over does not change it.
    pub sensitivity_m: f64,
    /// Edge length of the tracked module.
    pub body_length_m: f64,
}

impl OwnEngines {
    /// Whether the robot moves at least a body length. A robot that does not is compared with robots that do not either.
    fn walks(&self) -> bool {
        self.own_m >= self.body_length_m
    }

    /// Expected displacement in another engine, and its typical error, metres.
    fn expected(&self) -> (f64, f64) {
        let second_m = self.second_m.unwrap_or(self.own_m);
        let middle_m = (self.own_m * second_m).sqrt();
        let relaxed = self.relaxed_m.map(|relaxed_m| SHARE * relaxed_m);
        let expected_m = relaxed.unwrap_or(SHARE_OF_EXACT * middle_m);
        let parts_m = [
            0.5 * self.spread_m,
            self.sensitivity_m,
            TENTH * expected_m,
            FIFTH * (self.own_m - second_m),
            FIFTH * (expected_m - middle_m),
        ];
        let squared: f64 = parts_m.iter().map(|part_m| part_m * part_m).sum();
        (expected_m, squared.sqrt())
    }
}

/// A robot that was run in another engine, with its net displacements there, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The results of the own engines.
    pub known: OwnEngines,
    /// The net displacements in the other engine.
    pub theirs_m: Vec<f64>,
}

impl Judged {
    /// The robots of a table by tools/engine_spread.py. Rows that are not numbers, such as the header, are left out.
    pub fn table(text: &str) -> impl Iterator<Item = Self> {
        text.lines().filter_map(Self::row)
    }

    fn row(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [_seed, _modules, _friction, numbers @ .., runs] = cells.as_slice() else {
            return None;
        };
        let all = |cells: &[&str]| cells.iter().map(|cell| cell.parse().ok()).collect();
        let numbers: Option<Vec<f64>> = all(numbers);
        let [
            body_length_m,
            own_m,
            spread_m,
            second_m,
            relaxed_m,
            sensitivity_m,
        ] = numbers?[..]
        else {
            return None;
        };
        let theirs_m: Option<Vec<f64>> = all(&runs.split(' ').collect::<Vec<_>>());
        Some(Self {
            known: OwnEngines {
                own_m,
                second_m: Some(second_m),
                relaxed_m: Some(relaxed_m),
                spread_m,
                sensitivity_m,
                body_length_m,
            },
            theirs_m: theirs_m?,
        })
    }
}

/// Expected displacements of a robot in another engine.
///
/// ```
/// use realgap_lab::prediction::{OtherEngine, OwnEngines};
///
/// let alike = OwnEngines {
///     own_m: 0.3,
///     second_m: Some(0.3),
///     relaxed_m: Some(0.3),
///     spread_m: 0.01,
///     sensitivity_m: 0.01,
///     body_length_m: 0.058,
/// };
/// let apart = OwnEngines { second_m: Some(0.1), ..alike };
/// let width_m = |known| {
///     let range = OtherEngine::new(known).central(0.9);
///     range.high - range.low
/// };
/// assert!(width_m(&apart) / 0.1 > width_m(&alike) / 0.3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OtherEngine {
    /// Net displacements, equally likely, metres, in increasing order.
    ends_m: Vec<f64>,
}

impl OtherEngine {
    /// The displacements as learned from MuJoCo.
    pub fn new(known: &OwnEngines) -> Self {
        let (expected_m, distance_m) = known.expected();
        let mut ends_m = Vec::new();
        for mut robot in Judged::table(LEARNED) {
            if robot.known.walks() != known.walks() {
                continue;
            }
            // A robot without a run in the second engine is compared with what was known of the others without that run.
            robot.known.second_m = robot.known.second_m.filter(|_| known.second_m.is_some());
            robot.known.relaxed_m = robot.known.relaxed_m.filter(|_| known.relaxed_m.is_some());
            let (their_expected_m, their_distance_m) = robot.known.expected();
            let off = |m: &f64| (m - their_expected_m) / their_distance_m;
            let ends = robot.theirs_m.iter().map(off);
            ends_m.extend(ends.map(|off| (expected_m + distance_m * off).max(0.0)));
        }
        ends_m.sort_by(f64::total_cmp);
        Self { ends_m }
    }

    /// Number of robots from which was learned.
    pub fn robots() -> usize {
        Judged::table(LEARNED).count()
    }

    /// The displacements where MuJoCo has run this robot, too, under the same noise: a t-distribution about the mean of its runs,
    /// as of a further draw from a normal distribution of which this sample is known, and of the difference between MuJoCo with
    /// the contacts of the exported file and further engines and contacts.
    pub fn asked(known: &OwnEngines, runs_m: &[f64]) -> Self {
        let count = runs_m.len() as f64;
        let of_sample_m = standard_deviation(runs_m) * (1.0 + 1.0 / count).sqrt();
        let (_, distance_m) = known.expected();
        let spread_m = of_sample_m.hypot(BEYOND * distance_m);
        let ends = (0..QUANTILES).map(|index| {
            let level = (index as f64 + 0.5) / QUANTILES as f64;
            (mean(runs_m) + spread_m * student_quantile(level, count - 1.0)).max(0.0)
        });
        Self {
            ends_m: ends.collect(),
        }
    }

    /// The range that holds this share of runs, metres: between displacements of rank `level (n + 1)`, so that a further one is
    /// inside as often as stated, whatever their number is.
    pub fn central(&self, level: f64) -> Range {
        let last = self.ends_m.len().saturating_sub(1);
        let end = |share: f64| {
            let rank = (share * (last + 2) as f64 - 1.0).clamp(0.0, last as f64);
            let at = |rank: f64| self.ends_m.get(rank as usize).copied().unwrap_or(0.0);
            at(rank) + rank.fract() * (at(rank.ceil()) - at(rank))
        };
        Range {
            low: end(0.5 - 0.5 * level),
            high: end(0.5 + 0.5 * level),
        }
    }

    /// Probability that a run moves at least so far: never 0 or 1, which so few robots cannot show.
    pub fn reaches(&self, least_m: f64) -> f64 {
        let far = self.ends_m.iter().filter(|m| **m >= least_m).count();
        (far as f64 + 0.5) / (self.ends_m.len() + 1) as f64
    }
}
