//! What runs at some points say about the score at every point, those that nobody visited included.
//!
//! The score of a run is, on a logarithmic scale, a smooth function of the parameters, plus a smooth deviation of the
//! [setting](super::setting) that the run has, plus what is left: the ruggedness of a single run. The first two are Gaussian
//! processes with one kernel shape (Matérn 5/2, a length scale a parameter; Rasmussen & Williams 2006, sums of processes: section
//! 4.2.4). The sizes of all three are not known either: several sets of them are drawn as likely as the scores make them
//! (Metropolis et al. 1953, with weak priors), and what they say differently is doubt, too.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::setting::Setting;
use realgap_core::error::Result;
use realgap_core::random::Once;
use realgap_core::statistics::{matern_5_2, mean, median, standard_deviation};
use realgap_optimize::{Brief, default_optimizer, minimise, thin};

/// One run at one point.
#[derive(Debug, Clone)]
pub(super) struct ScoredRun {
    /// Coordinates of the point, 0 to 1.
    pub at: Vec<f64>,
    /// The setting that it had.
    pub setting: Setting,
    /// One score a fitted recording.
    pub recordings: Vec<f64>,
}

impl ScoredRun {
    /// Mean over the recordings.
    pub fn score(&self) -> f64 {
        mean(&self.recordings)
    }
}

/// Sizes of the three parts.
#[derive(Debug, Clone)]
struct Kernel {
    lengths: Vec<f64>,
    /// Variance of the score over the parameters.
    variance: f64,
    /// Variance of what a setting changes, as a share of it.
    between_settings: f64,
    /// Variance of a single run about that.
    noise: f64,
}

/// Bounds of lengths (shares of the range), variance, share between settings, and noise; scores are standardised.
const LENGTH: (f64, f64) = (0.05, 5.0);
const VARIANCE: (f64, f64) = (0.1, 30.0);
const BETWEEN: (f64, f64) = (1e-4, 1.0);
const NOISE: (f64, f64) = (1e-4, 1.0);
/// What sizes are likely before any run is seen, as median and standard deviation of the logarithm: wide enough that fifty runs
/// overrule them, narrow enough that ten do not invent a score that changes from point to point.
const LIKELY_LENGTH: (f64, f64) = (0.4, 0.8);
const LIKELY_VARIANCE: (f64, f64) = (1.5, 1.0);
const LIKELY_BETWEEN: (f64, f64) = (0.05, 1.5);
const LIKELY_NOISE: (f64, f64) = (0.03, 1.5);
/// Runs that kernels are fitted to, and runs that the emulator knows at most; work grows with the cube of either.
const FITTED: usize = 120;
const KNOWN: usize = 600;
/// Kernels tried per number of a kernel to find the likeliest, kernels drawn, and steps of the chain from one to the next.
const TRIES: usize = 40;
const KERNELS: usize = 5;
const STEPS: usize = 5;

impl Kernel {
    fn new(coordinates: &[f64]) -> Self {
        let within = |coordinate: f64, (low, high): (f64, f64)| {
            libm::exp(libm::log(low) + coordinate * (libm::log(high) - libm::log(low)))
        };
        let n = coordinates.len() - 3;
        Self {
            lengths: coordinates[..n]
                .iter()
                .map(|c| within(*c, LENGTH))
                .collect(),
            variance: within(coordinates[n], VARIANCE),
            between_settings: within(coordinates[n + 1], BETWEEN),
            noise: within(coordinates[n + 2], NOISE),
        }
    }

    /// Covariance of the answer at two points.
    fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let axes = a.iter().zip(b).zip(&self.lengths);
        let squares = axes.map(|((a, b), length)| ((a - b) / length).powi(2));
        self.variance * matern_5_2(squares.sum::<f64>().sqrt())
    }

    /// Covariance of all runs, factored; `None` where it is singular.
    fn factor(&self, runs: &[&ScoredRun]) -> Option<Cholesky<f64, Dyn>> {
        let n = runs.len();
        let mut matrix = DMatrix::zeros(n, n);
        for column in 0..n {
            for row in column..n {
                let (a, b) = (runs[row], runs[column]);
                let same = f64::from(u8::from(a.setting == b.setting));
                let alike = 1.0 + self.between_settings * same;
                matrix[(row, column)] = alike * self.covariance(&a.at, &b.at);
            }
            matrix[(column, column)] += self.noise;
        }
        Cholesky::new(matrix)
    }

    /// Minus twice the logarithm of how likely these sizes were before, without its constant.
    fn surprise(&self) -> f64 {
        let of = |value: f64, (median, sd): (f64, f64)| (libm::log(value / median) / sd).powi(2);
        let lengths = self.lengths.iter().map(|length| of(*length, LIKELY_LENGTH));
        lengths.sum::<f64>()
            + of(self.variance, LIKELY_VARIANCE)
            + of(self.between_settings, LIKELY_BETWEEN)
            + of(self.noise, LIKELY_NOISE)
    }

    /// Minus twice the log likelihood of the values, without its constant; their mean is the likeliest.
    fn misfit(&self, runs: &[&ScoredRun], values: &DVector<f64>) -> Option<f64> {
        let factor = self.factor(runs)?;
        let logs: f64 = factor.l_dirty().diagonal().map(libm::log).sum();
        let mean = mean_weights(&factor).dot(values);
        let rest = values.add_scalar(-mean);
        Some(rest.dot(&factor.solve(&rest)) + 2.0 * logs + self.surprise())
    }

    /// Kernels as likely as the values make them: a chain from the likeliest, which the optimizer that tunes simulations finds.
    fn drawn(runs: &[&ScoredRun], values: &DVector<f64>) -> Result<Vec<Self>> {
        let sizes = runs[0].at.len() + 3;
        let misfit = |point: &Vec<f64>| Self::new(point).misfit(runs, values);
        let brief = Brief {
            points: vec![2; sizes],
            budget: TRIES * sizes,
            seed: 1,
            priors: Vec::new(),
        };
        let told = minimise(default_optimizer(), &brief, misfit)?;
        let scored = told.into_iter().filter_map(|t| Some((t.score?, t.point)));
        let likeliest = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((mut here, mut at)) = likeliest else {
            return Ok(vec![Self::new(&vec![0.5; sizes])]);
        };
        let mut rng = Once::BestPoint.generator(1);
        // Steps grow where they are taken and shrink where they are not, towards one in three.
        let mut step = 0.1;
        let mut drawn = Vec::new();
        for number in 1..=KERNELS * STEPS * sizes {
            let normal = |rng: &mut _| -> f64 { StandardNormal.sample(rng) };
            let to: Vec<f64> = at.iter().map(|c| c + step * normal(&mut rng)).collect();
            let chance: f64 = rng.random();
            let inside = to.iter().all(|c| (0.0..=1.0).contains(c));
            let there = if inside { misfit(&to) } else { None };
            match there.filter(|there| libm::log(chance) < 0.5 * (here - there)) {
                Some(there) => {
                    (here, at) = (there, to);
                    step *= 1.1;
                }
                None => step *= 0.95,
            }
            if number % (STEPS * sizes) == 0 {
                drawn.push(Self::new(&at));
            }
        }
        Ok(drawn)
    }
}

/// Shares that the values have in their likeliest mean (ordinary kriging, Cressie 1993, section 3.2): where runs crowd, each
/// counts little, so that a crowd of good ones does not promise that the rest is as good.
fn mean_weights(factor: &Cholesky<f64, Dyn>) -> DVector<f64> {
    let ones = DVector::repeat(factor.l_dirty().nrows(), 1.0);
    let solved = factor.solve(&ones);
    let sum = solved.sum();
    solved / sum
}

/// From scores to the scale on which they are modelled: ln(score + offset), mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
struct Scale {
    offset: f64,
    mean: f64,
    sd: f64,
}

impl Scale {
    /// The offset is the median score: nearly linear below it, where distances of noisy runs vary alike, and logarithmic above, so
    /// that a few terrible points do not decide how smooth the good ones are.
    fn new(scores: &[f64]) -> Self {
        let offset = median(scores).max(f64::MIN_POSITIVE);
        let logs: Vec<f64> = scores.iter().map(|s| libm::log(s + offset)).collect();
        let sd = standard_deviation(&logs);
        Self {
            offset,
            mean: mean(&logs),
            sd: if sd > 0.0 { sd } else { 1.0 },
        }
    }

    fn of(self, score: f64) -> f64 {
        (libm::log(score.max(0.0) + self.offset) - self.mean) / self.sd
    }

    /// How much a standardised value changes with the score.
    fn slope(self, score: f64) -> f64 {
        1.0 / ((score.max(0.0) + self.offset) * self.sd)
    }

    fn back(self, value: f64) -> f64 {
        (libm::exp(value * self.sd + self.mean) - self.offset).max(0.0)
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
pub(super) struct Emulator {
    scale: Scale,
    /// Coordinates of the runs.
    at: Vec<Vec<f64>>,
    /// What each recording's score has beyond the mean over the recordings, standardised; one row a run.
    parts: DMatrix<f64>,
    members: Vec<Member>,
}

/// What the emulator says about some places together. All standardised: mean 0 and standard deviation 1 over the runs.
pub(super) struct Field {
    pub means: DVector<f64>,
    /// Covariance of what the runs leave open.
    pub emulator: DMatrix<f64>,
    /// Covariance of what one more equally valid setting changes.
    pub numerics: DMatrix<f64>,
    /// What each recording deviates, one row a place.
    pub parts: DMatrix<f64>,
    /// Correlation of the score's own variation.
    pub alike: DMatrix<f64>,
    /// Variances of single runs: about their setting, of settings, of recordings.
    pub noise: f64,
    pub setting: f64,
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
        let fitted = thinned(runs, FITTED);
        let values = fitted.iter().map(|run| scale.of(run.score()));
        let values = DVector::from_iterator(fitted.len(), values);
        let kernels = Kernel::drawn(&fitted, &values)?;
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
        let parts = DMatrix::from_fn(runs.len(), runs[0].recordings.len(), |run, recording| {
            let score = runs[run].score();
            scale.slope(score) * (runs[run].recordings[recording] - score)
        });
        Self {
            scale,
            members: members.collect(),
            at: runs.iter().map(|run| run.at.clone()).collect(),
            parts,
        }
    }

    fn across(&self, member: &Member, place: &[f64]) -> DVector<f64> {
        let covariances = self.at.iter().map(|at| member.kernel.covariance(at, place));
        DVector::from_iterator(self.at.len(), covariances)
    }

    /// Expected score at a place, standardised.
    pub fn standardised(&self, place: &[f64]) -> f64 {
        let means = self
            .members
            .iter()
            .map(|member| member.mean + self.across(member, place).dot(&member.weights));
        means.sum::<f64>() / self.members.len() as f64
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

    /// Everything about some places.
    pub fn field(&self, places: &[Vec<f64>]) -> Field {
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
            let mut across = DMatrix::zeros(runs, n);
            for (column, place) in places.iter().enumerate() {
                across.set_column(column, &self.across(member, place));
            }
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
            let doubt = &between - known.tr_mul(&across)
                + &unexplained * unexplained.transpose() * member.mean_variance;
            let weights = known.transpose() + &unexplained * member.shares.transpose();
            field.parts += weights * &self.parts * share;
            field.emulator += doubt * share;
            field.numerics += &between * (kernel.between_settings * share);
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
}

/// At most `most` of the runs: the better half, the others spread evenly over the rest.
fn thinned(runs: &[ScoredRun], most: usize) -> Vec<&ScoredRun> {
    let scored = runs.iter().map(|run| (run, run.score()));
    let kept = thin(scored.collect(), most).into_iter();
    kept.map(|(run, _)| run).collect()
}
