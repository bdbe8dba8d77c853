//! A simulated robot: its motion and fitness, or why it failed.

use super::{Evaluated, Failure, Reason, Travel};
use realgap_core::statistics::mean_of;
use realgap_core::{Error, Result};
use realgap_robot::genome::{Gene, Genome, Locus};
use realgap_store::{RobotOutcome, RobotRow};

/// A robot of a search with its result.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedRobot {
    /// Position in the search's order, from 0.
    pub index: usize,
    /// The genome.
    pub genome: Genome,
    /// The result.
    pub outcome: Outcome,
}

/// The result of a robot.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// It was simulated to the end in every repeat.
    Walked(Performance),
    /// It has no fitness.
    Failed(Failure),
}

/// The motion of a robot in its repeats, and its fitness.
#[derive(Debug, Clone, PartialEq)]
pub struct Performance {
    /// Fitness in the unit of the objective's measure; larger is better.
    pub fitness: f64,
    /// Every repeat, in order.
    pub repeats: Vec<Travel>,
    /// The descriptors that the strategy asks for, in its order.
    pub descriptors: Vec<f64>,
}

impl EvaluatedRobot {
    /// The performance; `None` for a failure.
    pub fn performance(&self) -> Option<&Performance> {
        match &self.outcome {
            Outcome::Walked(performance) => Some(performance),
            Outcome::Failed(_) => None,
        }
    }

    /// Fitness in the unit of the objective's measure; `None` for a failure.
    pub fn fitness(&self) -> Option<f64> {
        self.performance().map(|performance| performance.fitness)
    }

    /// Mean net displacement over the repeats, metres; `None` for a failure.
    pub fn mean_displacement_m(&self) -> Option<f64> {
        self.performance()
            .map(|performance| mean_displacement_m(&performance.repeats))
    }

    /// Whether both walked, and moved exactly alike in every repeat.
    pub(crate) fn walked_as(&self, other: &Self) -> bool {
        let repeats = |robot: &Self| robot.performance().map(|p| p.repeats.clone());
        repeats(self).is_some() && repeats(self) == repeats(other)
    }

    /// Whether it has the body that was proposed; its gait may have been tuned.
    pub(super) fn is_of(&self, proposed: &Genome) -> bool {
        let body = |gene: &Gene| {
            let body = Locus::ALL.into_iter().filter(|locus| locus.is_body());
            body.map(|locus| gene.get(locus)).collect::<Vec<f64>>()
        };
        let bodies = proposed.genes().iter().map(body);
        bodies.eq(self.genome.genes().iter().map(body))
    }

    /// The failure; `None` where there is a fitness.
    pub fn failure(&self) -> Option<&Failure> {
        match &self.outcome {
            Outcome::Walked(_) => None,
            Outcome::Failed(failure) => Some(failure),
        }
    }

    /// The robot in the form that strategies get.
    pub fn evaluated(&self) -> Evaluated {
        Evaluated {
            genome: self.genome.clone(),
            fitness: self.fitness(),
            descriptors: self
                .performance()
                .map(|performance| performance.descriptors.clone())
                .unwrap_or_default(),
        }
    }
}

/// Mean net displacement of some repeats, metres.
pub(super) fn mean_displacement_m(repeats: &[Travel]) -> f64 {
    mean_of(repeats.iter().map(|t| t.displacement_m))
}

impl From<&EvaluatedRobot> for RobotRow {
    fn from(robot: &EvaluatedRobot) -> Self {
        let outcome = match &robot.outcome {
            Outcome::Failed(failure) => RobotOutcome::Failed {
                reason: failure.reason.code().to_owned(),
                seen: failure.seen.clone(),
            },
            Outcome::Walked(performance) => RobotOutcome::Walked {
                fitness: performance.fitness,
                repeats: performance.repeats.clone(),
                descriptors: performance.descriptors.clone(),
            },
        };
        let genes = robot.genome.genes().iter();
        Self {
            index: robot.index,
            genome: genes.flat_map(|gene| *gene.values()).collect(),
            outcome,
        }
    }
}

impl TryFrom<&RobotRow> for EvaluatedRobot {
    type Error = Error;

    fn try_from(row: &RobotRow) -> Result<Self> {
        let strange = |what: &str| {
            Error::conflict("a stored robot cannot be understood")
                .field(format!("robot {}", row.index))
                .found(what)
        };
        let (genes, rest) = row.genome.as_chunks::<{ Gene::LEN }>();
        let genome = Genome::try_from(genes.to_vec());
        let genome = genome.ok().filter(|_| rest.is_empty());
        let outcome = match &row.outcome {
            RobotOutcome::Failed { reason, seen } => {
                let reason = Reason::by_code(reason)
                    .ok_or_else(|| strange("a reason to fail that is none"))?;
                Outcome::Failed(Failure::new(reason, seen))
            }
            RobotOutcome::Walked {
                fitness,
                repeats,
                descriptors,
            } => Outcome::Walked(Performance {
                fitness: *fitness,
                repeats: repeats.clone(),
                descriptors: descriptors.clone(),
            }),
        };
        Ok(Self {
            index: row.index,
            genome: genome.ok_or_else(|| strange("numbers that are no genome"))?,
            outcome,
        })
    }
}
