//! The optimizer `particle-swarm` (Zambrano-Bigiarini, Clerc & Rojas 2013, chapter II, section A).

use std::convert::Infallible;
use std::f64::consts::LN_2;

use rand::Rng;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::replay::{Replay, Unknown};
use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// Particle swarm.
pub(super) struct Swarm;

/// Number of particles; it is small because budgets are about a hundred simulations.
const PARTICLES: usize = 10;
/// Share of its velocity that a particle keeps (Clerc 2006).
const INERTIA: f64 = 1.0 / (2.0 * LN_2);
/// Strength of the attraction of a particle to its own best point and to the best point of all particles.
const ATTRACTION: f64 = 0.5 + LN_2;

struct Particle {
    position: UnitPoint,
    velocity: Vec<f64>,
    best: UnitPoint,
    best_score: f64,
}

impl Particle {
    fn new(position: UnitPoint, velocity: Vec<f64>, score: f64) -> Self {
        Self {
            best: position.clone(),
            best_score: score,
            position,
            velocity,
        }
    }
}

/// A random number between two numbers in any order; if they are equal, no random number is drawn.
fn between(a: f64, b: f64, random: &mut Xoshiro256PlusPlus) -> f64 {
    if a == b {
        return a;
    }
    // 52 random bits become the fraction of a floating-point number from 1 to 2.
    let from_one_to_two = f64::from_bits((1023 << 52) | (random.next_u64() >> 12));
    (from_one_to_two - 1.0) * (a - b).abs() + a.min(b)
}

/// Random positions within the range from 0 to 1, and random velocities from -1 to 1.
fn scatter(dimensions: usize, random: &mut Xoshiro256PlusPlus) -> Vec<(UnitPoint, Vec<f64>)> {
    let mut draw = |low| -> Vec<Vec<f64>> {
        (0..PARTICLES)
            .map(|_| (0..dimensions).map(|_| between(low, 1.0, random)).collect())
            .collect()
    };
    let positions = draw(0.0);
    positions.into_iter().zip(draw(-1.0)).collect()
}

fn search(
    problem: &OptimizationProblem,
    history: &History<'_>,
) -> std::result::Result<Infallible, Unknown> {
    let replay = Replay::new(history.evaluated);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(problem.seed);
    let known = history.best_of_design();
    let mut particles: Vec<Particle> = if known.len() >= PARTICLES {
        let at_rest = vec![0.0; problem.dimensions()];
        known[..PARTICLES]
            .iter()
            .map(|(point, score)| Particle::new((*point).clone(), at_rest.clone(), *score))
            .collect()
    } else {
        let begun = scatter(problem.dimensions(), &mut random);
        let scores = replay.scores(begun.iter().map(|(position, _)| position.as_slice()))?;
        let all = begun.into_iter().zip(scores);
        all.map(|((position, velocity), score)| Particle::new(position, velocity, score))
            .collect()
    };
    particles.sort_by(|a, b| a.best_score.total_cmp(&b.best_score));
    let (mut best, mut best_score) = (particles[0].best.clone(), particles[0].best_score);
    loop {
        for particle in &mut particles {
            let mut pull = |to: &UnitPoint| -> Vec<f64> {
                let ways = to.iter().zip(&particle.position);
                ways.map(|(to, from)| between(0.0, to - from, &mut random) * ATTRACTION)
                    .collect()
            };
            let (to_own, to_all) = (pull(&particle.best), pull(&best));
            for axis in 0..problem.dimensions() {
                let velocity = &mut particle.velocity[axis];
                *velocity = *velocity * INERTIA + to_own[axis] + to_all[axis];
                let position = &mut particle.position[axis];
                *position = (*position + *velocity).clamp(0.0, 1.0);
            }
        }
        let scores = replay.scores(particles.iter().map(|p| p.position.as_slice()))?;
        for (particle, score) in particles.iter_mut().zip(scores) {
            if score < particle.best_score {
                particle.best.clone_from(&particle.position);
                particle.best_score = score;
                if score < best_score {
                    best.clone_from(&particle.position);
                    best_score = score;
                }
            }
        }
    }
}

impl Optimizer for Swarm {
    fn name(&self) -> &'static str {
        "particle-swarm"
    }

    fn doc(&self) -> &'static str {
        "Particle swarm of 10 (Zambrano-Bigiarini et al. 2013)."
    }

    fn batch(&self, _problem: &OptimizationProblem) -> usize {
        PARTICLES
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let Err(Unknown(points)) = search(problem, history);
        Ok(Proposal::Evaluate(points))
    }
}
