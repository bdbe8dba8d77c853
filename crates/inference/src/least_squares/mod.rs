//! The posterior of a fit by least squares.
//!
//! Around the lowest deviance it is a Gaussian approximation (Laplace's method) whose noise has a scale for each channel and counts
//! correlated errors once (`noise`, `laplace`). Along directions that are hardly determined it is followed by runs (`ridge`). Other
//! descents that ended as low are modes of their own (`mode`). Draws are then run, and the agreement is part of the result: where no
//! ridge was followed, draws whose errors are larger than promised get lower weights (importance sampling; Kloek & van Dijk 1978).

mod agreement;
mod combination;
mod disagreement;
mod estimate;
mod laplace;
mod mode;
mod noise;
mod ridge;
mod runs;
#[cfg(test)]
mod tests;

use crate::posterior::PosteriorDraws;
use crate::resample::systematic;
use laplace::Laplace;
use mode::Mode;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use realgap_core::error::Result;
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{
    chi_squared_quantile, ends_of, mean_of, median, quantile, standard_deviation,
};
use realgap_optimization::{EvaluatedPoint, Grid, Linearisation, OptimizationProblem, UnitPoint};
use runs::CheckRuns;

pub use agreement::Agreement;
pub use combination::Combination;
pub use estimate::LeastSquaresEstimate;
pub use runs::{Evaluate, Finer};

/// Draws of the posterior.
const DRAWS: usize = 1000;
/// Draws that are run.
const CHECKED: usize = 24;
/// Most runs that check a posterior of a few parameters, and how many parameters these are. Of more parameters, the check costs at most
/// as many runs as the fit did.
const MOST_CHECKS: usize = 160;
const FEW: usize = 20;

/// Most runs that check a posterior of so many parameters after so many runs.
pub fn most_checks(parameters: usize, evaluated: usize) -> usize {
    match parameters {
        ..=FEW => MOST_CHECKS,
        _ => evaluated,
    }
}

/// A mode whose deviance is larger than the lowest by more than this is left out: its weight is below 0.003.
const FARTHEST: f64 = 12.0;
/// A run is obviously better than the centre of the best mode where its deviance is lower by so much (that of three standard
/// deviations), and the posterior is made again around such a run at most so often.
const BETTER: f64 = 9.0;
const RESTARTS: usize = 3;
/// Share of the evaluated points whose errors are smaller than those of a point far from the best one.
const FAR: f64 = 0.9;
/// The numerics move the truth by between these multiples of the shift to the limit of short timesteps. Reality has no timestep, so it
/// is at about 1; how fast the method converges is known roughly only; the best point, at 0, lies within.
const SHIFTS: (f64, f64) = (-0.25, 2.0);
/// A larger excess says no more than this one.
const MOST_EXCESS: f64 = 50.0;
/// Halvings of the range in which a factor on excesses is looked for.
const BISECTIONS: usize = 40;
/// Weight of the median excess beside those of the draws that were run; a draw at the same place has 1.
const NEARNESS: f64 = 0.1;
/// Runs with half and with a quarter of the timestep, with which the fit is repeated.
const REFITS: (usize, usize) = (2, 3);
/// Runs of [`LeastSquaresPosterior::with_numerics`].
pub const RUNS_OF_NUMERICS: usize = REFITS.0 + REFITS.1;
/// A parameter that changes along an open ridge by more than this share of its interval is not determined.
const OPEN: f64 = 0.25;
/// The truth is between these multiples of the remaining step from the point where the budget ended.
const REMAINING: (f64, f64) = (-0.5, 2.0);

/// A draw, before the numerics move it.
#[derive(Debug, Clone)]
struct Draw {
    point: UnitPoint,
    /// Number of its mode.
    mode: usize,
    /// The deviance above that of the mode's centre that is promised for it, as if errors were independent.
    promised: f64,
}

/// Runs that a mode takes at least: differences to both sides, last steps, and draws that are run.
fn runs_of_one_mode(parameters: usize) -> usize {
    2 * parameters + CHECKED
}

/// Size of the errors of a point far from the best one: all but a tenth of the points have smaller ones.
fn typical_size(evaluated: &[EvaluatedPoint]) -> f64 {
    let known = evaluated.iter().filter(|one| !one.errors.is_empty());
    let sizes = known.map(|one| mean_of(one.errors.iter().map(|error| error.abs())));
    let sizes: Vec<f64> = sizes.filter(|size| size.is_finite()).collect();
    match sizes.is_empty() {
        true => 0.0,
        false => quantile(&sizes, FAR),
    }
}

/// The posterior of a fit by least squares.
#[derive(Debug)]
pub struct LeastSquaresPosterior {
    /// The modes, with their deviance above that of the first.
    modes: Vec<(Mode, f64)>,
    agreement: Agreement,
    draws: Vec<Draw>,
}

impl LeastSquaresPosterior {
    /// From the points where descents ended, the best first; `None` without one. `evaluated` are the points that are known, and
    /// `evaluate` runs at most `most` further ones.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn new<'a>(
        problem: &OptimizationProblem,
        evaluated: &[EvaluatedPoint],
        linearisations: &[Linearisation],
        (evaluate, most): (&'a mut Evaluate<'a>, usize),
    ) -> Result<Option<Self>> {
        let Some(first) = linearisations.first() else {
            return Ok(None);
        };
        let mut runs = CheckRuns::new(evaluate, most, first.errors.len());
        let known = (problem, evaluated, linearisations);
        let mut posterior = Self::around(known, None, &mut runs)?;
        // A run that was made to check the posterior may be better than the point where the descent ended by more than a right
        // approximation allows: then that end was no minimum, and everything is made again from there.
        for _ in 0..RESTARTS {
            let better = posterior.better_run(&runs);
            if better.is_none() || !runs.has_left(runs_of_one_mode(problem.dimensions())) {
                break;
            }
            posterior = Self::around(known, better, &mut runs)?;
        }
        if let Some((point, errors)) = posterior.better_run(&runs) {
            posterior.agreement.remaining = posterior
                .agreement
                .remaining
                .max(posterior.better(&point, &errors).sqrt());
        }
        Ok(Some(posterior))
    }

    /// The posterior around the ends of descents, the best first, or for the first of them around a better run.
    fn around(
        (problem, evaluated, linearisations): (
            &OptimizationProblem,
            &[EvaluatedPoint],
            &[Linearisation],
        ),
        better: Option<(UnitPoint, Vec<f64>)>,
        runs: &mut CheckRuns<'_>,
    ) -> Result<Self> {
        let errors = linearisations[0].errors.len();
        let mut modes: Vec<(Mode, f64)> = Vec::new();
        for known in linearisations {
            let mut laplace = Laplace::new(problem, known);
            if modes.is_empty() {
                // The budget may end before there are differences around the last step.
                let known = evaluated.iter().filter(|one| one.score.is_some());
                let known = known.filter(|one| one.errors.len() == errors);
                let deviance = |one: &&EvaluatedPoint| laplace.deviance(&one.point, &one.errors);
                let lowest = known.min_by(|a, b| deviance(a).total_cmp(&deviance(b)));
                let lowest = lowest.map(|one| (one.point.clone(), one.errors.clone()));
                if let Some((point, errors)) = better.clone().or(lowest)
                    && point != *laplace.centre()
                {
                    laplace.move_to(point, errors);
                    laplace.renew(problem);
                }
            }
            let (excess, is_new) = match modes.first() {
                Some((best, _)) => {
                    let reference = &best.laplace;
                    let excess =
                        reference.deviance(laplace.centre(), laplace.errors()) - reference.lowest();
                    let excess = excess / reference.mean_inflation();
                    let is_new = modes
                        .iter()
                        .all(|(mode, _)| mode.is_apart(laplace.centre()));
                    (excess, is_new)
                }
                None => (0.0, true),
            };
            if is_new && excess < FARTHEST {
                modes.push((Mode::new(problem, laplace, runs)?, excess));
            }
        }
        let mut posterior = Self {
            agreement: Agreement {
                remaining: modes[0].0.remaining_deviations(),
                systematic: modes[0].0.laplace.systematic(typical_size(evaluated)),
                descents: None,
                checked: 0,
                effective: 0.0,
                excess: None,
            },
            modes,
            draws: Vec::new(),
        };
        posterior.agreement.descents = problem.has_several_starts().then(|| {
            let (best, _) = &posterior.modes[0];
            let ended = linearisations.iter().map(|known| &known.at);
            ended.filter(|at| !best.is_apart(at)).count()
        });
        posterior.check(problem.seed, runs)?;
        Ok(posterior)
    }

    /// By how much the deviance of these errors is below that of the best mode's centre, in units of the mean inflation.
    fn better(&self, point: &[f64], errors: &[f64]) -> f64 {
        let laplace = &self.modes[0].0.laplace;
        (laplace.lowest() - laplace.deviance(point, errors)) / laplace.mean_inflation()
    }

    /// The best of the runs that checked the posterior, where it is obviously better than the best mode's centre.
    fn better_run(&self, runs: &CheckRuns<'_>) -> Option<(UnitPoint, Vec<f64>)> {
        let known = runs.known().iter();
        let known = known.map(|(point, errors)| (self.better(point, errors), point, errors));
        let (better, point, errors) = known.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (better > BETTER).then(|| (point.clone(), errors.clone()))
    }

    /// The share of each mode.
    fn shares(&self) -> Vec<f64> {
        let logs = self
            .modes
            .iter()
            .map(|(mode, excess)| mode.log_volume() - 0.5 * excess);
        let logs: Vec<f64> = logs.collect();
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares: Vec<f64> = logs.iter().map(|log| libm::exp(log - largest)).collect();
        let total: f64 = shares.iter().sum();
        shares.iter().map(|share| share / total).collect()
    }

    /// Runs some draws and weighs all of them by how far these runs fall short of what was promised.
    fn check(&mut self, seed: u64, runs: &mut CheckRuns<'_>) -> Result<()> {
        let mut rng = Once::BestPoint.generator(seed);
        for (mode, share) in self.shares().into_iter().enumerate() {
            let count = (share * DRAWS as f64).round() as usize;
            let draws = self.modes[mode].0.draws(count, &mut rng).into_iter();
            let draws = draws.map(|(point, promised)| Draw {
                point,
                mode,
                promised,
            });
            self.draws.extend(draws);
        }
        let checked = CHECKED.min(self.draws.len());
        if checked == 0 || !runs.has_left(checked) {
            return Ok(());
        }
        let step = self.draws.len() / checked;
        let chosen: Vec<Draw> = (0..checked)
            .map(|k| self.draws[k * step + step / 2].clone())
            .collect();
        let points = chosen.iter().map(|draw| draw.point.clone()).collect();
        let (mut excesses, mut along) = (Vec::new(), Vec::new());
        for (draw, errors) in chosen.iter().zip(runs.run(points)?) {
            let mode = &self.modes[draw.mode].0;
            let laplace = &mode.laplace;
            let excess = errors.map_or(f64::INFINITY, |errors| {
                laplace.deviance(&draw.point, &errors) - laplace.lowest() - draw.promised
            });
            let excess = (excess / laplace.mean_inflation()).min(MOST_EXCESS);
            excesses.push(excess);
            // The density along a ridge was measured by the runs along it, and draws beside it are no less likely than those on it.
            along.push(if mode.has_ridges() { 0.0 } else { excess });
        }
        let dimensions = self.best().len();
        self.agreement = self.agreement.with_checks(&excesses, dimensions);
        self.draws = reweighted(&self.draws, (&chosen, &along), &mut rng);
        Ok(())
    }

    /// The simulated point with the lowest deviance.
    pub fn best(&self) -> &UnitPoint {
        self.modes[0].0.laplace.centre()
    }

    /// What is known about how good the approximation is.
    pub fn agreement(&self) -> Agreement {
        self.agreement
    }

    /// Variance of each fitted error, as if errors were independent, and how many of them count as one.
    pub fn noise(&self) -> (Vec<f64>, f64) {
        let laplace = &self.modes[0].0.laplace;
        (laplace.variances(), laplace.errors_for_one())
    }

    /// The errors of the best point as they would be if the fit had not seen the group of each, to first order; `groups` has the number
    /// of its group for every error. What a fit leaves of what it has seen is less than what it leaves of what it has not.
    pub fn left_out_errors(&self, groups: &[usize]) -> Vec<f64> {
        let laplace = &self.modes[0].0.laplace;
        match groups.len() == laplace.errors().len() {
            true => laplace.left_out(groups),
            false => laplace.errors().to_vec(),
        }
    }

    /// Precision of each coordinate before the recordings.
    pub fn prior_precisions(&self) -> Vec<f64> {
        self.modes[0].0.laplace.prior_precisions()
    }

    /// Whether the values of a parameter end where a range does, and not because of the recordings; `width` is the length of its
    /// interval, in coordinates.
    pub fn is_open(&self, axis: usize, width: f64) -> bool {
        self.modes
            .iter()
            .any(|(mode, _)| mode.is_open(axis, OPEN * width))
    }

    /// Whether a point with these errors belongs to the confidence set at this level (likelihood ratio).
    pub fn is_in_set(&self, point: &[f64], errors: &[f64], level: f64) -> bool {
        let laplace = &self.modes[0].0.laplace;
        let limit = chi_squared_quantile(level, point.len() as f64);
        let excess = laplace.deviance(point, errors) - laplace.lowest();
        errors.len() == laplace.errors().len() && excess / laplace.mean_inflation() <= limit
    }

    /// The score that the approximation expects at a point, as a multiple of that at the best point. A score is about proportional to
    /// the root of the deviance.
    pub fn relative_score(&self, point: &[f64]) -> f64 {
        self.relative(|laplace| laplace.beyond(point))
    }

    /// The lowest relative score of all points with this coordinate along one axis.
    pub fn relative_profile(&self, axis: usize, coordinate: f64) -> f64 {
        self.relative(|laplace| laplace.beyond_along(axis, coordinate))
    }

    /// The relative score where a mode's deviance exceeds that of its centre by so much, in the mode where it is lowest.
    fn relative(&self, beyond: impl Fn(&Laplace) -> f64) -> f64 {
        let of_mode = |(mode, excess): &(Mode, f64)| {
            excess * mode.laplace.mean_inflation() + beyond(&mode.laplace)
        };
        let beyond = self.modes.iter().map(of_mode).fold(f64::INFINITY, f64::min);
        let here = self.modes[0].0.laplace.lowest();
        (1.0 + beyond / here.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Adds what the numerics leave open: `run` gives the errors at a point with a timestep that is multiplied by a factor.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn with_numerics(mut self, run: &mut Finer<'_>) -> Result<Self> {
        // The shift of the best mode stands for that of the others, which are not run.
        let best = &mut self.modes[0].0;
        let half = best.refitted(REFITS.0, (0.5, &mut *run))?;
        let quarter = best.refitted(REFITS.1, (0.25, run))?;
        if let (Some(half), Some(quarter)) = (half, quarter) {
            best.set_shift(&half, &quarter);
        }
        Ok(self)
    }

    /// Adds what equally valid runs leave open, e.g. those from other starts: each item is the errors at the best point in another
    /// such run, drawn from what is not known of it. Calls add up.
    #[must_use]
    pub fn with_variants(mut self, others: &[Vec<f64>]) -> Self {
        let best = &mut self.modes[0].0;
        let others = others.iter();
        let others = others.filter(|errors| errors.len() == best.laplace.errors().len());
        let shifts = others.map(|errors| best.across_ridges(best.laplace.shift(errors)));
        let shifts: Vec<_> = shifts.collect();
        best.variants.push(shifts);
        self
    }

    /// The draws, in parameter values.
    pub fn posterior(&self, grid: &Grid, seed: u64) -> PosteriorDraws {
        let mut rng = Once::WithinCell.generator(seed);
        let best = &self.modes[0].0;
        let (shift, variants) = (&best.shift, &best.variants);
        let draws = self.draws.iter().map(|draw| {
            let mut factor = |(from, to): (f64, f64)| from + rng.random::<f64>() * (to - from);
            let remaining = &self.modes[draw.mode].0.remaining;
            let mut moves = shift * factor(SHIFTS) + remaining.map(|step| step * factor(REMAINING));
            // The drawn shifts are a sample of a normal distribution around 0, and so are their random sums.
            for shifts in variants {
                let share = 1.0 / (shifts.len().max(1) as f64).sqrt();
                for shift in shifts {
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    moves += shift * (normal * share);
                }
            }
            let moved = draw.point.iter().zip(moves.iter());
            let moved: UnitPoint = moved.map(|(at, by)| (at + by).clamp(0.0, 1.0)).collect();
            grid.values_at(&moved)
        });
        let draws: Vec<Vec<f64>> = draws.collect();
        let gaps = (0..grid.ranges().len()).map(|axis| self.gaps(axis, grid));
        PosteriorDraws::new(draws, gaps.collect())
    }

    /// Values along a parameter that lie between the draws of one mode and those of another.
    fn gaps(&self, axis: usize, grid: &Grid) -> Vec<f64> {
        let of_mode = |mode: usize| {
            let own = self.draws.iter().filter(|draw| draw.mode == mode);
            ends_of(own.map(|draw| draw.point[axis]))
        };
        let mut parts: Vec<(f64, f64)> = (0..self.modes.len()).map(of_mode).collect();
        parts.retain(|(low, high)| low <= high);
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut gaps = Vec::new();
        let mut end = f64::NEG_INFINITY;
        for (low, high) in parts {
            if end.is_finite() && low > end {
                gaps.push(grid.ranges()[axis].at(0.5 * (end + low)));
            }
            end = end.max(high);
        }
        gaps
    }
}

/// The weights of draws with these excesses, as if the excess of all were multiplied by the largest factor up to 1 with which the draws
/// count as at least so many (Kish 1965). Where runs at a few draws contradict the approximation strongly, the least of their excesses
/// would else be the whole posterior, and its intervals points: so few runs tell where it lies, and not that it has no width (tempered
/// weights, Koblents & Míguez 2015).
fn tempered(excesses: &[f64], least_effective: usize) -> Vec<f64> {
    let least = ends_of(excesses.iter().copied()).0;
    let weights = |factor: f64| -> Vec<f64> {
        let all = excesses.iter();
        all.map(|excess| libm::exp(-0.5 * factor * (excess - least)))
            .collect()
    };
    if effective(&weights(1.0)) >= least_effective as f64 {
        return weights(1.0);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match effective(&weights(middle)) >= least_effective as f64 {
            true => low = middle,
            false => high = middle,
        }
    }
    weights(low)
}

/// As how many draws of equal weight these count (Kish 1965).
fn effective(weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    match squares > 0.0 {
        true => total * total / squares,
        false => 0.0,
    }
}

/// The draws resampled by weights: the excess of the runs near a draw, in standard deviations of the draws, tells its own.
fn reweighted(
    draws: &[Draw],
    (chosen, excesses): (&[Draw], &[f64]),
    rng: &mut Generator,
) -> Vec<Draw> {
    let dimensions = draws[0].point.len();
    let spread = |axis: usize| {
        let values: Vec<f64> = draws.iter().map(|draw| draw.point[axis]).collect();
        standard_deviation(&values).max(1e-12)
    };
    let spreads: Vec<f64> = (0..dimensions).map(spread).collect();
    let middle = median(excesses);
    let near = |draw: &Draw| {
        let (mut sum, mut total) = (NEARNESS * middle, NEARNESS);
        for (other, excess) in chosen
            .iter()
            .zip(excesses)
            .filter(|(other, _)| other.mode == draw.mode)
        {
            let axes = draw.point.iter().zip(&other.point).zip(&spreads);
            let squares = axes.map(|((a, b), spread)| ((a - b) / spread).powi(2));
            let weight = libm::exp(-squares.sum::<f64>() / dimensions as f64);
            sum += weight * excess;
            total += weight;
        }
        sum / total
    };
    let expected: Vec<f64> = draws.iter().map(near).collect();
    let weights = tempered(&expected, chosen.len().min(draws.len() / 2));
    let drawn = systematic(&weights, draws.len(), rng.random()).into_iter();
    drawn.map(|index| draws[index].clone()).collect()
}
