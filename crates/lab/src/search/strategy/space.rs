//! The space of a search: what a strategy may know about robots.

use super::Variation;
use crate::search::Body;
use crate::search::body::{GAIT, driven, genome_of};
use realgap_core::{Error, Result};
use realgap_robot::genome::{Genome, Locus};

/// The space of a search: how genomes become robots, where they start, and the seed. It has no simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    body: Body,
    start: Option<Genome>,
    seed: u64,
}

impl Space {
    /// A space; `start` is the genome in its middle, where there is one.
    pub fn new(body: Body, start: Option<Genome>, seed: u64) -> Self {
        Self { body, start, seed }
    }

    /// How genomes become robots.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Seed of everything random.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The genome to start from. Numbers in `searched` of a given robot may lie outside of their range, the others may not.
    ///
    /// # Errors
    /// Neither a genome nor a robot to start from.
    pub fn base(&self, searched: &[Locus]) -> Result<Genome> {
        match (&self.start, &self.body) {
            (Some(genome), _) => Ok(genome.clone()),
            (None, Body::Fixed(robot, ranges)) => genome_of(robot, ranges, searched),
            (None, Body::Developed(_)) => Err(Error::invalid(
                "this strategy needs something to start from",
            )
            .field("start")
            .allowed("Genome(\"file.ron\") or Morphology(\"file.ron\")")),
        }
    }

    /// The genome in the middle of the space, where one was given.
    pub fn start(&self) -> Option<&Genome> {
        self.start.as_ref()
    }

    /// The modules with a servo of this genome's robot.
    ///
    /// # Errors
    /// A genome without a robot.
    pub fn driven(&self, genome: &Genome) -> Result<Vec<usize>> {
        Ok(driven(&self.body.build("robot", genome)?))
    }

    /// Refuses a genome or a robot to start from: for strategies that start from random robots.
    ///
    /// # Errors
    /// A genome or a robot to start from.
    pub(crate) fn must_be_free(&self) -> Result<()> {
        if self.start.is_none() && matches!(self.body, Body::Developed(_)) {
            return Ok(());
        }
        Err(Error::invalid("this strategy draws its own robots")
            .field("start")
            .allowed("nothing here; Grid and CmaEs start from a genome or a morphology"))
    }

    /// Refuses robots larger than development allows.
    ///
    /// # Errors
    /// A variation of larger robots.
    pub fn must_hold(&self, variation: &Variation) -> Result<()> {
        let most = self.body.development().max_modules;
        if variation.max_modules <= most {
            return Ok(());
        }
        Err(
            Error::invalid("the strategy makes larger robots than development allows")
                .field("strategy.variation.max_modules")
                .found(variation.max_modules)
                .allowed(format!("1 to {most}"))
                .hint("raise `development: (max_modules: ...)`, too"),
        )
    }

    /// Refuses numbers of the body where the body is given.
    ///
    /// # Errors
    /// A number of the body.
    pub(crate) fn must_leave_the_body(&self, searched: &[Locus]) -> Result<()> {
        match self.body {
            Body::Fixed(..) => self.must_be_gait(searched),
            Body::Developed(_) => Ok(()),
        }
    }

    /// Refuses numbers of the body.
    ///
    /// # Errors
    /// A number of the body.
    pub(crate) fn must_be_gait(&self, searched: &[Locus]) -> Result<()> {
        match searched.iter().find(|locus| locus.is_body()) {
            None => Ok(()),
            Some(locus) => Err(Error::invalid("the body is fixed here")
                .field("strategy.genes")
                .found(locus.name())
                .allowed(GAIT.map(Locus::name).join(", "))),
        }
    }
}

/// The error with its place in the file, because a group of fields knows only its own names.
pub fn within(group: &str, error: Error) -> Error {
    let field = match error.field_name() {
        Some(field) => format!("{group}.{field}"),
        None => group.to_owned(),
    };
    error.field(field)
}
