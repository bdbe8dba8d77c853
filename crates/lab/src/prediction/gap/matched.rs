//! Windows of two sets of runs that are alike in start and command: does the robot accelerate alike in them?
//!
//! Each window of the first set is paired with the most similar one of the second. If both sets come from one world, the difference of
//! a pair is as likely as its opposite, so that signs may be exchanged. Neighbouring windows are not independent: all pairs of one
//! block of time get one sign.

use nalgebra::{DMatrix, Vector2};
use rand::RngExt;
use serde::Serialize;

use super::between::{Alike, POWER};
use crate::claim::SIGNIFICANT;
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{PERMUTATIONS, mean, median, standard_deviation};
use realgap_core::unit::{counted, number};
use realgap_core::{Error, Result};
use realgap_path::trajectory::Trajectory;

/// The velocity at a time is that of this time before it, seconds.
const PAST_S: f64 = 0.1;
/// Slower robots are left out: their direction is uncertain.
const LEAST_SPEED_M_S: f64 = 0.2;
/// Windows are alike where their covariates differ by less than this many standard deviations, by root mean square over four.
const ALIKE: f64 = 0.5;
/// A block of time, seconds, unless a set is long: then a twelfth of it.
const LEAST_BLOCK_S: f64 = 1.0;
const BLOCKS: f64 = 12.0;
/// Six blocks have 32 different divisions of signs, so that p values below 0.05 exist.
const LEAST_BLOCKS: usize = 6;
/// Below this share of gravity a robot's motion hardly depends on friction: wheels roll almost without slip.
const EXCITED_G: f64 = 0.4;
const GRAVITY_M_S2: f64 = 9.81;
/// Differences of acceleration whose detection is tried, m/s².
const SHIFTS_M_S2: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
const POWER_DRAWS: usize = 40;
const POWER_PERMUTATIONS: usize = 199;
/// The ridge of the regression on what is left of unlike starts and commands, in pairs.
const RIDGE: f64 = 1.0;

/// The comparison of windows alike in start and command.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Matched {
    /// Length of a window, seconds.
    pub window_s: f64,
    /// Columns of commands in which windows are alike.
    pub commands: Vec<String>,
    /// Numbers of windows in the two sets.
    pub windows: [usize; 2],
    /// Pairs of windows that are alike.
    pub pairs: usize,
    /// Blocks of time whose signs are exchanged.
    pub blocks: usize,
    /// Share of exchanges of signs with a difference at least as large; `None` for fewer than six blocks.
    pub p_value: Option<f64>,
    /// Median over the pairs of the larger horizontal acceleration, m/s²; `None` without pairs.
    pub acceleration_m_s2: Option<f64>,
    /// Mean difference of acceleration, first less second set, forward and to the left, m/s².
    pub difference_m_s2: Option<[f64; 2]>,
    /// The least difference of acceleration, of those tried, that is found in 8 of 10 cases, m/s².
    pub finds_m_s2: Option<f64>,
}

impl Matched {
    /// The answer, and a sentence with its numbers.
    pub(super) fn answer(&self) -> (Alike, String) {
        let (Some(p_value), Some(acceleration_m_s2)) = (self.p_value, self.acceleration_m_s2)
        else {
            return (
                Alike::CannotTell,
                format!(
                    "These runs cannot tell: {} of windows alike in start and command in {} of time; {LEAST_BLOCKS} blocks are needed.",
                    counted(self.pairs, "pair"),
                    counted(self.blocks, "block")
                ),
            );
        };
        let share = acceleration_m_s2 / GRAVITY_M_S2;
        let test = format!(
            "p = {}, {} in {}",
            number(p_value),
            counted(self.pairs, "pair of windows"),
            counted(self.blocks, "block")
        );
        let test = test.replace("pair of windowss", "pairs of windows");
        if share < EXCITED_G {
            return (
                Alike::CannotTell,
                format!(
                    "These runs cannot tell: they accelerate by {} g only, where motion hardly depends on friction; {EXCITED_G} g is needed ({test}).",
                    number(share)
                ),
            );
        }
        match self.finds_m_s2 {
            _ if p_value <= SIGNIFICANT => {
                let [ahead, left] = self.difference_m_s2.unwrap_or_default();
                (
                    Alike::Differ,
                    format!(
                        "The two sets differ ({test}): after like starts and commands the first accelerates by {} m/s² more forward and {} m/s² more to the left.",
                        number(ahead),
                        number(left)
                    ),
                )
            }
            Some(finds) => (
                Alike::NoneFound,
                format!(
                    "No difference is found ({test}); a difference of {} m/s² would be found in 8 of 10 cases.",
                    number(finds)
                ),
            ),
            None => (
                Alike::CannotTell,
                format!(
                    "These runs cannot tell ({test}): even a difference of 4 m/s² would not be found in 8 of 10 cases."
                ),
            ),
        }
    }
}

/// One window: what it starts with and is commanded, and how the robot then accelerates.
struct Window {
    block: usize,
    covariates: Vec<f64>,
    acceleration_m_s2: Vector2<f64>,
}

/// Compares two sets of runs in windows alike in these columns of commands.
///
/// # Errors
/// A window that is no time, a run without one of the columns.
pub(super) fn matched(
    first: &[&Trajectory],
    second: &[&Trajectory],
    commands: &[String],
    window_s: f64,
    seed: u64,
) -> Result<Matched> {
    if !(0.05..=60.0).contains(&window_s) {
        return Err(Error::invalid("no length of a window")
            .field("window")
            .found(window_s)
            .allowed("0.05 to 60 s"));
    }
    let sets = [
        windows(first, commands, window_s)?,
        windows(second, commands, window_s)?,
    ];
    let counts = [sets[0].len(), sets[1].len()];
    let pairs = paired(&sets);
    let mut blocks: Vec<usize> = pairs.iter().map(|(i, _, _)| sets[0][*i].block).collect();
    blocks.sort_unstable();
    blocks.dedup();
    let block_of = |i: usize| blocks.partition_point(|block| *block < sets[0][i].block);
    let of_pair: Vec<usize> = pairs.iter().map(|(i, _, _)| block_of(*i)).collect();
    let mut found = Matched {
        window_s,
        commands: commands.to_vec(),
        windows: counts,
        pairs: pairs.len(),
        blocks: blocks.len(),
        p_value: None,
        acceleration_m_s2: None,
        difference_m_s2: None,
        finds_m_s2: None,
    };
    if pairs.is_empty() {
        return Ok(found);
    }
    let size = |window: &Window| window.acceleration_m_s2.norm();
    let demands = pairs
        .iter()
        .map(|(i, j, _)| size(&sets[0][*i]).max(size(&sets[1][*j])));
    let mut demands: Vec<f64> = demands.collect();
    demands.sort_by(f64::total_cmp);
    found.acceleration_m_s2 = Some(median(&demands));
    if blocks.len() < LEAST_BLOCKS {
        return Ok(found);
    }
    let apart = pairs
        .iter()
        .map(|(i, j, _)| sets[0][*i].acceleration_m_s2 - sets[1][*j].acceleration_m_s2);
    let differences = without_covariates(&apart.collect::<Vec<_>>(), &pairs);
    let axis = |k: usize| mean(&differences.iter().map(|d| d[k]).collect::<Vec<_>>());
    found.difference_m_s2 = Some([axis(0), axis(1)]);
    let mut rng = Once::Permutation.generator(seed);
    found.p_value = Some(p_value(
        &differences,
        &of_pair,
        blocks.len(),
        PERMUTATIONS,
        &mut rng,
    ));
    found.finds_m_s2 = finds(&differences, &of_pair, blocks.len(), &mut rng);
    Ok(found)
}

/// The windows of some runs, half a window apart. Blocks of different runs have different numbers.
fn windows(runs: &[&Trajectory], commands: &[String], window_s: f64) -> Result<Vec<Window>> {
    let total_s: f64 = runs.iter().map(|run| run.duration_s()).sum();
    let block_s = (total_s / BLOCKS).clamp(LEAST_BLOCK_S.max(2.0 * window_s), 30.0);
    let mut found = Vec::new();
    let mut before = 0;
    for run in runs {
        let columns = commands.iter().map(|name| {
            run.signal(name).ok_or_else(|| {
                let known: Vec<&str> = run.signals().iter().map(|s| s.name.as_str()).collect();
                Error::invalid("a run has no such column of commands")
                    .field("command")
                    .found(name)
                    .allowed(known.join(", "))
            })
        });
        let columns = columns.collect::<Result<Vec<_>>>()?;
        let times_s = run.times_s();
        let (begin_s, end_s) = (times_s[0], times_s[times_s.len() - 1]);
        let mut start_s = begin_s + PAST_S;
        while start_s + window_s <= end_s {
            let motion = Motion::at(run, start_s).zip(Motion::at(run, start_s + window_s));
            let from = times_s.partition_point(|t| *t < start_s - 1e-6);
            let to = times_s.partition_point(|t| *t <= start_s + window_s + 1e-6);
            let widest_s = times_s[from.saturating_sub(1)..to]
                .windows(2)
                .map(|t| t[1] - t[0]);
            let is_whole = widest_s.fold(0.0, f64::max) <= 0.25 * window_s.max(0.4);
            if let Some((start, end)) = motion
                && is_whole
                && start.velocity_m_s.norm() >= LEAST_SPEED_M_S
            {
                let ahead = Vector2::new(start.heading_rad.cos(), start.heading_rad.sin());
                let left = Vector2::new(-ahead.y, ahead.x);
                let inside = |of: Vector2<f64>| Vector2::new(ahead.dot(&of), left.dot(&of));
                let velocity = inside(start.velocity_m_s);
                let mut covariates = vec![velocity.x, start.turn_rad_s * velocity.norm()];
                for column in &columns {
                    covariates.push(mean(&column.values[from..to.max(from + 1)]));
                }
                // The direction in the middle of the window halves the effect of the turn within it.
                let turn_rad = 0.25 * window_s * (start.turn_rad_s + end.turn_rad_s);
                let change = inside(end.velocity_m_s - start.velocity_m_s) / window_s;
                let (sin, cos) = turn_rad.sin_cos();
                found.push(Window {
                    block: before + ((start_s - begin_s) / block_s) as usize,
                    covariates,
                    acceleration_m_s2: Vector2::new(
                        cos * change.x + sin * change.y,
                        cos * change.y - sin * change.x,
                    ),
                });
            }
            start_s += 0.5 * window_s;
        }
        before += (run.duration_s() / block_s) as usize + 1;
    }
    Ok(found)
}

/// How a robot moves in the plane, from the samples of the past tenth of a second.
struct Motion {
    velocity_m_s: Vector2<f64>,
    heading_rad: f64,
    turn_rad_s: f64,
}

impl Motion {
    fn at(run: &Trajectory, now_s: f64) -> Option<Self> {
        let times_s = run.times_s();
        let from = times_s.partition_point(|t| *t < now_s - PAST_S - 1e-6);
        let to = times_s.partition_point(|t| *t <= now_s + 1e-6);
        let past = from..to;
        if past.len() < 3 {
            return None;
        }
        let middle_s = mean(&times_s[past.clone()]);
        let slope = |values: &[f64]| {
            let about: Vec<f64> = times_s[past.clone()].iter().map(|t| t - middle_s).collect();
            let square: f64 = about.iter().map(|t| t * t).sum();
            about.iter().zip(values).map(|(t, v)| t * v).sum::<f64>() / square
        };
        let places = &run.positions_world_m()[past.clone()];
        let axis = |k: usize| slope(&places.iter().map(|p| p[k]).collect::<Vec<_>>());
        let velocity_m_s = Vector2::new(axis(0), axis(1));
        let directions: Vec<f64> = match run.orientations_world_from_body() {
            Some(turns) => turns[past.clone()]
                .iter()
                .map(|turn| turn.euler_angles().2)
                .collect(),
            // Without orientations the direction of travel stands for the heading.
            None => {
                let steps = run.positions_world_m()[from.saturating_sub(1)..to].windows(2);
                let steps = steps.map(|p| p[1] - p[0]).map(|step| step.y.atan2(step.x));
                let mut steps: Vec<f64> = steps.collect();
                while steps.len() < past.len() {
                    steps.insert(0, *steps.first()?);
                }
                steps
            }
        };
        let directions = unwrapped(directions);
        Some(Self {
            velocity_m_s,
            heading_rad: *directions.last()?,
            turn_rad_s: slope(&directions),
        })
    }
}

/// Angles without jumps of whole turns.
fn unwrapped(mut angles_rad: Vec<f64>) -> Vec<f64> {
    for k in 1..angles_rad.len() {
        let step = angles_rad[k] - angles_rad[k - 1];
        angles_rad[k] -= (step / std::f64::consts::TAU).round() * std::f64::consts::TAU;
    }
    angles_rad
}

/// Pairs of windows that are alike, the most similar first, each window in one pair: their indices, and how their covariates differ in
/// units of what counts as alike.
fn paired(sets: &[Vec<Window>; 2]) -> Vec<(usize, usize, Vec<f64>)> {
    let Some(some) = sets[0].first() else {
        return Vec::new();
    };
    let count = some.covariates.len();
    // A column that never changes does not matter.
    let scales: Vec<f64> = (0..count)
        .map(|k| {
            let all = sets.iter().flatten().map(|window| window.covariates[k]);
            let spread = standard_deviation(&all.collect::<Vec<_>>());
            if spread > 1e-9 { spread * ALIKE } else { 1.0 }
        })
        .collect();
    let limit = (count as f64 / 4.0).max(1.0).sqrt();
    let apart = |i: usize, j: usize| -> Vec<f64> {
        let both = sets[0][i].covariates.iter().zip(&sets[1][j].covariates);
        both.zip(&scales)
            .map(|((a, b), scale)| (a - b) / scale)
            .collect()
    };
    let mut near = Vec::new();
    for i in 0..sets[0].len() {
        for j in 0..sets[1].len() {
            let size = apart(i, j).iter().map(|d| d * d).sum::<f64>().sqrt();
            if size <= limit {
                near.push((size, i, j));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = [vec![false; sets[0].len()], vec![false; sets[1].len()]];
    let mut pairs = Vec::new();
    for (_, i, j) in near {
        if !taken[0][i] && !taken[1][j] {
            taken[0][i] = true;
            taken[1][j] = true;
            pairs.push((i, j, apart(i, j)));
        }
    }
    pairs
}

/// The differences without what a linear function of the differences of start and command explains. The function is odd, so that an
/// exchange of the two windows of a pair still changes the sign alone.
fn without_covariates(
    differences: &[Vector2<f64>],
    pairs: &[(usize, usize, Vec<f64>)],
) -> Vec<Vector2<f64>> {
    let count = pairs.first().map_or(0, |pair| pair.2.len());
    let rows = DMatrix::from_fn(pairs.len(), count, |i, k| pairs[i].2[k]);
    let answers = DMatrix::from_fn(pairs.len(), 2, |i, k| differences[i][k]);
    let square = rows.transpose() * &rows + DMatrix::identity(count, count) * RIDGE;
    let Some(factors) = square.cholesky() else {
        return differences.to_vec();
    };
    let left = &answers - &rows * factors.solve(&(rows.transpose() * &answers));
    (0..pairs.len())
        .map(|i| Vector2::new(left[(i, 0)], left[(i, 1)]))
        .collect()
}

/// The energy test of symmetry: 2 E‖d + d′‖ − 2 E‖d − d′‖ is 0 where d has the distribution of −d, and larger elsewhere.
fn p_value(
    differences: &[Vector2<f64>],
    of_pair: &[usize],
    blocks: usize,
    permutations: usize,
    rng: &mut Generator,
) -> f64 {
    // Signs are those of blocks, so that one sum for each two blocks suffices.
    let mut sums = vec![0.0; blocks * blocks];
    for (a, i) in differences.iter().zip(of_pair) {
        for (b, j) in differences.iter().zip(of_pair) {
            sums[i * blocks + j] += (a + b).norm() - (a - b).norm();
        }
    }
    let largest: f64 = sums.iter().map(|sum| sum.abs()).sum();
    let energy = |signs: &[f64]| {
        let row = |i: usize| (0..blocks).map(move |j| (i, j));
        let all = (0..blocks).flat_map(row);
        all.map(|(i, j)| signs[i] * signs[j] * sums[i * blocks + j])
            .sum::<f64>()
    };
    let observed = energy(&vec![1.0; blocks]);
    let as_large = (0..permutations).filter(|_| {
        let signs: Vec<f64> = (0..blocks)
            .map(|_| if rng.random_bool(0.5) { 1.0 } else { -1.0 })
            .collect();
        energy(&signs) >= observed - 1e-12 * largest
    });
    (as_large.count() + 1) as f64 / (permutations + 1) as f64
}

/// The least difference of [`SHIFTS_M_S2`], in any direction, that is found with a probability of [`POWER`] where the rest of the
/// differences has no sign.
fn finds(
    differences: &[Vector2<f64>],
    of_pair: &[usize],
    blocks: usize,
    rng: &mut Generator,
) -> Option<f64> {
    let center = differences.iter().sum::<Vector2<f64>>() / differences.len() as f64;
    SHIFTS_M_S2.into_iter().find(|shift_m_s2| {
        let found = (0..POWER_DRAWS).filter(|_| {
            let signs: Vec<f64> = (0..blocks)
                .map(|_| if rng.random_bool(0.5) { 1.0 } else { -1.0 })
                .collect();
            let angle_rad = rng.random_range(0.0..std::f64::consts::TAU);
            let shift = Vector2::new(angle_rad.cos(), angle_rad.sin()) * *shift_m_s2;
            let moved = differences.iter().zip(of_pair);
            let moved: Vec<Vector2<f64>> = moved
                .map(|(d, block)| (d - center) * signs[*block] + shift)
                .collect();
            p_value(&moved, of_pair, blocks, POWER_PERMUTATIONS, rng) <= SIGNIFICANT
        });
        found.count() as f64 >= POWER * POWER_DRAWS as f64
    })
}
