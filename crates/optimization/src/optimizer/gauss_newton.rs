//! The optimizer `gauss-newton`: damped nonlinear least squares on residuals, with derivatives by finite differences.

mod bounded;
mod channel;
mod far;
mod problem;
mod robust;

use super::random::space_filling;
use super::replay::{Replay, Unknown};
use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use far::far_along_weakest;
use problem::LinearisedProblem;
use realgap_core::error::Result;
use realgap_core::warning::{Code, Warning};

pub use bounded::minimum_within;
pub use channel::{ErrorBlock, blocks_of, error_scales};
pub use problem::{Linearisation, slopes};
pub use robust::{robust_loss, robust_slope};

/// Gauss–Newton with Marquardt's damping, from the own values and then from further space-filling points.
pub(super) struct GaussNewton;

/// Space-filling points of which the best is the start of a descent.
const STARTS: usize = 12;
/// Step of the finite differences as a share of a range: the initial step, and the smallest step. Differences over smaller steps are
/// dominated by the discrete steps of the solver and by stick and slip.
const FIRST_STEP: f64 = 0.02;
const LEAST_STEP: f64 = 0.002;
/// Initial value of Marquardt's damping; a batch of trial steps uses a tenth and ten times the damping, too.
const FIRST_DAMPING: f64 = 1e-2;
const DAMPINGS: [f64; 3] = [0.1, 1.0, 10.0];
/// Factor on the damping if no trial step was better, and how many such batches are tried in a row.
const MORE_DAMPING: f64 = 1e3;
const TRIALS: usize = 3;
/// Criteria of convergence: the loss falls by less than this share, and no coordinate moves farther than this.
const CONVERGED_LOSS: f64 = 1e-4;
const CONVERGED_STEP: f64 = 1e-3;
/// A descent ended on a rough score if its last steps promised to reduce the loss by more than this share, but did not reduce it.
const SMOOTH: f64 = 0.01;

/// How one descent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// The descent converged.
    Converged,
    /// No step reduces the loss, although the finite differences predict it: the score is rough.
    Rough,
    /// The start has no errors because its simulation diverged.
    NoStart,
}

/// The state of a search: how each finished descent ended, and the points that have finite differences around them.
struct SearchState {
    ends: Vec<End>,
    /// The best point of all descents.
    best: Option<(LinearisedProblem, Linearisation)>,
    /// The point where each descent ended.
    ended: Vec<Linearisation>,
    /// The last point of the current descent.
    last: Option<Linearisation>,
}

/// The errors of these points, in order; `None` for a point without errors. All coordinates are within 0 to 1 already.
fn errors_of<'r>(
    replay: &Replay<'r>,
    points: &[UnitPoint],
) -> std::result::Result<Vec<Option<&'r [f64]>>, Unknown> {
    let evaluated = replay.evaluated(points.iter().map(Vec::as_slice))?;
    let errors = |one: &'r super::EvaluatedPoint| {
        let has_errors = one.score.is_some() && !one.errors.is_empty();
        has_errors.then_some(one.errors.as_slice())
    };
    Ok(evaluated.into_iter().map(errors).collect())
}

/// One descent from a point whose errors are known.
fn descend(
    replay: &Replay<'_>,
    problem: &OptimizationProblem,
    start: (UnitPoint, &[f64], usize),
    state: &mut SearchState,
) -> std::result::Result<End, Unknown> {
    let (mut point, mut errors) = (start.0, start.1.to_vec());
    let mut at = start.2;
    let (mut step, mut damping) = (FIRST_STEP, FIRST_DAMPING);
    loop {
        let moved: Vec<UnitPoint> = (0..point.len())
            .map(|axis| {
                let mut moved = point.clone();
                moved[axis] += if moved[axis] > 0.5 { -step } else { step };
                moved
            })
            .collect();
        let indices = (at, replay.answered());
        let shifted = errors_of(replay, &moved)?;
        let linearised = LinearisedProblem::new(&point, &errors, problem, &moved, &shifted);
        let here = linearised.loss(&point, &errors);
        // Both points are compared by the loss of the known point, because the width of a robust loss depends on the errors at
        // the point for which it was made.
        let is_better = |(known, _): &(LinearisedProblem, Linearisation)| {
            known.loss(&point, &errors) < known.loss_here()
        };
        let known = Linearisation {
            at: point.clone(),
            errors: errors.clone(),
            jacobian: slopes(&point, &errors, moved.iter().zip(shifted.iter().copied())),
            scales: linearised.scales().to_vec(),
            indices,
        };
        state.last = Some(known.clone());
        if state.best.as_ref().is_none_or(is_better) {
            state.best = Some((linearised.clone(), known));
        }
        let mut promised = 0.0_f64;
        let mut reached: Option<(f64, UnitPoint, &[f64], usize)> = None;
        for _ in 0..TRIALS {
            let steps: Vec<(f64, UnitPoint)> = DAMPINGS
                .iter()
                .map(|share| {
                    let to = linearised.step(&point, damping * share);
                    (linearised.gain(&point, &to), to)
                })
                .collect();
            promised = steps.iter().map(|(gain, _)| *gain).fold(0.0, f64::max);
            let targets: Vec<UnitPoint> = steps.iter().map(|(_, to)| to.clone()).collect();
            let first = replay.answered();
            for (index, after) in errors_of(replay, &targets)?.into_iter().enumerate() {
                let Some(after) = after.filter(|after| after.len() == errors.len()) else {
                    continue;
                };
                let loss = linearised.loss(&targets[index], after);
                if loss < here && reached.as_ref().is_none_or(|best| loss < best.0) {
                    reached = Some((loss, targets[index].clone(), after, first + index));
                    damping = (damping * DAMPINGS[index]).max(1e-9);
                }
            }
            if reached.is_some() || promised < CONVERGED_LOSS * here {
                break;
            }
            damping *= MORE_DAMPING;
        }
        let Some((loss, to, after, index)) = reached else {
            if step > LEAST_STEP {
                // The finite differences may have been too long for a narrow minimum.
                (step, damping) = (LEAST_STEP, FIRST_DAMPING);
                continue;
            }
            let is_smooth = promised < SMOOTH * here.max(f64::MIN_POSITIVE);
            state.ended.extend(state.last.take());
            return Ok(if is_smooth {
                End::Converged
            } else {
                End::Rough
            });
        };
        let far = |(a, b): (&f64, &f64)| (a - b).abs();
        let longest = point.iter().zip(&to).map(far).fold(0.0, f64::max);
        let has_converged = here - loss < CONVERGED_LOSS * here && longest < CONVERGED_STEP;
        (point, errors, at) = (to, after.to_vec(), index);
        if has_converged {
            // The last step is so short that the derivatives before it serve after it.
            let ended = state.last.take().map(|last| Linearisation {
                at: point,
                errors,
                ..last
            });
            state.ended.extend(ended);
            return Ok(End::Converged);
        }
        step = (0.5 * longest).clamp(LEAST_STEP, step);
    }
}

/// Runs the algorithm until it needs points that have not been evaluated yet, and returns those points.
fn search(
    problem: &OptimizationProblem,
    history: &History<'_>,
    state: &mut SearchState,
) -> Unknown {
    let replay = Replay::new(history.evaluated);
    let dimensions = problem.dimensions();
    let mut begun = 0;
    loop {
        // The first start is the own values (or the medians of priors, or the middle of the ranges); of a few parameters without
        // priors, the best of these, the middle and some space-filling points. Each second further one lies far from the end of the
        // last descent along the direction that is least determined there: a descent into a wrong minimum ends where one parameter
        // does another's work, and more space-filling points often lead to the same place. The others are the best of more
        // space-filling points. A descent costs several times as many runs as these do.
        let ended = state.ended.last().filter(|_| begun % 2 == 1);
        let starts = match (begun, ended) {
            (0, _) => {
                let mut starts = vec![problem.beginning()];
                if problem.has_several_starts() {
                    starts.push(problem.middle());
                    starts.extend(space_filling(dimensions, 0, STARTS, problem.seed));
                }
                starts
            }
            (_, Some(ended)) => far_along_weakest(ended),
            (n, None) => space_filling(dimensions, n * STARTS, (n + 1) * STARTS, problem.seed),
        };
        begun += 1;
        let known = match errors_of(&replay, &starts) {
            Ok(errors) => errors,
            Err(unknown) => return unknown,
        };
        let first = replay.answered() - starts.len();
        let size = |errors: &[f64]| errors.iter().map(|error| error.abs()).sum::<f64>();
        let with_errors = starts.into_iter().zip(known).enumerate();
        let with_errors = with_errors.filter_map(|(index, (start, errors))| {
            let errors = errors?;
            Some((size(errors), (start, errors, first + index)))
        });
        let end = match with_errors.min_by(|a, b| a.0.total_cmp(&b.0)) {
            None => Ok(End::NoStart),
            Some((_, start)) => descend(&replay, problem, start, state),
        };
        match end {
            Ok(end) => state.ends.push(end),
            Err(unknown) => return unknown,
        }
    }
}

/// The state of the search after this history, and the points that it needs next.
fn replayed(problem: &OptimizationProblem, history: &History<'_>) -> (SearchState, Unknown) {
    let mut state = SearchState {
        ends: Vec::new(),
        best: None,
        ended: Vec::new(),
        last: None,
    };
    let unknown = search(problem, history, &mut state);
    (state, unknown)
}

impl Optimizer for GaussNewton {
    fn name(&self) -> &'static str {
        "gauss-newton"
    }

    fn doc(&self) -> &'static str {
        "Least squares on single errors with finite differences (Gauss-Newton, damped after Marquardt 1963, robust), for many parameters and a smooth metric such as joints; starts from the robot's own values, then from other points."
    }

    fn design(&self, _dimensions: usize) -> usize {
        0
    }

    fn batch(&self, problem: &OptimizationProblem) -> usize {
        let first = match problem.has_several_starts() {
            // With fewer runs there would be no derivatives.
            true => 2 + STARTS,
            false => 1,
        };
        first + problem.dimensions().max(DAMPINGS.len())
    }

    fn needs_errors(&self) -> bool {
        true
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        Ok(Proposal::Evaluate(replayed(problem, history).1.0))
    }

    fn warning(&self, problem: &OptimizationProblem, history: &History<'_>) -> Option<Warning> {
        let ends = replayed(problem, history).0.ends;
        let rough = ends.iter().filter(|end| **end == End::Rough).count();
        (rough > 0).then(|| {
            Code::RoughScore.warning(format!(
                "{rough} of {} descents ended where steps do not reduce the score although finite differences predict it: the score is rough there, as it is with contacts, stick and slip",
                ends.len()
            ))
        })
    }

    fn linearisations(
        &self,
        problem: &OptimizationProblem,
        history: &History<'_>,
    ) -> Vec<Linearisation> {
        let state = replayed(problem, history).0;
        let Some((linearised, best)) = state.best else {
            return Vec::new();
        };
        let loss = |known: &Linearisation| linearised.loss(&known.at, &known.errors);
        let mut all = state.ended;
        // The budget may end before the descent from the best point does.
        if all.iter().all(|known| known.at != best.at) {
            all.push(best);
        }
        all.sort_by(|a, b| loss(a).total_cmp(&loss(b)));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::super::EvaluatedPoint;
    use super::*;

    /// The points of a search of which the errors are known, up to its budget; the score is the size of the first error.
    fn searched(
        problem: &OptimizationProblem,
        errors: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Vec<EvaluatedPoint> {
        let mut evaluated: Vec<EvaluatedPoint> = Vec::new();
        while evaluated.len() < problem.budget {
            let history = History {
                design: &[],
                evaluated: &evaluated,
            };
            let Proposal::Evaluate(points) = GaussNewton.propose(problem, &history).unwrap() else {
                panic!("nothing more to try");
            };
            let left = problem.budget - evaluated.len();
            evaluated.extend(points.into_iter().take(left).map(|point| {
                let errors = errors(&point);
                EvaluatedPoint {
                    score: Some(errors[0].abs()),
                    errors,
                    point,
                }
            }));
        }
        evaluated
    }

    #[test]
    fn a_fit_begins_at_the_own_values_and_at_the_median_of_a_prior() {
        let problem =
            |priors: Vec<Option<(f64, f64)>>, own: Option<UnitPoint>| OptimizationProblem {
                points: vec![2; 9],
                budget: 100,
                seed: 1,
                priors,
                error_blocks: Vec::new(),
                own,
            };
        let first = |problem: &OptimizationProblem| {
            let history = History {
                design: &[],
                evaluated: &[],
            };
            match GaussNewton.propose(problem, &history).unwrap() {
                Proposal::Evaluate(points) => points[0].clone(),
                Proposal::Exhausted => panic!("nothing to try"),
            }
        };
        assert_eq!(first(&problem(Vec::new(), None)), vec![0.5; 9]);
        let own: UnitPoint = (0..9).map(|axis| 0.1 * f64::from(axis)).collect();
        assert_eq!(first(&problem(Vec::new(), Some(own.clone()))), own);
        let mut priors = vec![None; 9];
        priors[3] = Some((0.9, 0.01));
        let begun = first(&problem(priors, Some(own.clone())));
        assert_eq!((begun[3], begun[4]), (0.9, own[4]));
    }

    #[test]
    fn the_best_point_with_differences_is_found_wherever_the_budget_ends() {
        // There is one parameter, and all errors grow with its distance from the truth, so that the order of points is the same
        // for all of them.
        let truth = 0.83;
        let error = |point: &[f64]| point[0].powi(3) - f64::powi(truth, 3);
        for budget in 20..=44 {
            let problem = OptimizationProblem {
                points: vec![2],
                budget,
                seed: 1,
                priors: Vec::new(),
                error_blocks: Vec::new(),
                own: None,
            };
            let evaluated = searched(&problem, |point| {
                (1..=8).map(|row| f64::from(row) * error(point)).collect()
            });
            let history = History {
                design: &[],
                evaluated: &evaluated,
            };
            let known = GaussNewton.linearisations(&problem, &history);
            // The budget may end before there are finite differences around the best point, but no other point that has them is better.
            let at = error(&known[0].at).abs();
            assert!(
                known.iter().all(|one| at <= error(&one.at).abs()),
                "{budget}"
            );
            let starts = evaluated[..=STARTS].iter().map(|one| one.score.unwrap());
            assert!(starts.fold(f64::INFINITY, f64::min) >= at, "{budget}: {at}");
            let (at, moved) = known[0].indices;
            let axis = |number: usize| evaluated[number].point[0];
            assert!(
                (axis(at) - known[0].at[0]).abs() < CONVERGED_STEP,
                "{budget}"
            );
            assert_ne!(evaluated[at].point, evaluated[moved].point, "{budget}");
        }
    }

    /// Two channels: one that four coordinates move, and a joint that friction holds, whose small error its coordinate hardly changes
    /// unless it is so large that the joint breaks loose.
    fn with_a_held_joint(point: &[f64]) -> Vec<f64> {
        let truth = [0.3, 0.55, 0.7, 0.4];
        let moving = (0..80).map(|sample| {
            let t = 0.1 * f64::from(sample);
            let shapes = [1.0, t.sin(), (2.3 * t).cos(), (0.7 * t).sin()];
            let off = (0..4).map(|axis| (point[axis] - truth[axis]) * shapes[axis]);
            0.1 * off.sum::<f64>()
        });
        let held = match (point[4] - 0.5).abs() < 0.3 {
            true => 0.002 + 1e-5 * (point[4] - 0.5),
            false => 0.05,
        };
        moving.chain(std::iter::repeat_n(held, 80)).collect()
    }

    #[test]
    fn a_joint_that_friction_holds_does_not_stop_the_descent_of_the_others() {
        let block = |channel: usize| ErrorBlock {
            channel,
            log: 0,
            count: 80,
            resolution: 0.0015,
        };
        let problem = OptimizationProblem {
            points: vec![2; 5],
            budget: 40,
            seed: 1,
            priors: Vec::new(),
            error_blocks: vec![block(0), block(1)],
            own: Some(vec![0.5; 5]),
        };
        let evaluated = searched(&problem, with_a_held_joint);
        let history = History {
            design: &[],
            evaluated: &evaluated,
        };
        let known = GaussNewton.linearisations(&problem, &history);
        for (axis, truth) in [0.3, 0.55, 0.7, 0.4].into_iter().enumerate() {
            let found = known[0].at[axis];
            assert!((found - truth).abs() < 0.005, "{axis}: {found}");
        }
    }
}
