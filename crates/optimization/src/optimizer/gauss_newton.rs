//! Damped least squares on single errors, with finite differences.

mod log;
mod problem;

use nalgebra::{DMatrix, DVector};

use super::random::space_filling;
use super::replay::{Replay, Unknown};
use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use problem::Problem;
use realgap_core::error::Result;
use realgap_core::warning::{Code, Warning};

pub use problem::{Quadratic, slopes};

/// Gauss–Newton with Marquardt's damping, restarted from the best points of the first design.
pub(super) struct GaussNewton;

/// Finite differences: share of a range at first, and at least. Below the latter, steps of a solver and stick and slip show.
const FIRST_STEP: f64 = 0.02;
const LEAST_STEP: f64 = 0.002;
/// Marquardt's damping at first; a batch of trial steps has a tenth and ten times of it, too.
const FIRST_DAMPING: f64 = 1e-2;
const DAMPINGS: [f64; 3] = [0.1, 1.0, 10.0];
/// Factor on the damping where no trial step was better, and how often in a row.
const MORE_DAMPING: f64 = 1e3;
const TRIALS: usize = 3;
/// Arrived: the loss falls by less than this share, and no coordinate moves farther than this.
const ARRIVED_LOSS: f64 = 1e-4;
const ARRIVED_STEP: f64 = 1e-3;
/// Share of the loss that steps may promise in vain where errors are smooth.
const SMOOTH: f64 = 0.01;

/// How one descent went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// No step is worth it.
    Arrived,
    /// Steps promise what they do not keep.
    Rough,
    /// There is nothing to begin with.
    Nowhere,
}

/// Where a search is: every descent that ended, and the best point with differences around it.
struct Course {
    ends: Vec<End>,
    best: Option<Linear>,
}

/// A problem that was made linear, and where in the history its points are.
struct Linear {
    problem: Problem,
    /// The point itself, and the first of those moved along one coordinate each.
    told: (usize, usize),
}

/// What is told of these points, in order; coordinates are within 0 to 1 already.
fn ask<'r>(
    replay: &Replay<'r>,
    points: &[UnitPoint],
) -> std::result::Result<Vec<Option<&'r [f64]>>, Unknown> {
    let told = replay.told(points.iter().map(Vec::as_slice))?;
    let errors = |told: &'r super::EvaluatedPoint| {
        let is_there = told.score.is_some() && !told.errors.is_empty();
        is_there.then_some(told.errors.as_slice())
    };
    Ok(told.into_iter().map(errors).collect())
}

/// One descent from a point whose errors are known.
fn descend(
    replay: &Replay<'_>,
    brief: &OptimizationProblem,
    start: (UnitPoint, &[f64]),
    best: &mut Option<Linear>,
) -> std::result::Result<End, Unknown> {
    let (mut point, mut errors) = (start.0, start.1.to_vec());
    let mut at = replay.answered() - 1;
    let (mut step, mut damping) = (FIRST_STEP, FIRST_DAMPING);
    loop {
        let moved: Vec<UnitPoint> = (0..point.len())
            .map(|axis| {
                let mut moved = point.clone();
                moved[axis] += if moved[axis] > 0.5 { -step } else { step };
                moved
            })
            .collect();
        let told = (at, replay.answered());
        let shifted = ask(replay, &moved)?;
        let problem = Problem::new(&point, &errors, brief, &moved, &shifted);
        let here = problem.loss(&point, &errors);
        // By the known one's measure: the width of a loss is that of the errors where it was made.
        let is_better = |known: &Linear| known.problem.loss(&point, &errors) < known.problem.here();
        if best.as_ref().is_none_or(is_better) {
            let problem = problem.clone();
            *best = Some(Linear { problem, told });
        }
        let mut promised = 0.0_f64;
        let mut reached: Option<(f64, UnitPoint, &[f64], usize)> = None;
        for _ in 0..TRIALS {
            let steps: Vec<(f64, UnitPoint)> = DAMPINGS
                .iter()
                .map(|share| {
                    let to = problem.step(&point, damping * share);
                    (problem.gain(&point, &to), to)
                })
                .collect();
            promised = steps.iter().map(|(gain, _)| *gain).fold(0.0, f64::max);
            let targets: Vec<UnitPoint> = steps.iter().map(|(_, to)| to.clone()).collect();
            let first = replay.answered();
            for (index, told) in ask(replay, &targets)?.into_iter().enumerate() {
                let Some(told) = told.filter(|told| told.len() == errors.len()) else {
                    continue;
                };
                let loss = problem.loss(&targets[index], told);
                if loss < here && reached.as_ref().is_none_or(|best| loss < best.0) {
                    reached = Some((loss, targets[index].clone(), told, first + index));
                    damping = (damping * DAMPINGS[index]).max(1e-9);
                }
            }
            if reached.is_some() || promised < ARRIVED_LOSS * here {
                break;
            }
            damping *= MORE_DAMPING;
        }
        let Some((loss, to, told, index)) = reached else {
            if step > LEAST_STEP {
                // Perhaps the differences were too long for where the minimum is narrow.
                (step, damping) = (LEAST_STEP, FIRST_DAMPING);
                continue;
            }
            let is_smooth = promised < SMOOTH * here.max(f64::MIN_POSITIVE);
            return Ok(if is_smooth { End::Arrived } else { End::Rough });
        };
        let far = |(a, b): (&f64, &f64)| (a - b).abs();
        let longest = point.iter().zip(&to).map(far).fold(0.0, f64::max);
        let is_arrived = here - loss < ARRIVED_LOSS * here && longest < ARRIVED_STEP;
        (point, errors, at) = (to, told.to_vec(), index);
        if is_arrived {
            return Ok(End::Arrived);
        }
        step = (0.5 * longest).clamp(LEAST_STEP, step);
    }
}

/// Goes on until a point is asked for that nobody has evaluated.
fn search(brief: &OptimizationProblem, history: &History<'_>, course: &mut Course) -> Unknown {
    let replay = Replay::new(history.told);
    let dimensions = brief.dimensions();
    let mut begun = 0;
    loop {
        // The middle of the ranges (or what is believed beforehand) first, then other places that are spread out.
        let start = match begun {
            0 => brief.middle(),
            n => space_filling(dimensions, n - 1, n, brief.seed).remove(0),
        };
        begun += 1;
        let known = match ask(&replay, std::slice::from_ref(&start)) {
            Ok(told) => told[0],
            Err(unknown) => return unknown,
        };
        let end = match known {
            None => Ok(End::Nowhere),
            Some(errors) => descend(&replay, brief, (start, errors), &mut course.best),
        };
        match end {
            Ok(end) => course.ends.push(end),
            Err(unknown) => return unknown,
        }
    }
}

fn course(brief: &OptimizationProblem, history: &History<'_>) -> (Course, Unknown) {
    let mut course = Course {
        ends: Vec::new(),
        best: None,
    };
    let unknown = search(brief, history, &mut course);
    (course, unknown)
}

impl Optimizer for GaussNewton {
    fn name(&self) -> &'static str {
        "gauss-newton"
    }

    fn doc(&self) -> &'static str {
        "Least squares on single errors with finite differences (Gauss-Newton, damped after Marquardt 1963, robust), for many parameters and a smooth metric such as joints; from the middle of the ranges, then from other places."
    }

    fn design(&self, _dimensions: usize) -> usize {
        0
    }

    fn batch(&self, brief: &OptimizationProblem) -> usize {
        brief.dimensions().max(DAMPINGS.len())
    }

    fn needs_errors(&self) -> bool {
        true
    }

    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        Ok(Proposal::Evaluate(course(brief, history).1.0))
    }

    fn warning(&self, brief: &OptimizationProblem, history: &History<'_>) -> Option<Warning> {
        let ends = course(brief, history).0.ends;
        let rough = ends.iter().filter(|end| **end == End::Rough).count();
        (rough > 0).then(|| {
            Code::RoughScore.warning(format!(
                "{rough} of {} descents ended where steps do not keep what finite differences promise: the score is rough there, as contact, stick and slip make it",
                ends.len()
            ))
        })
    }

    fn quadratic(
        &self,
        brief: &OptimizationProblem,
        history: &History<'_>,
        logs: &[usize],
    ) -> Option<Quadratic> {
        let Linear { problem, told } = course(brief, history).0.best?;
        // The budget may end before there are differences around the last step: everything that was simulated is compared,
        // and by one measure.
        let known = history.told.iter().filter(|told| told.score.is_some());
        let known = known.filter(|told| told.errors.len() == problem.errors());
        let losses = known.map(|told| (problem.loss(&told.point, &told.errors), &told.point));
        let (loss, at) = losses.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(problem.quadratic((at.clone(), loss), told, logs))
    }
}

/// Solves a symmetric system with positive diagonal; a direction that nothing tells of gets no step.
fn solve(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let size = right.len();
    match matrix.cholesky() {
        Some(cholesky) => cholesky.solve(right),
        None => DVector::zeros(size),
    }
}

#[cfg(test)]
mod tests {
    use super::super::EvaluatedPoint;
    use super::*;

    #[test]
    fn the_best_is_the_nearest_of_all_simulated_wherever_the_budget_ends() {
        // One parameter whose errors all grow with its distance from the truth, so that there is one order of points.
        let truth = 0.83;
        let error = |point: &[f64]| point[0].powi(3) - f64::powi(truth, 3);
        for budget in 5..=24 {
            let brief = OptimizationProblem {
                points: vec![2],
                budget,
                seed: 1,
                priors: Vec::new(),
            };
            let mut told: Vec<EvaluatedPoint> = Vec::new();
            while told.len() < budget {
                let history = History {
                    design: &[],
                    told: &told,
                };
                let Proposal::Evaluate(points) = GaussNewton.propose(&brief, &history).unwrap()
                else {
                    panic!("nothing more to try");
                };
                told.extend(points.into_iter().take(budget - told.len()).map(|point| {
                    EvaluatedPoint {
                        score: Some(error(&point).abs()),
                        errors: (1..=8).map(|row| f64::from(row) * error(&point)).collect(),
                        point,
                    }
                }));
            }
            let history = History {
                design: &[],
                told: &told,
            };
            let known = GaussNewton.quadratic(&brief, &history, &[]).unwrap();
            let nearest = told.iter().map(|told| told.score.unwrap());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert_eq!(error(&known.at).abs(), nearest, "{budget}");
            let (at, moved) = known.told;
            assert_ne!(told[at].point, told[moved].point, "{budget}");
        }
    }
}
