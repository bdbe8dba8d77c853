//! CMA-ES on the gait of a fixed body: an optimizer of `tuning` behind the trait of strategies.

use crate::Result;
use crate::optimization::{Brief, History, Proposal, Told, optimizer_by_name};
use crate::robot::genome::{Gene, Genome, Locus};
use crate::search::{Evaluated, Strategy};

/// Covariance matrix adaptation on chosen numbers of one genome.
#[derive(Debug, Clone, PartialEq)]
pub struct CmaEs {
    /// The genome; what is not searched stays as it is here.
    pub base: Genome,
    /// Module and number of everything that is searched.
    pub searched: Vec<(usize, Locus)>,
    /// Robots of the whole search.
    pub evaluations: usize,
    /// Seed of every random choice.
    pub seed: u64,
}

impl Strategy for CmaEs {
    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        let left = self.evaluations.saturating_sub(history.len());
        if left == 0 {
            return Ok(Vec::new());
        }
        let told: Vec<Told> = history
            .iter()
            .map(|evaluated| Told {
                point: self
                    .searched
                    .iter()
                    .map(|&(module, locus)| evaluated.genome.genes()[module].get(locus))
                    .collect(),
                // Optimizers of `tuning` make small what is to be large here.
                score: evaluated.fitness.filter(|f| f.is_finite()).map(|f| -f),
            })
            .collect();
        let brief = Brief {
            points: vec![1; self.searched.len()],
            budget: self.evaluations,
            seed: self.seed,
        };
        let history = History {
            design: &[],
            told: &told,
        };
        let optimizer = optimizer_by_name("cma-es")?;
        match optimizer.propose(&brief, &history)? {
            Proposal::Exhausted => Ok(Vec::new()),
            Proposal::Evaluate(points) => {
                points.iter().take(left).map(|p| self.genome(p)).collect()
            }
        }
    }
}

impl CmaEs {
    fn genome(&self, point: &[f64]) -> Result<Genome> {
        let mut genes: Vec<[f64; Gene::LEN]> =
            self.base.genes().iter().map(|g| *g.values()).collect();
        for (&(module, locus), &value) in self.searched.iter().zip(point) {
            genes[module][locus.index()] = value;
        }
        Genome::new(genes.into_iter().map(Gene::clamped).collect())
    }
}
