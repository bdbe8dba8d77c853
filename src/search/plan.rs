//! The strategy of a search file, ready to propose.

use serde::{Deserialize, Serialize};

use super::body::{Body, GAIT, driven, genome_of};
use super::brain::CmaEs;
use super::descriptor::descriptor_named;
use crate::robot::genome::{Development, Genome, Locus};
use crate::robot::morphology::Morphology;
use crate::search::{Evolution, GeneValues, Grid, MapElites, Strategy, Variation};
use crate::{Error, Result};

/// The strategy as a file names it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) enum StrategyFile {
    Evolution {
        #[serde(default = "ten")]
        population: usize,
        #[serde(default = "ten")]
        generations: usize,
        #[serde(default = "two")]
        elites: usize,
        #[serde(default = "tournament")]
        selection: String,
        #[serde(default)]
        variation: Variation,
    },
    MapElites {
        #[serde(default)]
        axes: Vec<crate::search::Axis>,
        #[serde(default = "ten")]
        initial: usize,
        #[serde(default = "ten")]
        batch: usize,
        #[serde(default = "hundred")]
        evaluations: usize,
        #[serde(default)]
        variation: Variation,
    },
    Grid {
        genes: Vec<GeneValues>,
    },
    CmaEs {
        #[serde(default = "hundred")]
        evaluations: usize,
        #[serde(default = "gait")]
        genes: Vec<String>,
    },
}

fn ten() -> usize {
    10
}

fn two() -> usize {
    2
}

fn hundred() -> usize {
    100
}

fn tournament() -> String {
    Evolution::default().selection
}

fn gait() -> Vec<String> {
    GAIT.map(|locus| locus.name().to_owned()).to_vec()
}

/// Where genomes start: nowhere, at a genome, or at a robot whose body stays.
#[derive(Debug, Clone)]
pub(super) enum Origin {
    Anything,
    Genome(Genome),
    Robot(Box<Morphology>),
}

/// Whatever chooses the robots.
#[derive(Debug, Clone, PartialEq)]
pub enum Plan {
    /// Generations.
    Evolution(Evolution),
    /// An archive.
    MapElites(MapElites),
    /// Every combination.
    Grid(Grid),
    /// The gait of one body.
    CmaEs(CmaEs),
}

impl Plan {
    /// The strategy of a file and how it builds robots.
    pub(super) fn new(
        file: StrategyFile,
        origin: &Origin,
        development: &Development,
        seed: u64,
    ) -> Result<(Self, Body)> {
        let body = match origin {
            Origin::Robot(robot) => Body::Fixed(robot.clone(), development.clone()),
            Origin::Anything | Origin::Genome(_) => Body::Developed(development.clone()),
        };
        let plan = match file {
            StrategyFile::Evolution {
                population,
                generations,
                elites,
                selection,
                variation,
            } => {
                must_be_free(origin)?;
                Self::Evolution(Evolution {
                    population,
                    generations,
                    elites,
                    selection,
                    variation,
                    seed,
                })
            }
            StrategyFile::MapElites {
                axes,
                initial,
                batch,
                evaluations,
                variation,
            } => {
                must_be_free(origin)?;
                for (index, axis) in axes.iter().enumerate() {
                    descriptor_named(&axis.name)
                        .map_err(|e| e.field(format!("strategy.axes[{index}].name")))?;
                }
                Self::MapElites(MapElites {
                    axes,
                    initial,
                    batch,
                    evaluations,
                    variation,
                    seed,
                })
            }
            StrategyFile::Grid { genes } => {
                let named: Vec<Locus> = genes
                    .iter()
                    .filter_map(|g| Locus::named(&g.gene).ok())
                    .collect();
                let base = base(origin, development, &named)?;
                if matches!(origin, Origin::Robot(_)) {
                    gait_only(&named)?;
                }
                Self::Grid(Grid { base, axes: genes })
            }
            StrategyFile::CmaEs { evaluations, genes } => {
                let named: Result<Vec<Locus>> = genes.iter().map(|g| Locus::named(g)).collect();
                let named = named.map_err(|e| e.field("strategy.genes"))?;
                gait_only(&named)?;
                let base = base(origin, development, &named)?;
                let robot = body.build("robot", &base)?;
                let searched: Vec<(usize, Locus)> = driven(&robot)
                    .into_iter()
                    .flat_map(|module| named.iter().map(move |&locus| (module, locus)))
                    .collect();
                if searched.is_empty() || evaluations == 0 {
                    return Err(Error::invalid("there is nothing to search")
                        .field("strategy")
                        .found(format!(
                            "{} numbers, {evaluations} evaluations",
                            searched.len()
                        ))
                        .allowed(
                            "a robot with a servo, a number of its gait, 1 or more evaluations",
                        ));
                }
                Self::CmaEs(CmaEs {
                    base,
                    searched,
                    evaluations,
                    seed,
                })
            }
        };
        plan.check(development)
            .map_err(|e| within_strategy(e, &plan))?;
        Ok((plan, body))
    }

    fn check(&self, development: &Development) -> Result<()> {
        let (Self::Evolution(Evolution { variation, .. })
        | Self::MapElites(MapElites { variation, .. })) = self
        else {
            return match self {
                Self::Grid(grid) => grid.check(),
                _ => Ok(()),
            };
        };
        match self {
            Self::Evolution(evolution) => evolution.check()?,
            Self::MapElites(archive) => archive.check()?,
            Self::Grid(_) | Self::CmaEs(_) => {}
        }
        if variation.max_modules > development.max_modules {
            return Err(
                Error::invalid("the strategy makes larger robots than development allows")
                    .field("variation.max_modules")
                    .found(variation.max_modules)
                    .allowed(format!("1 to {}", development.max_modules))
                    .hint("raise `development: (max_modules: ...)`, too"),
            );
        }
        Ok(())
    }

    /// What proposes.
    pub fn strategy(&self) -> &dyn Strategy {
        match self {
            Self::Evolution(evolution) => evolution,
            Self::MapElites(archive) => archive,
            Self::Grid(grid) => grid,
            Self::CmaEs(brain) => brain,
        }
    }

    /// Name in tables and pictures.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Evolution(_) => "evolution",
            Self::MapElites(_) => "map-elites",
            Self::Grid(_) => "grid",
            Self::CmaEs(_) => "cma-es",
        }
    }

    /// Robots of the whole search.
    pub fn budget(&self) -> usize {
        match self {
            Self::Evolution(evolution) => evolution.budget(),
            Self::MapElites(archive) => archive.evaluations,
            Self::Grid(grid) => grid.budget(),
            Self::CmaEs(brain) => brain.evaluations,
        }
    }

    /// Robots that are proposed at once: a generation, for pictures.
    pub fn generation_of(&self, index: usize) -> usize {
        let (first, others) = match self {
            Self::Evolution(e) => (e.population, e.population - e.elites),
            Self::MapElites(m) => (m.initial, m.batch),
            Self::Grid(_) => (10, 10),
            Self::CmaEs(c) => {
                // As `tuning` sets the population: 4 + 3 ln n.
                let population = 4 + (3.0 * (c.searched.len() as f64).ln()).floor() as usize;
                (population, population)
            }
        };
        match index.checked_sub(first) {
            None => 0,
            Some(later) => 1 + later / others.max(1),
        }
    }
}

fn must_be_free(origin: &Origin) -> Result<()> {
    match origin {
        Origin::Anything => Ok(()),
        _ => Err(Error::invalid("this strategy draws its own robots")
            .field("start")
            .allowed("nothing here; Grid and CmaEs start from a genome or a morphology")),
    }
}

fn base(origin: &Origin, development: &Development, searched: &[Locus]) -> Result<Genome> {
    match origin {
        Origin::Genome(genome) => Ok(genome.clone()),
        Origin::Robot(robot) => genome_of(robot, development, searched),
        Origin::Anything => Err(
            Error::invalid("this strategy needs something to start from")
                .field("start")
                .allowed("Genome(\"file.ron\") or Morphology(\"file.ron\")"),
        ),
    }
}

fn gait_only(named: &[Locus]) -> Result<()> {
    match named.iter().find(|locus| locus.is_body()) {
        None => Ok(()),
        Some(locus) => Err(Error::invalid("the body is fixed here")
            .field("strategy.genes")
            .found(locus.name())
            .allowed(gait().join(", "))),
    }
}

/// Says where in the file: strategies know their own fields only.
fn within_strategy(error: Error, plan: &Plan) -> Error {
    let field = match error.field_name() {
        Some(field) => format!("strategy.{field}"),
        None => format!("strategy ({})", plan.name()),
    };
    error.field(field)
}
