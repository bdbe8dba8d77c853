//! Builds a search, from Rust or from a file; every setting is checked in one place.

use std::sync::Arc;

use super::strategy::within;
use super::{
    Body, FailureRules, FinalsSettings, GaitTuning, Objective, Search, SettingsChoice, Space,
    StrategySettings, descriptor_named,
};
use crate::prediction::{UncertainParameters, UncertainRange};
use realgap_core::file::check_name;
use realgap_core::range::Range;
use realgap_core::{Error, Result};
use realgap_robot::genome::{Development, Genome};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{LONGEST_S, Noise};

/// Most repeats of one robot.
const REPEATS_AT_MOST: usize = 5000;
/// Most robots of a search: they are held in memory, and every proposal looks at all of them.
const MOST_ROBOTS: usize = 1_000_000;

/// A search that is being built. A setting that is not given has the default of a search file.
#[derive(Debug)]
#[must_use = "nothing is a search before `build`"]
pub struct SearchBuilder {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) description: String,
    pub(super) strategy: Box<dyn StrategySettings>,
    pub(super) development: Development,
    pub(super) robot: Option<Morphology>,
    pub(super) genome: Option<Genome>,
    pub(super) duration_s: f64,
    pub(super) set: Vec<(String, f64)>,
    pub(super) overruling: ParameterSet,
    pub(super) ranges: Vec<UncertainRange>,
    pub(super) points: Vec<Vec<ParameterSet>>,
    pub(super) posterior_from: Option<String>,
    pub(super) noise: Option<(Noise, String)>,
    pub(super) objective: Objective,
    pub(super) repeats: usize,
    pub(super) failures: FailureRules,
    pub(super) settings: SettingsChoice,
    pub(super) gait: Option<GaitTuning>,
    pub(super) finals: FinalsSettings,
    pub(super) seed: u64,
}

impl Search {
    /// A search by this strategy: [`Evolution`](super::Evolution), [`MapElites`](super::MapElites),
    /// [`GridSettings`](super::GridSettings) or [`CmaEsSettings`](super::CmaEsSettings).
    pub fn builder(strategy: impl StrategySettings + 'static) -> SearchBuilder {
        SearchBuilder {
            name: "search".to_owned(),
            text: String::new(),
            description: String::new(),
            strategy: Box::new(strategy),
            development: Development::default(),
            robot: None,
            genome: None,
            duration_s: 20.0,
            set: Vec::new(),
            overruling: ParameterSet::new(),
            ranges: Vec::new(),
            points: Vec::new(),
            posterior_from: None,
            noise: None,
            objective: Objective::default(),
            repeats: 8,
            failures: FailureRules::default(),
            settings: SettingsChoice::default(),
            gait: None,
            finals: FinalsSettings::default(),
            seed: 1,
        }
    }
}

impl SearchBuilder {
    realgap_core::setters! {
        /// Name of the search, for pictures and messages; `search` by default.
        name: impl Into<String>;
        /// How genomes become robots; for a given robot, the ranges of its gait.
        development: Development;
        /// Starts from this robot: its body stays, and its gait may be searched.
        robot: Morphology;
        /// Starts from this genome.
        genome: Genome;
        /// Length of each run, seconds.
        duration_s: f64;
        /// The objective.
        objective: Objective;
        /// Runs of every robot.
        repeats: usize;
        /// Rules for failures.
        failures: FailureRules;
        /// The settings of engine and steps of the repeats.
        settings: SettingsChoice;
        /// Tunes the gait of every body by short runs before the body is judged.
        gait: GaitTuning;
        /// How the best robots are judged again.
        finals: FinalsSettings;
        /// Seed of everything random, the strategy's choices included.
        seed: u64;
    }

    /// A fixed value of a parameter, e.g. `floor.friction`.
    pub fn set(mut self, name: impl Into<String>, value: f64) -> Self {
        self.set.push((name.into(), value));
        self
    }

    /// A parameter of which only a range is known: every repeat draws its value.
    pub fn uncertain(mut self, name: impl Into<String>, low: f64, high: f64) -> Self {
        let name = name.into();
        self.ranges.push(UncertainRange { name, low, high });
        self
    }

    /// Noise of the repeats, and its source; by default an estimate for a robot that was not measured.
    pub fn noise(mut self, noise: Noise, from: impl Into<String>) -> Self {
        self.noise = Some((noise, from.into()));
        self
    }

    /// The search.
    ///
    /// # Errors
    /// The first setting that is not allowed; `field` is its name in a search file.
    pub fn build(self) -> Result<Search> {
        check_name(&self.name, "a search")?;
        self.check_numbers()?;
        self.development
            .check()
            .map_err(|e| within("development", e))?;
        let (noise, noise_from) = match self.noise {
            Some(stated) => stated,
            None => (Noise::unmeasured_robot(), "estimate".to_owned()),
        };
        if let Some((field, error)) = noise.fault() {
            return Err(error.field(format!("noise.{field}")));
        }
        self.objective.check().map_err(|e| within("objective", e))?;
        if let Some(gait) = &self.gait {
            gait.check().map_err(|e| within("gait", e))?;
        }
        if self.objective.from_s >= self.duration_s {
            return Err(Error::invalid("nothing of the run counts")
                .field("objective.from_s")
                .found(self.objective.from_s)
                .allowed(format!("less than the duration, {} s", self.duration_s)));
        }
        let set = self.set.iter();
        let set: Result<ParameterSet> = set.map(|(n, v)| Assignment::new(n, *v)).collect();
        let set = set.map_err(|e| e.field("set"))?.with_all(&self.overruling);
        let body = match self.robot {
            Some(robot) => Body::Fixed(Box::new(robot), self.development),
            None => Body::Developed(self.development),
        };
        let space = Space::new(body, self.genome, self.seed);
        let strategy = self.strategy.strategy(&space)?;
        if strategy.budget() > MOST_ROBOTS {
            return Err(Error::invalid("too many robots")
                .field("strategy")
                .found(strategy.budget())
                .allowed(format!("at most {MOST_ROBOTS}")));
        }
        for name in strategy.descriptors() {
            descriptor_named(name).map_err(|e| e.field("strategy"))?;
        }
        let uncertain = UncertainParameters::new(self.ranges, self.points)?;
        Ok(Search {
            name: self.name,
            text: self.text,
            description: self.description,
            strategy: Arc::from(strategy),
            space,
            duration_s: self.duration_s,
            set,
            centre: uncertain.centre()?,
            uncertain,
            posterior_from: self.posterior_from,
            noise,
            noise_from,
            objective: self.objective,
            repeats: self.repeats,
            failures: self.failures,
            settings: self.settings,
            gait: self.gait,
            finals: self.finals,
        })
    }

    fn check_numbers(&self) -> Result<()> {
        let (finals, failures) = (&self.finals, &self.failures);
        let repeats = Range::within(1.0, REPEATS_AT_MOST as f64, "");
        let body_lengths = Range::within(0.0, 1e6, "");
        Range::within(0.01, LONGEST_S, "s").check(self.duration_s, "duration_s")?;
        repeats.check(self.repeats as f64, "repeats")?;
        Range::within(1.0, 60.0, "").check(finals.count as f64, "finalists.count")?;
        repeats.check(finals.repeats as f64, "finalists.repeats")?;
        Range::within(0.0, 10.0, "").check(finals.tolerance, "finalists.tolerance")?;
        let (flight, overlap) = (failures.flight_body_lengths, failures.overlap_body_lengths);
        body_lengths.check(flight, "failures.flight_body_lengths")?;
        body_lengths.check(overlap, "failures.overlap_body_lengths")
    }
}
