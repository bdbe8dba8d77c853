//! How far a robot gets in an engine that nobody has asked: learned from MuJoCo on random robots.
//!
//! What the own engines do says where another one's runs are to be expected, and how far off they may be: what they do with contacts
//! like its own, how far the two part, how the repeats spread, and how much the robot feels of what nobody can measure. By how many such distances MuJoCo's runs
//! were off, robot by robot, is the distribution of further ones (split conformal prediction with a normalised score: Lei et al.
//! 2018). Doubt about numerics is part of that distance, and is not multiplied on it again.

use super::Range;

/// What MuJoCo made of random robots: tools/engine_spread.py, docs/validation/ensembles.md.
const LEARNED: &str = include_str!("engines.csv");
/// Expected displacement as a share of that with relaxed contacts; where nothing has run it with these, as a share of the geometric
/// mean of both own engines.
const SHARE: f64 = 0.95;
const SHARE_OF_EXACT: f64 = 0.9;
/// The distance is, squared and summed: half of the repeats' spread, what the robot feels, a tenth of the expected displacement and a
/// fifth of what the own engines part by and of what relaxed contacts change. All of these numbers were chosen on the learned
/// robots, one of them left out at a time.
const TENTH: f64 = 0.1;
const FIFTH: f64 = 0.2;

/// What the own engines say about a robot; all in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnEngines {
    /// Mean net displacement of the repeats.
    pub own_m: f64,
    /// The same in the second engine; `None` where it cannot run the robot.
    pub second_m: Option<f64>,
    /// The same there with contacts that are relaxed, as other engines have them; `None` likewise.
    pub relaxed_m: Option<f64>,
    /// Standard deviation of the repeats' net displacements.
    pub spread_m: f64,
    /// How repeats in the second engine spread under the noise of a robot that nobody has measured: their interquartile range over
    /// that of a standard normal distribution, for a repeat that falls over is none of what the others feel.
    pub sensitivity_m: f64,
    /// Edge length of the tracked module.
    pub body_length_m: f64,
}

impl OwnEngines {
    /// Whether the robot gets at least a body length far. One that does not is judged by robots that do not, either.
    fn walks(&self) -> bool {
        self.own_m >= self.body_length_m
    }

    /// Displacement that is expected in another engine, and the distance by which it may be off, metres.
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

/// A robot that another engine has run, and its net displacements there, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// What the own engines say.
    pub known: OwnEngines,
    /// What the other one did.
    pub theirs_m: Vec<f64>,
}

impl Judged {
    /// The robots of a table by tools/engine_spread.py. What is no row of numbers is left out, as its header is.
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

/// Where the runs of a robot end in another engine.
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
    /// Net displacements, each as likely, metres, in increasing order.
    ends_m: Vec<f64>,
}

impl OtherEngine {
    /// As learned from MuJoCo.
    pub fn new(known: &OwnEngines) -> Self {
        let (expected_m, distance_m) = known.expected();
        let mut ends_m = Vec::new();
        for mut robot in Judged::table(LEARNED) {
            if robot.known.walks() != known.walks() {
                continue;
            }
            // What no second engine has run is judged by what was known without it.
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

    /// The range that holds this share of runs, metres: between ends of rank `level (n + 1)`, so that a further one is as often
    /// inside as stated, however few there are.
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

    /// Probability that a run gets at least so far: never 0 or 1, which so few robots cannot show.
    pub fn reaches(&self, least_m: f64) -> f64 {
        let far = self.ends_m.iter().filter(|m| **m >= least_m).count();
        (far as f64 + 0.5) / (self.ends_m.len() + 1) as f64
    }
}
