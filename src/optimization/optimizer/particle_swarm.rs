//! A swarm of particles, from the `argmin` library.

use argmin::core::{CostFunction, PopulationState, Problem, Solver, State};
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::replay::Replay;
use super::{Brief, History, Optimizer, Proposal};
use crate::error::{Advice, Error, Result};

/// Particle swarm.
pub(super) struct Swarm;

/// Particles: few, for budgets of a hundred simulations.
const PARTICLES: usize = 10;

type SolverState = PopulationState<Particle<Vec<f64>, f64>, f64>;

struct Costs<'a>(&'a Replay<'a>);

impl CostFunction for Costs<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, point: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.0.cost(point.iter().copied()))
    }
}

fn refused(error: &argmin::core::Error) -> Error {
    Error::conflict(format!("the swarm cannot go on: {error}"))
        .advise(Advice::OtherOptimizer)
        .advise(Advice::OtherSeed)
}

impl Optimizer for Swarm {
    fn name(&self) -> &'static str {
        "particle-swarm"
    }

    fn doc(&self) -> &'static str {
        "Particle swarm of 10 (Zambrano-Bigiarini et al. 2013, argmin)."
    }

    fn batch(&self, _brief: &Brief) -> usize {
        PARTICLES
    }

    fn propose(&self, brief: &Brief, history: &History<'_>) -> Result<Proposal> {
        let replay = Replay::new(history.told);
        let n = brief.dimensions();
        let mut solver = ParticleSwarm::new((vec![0.0; n], vec![1.0; n]), PARTICLES)
            .with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(brief.seed));
        let mut problem = Problem::new(Costs(&replay));
        let mut state = SolverState::new();
        let best = history.best_of_design();
        if best.len() >= PARTICLES {
            let at_rest = vec![0.0; n];
            let particles = best.iter().take(PARTICLES);
            state = state.population(
                particles
                    .map(|(point, score)| Particle::new((*point).clone(), *score, at_rest.clone()))
                    .collect(),
            );
        }
        (state, _) = solver.init(&mut problem, state).map_err(|e| refused(&e))?;
        loop {
            let asked = replay.asked();
            if !asked.is_empty() {
                return Ok(Proposal::Evaluate(asked));
            }
            (state, _) = solver
                .next_iter(&mut problem, state)
                .map_err(|e| refused(&e))?;
        }
    }
}
