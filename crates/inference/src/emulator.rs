//! What runs at some points say about the score at every point, those that nobody visited included.
//!
//! The score of a run is, on a logarithmic scale, a smooth function of the parameters, plus a smooth deviation of the
//! setting that the run has, plus what is left: the ruggedness of a single run. Where settings are of two
//! engines, their half difference is one more smooth function, added in one and subtracted in the other, so that the first is the
//! mean of both, whichever ran where. All but the last are Gaussian processes with one kernel shape (Matérn 5/2, a length scale a
//! parameter; Rasmussen & Williams 2006, sums of processes: section 4.2.4). Their sizes are not known either: several
//! kernels are drawn, and what they say differently is doubt, too.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::kernel::{Fitted, Kernel, ScoredRun, mean_weights};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, median, standard_deviation};
use realgap_optimization::thin;

/// Runs that kernels are fitted to, and runs that the emulator knows at most; work grows with the cube of either.
const FITTED: usize = 120;
const KNOWN: usize = 600;

/// From scores to the scale on which they are modelled: ln(score² + offset²), mean 0 and standard deviation 1. A distance has a
/// kink where simulation and reality meet, its square has none.
#[derive(Debug, Clone, Copy)]
struct Scale {
    offset: f64,
    mean: f64,
    sd: f64,
}

impl Scale {
    /// The offset is the median score: nearly the square below it, and logarithmic above, so that a few terrible points do not decide
    /// how smooth the good ones are.
    fn new(scores: &[f64]) -> Self {
        let offset = median(scores).max(f64::MIN_POSITIVE.sqrt());
        let logs: Vec<f64> = scores
            .iter()
            .map(|s| libm::log(s * s + offset * offset))
            .collect();
        let sd = standard_deviation(&logs);
        Self {
            offset,
            mean: mean(&logs),
            sd: if sd > 0.0 { sd } else { 1.0 },
        }
    }

    fn of(self, score: f64) -> f64 {
        (libm::log(score * score + self.offset * self.offset) - self.mean) / self.sd
    }

    /// How much a standardised value changes with the score.
    fn slope(self, score: f64) -> f64 {
        2.0 * score / ((score * score + self.offset * self.offset) * self.sd)
    }

    fn back(self, value: f64) -> f64 {
        (libm::exp(value * self.sd + self.mean) - self.offset * self.offset)
            .max(0.0)
            .sqrt()
    }
}

impl<'a> Fitted<'a> {
    fn new(scale: Scale, runs: &'a [ScoredRun]) -> Self {
        let runs = thinned(runs, FITTED);
        let values = runs.iter().map(|run| scale.of(run.score()));
        Self {
            values: DVector::from_iterator(runs.len(), values),
            runs,
        }
    }
}

/// One kernel with what the runs say through it.
#[derive(Debug, Clone)]
struct Member {
    kernel: Kernel,
    factor: Cholesky<f64, Dyn>,
    /// Shares of the runs in their likeliest mean, and its variance.
    shares: DVector<f64>,
    mean_variance: f64,
    /// That mean, and the inverse covariance times what the values have beyond it.
    mean: f64,
    weights: DVector<f64>,
}

/// The score over the parameters.
#[derive(Debug, Clone)]
pub struct Emulator {
    scale: Scale,
    /// Coordinates of the runs.
    at: Vec<Vec<f64>>,
    /// Engines of the runs, as [`ScoredRun::engine`].
    engines: Vec<f64>,
    /// What each recording's score has beyond the mean over the recordings, standardised; one row a run.
    parts: DMatrix<f64>,
    members: Vec<Member>,
}

/// What the emulator says about some places together. All standardised: mean 0 and standard deviation 1 over the runs.
pub struct Field {
    /// Expected scores.
    pub means: DVector<f64>,
    /// Covariance of what the runs leave open.
    pub emulator: DMatrix<f64>,
    /// Covariance of what one more equally valid setting changes; where engines are averaged, with what either changes.
    pub numerics: DMatrix<f64>,
    /// What each recording deviates, one row a place.
    pub parts: DMatrix<f64>,
    /// Correlation of the score's own variation.
    pub alike: DMatrix<f64>,
    /// Variance of single runs about their setting.
    pub noise: f64,
    /// Variance of settings.
    pub setting: f64,
    /// Variance of recordings.
    pub recording: f64,
}

impl Emulator {
    /// `None` for fewer than three runs.
    ///
    /// # Errors
    /// None beyond those of the optimizer that finds the likeliest kernel.
    pub fn new(runs: &[ScoredRun]) -> Result<Option<Self>> {
        if runs.len() < 3 {
            return Ok(None);
        }
        let scores: Vec<f64> = runs.iter().map(ScoredRun::score).collect();
        let scale = Scale::new(&scores);
        let kernels = Fitted::new(scale, runs).kernels()?;
        Ok(Some(Self::with(scale, &kernels, runs)))
    }

    /// The same kernels with more runs.
    pub fn again(&self, runs: &[ScoredRun]) -> Self {
        let kernels: Vec<Kernel> = self.members.iter().map(|m| m.kernel.clone()).collect();
        Self::with(self.scale, &kernels, runs)
    }

    fn with(scale: Scale, kernels: &[Kernel], runs: &[ScoredRun]) -> Self {
        let runs = thinned(runs, KNOWN);
        let values = runs.iter().map(|run| scale.of(run.score()));
        let values = DVector::from_iterator(runs.len(), values);
        let parts = match runs[0].surrogate_recordings.as_slice() {
            [] => DMatrix::from_fn(runs.len(), runs[0].recordings.len(), |run, recording| {
                let score = runs[run].score();
                scale.slope(score) * (runs[run].recordings[recording] - score)
            }),
            engines => {
                let columns = engines.iter().map(Vec::len).sum();
                let rows = runs
                    .iter()
                    .flat_map(|run| deviations(scale, &run.surrogate_recordings));
                DMatrix::from_row_iterator(runs.len(), columns, rows)
            }
        };
        let members = kernels.iter().filter_map(|kernel| {
            let factor = kernel.factor(&runs)?;
            let shares = mean_weights(&factor);
            let mean = shares.dot(&values);
            let ones = DVector::repeat(runs.len(), 1.0);
            Some(Member {
                kernel: kernel.clone(),
                mean_variance: factor.solve(&ones).sum().recip(),
                weights: factor.solve(&values.add_scalar(-mean)),
                factor,
                shares,
                mean,
            })
        });
        Self {
            scale,
            members: members.collect(),
            at: runs.iter().map(|run| run.at.clone()).collect(),
            engines: runs.iter().map(|run| run.engine).collect(),
            parts,
        }
    }

    /// Covariance of a run with the score at a place: in an engine, or, for 0, on average over both.
    fn covariance(&self, kernel: &Kernel, run: usize, place: &[f64], engine: f64) -> f64 {
        let alike = 1.0 + kernel.between_engines * engine * self.engines[run];
        alike * kernel.covariance(&self.at[run], place)
    }

    fn across(&self, member: &Member, place: &[f64], engine: f64) -> DVector<f64> {
        let runs = 0..self.at.len();
        let covariances = runs.map(|run| self.covariance(&member.kernel, run, place, engine));
        DVector::from_iterator(self.at.len(), covariances)
    }

    /// Expected score at a place, standardised.
    pub fn standardised(&self, place: &[f64]) -> f64 {
        self.standardised_in(place, 0.0)
    }

    fn standardised_in(&self, place: &[f64], engine: f64) -> f64 {
        let means = self
            .members
            .iter()
            .map(|member| member.mean + self.across(member, place, engine).dot(&member.weights));
        means.sum::<f64>() / self.members.len() as f64
    }

    /// Expected score at a place in one engine.
    pub fn mean_in(&self, place: &[f64], engine: f64) -> f64 {
        self.scale.back(self.standardised_in(place, engine))
    }

    /// Whether the runs are of two engines.
    pub fn has_two_engines(&self) -> bool {
        self.engines.iter().any(|engine| *engine != 0.0)
    }

    /// Expected score at a place.
    pub fn mean(&self, place: &[f64]) -> f64 {
        self.scale.back(self.standardised(place))
    }

    /// Central range of the score at a place that the runs allow, `deviations` standard deviations to each side.
    pub fn band(&self, place: &[f64], deviations: f64) -> (f64, f64) {
        let field = self.field(std::slice::from_ref(&place.to_vec()));
        let half = deviations * field.emulator[(0, 0)].max(0.0).sqrt();
        let at = |side: f64| self.scale.back(field.means[0] + side);
        (at(-half), at(half))
    }

    /// Which parameters the scores depend on, as far as they tell.
    pub fn active(&self) -> Vec<bool> {
        let lengths = self
            .members
            .iter()
            .flat_map(|member| &member.kernel.lengths);
        let dimensions = self.at[0].len();
        lengths
            .take(dimensions)
            .map(|length| length.is_finite())
            .collect()
    }

    /// Everything about some places, on average over the engines.
    pub fn field(&self, places: &[Vec<f64>]) -> Field {
        self.field_in(places, 0.0)
    }

    /// Everything about some places: in an engine, or, for 0, on average over both.
    pub fn field_in(&self, places: &[Vec<f64>], engine: f64) -> Field {
        let (runs, n, recordings) = (self.at.len(), places.len(), self.parts.ncols());
        let square = || DMatrix::zeros(n, n);
        let mut field = Field {
            means: DVector::zeros(n),
            emulator: square(),
            numerics: square(),
            parts: DMatrix::zeros(n, recordings),
            alike: square(),
            noise: 0.0,
            setting: 0.0,
            recording: self.parts.norm_squared() / (runs * (recordings - 1).max(1)) as f64,
        };
        let share = 1.0 / self.members.len() as f64;
        let mut means = Vec::new();
        for member in &self.members {
            let kernel = &member.kernel;
            let across = DMatrix::from_fn(runs, n, |run, place| {
                self.covariance(kernel, run, &places[place], engine)
            });
            let mut between = square();
            for column in 0..n {
                for row in column..n {
                    let covariance = kernel.covariance(&places[row], &places[column]);
                    (between[(row, column)], between[(column, row)]) = (covariance, covariance);
                }
            }
            let known = member.factor.solve(&across);
            // What the runs nearby do not explain of a place comes from the mean, and has its doubt.
            let unexplained = DVector::from_fn(n, |place, _| 1.0 - known.column(place).sum());
            let here = (across.tr_mul(&member.weights)).add_scalar(member.mean);
            let own = 1.0 + kernel.between_engines * engine * engine;
            let doubt = &between * own - known.tr_mul(&across)
                + &unexplained * unexplained.transpose() * member.mean_variance;
            let weights = known.transpose() + &unexplained * member.shares.transpose();
            field.parts += weights * &self.parts * share;
            field.emulator += doubt * share;
            field.numerics += &between * (kernel.between_settings * share);
            if engine == 0.0 && self.has_two_engines() {
                field.numerics += self.apart(member, &across, &between) * share;
            }
            field.alike += between * (share / kernel.variance);
            field.noise += kernel.noise * share;
            field.setting += kernel.between_settings * kernel.variance * share;
            field.means += &here * share;
            means.push(here);
        }
        for here in means {
            let apart = here - &field.means;
            field.emulator += &apart * apart.transpose() * share;
        }
        field
    }

    /// Covariance of what either engine deviates from their mean, as its square is expected: nobody knows which of them is right.
    /// `across` are covariances of runs with the mean at the places, `between` those of the places.
    fn apart(
        &self,
        member: &Member,
        across: &DMatrix<f64>,
        between: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let share = member.kernel.between_engines;
        let across = DMatrix::from_fn(across.nrows(), across.ncols(), |run, place| {
            share * self.engines[run] * across[(run, place)]
        });
        let half = across.tr_mul(&member.weights);
        let doubt = between * share - across.tr_mul(&member.factor.solve(&across));
        &half * half.transpose() + doubt
    }
}

/// How far each of what might have been recorded is, by the score, from the mean of its engine: as if all were of one engine that
/// varies as much as either does on average. Reality is like one of them. What might have been is as far from what was as from each
/// other, so that no slope holds for all of it.
fn deviations(scale: Scale, engines: &[Vec<f64>]) -> Vec<f64> {
    let freedom = |count: usize| count as f64 - 1.0;
    let all = freedom(engines.iter().map(Vec::len).sum());
    let of = |scores: &Vec<f64>| {
        let scores: Vec<f64> = scores.iter().map(|score| scale.of(*score)).collect();
        let middle = mean(&scores);
        let share = (all / (engines.len() as f64 * freedom(scores.len()))).sqrt();
        scores
            .into_iter()
            .map(move |score| share * (score - middle))
    };
    engines.iter().flat_map(of).collect()
}

/// At most `most` of the runs, of each engine its share: the better half, the others spread evenly over the rest.
fn thinned(runs: &[ScoredRun], most: usize) -> Vec<&ScoredRun> {
    let of = |is_second: bool| {
        let own = runs.iter().filter(|run| (run.engine < 0.0) == is_second);
        let scored: Vec<(&ScoredRun, f64)> = own.map(|run| (run, run.score())).collect();
        let share = (most * scored.len()).div_ceil(runs.len());
        thin(scored, share)
    };
    let kept = of(false).into_iter().chain(of(true));
    kept.map(|(run, _)| run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_might_have_been_varies_as_either_engine_does_on_average_however_many_runs_each_has() {
        let scale = Scale::new(&[1.0, 2.0, 4.0]);
        let engines = [vec![1.0, 3.0], vec![2.0, 2.1, 2.2, 2.1, 2.0]];
        let deviations = deviations(scale, &engines);
        let squares = deviations.iter().map(|deviation| deviation * deviation);
        let variance = squares.sum::<f64>() / (deviations.len() - 1) as f64;
        let of = |scores: &Vec<f64>| {
            let scores: Vec<f64> = scores.iter().map(|score| scale.of(*score)).collect();
            standard_deviation(&scores).powi(2)
        };
        let expected = 0.5 * (of(&engines[0]) + of(&engines[1]));
        assert!(
            (variance - expected).abs() < 1e-12,
            "{variance}, {expected}"
        );
        // One engine alone deviates as it does.
        let alone = super::deviations(scale, &engines[..1]);
        let apart = alone[1] - alone[0];
        assert!((apart - (scale.of(3.0) - scale.of(1.0))).abs() < 1e-12);
    }
}
