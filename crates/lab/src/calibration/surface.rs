//! What runs at some points say about the score at every point, those that nobody visited included.
//!
//! The score of a run is, on a logarithmic scale, a smooth function of the parameters, plus a smooth deviation of the
//! [setting](super::setting) that the run has, plus what is left: the ruggedness of a single run. The first two are Gaussian
//! processes with one kernel shape (Matérn 5/2, a length scale a parameter); all sizes are the most probable given the
//! scores (Rasmussen & Williams 2006, section 5.4, with weak priors; sums of processes: section 4.2.4). The answer is the
//! first part; the second comes back as doubt, because reality too has one setting of its own that nobody knows.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::setting::Setting;
use realgap_core::error::Result;
use realgap_core::random::Generator;
use realgap_core::statistics::{Resample, matern_5_2, mean, standard_deviation};
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
/// Runs that the kernel is fitted to, and runs that the surface knows at most; work grows with the cube of either.
const FITTED: usize = 150;
const KNOWN: usize = 900;
/// Kernels tried per number of a kernel.
const TRIES: usize = 60;

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

    /// The likeliest kernel, found by the optimizer that tunes simulations.
    fn fit(runs: &[&ScoredRun], values: &DVector<f64>, dimensions: usize) -> Result<Self> {
        let brief = Brief {
            points: vec![2; dimensions + 3],
            budget: TRIES * (dimensions + 3),
            seed: 1,
            priors: Vec::new(),
        };
        let told = minimise(default_optimizer(), &brief, |point| {
            Self::new(point).misfit(runs, values)
        })?;
        let scored = told.iter().filter_map(|t| Some((t.score?, &t.point)));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self::new(
            best.map_or(&vec![0.5; dimensions + 3], |(_, point)| point),
        ))
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
    /// The offset is the lowest score: a point twice as bad as the best is as far away as one that is five times as bad from
    /// one that is twice, so that a few terrible points do not decide how smooth the good ones are.
    fn new(scores: &[f64]) -> Self {
        let lowest = scores.iter().copied().fold(f64::INFINITY, f64::min);
        let offset = lowest.max(1e-3 * mean(scores)).max(f64::MIN_POSITIVE);
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

    fn back(self, value: f64) -> f64 {
        (libm::exp(value * self.sd + self.mean) - self.offset).max(0.0)
    }
}

/// The score over the parameters, known at nodes.
#[derive(Debug)]
pub(super) struct Surface {
    scale: Scale,
    /// The runs' scores, one row a run.
    scores: Vec<Vec<f64>>,
    /// From the runs' values to the mean at the nodes.
    weights: DMatrix<f64>,
    /// A root of the covariance of the answer at the nodes, given the runs.
    doubt: DMatrix<f64>,
    /// A root of the covariance of what one more setting changes.
    deviation: DMatrix<f64>,
    /// Means at the nodes, standardised.
    means: DVector<f64>,
}

impl Surface {
    /// `None` for fewer than three runs with a score. `nodes` are coordinates.
    ///
    /// # Errors
    /// None beyond those of the optimizer that fits the kernel.
    pub fn new(runs: &[ScoredRun], nodes: &[Vec<f64>]) -> Result<Option<Self>> {
        if runs.len() < 3 || nodes.is_empty() {
            return Ok(None);
        }
        let runs = thinned(runs.iter(), KNOWN);
        let plain = |runs: &[&ScoredRun]| -> Vec<f64> {
            runs.iter().map(|run| mean(&run.recordings)).collect()
        };
        let scores = plain(&runs);
        let scale = Scale::new(&scores);
        let fitted = thinned(runs.iter().copied(), FITTED);
        let values = |scores: Vec<f64>| {
            DVector::from_iterator(scores.len(), scores.into_iter().map(|s| scale.of(s)))
        };
        let kernel = Kernel::fit(&fitted, &values(plain(&fitted)), nodes[0].len())?;
        let Some(factor) = kernel.factor(&runs) else {
            return Ok(None);
        };
        let across = DMatrix::from_fn(runs.len(), nodes.len(), |run, node| {
            kernel.covariance(&runs[run].at, &nodes[node])
        });
        let between = DMatrix::from_fn(nodes.len(), nodes.len(), |a, b| {
            kernel.covariance(&nodes[a], &nodes[b])
        });
        let known = factor.solve(&across);
        // What the runs nearby do not explain of a node comes from the mean, and has its doubt.
        let shares = mean_weights(&factor);
        let unexplained = DVector::from_fn(nodes.len(), |node, _| 1.0 - known.column(node).sum());
        let mean_variance = factor
            .solve(&DVector::repeat(runs.len(), 1.0))
            .sum()
            .recip();
        let doubt = root(
            &between - known.tr_mul(&across)
                + &unexplained * unexplained.transpose() * mean_variance,
        );
        let weights = known.transpose() + &unexplained * shares.transpose();
        // A single recording is one run of its own, whose ruggedness no other recording averages out.
        let alone = if runs[0].recordings.len() < 2 {
            kernel.noise / kernel.variance
        } else {
            0.0
        };
        let deviation = root(between * (kernel.between_settings + alone));
        let means = &weights * values(scores);
        Ok(Some(Self {
            scale,
            scores: runs.iter().map(|run| run.recordings.clone()).collect(),
            weights,
            doubt,
            deviation,
            means,
        }))
    }

    /// Mean score at a node.
    pub fn mean(&self, node: usize) -> f64 {
        self.scale.back(self.means[node])
    }

    /// The node with the lowest mean among some.
    pub fn lowest(&self, among: impl IntoIterator<Item = usize>) -> Option<usize> {
        let among = among.into_iter();
        among.min_by(|a, b| self.means[*a].total_cmp(&self.means[*b]))
    }

    /// One surface that the runs allow, standardised: what the answer may be.
    pub fn draw(&self, rng: &mut Generator) -> DVector<f64> {
        &self.means + &self.doubt * normals(self.doubt.ncols(), rng)
    }

    /// One surface that another reality would have shown: recordings drawn again, another setting of its own.
    ///
    /// Resamples hold one recording less than there are, which makes the variance of their mean that of the mean
    /// (Efron & Tibshirani 1993, section 6.2), and deviate as widely as Student's t says for so few.
    pub fn draw_reality(&self, resample: Option<&Resample>, rng: &mut Generator) -> DVector<f64> {
        let means = match resample {
            None => self.means.clone(),
            Some(resample) => {
                let freedom = (self.scores[0].len() - 1) as f64;
                let wide =
                    ChiSquared::new(freedom).map_or(1.0, |chi| (freedom / chi.sample(rng)).sqrt());
                let values = self.scores.iter().map(|scores| {
                    let here = mean(scores);
                    self.scale.of(here + wide * (resample.mean(scores) - here))
                });
                &self.weights * DVector::from_iterator(self.scores.len(), values)
            }
        };
        means
            + &self.doubt * normals(self.doubt.ncols(), rng)
            + &self.deviation * normals(self.deviation.ncols(), rng)
    }
}

fn normals(count: usize, rng: &mut Generator) -> DVector<f64> {
    DVector::from_fn(count, |_, _| StandardNormal.sample(rng))
}

/// A lower triangular matrix whose square this is, up to rounding.
fn root(mut covariance: DMatrix<f64>) -> DMatrix<f64> {
    let largest = covariance.diagonal().max().max(f64::MIN_POSITIVE);
    let mut jitter = 1e-9 * largest;
    for index in 0..covariance.nrows() {
        covariance[(index, index)] += jitter;
    }
    loop {
        if let Some(factor) = Cholesky::new(covariance.clone()) {
            return factor.l();
        }
        for index in 0..covariance.nrows() {
            covariance[(index, index)] += 9.0 * jitter;
        }
        jitter *= 10.0;
    }
}

/// At most `most` of the runs: the better half, the others spread evenly over the rest.
fn thinned<'a>(runs: impl Iterator<Item = &'a ScoredRun>, most: usize) -> Vec<&'a ScoredRun> {
    let scored = runs.map(|run| (run, mean(&run.recordings)));
    let kept = thin(scored.collect(), most).into_iter();
    kept.map(|(run, _)| run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::random::Once;

    /// A valley at 0.4 whose runs are rugged, and whose settings move it.
    fn valley(at: f64, setting: usize, rugged: f64, moved: f64) -> ScoredRun {
        let centre = 0.4 + moved * ((setting as f64 * 1.7).sin());
        let noise = rugged * ((at * 977.0 + setting as f64 * 31.0).sin());
        let score = 1.0 + 20.0 * (at - centre).powi(2) + noise;
        ScoredRun {
            at: vec![at],
            setting: Setting::new(setting),
            recordings: vec![score, score * 1.05, score * 0.95],
        }
    }

    fn line(count: usize) -> Vec<Vec<f64>> {
        (0..count)
            .map(|i| vec![i as f64 / (count - 1) as f64])
            .collect()
    }

    fn surface(runs: &[ScoredRun], nodes: &[Vec<f64>]) -> Surface {
        Surface::new(runs, nodes).unwrap().unwrap()
    }

    /// Lowest nodes of many realities, sorted.
    fn lowest(surface: &Surface, nodes: &[Vec<f64>]) -> Vec<f64> {
        let mut rng = Once::BestPoint.generator(7);
        let mut all: Vec<f64> = (0..400)
            .map(|_| nodes[surface.draw_reality(None, &mut rng).imin()][0])
            .collect();
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn the_lucky_run_is_not_the_best_point() {
        let nodes = line(41);
        let mut runs: Vec<ScoredRun> = nodes
            .iter()
            .enumerate()
            .map(|(index, node)| valley(node[0], index % 16, 0.2, 0.0))
            .collect();
        // One run far from the valley is lucky by chance.
        runs[36].recordings = vec![0.9; 3];
        let surface = surface(&runs, &nodes);
        let best = nodes[surface.lowest(0..41).unwrap()][0];
        assert!((best - 0.4).abs() <= 0.1, "{best}");
    }

    #[test]
    fn what_settings_move_widens_the_answer_by_as_much() {
        let nodes = line(41);
        let width = |moved: f64| {
            let runs: Vec<ScoredRun> = (0..3)
                .flat_map(|pass| {
                    nodes
                        .iter()
                        .enumerate()
                        .map(move |(i, node)| (pass, i, node))
                })
                .map(|(pass, index, node)| valley(node[0], (index + 5 * pass) % 16, 0.02, moved))
                .collect();
            let draws = lowest(&surface(&runs, &nodes), &nodes);
            draws[380] - draws[20]
        };
        let (still, moved) = (width(0.0), width(0.15));
        assert!(still < 0.15, "{still}");
        // Nine of ten places of a sine's minimum lie within 0.15 of its centre.
        assert!((0.15..=0.6).contains(&moved), "{moved}");
    }

    #[test]
    fn where_nobody_was_anything_may_be() {
        let nodes = line(41);
        // All runs on the left half, crowded around a shallow minimum.
        let runs: Vec<ScoredRun> = (0..60)
            .map(|i| valley(0.5 * (i as f64 * 0.618).fract(), i % 16, 0.02, 0.0))
            .collect();
        let surface = surface(&runs, &nodes);
        let mut rng = Once::BestPoint.generator(7);
        let spread = |node: usize, rng: &mut Generator| {
            let draws: Vec<f64> = (0..200).map(|_| surface.draw(rng)[node]).collect();
            standard_deviation(&draws)
        };
        let (visited, unvisited) = (spread(8, &mut rng), spread(40, &mut rng));
        assert!(unvisited > 5.0 * visited, "{visited} {unvisited}");
    }

    #[test]
    fn a_crowd_of_good_runs_promises_nothing_elsewhere() {
        let nodes = line(41);
        let mut runs: Vec<ScoredRun> = (0..8)
            .map(|i| valley(i as f64 / 7.0, i, 0.02, 0.0))
            .collect();
        runs.extend(
            (0..60).map(|i| valley(0.38 + 0.04 * (i as f64 * 0.618).fract(), i % 16, 0.02, 0.0)),
        );
        let draws = lowest(&surface(&runs, &nodes), &nodes);
        assert!(
            draws[20] > 0.25 && draws[380] < 0.55,
            "{} {}",
            draws[20],
            draws[380]
        );
    }
}
