//! CMA-ES on the gait of one body: an optimizer of [`optimization`](realgap_optimization) as a strategy.

use serde::Deserialize;

use super::{Evaluated, Space, Strategy, StrategySettings};
use crate::search::body::GAIT;
use realgap_core::{Error, Result};
use realgap_optimization::{
    EvaluatedPoint, History, OptimizationProblem, Proposal, optimizer_by_name,
};
use realgap_robot::genome::{Gene, Genome, Locus};

/// CMA-ES as a file names it: on the gait of the genome or the robot that the search starts from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CmaEsSettings {
    /// Robots of the whole search.
    pub evaluations: usize,
    /// Names of the numbers of the gait that are searched, of every module with a servo.
    pub genes: Vec<String>,
}

impl Default for CmaEsSettings {
    /// A hundred robots; the whole gait.
    fn default() -> Self {
        Self {
            evaluations: 100,
            genes: GAIT.map(|locus| locus.name().to_owned()).to_vec(),
        }
    }
}

impl StrategySettings for CmaEsSettings {
    fn strategy(&self, space: &Space) -> Result<Box<dyn Strategy>> {
        let named: Result<Vec<Locus>> = self.genes.iter().map(|g| Locus::named(g)).collect();
        let named = named.map_err(|e| e.field("strategy.genes"))?;
        space.must_be_gait(&named)?;
        let base = space.base(&named)?;
        let searched: Vec<(usize, Locus)> = space
            .driven(&base)?
            .into_iter()
            .flat_map(|module| named.iter().map(move |&locus| (module, locus)))
            .collect();
        if searched.is_empty() || self.evaluations == 0 {
            return Err(Error::invalid("there is nothing to search")
                .field("strategy")
                .found(format!(
                    "{} numbers, {} evaluations",
                    searched.len(),
                    self.evaluations
                ))
                .allowed("a robot with a servo, a number of its gait, 1 or more evaluations"));
        }
        Ok(Box::new(CmaEs {
            base,
            searched,
            evaluations: self.evaluations,
            seed: space.seed(),
        }))
    }
}

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
    fn name(&self) -> &'static str {
        "cma-es"
    }

    fn budget(&self) -> usize {
        self.evaluations
    }

    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        let left = self.evaluations.saturating_sub(history.len());
        if left == 0 {
            return Ok(Vec::new());
        }
        let told: Vec<EvaluatedPoint> = history
            .iter()
            .map(|evaluated| EvaluatedPoint {
                point: self
                    .searched
                    .iter()
                    .map(|&(module, locus)| evaluated.genome.genes()[module].get(locus))
                    .collect(),
                // Optimizers minimise, and the fitness is maximised.
                score: evaluated.fitness.filter(|f| f.is_finite()).map(|f| -f),
                errors: Vec::new(),
            })
            .collect();
        let brief = OptimizationProblem {
            points: vec![1; self.searched.len()],
            budget: self.evaluations,
            seed: self.seed,
            priors: Vec::new(),
            error_blocks: Vec::new(),
            own: None,
        };
        let history = History {
            design: &[],
            evaluated: &told,
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
