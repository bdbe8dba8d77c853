//! One mode of the posterior of a fit by least squares: a Gaussian approximation with its ridges, from which draws are made.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use realgap_core::error::Result;
use realgap_core::random::Generator;
use realgap_core::statistics::truncated_normal_quantile;
use realgap_optimization::{OptimizationProblem, UnitPoint};

use super::laplace::Laplace;
use super::ridge::{Follower, Ridge, clamped, room};
use super::runs::{CheckRuns, Finer};
use super::{CHECKED, FEW};

/// A direction with a larger standard deviation than this, as a share of a range, is followed by runs, and so is the least determined
/// one; at most so many are.
const WIDE: f64 = 0.03;
const MOST_RIDGES: usize = 3;
/// So is one with less than this share of the information about the best determined direction: so little may be a rounding error of
/// the differences.
const WEAK: f64 = 1e-4;
/// Step of the differences to both sides, as a share of a range.
const STEP: f64 = 0.01;
/// Length of a ridge, as a share of a range, up to which it needs no treatment of its own.
const SHORT: f64 = 0.1;
/// Steps of the last descent before the centre is taken as it is.
const LAST_STEPS: usize = 3;
/// How often the derivatives are taken again where these steps did not end.
const ROUNDS: usize = 6;
/// A step that promises to reduce the deviance by less is not made.
const SMALL_GAIN: f64 = 0.1;
/// Sweeps over all directions between two draws.
const SWEEPS: usize = 3;
/// How far a point of a ridge may lie outside of the range, as a share of it, before it is refused; it is then moved to the end of the
/// range. Between the points that were run a ridge is known to about so much.
const OUTSIDE: f64 = 0.02;

/// A mode of the posterior.
#[derive(Debug)]
pub(super) struct Mode {
    pub laplace: Laplace,
    ridges: Vec<Ridge>,
    /// How far the numerics move the mode in the limit of short timesteps.
    pub shift: DVector<f64>,
    /// How far equally valid runs move the mode, e.g. those from other starts: one list for each kind.
    pub variants: Vec<Vec<DVector<f64>>>,
    /// The step that the descent would go on with: what the budget left open.
    pub remaining: DVector<f64>,
}

/// A point is outside of a mode that lies farther from it than so many standard deviations, and than this share of a range.
const APART: f64 = 4.0;
const BESIDE: f64 = 0.05;

/// A position in a mode: a coordinate for each direction.
type Position = DVector<f64>;

/// Takes differences to both sides of the centre; at an end of the range, differences over one and two steps to the inside. Where there
/// are too few runs for both sides, one side is taken.
fn differences(laplace: &mut Laplace, runs: &mut CheckRuns<'_>) -> Result<()> {
    let dimensions = laplace.centre().len();
    if !runs.has_left(dimensions) {
        return Ok(());
    }
    let has_both = runs.has_left(2 * dimensions);
    let steps = |axis: usize| match laplace.centre()[axis] {
        low if low < STEP => (STEP, 2.0 * STEP),
        high if high > 1.0 - STEP => (-STEP, -2.0 * STEP),
        _ => (STEP, -STEP),
    };
    let moved = |axis: usize, step: f64| {
        let mut moved = laplace.centre().clone();
        moved[axis] += step;
        moved
    };
    let one = (0..dimensions).map(|axis| moved(axis, steps(axis).0));
    let other = (0..dimensions).map(|axis| moved(axis, steps(axis).1));
    let one = runs.run(one.collect())?;
    let other = match has_both {
        true => runs.run(other.collect())?,
        false => vec![None; dimensions],
    };
    let slope = |errors: &Option<Vec<f64>>, step: f64| {
        let after = errors.as_ref()?.iter().zip(laplace.errors());
        let slopes = after.map(|(after, before)| (after - before) / step);
        Some(DVector::from_iterator(laplace.errors().len(), slopes))
    };
    let mut central = DMatrix::zeros(laplace.errors().len(), dimensions);
    let mut asymmetry = central.clone();
    for axis in 0..dimensions {
        let (a, b) = steps(axis);
        match (slope(&one[axis], a), slope(&other[axis], b)) {
            (Some(near), Some(far)) => {
                central.set_column(axis, &((&near * b - &far * a) / (b - a)));
                asymmetry.set_column(axis, &((near - far) * (STEP / (a - b))));
            }
            (Some(only), None) | (None, Some(only)) => {
                central.set_column(axis, &only);
                // Where one of two runs diverged, nothing shows how far the other slope can be trusted.
                asymmetry.set_column(axis, &(only * f64::from(u8::from(has_both))));
            }
            (None, None) => (),
        }
    }
    laplace.with_both_sides(&central, &asymmetry);
    Ok(())
}

/// Moves the centre to the lowest deviance by a few steps with the derivatives as they are; whether a step more would gain little.
fn last_steps(laplace: &mut Laplace, runs: &mut CheckRuns<'_>) -> Result<bool> {
    for _ in 0..LAST_STEPS {
        let step = laplace.step(laplace.centre(), laplace.errors());
        if laplace.gain(&step) < SMALL_GAIN {
            return Ok(true);
        }
        let target = clamped(&(DVector::from_column_slice(laplace.centre()) + step));
        let Some(errors) = runs.run(vec![target.clone()])?.pop().flatten() else {
            return Ok(false);
        };
        if laplace.deviance(&target, &errors) >= laplace.lowest() {
            return Ok(false);
        }
        laplace.move_to(target, errors);
    }
    let step = laplace.step(laplace.centre(), laplace.errors());
    Ok(laplace.gain(&step) < SMALL_GAIN)
}

impl Mode {
    /// Moves the centre to the lowest deviance and follows its ridges.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn new(
        problem: &OptimizationProblem,
        mut laplace: Laplace,
        runs: &mut CheckRuns<'_>,
    ) -> Result<Self> {
        let dimensions = laplace.centre().len();
        differences(&mut laplace, runs)?;
        let mut has_ended = last_steps(&mut laplace, runs)?;
        // Of few parameters, a descent that its budget cut off is brought to its end, because nothing can be learned around a point
        // that is no minimum.
        for _ in 0..ROUNDS {
            if has_ended
                || dimensions > FEW
                || !runs.has_left(2 * dimensions + LAST_STEPS + CHECKED)
            {
                break;
            }
            laplace.renew(problem);
            differences(&mut laplace, runs)?;
            has_ended = last_steps(&mut laplace, runs)?;
        }
        let best_known = laplace.information(dimensions - 1);
        let is_weak = |k: usize| laplace.information(k) < WEAK * best_known;
        let wide: Vec<usize> = (0..dimensions)
            .filter(|k| *k == 0 || laplace.deviation(*k) > WIDE || is_weak(*k))
            .take(MOST_RIDGES)
            .collect();
        let sides = wide.iter().flat_map(|k| [(*k, -1.0), (*k, 1.0)]);
        let mut followers: Vec<Follower> = sides
            .map(|(k, side)| Follower::new(&laplace, k, side))
            .collect();
        loop {
            let asking: Vec<usize> = (0..followers.len())
                .filter(|index| followers[*index].next.is_some())
                .collect();
            let points = asking
                .iter()
                .filter_map(|index| followers[*index].next.clone());
            let points: Vec<UnitPoint> = points.collect();
            if points.is_empty() || !runs.has_left(points.len() + CHECKED) {
                break;
            }
            for (index, errors) in asking.into_iter().zip(runs.run(points)?) {
                followers[index].tell(&laplace, errors.as_deref());
            }
        }
        let mut ridges = Vec::new();
        let mut sides = followers.into_iter();
        while let (Some(one), Some(other)) = (sides.next(), sides.next()) {
            // A ridge that was not followed to its ends would seem to end where the runs did.
            if one.is_finished() && other.is_finished() {
                let ridge = Ridge::new([one, other], dimensions);
                // A short one is what the Gaussian approximation says already.
                ridges.extend(Some(ridge).filter(|ridge| ridge.length() > SHORT));
            }
        }
        let mut mode = Self {
            shift: DVector::zeros(dimensions),
            variants: Vec::new(),
            remaining: DVector::zeros(dimensions),
            laplace,
            ridges,
        };
        let laplace = &mode.laplace;
        let step = mode.across_ridges(laplace.step(laplace.centre(), laplace.errors()));
        let within = laplace.centre().iter().zip(step.iter());
        let within = within.map(|(at, step)| (at + step).clamp(0.0, 1.0) - at);
        mode.remaining = DVector::from_iterator(dimensions, within);
        Ok(mode)
    }

    /// Whether a point lies elsewhere than this mode and its ridges.
    pub fn is_apart(&self, point: &[f64]) -> bool {
        let from = point.iter().zip(self.laplace.centre()).map(|(a, b)| a - b);
        let mut position = self
            .laplace
            .directions
            .tr_mul(&DVector::from_iterator(point.len(), from));
        let mut is_beside = false;
        for ridge in &self.ridges {
            let (from, to) = ridge.ends();
            let along = position[ridge.direction];
            is_beside |= along < from - BESIDE || along > to + BESIDE;
            let off = self.laplace.directions.tr_mul(&ridge.off(along));
            position -= off;
            position[ridge.direction] = 0.0;
        }
        let distances = position.iter().enumerate();
        let distances =
            distances.map(|(k, at)| at.abs() / (APART * self.laplace.deviation(k)).max(BESIDE));
        is_beside || distances.fold(0.0, f64::max) > 1.0
    }

    /// How many standard deviations the remaining step is long.
    pub fn remaining_deviations(&self) -> f64 {
        self.laplace.deviations(&self.remaining)
    }

    /// Whether a ridge reaches an end of the range on which the parameter changes by at least this much: its values end there because
    /// the range of some parameter does, and not because the recordings say so.
    pub fn is_open(&self, axis: usize, change: f64) -> bool {
        self.ridges.iter().any(|ridge| {
            let (from, to) = ridge.open_ends();
            let at = |along: f64| {
                let line = self.laplace.directions[(axis, ridge.direction)] * along;
                line + ridge.off(along)[axis]
            };
            let ends = [from, to].into_iter().flatten();
            ends.map(at).any(|moved| moved.abs() > change)
        })
    }

    /// Whether a direction was followed by runs.
    pub fn has_ridges(&self) -> bool {
        !self.ridges.is_empty()
    }

    /// How far the lowest deviance lies from the centre with a timestep that is multiplied by a factor, by so many steps with the
    /// derivatives at the centre; `None` where a run diverges.
    pub fn refitted(
        &self,
        steps: usize,
        (factor, run): (f64, &mut Finer<'_>),
    ) -> Result<Option<DVector<f64>>> {
        let centre = DVector::from_column_slice(self.laplace.centre());
        let mut at = centre.clone();
        for _ in 0..steps {
            let point = clamped(&at);
            let errors = run(&point, factor)?;
            let whole = errors.filter(|errors| errors.len() == self.laplace.errors().len());
            let Some(errors) = whole else {
                return Ok(None);
            };
            at = DVector::from_vec(point) + self.across_ridges(self.laplace.shift(&errors));
        }
        Ok(Some(at - centre))
    }

    /// Sets how far the numerics move the mode, from how far it moves with half and with a quarter of the timestep. The limit is as far
    /// from the quarter as the quarter is from the half (extrapolation of first order; Richardson 1911).
    pub fn set_shift(&mut self, half: &DVector<f64>, quarter: &DVector<f64>) {
        self.shift = quarter * 2.0 - half;
    }

    /// A move without its parts along ridges, which the runs along them show.
    pub fn across_ridges(&self, mut by: DVector<f64>) -> DVector<f64> {
        for ridge in &self.ridges {
            let along = self.laplace.directions.column(ridge.direction);
            by -= along * along.dot(&by);
        }
        by
    }

    fn ridge(&self, direction: usize) -> Option<&Ridge> {
        self.ridges
            .iter()
            .find(|ridge| ridge.direction == direction)
    }

    fn point(&self, position: &Position) -> DVector<f64> {
        let centre = DVector::from_column_slice(self.laplace.centre());
        let mut point = centre + &self.laplace.directions * position;
        for ridge in &self.ridges {
            point += ridge.off(position[ridge.direction]);
        }
        point
    }

    /// The promised deviance of a position relative to the centre, as if errors were independent.
    fn promised(&self, position: &Position) -> f64 {
        let all = position
            .iter()
            .enumerate()
            .map(|(k, at)| match self.ridge(k) {
                Some(ridge) => self.laplace.inflation_along(k) * ridge.deviance(*at),
                None => self.laplace.information(k) * at * at,
            });
        all.sum()
    }

    /// Logarithm of the share of the unit cube that the mode takes, up to a constant.
    pub fn log_volume(&self) -> f64 {
        let centre = self.laplace.centre();
        let widths = (0..centre.len()).map(|k| {
            let line = self.laplace.directions.column(k).into_owned();
            let extent = room(centre, &line) + room(centre, &-line);
            (std::f64::consts::TAU.sqrt() * self.laplace.deviation(k)).min(extent.max(1e-6))
        });
        widths.map(libm::log).sum()
    }

    /// So many draws, with the deviance that is promised for each (Gibbs sampling along ridges and uncorrelated directions, within the
    /// range). The shift by the numerics is not in them.
    pub fn draws(&self, count: usize, rng: &mut Generator) -> Vec<(UnitPoint, f64)> {
        let dimensions = self.laplace.centre().len();
        let straight: Vec<usize> = (0..dimensions)
            .filter(|k| self.ridge(*k).is_none())
            .collect();
        let (axes, precisions) = self.laplace.uncorrelated(&straight);
        // One coordinate for each ridge and for each uncorrelated direction.
        let mut drawn = Position::zeros(dimensions);
        let is_within =
            |point: &DVector<f64>| point.iter().all(|c| (-OUTSIDE..=1.0 + OUTSIDE).contains(c));
        let mut draws = Vec::with_capacity(count);
        for _ in 0..count {
            for _ in 0..SWEEPS {
                for k in 0..dimensions {
                    let share: f64 = rng.random();
                    match self.ridge(k) {
                        Some(ridge) => {
                            let mut other = drawn.clone();
                            other[k] = ridge.at_share(share);
                            if is_within(&self.point(&(&axes * &other))) {
                                drawn = other;
                            }
                        }
                        None => {
                            let point = self.point(&(&axes * &drawn));
                            let line = &self.laplace.directions * axes.column(k);
                            drawn[k] = along((&line, precisions[k]), &point, drawn[k], share);
                        }
                    }
                }
            }
            let position = &axes * &drawn;
            let point = clamped(&self.point(&position));
            draws.push((point, self.promised(&position)));
        }
        draws
    }
}

/// A normal number along a direction with this precision, truncated to the range.
fn along(
    (line, precision): (&DVector<f64>, f64),
    point: &DVector<f64>,
    now: f64,
    share: f64,
) -> f64 {
    let inside = clamped(point);
    let (low, high) = (
        now - room(&inside, &-line.clone()),
        now + room(&inside, line),
    );
    let precision = precision.sqrt();
    if precision * (high - low) < 1e-6 {
        return low + share * (high - low);
    }
    truncated_normal_quantile(low * precision, high * precision, share) / precision
}
