//! The optimizer `cma-es`: covariance matrix adaptation as in Hansen's tutorial (2016, arXiv 1604.00772), figure 6, with the
//! default parameters of its table 1 and the termination criteria of its appendix B.3.

use std::collections::VecDeque;
use std::convert::Infallible;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::random::space_filling;
use super::replay::{Replay, Unknown};
use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;
use realgap_core::statistics::ends_of;

/// CMA-ES with restarts, each with twice the population.
pub(super) struct CmaEs;

/// Initial step size as a share of the range: without an initial design, the search covers the whole range; with one, it
/// starts in the neighbourhood of the best point of the design.
const WIDE: f64 = 0.3;
const NEAR: f64 = 0.15;
/// Largest number of doublings of the population.
const DOUBLINGS: usize = 10;

/// A search ends if its scores differ by less than this, or if its steps are shorter than this share of the initial step.
const TOLERANCE: f64 = 1e-12;
/// A search ends, too, if its scores differ by less than this share of the best score: a mean over valid settings is not more
/// accurate, and another start may lead to another minimum.
const RELATIVE_TOLERANCE: f64 = 1e-3;
/// Condition of the covariance beyond which directions are lost to rounding.
const CONDITION: f64 = 1e14;
/// Growth of the longest axis at which a search ends, because the initial step was far too small or the search diverges.
const GROWTH: f64 = 1e4;
/// Largest number of past generations that are used to detect stagnation.
const MEMORY: usize = 20_000;

/// The default population size, 4 + 3 ln n.
fn population(dimensions: usize) -> usize {
    4 + (3.0 * libm::log(dimensions as f64)).floor() as usize
}

/// Parameters of the strategy, which are constant during a search (table 1).
struct Constants {
    /// Recombination weights of the candidates, best first: positive for the better half, negative for the others.
    weights: Vec<f64>,
    /// Number of candidates from which the mean is computed.
    parents: usize,
    /// Variance-effective number of parents.
    effective: f64,
    step_rate: f64,
    step_damping: f64,
    path_rate: f64,
    rank_one_rate: f64,
    rank_mu_rate: f64,
    /// Expected length of a vector of independent standard normal numbers.
    expected_length: f64,
}

impl Constants {
    fn new(dimensions: usize, population: usize) -> Self {
        let n = dimensions as f64;
        let raw: Vec<f64> = (1..=population)
            .map(|rank| libm::log((population as f64 + 1.0) / 2.0) - libm::log(rank as f64))
            .collect();
        let parents = population / 2;
        let effective_of = |raw: &[f64]| {
            raw.iter().sum::<f64>().powi(2) / raw.iter().map(|weight| weight * weight).sum::<f64>()
        };
        let effective = effective_of(&raw[..parents]);
        let effective_negative = effective_of(&raw[parents..]);

        let step_rate = (effective + 2.0) / (n + effective + 5.0);
        let excess = ((effective - 1.0) / (n + 1.0)).sqrt() - 1.0;
        let step_damping = 1.0 + 2.0 * excess.max(0.0) + step_rate;
        let path_rate = (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n);
        let rank_one_rate = 2.0 / ((n + 1.3).powi(2) + effective);
        let rank_mu_rate = (2.0 * (0.25 + effective + 1.0 / effective - 2.0)
            / ((n + 2.0).powi(2) + effective))
            .min(1.0 - rank_one_rate);

        let positive: f64 = raw.iter().filter(|weight| **weight > 0.0).sum();
        let negative: f64 = -raw.iter().filter(|weight| **weight < 0.0).sum::<f64>();
        let most_negative = (1.0 + rank_one_rate / rank_mu_rate)
            .min(1.0 + 2.0 * effective_negative / (effective + 2.0))
            .min((1.0 - rank_one_rate - rank_mu_rate) / (n * rank_mu_rate));
        let weights = raw
            .iter()
            .map(|weight| {
                if *weight >= 0.0 {
                    weight / positive
                } else {
                    weight * most_negative / negative
                }
            })
            .collect();
        Self {
            weights,
            parents,
            effective,
            step_rate,
            step_damping,
            path_rate,
            rank_one_rate,
            rank_mu_rate,
            expected_length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// One search from one start, until it ends.
struct Evolution {
    constants: Constants,
    random: ChaCha8Rng,
    mean: DVector<f64>,
    first_step: f64,
    step: f64,
    covariance: DMatrix<f64>,
    /// Eigenvectors of the covariance, and the square roots of its eigenvalues.
    axes: DMatrix<f64>,
    lengths: DVector<f64>,
    covariance_path: DVector<f64>,
    step_path: DVector<f64>,
    generation: usize,
    /// The best and the median score of past generations, newest first.
    bests: VecDeque<f64>,
    medians: VecDeque<f64>,
    ended: bool,
}

impl Evolution {
    fn new(mean: UnitPoint, step: f64, population: usize, seed: u64) -> Self {
        let n = mean.len();
        Self {
            constants: Constants::new(n, population),
            random: ChaCha8Rng::seed_from_u64(seed),
            mean: DVector::from_vec(mean),
            first_step: step,
            step,
            covariance: DMatrix::identity(n, n),
            axes: DMatrix::identity(n, n),
            lengths: DVector::from_element(n, 1.0),
            covariance_path: DVector::zeros(n),
            step_path: DVector::zeros(n),
            generation: 0,
            bests: VecDeque::new(),
            medians: VecDeque::new(),
            ended: false,
        }
    }

    /// The directions of the next generation's candidates; a candidate is the mean plus the step size times its direction.
    fn directions(&mut self) -> Vec<DVector<f64>> {
        (0..self.constants.weights.len())
            .map(|_| {
                let random = &mut self.random;
                let stretched = self.lengths.map(|length| length * normal(random));
                &self.axes * stretched
            })
            .collect()
    }

    fn candidate(&self, direction: &DVector<f64>) -> UnitPoint {
        let point = &self.mean + direction * self.step;
        point.iter().copied().collect()
    }

    /// Updates the mean, the step size and the covariance from the directions and scores of a generation (equations 41 to 47).
    fn learn(&mut self, directions: &[DVector<f64>], scores: &[f64]) {
        let c = &self.constants;
        let n = self.mean.len() as f64;
        let mut order: Vec<usize> = (0..scores.len()).collect();
        order.sort_by(|a, b| scores[*a].total_cmp(&scores[*b]));
        let ranked = || c.weights.iter().zip(&order);
        let whiten =
            |v: &DVector<f64>| &self.axes * (self.axes.tr_mul(v)).component_div(&self.lengths);

        let mut mean_direction = DVector::zeros(self.mean.len());
        for (weight, index) in ranked().take(c.parents) {
            mean_direction.axpy(*weight, &directions[*index], 1.0);
        }
        self.mean.axpy(self.step, &mean_direction, 1.0);

        let push = (c.step_rate * (2.0 - c.step_rate) * c.effective).sqrt();
        self.step_path *= 1.0 - c.step_rate;
        self.step_path.axpy(push, &whiten(&mean_direction), 1.0);
        self.generation += 1;
        let exponent = 2.0 * self.generation as f64;
        let warm_up = (1.0 - libm::pow(1.0 - c.step_rate, exponent)).sqrt();
        let length = self.step_path.norm() / c.expected_length;
        // While the step size grows fast, the path contains no information about the shape of the covariance.
        let stalled = if length / warm_up < 1.4 + 2.0 / (n + 1.0) {
            1.0
        } else {
            0.0
        };
        let push = stalled * (c.path_rate * (2.0 - c.path_rate) * c.effective).sqrt();
        self.covariance_path *= 1.0 - c.path_rate;
        self.covariance_path.axpy(push, &mean_direction, 1.0);

        let lost = (1.0 - stalled) * c.path_rate * (2.0 - c.path_rate);
        let kept = 1.0 + c.rank_one_rate * lost
            - c.rank_one_rate
            - c.rank_mu_rate * c.weights.iter().sum::<f64>();
        let mut covariance = &self.covariance * kept;
        let path = &self.covariance_path;
        covariance.ger(c.rank_one_rate, path, path, 1.0);
        for (weight, index) in ranked() {
            let direction = &directions[*index];
            // Without this scaling, bad candidates that are far away would make the covariance indefinite.
            let scaled = if *weight < 0.0 {
                weight * n / whiten(direction).norm_squared().max(f64::MIN_POSITIVE)
            } else {
                *weight
            };
            covariance.ger(c.rank_mu_rate * scaled, direction, direction, 1.0);
        }
        self.step *= libm::exp((c.step_rate / c.step_damping) * (length - 1.0));

        self.bests.push_front(scores[order[0]]);
        self.medians.push_front(scores[order[order.len() / 2]]);
        self.bests.truncate(MEMORY);
        self.medians.truncate(MEMORY);
        self.decompose(covariance);
        self.ended |= self.is_over();
    }

    fn decompose(&mut self, covariance: DMatrix<f64>) {
        let symmetric = (&covariance + covariance.transpose()) * 0.5;
        self.covariance.copy_from(&symmetric);
        let decomposition = SymmetricEigen::new(symmetric);
        let smallest = decomposition.eigenvalues.min();
        if !(smallest > 0.0 && decomposition.eigenvalues.max() < CONDITION * smallest) {
            self.ended = true;
            return;
        }
        self.lengths = decomposition.eigenvalues.map(f64::sqrt);
        self.axes = decomposition.eigenvectors;
    }

    fn is_over(&self) -> bool {
        let n = self.mean.len();
        let candidates = self.constants.weights.len();
        let recent = 10 + (30 * n).div_ceil(candidates);
        let (low, high) = ends_of(self.bests.iter().take(recent).copied());
        let progress = (RELATIVE_TOLERANCE * low.abs()).max(TOLERANCE);
        let flat = self.bests.len() >= recent && high - low < progress;

        let deviations = self
            .covariance
            .diagonal()
            .map(|variance| self.step * variance.sqrt());
        let tiny = TOLERANCE * self.first_step;
        let arrived = deviations.iter().all(|deviation| *deviation < tiny)
            && self
                .covariance_path
                .iter()
                .all(|path| (self.step * path).abs() < tiny);

        let axis = self.generation % n;
        let along = self.axes.column(axis) * (0.1 * self.step * self.lengths[axis]);
        let no_effect = &self.mean + along == self.mean
            || (self.mean.iter().zip(&deviations)).any(|(m, deviation)| m + 0.2 * deviation == *m);

        let diverged = self.step * self.lengths.max() > GROWTH * self.first_step;
        flat || arrived || no_effect || diverged || !self.step.is_normal() || self.stagnates()
    }

    /// Whether neither the best nor the median scores have improved over the last fifth of the generations.
    fn stagnates(&self) -> bool {
        let n = self.mean.len();
        let least = 120 + (30 * n).div_ceil(self.constants.weights.len());
        let window = (self.generation / 5).clamp(least, MEMORY);
        let worse = |history: &VecDeque<f64>| {
            let part = window * 3 / 10;
            let newest = median(history.iter().take(part));
            newest >= median(history.iter().take(window).skip(window - part))
        };
        self.bests.len() >= window && worse(&self.bests) && worse(&self.medians)
    }
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

fn median<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let mut sorted: Vec<f64> = values.copied().collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn search(
    problem: &OptimizationProblem,
    history: &History<'_>,
) -> std::result::Result<Infallible, Unknown> {
    let replay = Replay::new(history.evaluated);
    let n = problem.dimensions();
    let best = history.best_of_design();
    let mut restart = 0;
    loop {
        let (mean, step) = match (restart, best.first()) {
            (0, Some((point, _))) => ((*point).clone(), NEAR),
            (0, None) => (vec![0.5; n], WIDE),
            _ => {
                let mut starts = space_filling(n, restart, restart + 1, problem.seed);
                (starts.swap_remove(0), WIDE)
            }
        };
        let candidates = population(n) << restart.min(DOUBLINGS);
        let seed = problem.seed.wrapping_add(restart as u64);
        let mut evolution = Evolution::new(mean, step, candidates, seed);
        while !evolution.ended {
            let directions = evolution.directions();
            let points: Vec<UnitPoint> = directions
                .iter()
                .map(|direction| evolution.candidate(direction))
                .collect();
            let scores = replay.scores(points.iter().map(Vec::as_slice))?;
            evolution.learn(&directions, &scores);
        }
        restart += 1;
    }
}

impl Optimizer for CmaEs {
    fn name(&self) -> &'static str {
        "cma-es"
    }

    fn doc(&self) -> &'static str {
        "Covariance matrix adaptation (Hansen 2016), reflected at the bounds, restarted with twice the population when it has converged (Auger & Hansen 2005)."
    }

    fn batch(&self, problem: &OptimizationProblem) -> usize {
        population(problem.dimensions())
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let Err(Unknown(points)) = search(problem, history);
        Ok(Proposal::Evaluate(points))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: f64 = 1e-10;

    type Function = fn(&[f64]) -> f64;

    /// The test functions of the tutorial that pycma was run on (tools/golden_cma_es.py).
    fn function(name: &str) -> Function {
        /// Position of a coordinate among all coordinates: from 0 for the first to 1 for the last.
        fn place(index: usize, x: &[f64]) -> f64 {
            index as f64 / (x.len() - 1) as f64
        }
        fn squares(x: &[f64]) -> f64 {
            x.iter().map(|x| x * x).sum()
        }
        match name {
            "sphere" => squares,
            "cigar" => |x| x[0] * x[0] + 1e6 * squares(&x[1..]),
            "tablet" => |x| 1e6 * x[0] * x[0] + squares(&x[1..]),
            "ellipsoid" => |x| {
                let axes = x.iter().enumerate();
                axes.map(|(i, value)| 1e6_f64.powf(place(i, x)) * value * value)
                    .sum()
            },
            "different_powers" => |x| {
                let axes = x.iter().enumerate();
                axes.map(|(i, value)| value.abs().powf(2.0 + 4.0 * place(i, x)))
                    .sum()
            },
            "rosenbrock" => |x| {
                x.windows(2)
                    .map(|w| 100.0 * (w[0] * w[0] - w[1]).powi(2) + (w[0] - 1.0).powi(2))
                    .sum()
            },
            other => panic!("no function {other}"),
        }
    }

    /// Number of evaluations until the target is reached; `None` if the search ends before.
    fn evaluations(function: Function, start: &[f64], step: f64, seed: u64) -> Option<usize> {
        let mut evolution = Evolution::new(start.to_vec(), step, population(start.len()), seed);
        let mut count = 0;
        while !evolution.ended {
            let directions = evolution.directions();
            let mut scores = Vec::new();
            for direction in &directions {
                let score = function(&evolution.candidate(direction));
                count += 1;
                if score <= TARGET {
                    return Some(count);
                }
                scores.push(score);
            }
            evolution.learn(&directions, &scores);
        }
        None
    }

    #[test]
    fn hansens_test_functions_take_as_many_evaluations_as_with_pycma() {
        let mut table =
            csv::Reader::from_reader(include_str!("../../tests/golden/cma_es.csv").as_bytes());
        let rows: Vec<_> = table.records().map(|row| row.unwrap()).collect();
        assert_eq!(rows.len(), 18);
        for row in rows {
            let number = |column: usize| row[column].parse::<f64>().unwrap();
            let (name, n) = (&row[0], number(1) as usize);
            let start = vec![number(2); n];
            let mut needed: Vec<f64> = (1..=25)
                .filter_map(|seed| evaluations(function(name), &start, number(3), seed))
                .map(|count| count as f64)
                .collect();
            needed.sort_by(f64::total_cmp);
            // Rosenbrock's function has a local minimum that some searches end in.
            assert!(needed.len() >= 20, "{name} {n}: {} arrive", needed.len());
            let (median, reference) = (needed[needed.len() / 2], number(5));
            assert!(
                (median / reference - 1.0).abs() < 0.1,
                "{name} in {n} dimensions: {median} evaluations, pycma {reference}"
            );
        }
    }

    #[test]
    fn the_constants_are_those_of_pycma() {
        let c = Constants::new(10, population(10));
        let found = [c.effective, c.rank_one_rate, c.rank_mu_rate, c.path_rate];
        let pycma = [
            3.167_299_281_410_701_7,
            0.015_283_824_524_751_714,
            0.023_551_776_650_417_47,
            0.294_990_383_035_622_25,
        ];
        for (found, pycma) in found.iter().zip(pycma).chain(c.weights.iter().zip([
            0.456_272_646_903_405_97,
            0.270_753_097_001_785_2,
            0.162_231_117_158_669_78,
            0.085_233_547_100_164_45,
            0.025_509_591_835_974_777,
            -0.080_012_607_580_872_24,
            -0.221_764_160_999_146_53,
            -0.344_554_941_784_821_03,
            -0.452_864_086_378_421_96,
            -0.549_749_917_697_385_3,
        ])) {
            assert!((found - pycma).abs() < 1e-12, "{found} {pycma}");
        }
    }

    fn generations_until_the_end(function: Function) -> usize {
        let mut evolution = Evolution::new(vec![0.5; 2], WIDE, population(2), 1);
        while !evolution.ended {
            let directions = evolution.directions();
            let candidates = directions.iter().map(|d| evolution.candidate(d));
            let scores: Vec<f64> = candidates.map(|point| function(&point)).collect();
            evolution.learn(&directions, &scores);
        }
        evolution.generation
    }

    #[test]
    fn a_flat_function_ends_the_search_instead_of_drifting_for_ever() {
        assert_eq!(generations_until_the_end(|_| 1.0), 20);
    }

    #[test]
    fn a_search_ends_in_a_valley_whose_scores_hardly_differ() {
        let shallow: Function = |x| 1.0 + 1e-4 * x.iter().map(|x| x * x).sum::<f64>();
        assert_eq!(generations_until_the_end(shallow), 20);
    }

    #[test]
    fn a_restart_doubles_the_population() {
        let problem = OptimizationProblem {
            points: vec![11; 2],
            budget: 1000,
            seed: 1,
            priors: Vec::new(),
            error_blocks: Vec::new(),
            own: None,
        };
        let mut evaluated = Vec::new();
        let mut sizes = Vec::new();
        while evaluated.len() < 600 {
            let history = History {
                design: &[],
                evaluated: &evaluated,
            };
            let Proposal::Evaluate(batch) = CmaEs.propose(&problem, &history).unwrap() else {
                panic!("nothing to try");
            };
            sizes.push(batch.len());
            evaluated.extend(batch.into_iter().map(|point| super::super::EvaluatedPoint {
                point,
                score: Some(1.0),
                errors: Vec::new(),
            }));
        }
        sizes.dedup();
        assert_eq!(sizes[..3], [6, 12, 24]);
    }
}
