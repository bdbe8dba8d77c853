//! The RON form of a search, and its validated form.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::body::Body;
use super::doubt::{Doubt, Uncertain, read_indistinguishable};
use super::failure::Rules;
use super::objective::Objective;
use super::plan::{Origin, Plan, StrategyFile};
use crate::file::{Source, parse_ron};
use crate::robot::genome::{Development, Specimen};
use crate::robot::morphology::Morphology;
use crate::simulation::parameter::{Assignment, ParameterSet};
use crate::simulation::{Experiment, Noise, Sampling};
use crate::store::Fingerprint;
use crate::{Error, Result};

/// What a body or a gait is taken from.
#[derive(Debug, Clone, Deserialize)]
enum StartFile {
    Genome(PathBuf),
    Morphology(PathBuf),
}

/// How the best are looked at again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Finals {
    /// How many robots.
    pub count: usize,
    /// Repeats of each with draws that the search has not seen, for its prediction card and its rank.
    pub repeats: usize,
    /// Largest change of the mean displacement under other solver settings that it survives, as a share.
    pub tolerance: f64,
}

impl Default for Finals {
    fn default() -> Self {
        Self {
            count: 5,
            repeats: 50,
            tolerance: 0.25,
        }
    }
}

/// A search file as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Search")]
struct SearchFile {
    #[serde(default)]
    description: String,
    strategy: StrategyFile,
    start: Option<StartFile>,
    duration_s: f64,
    #[serde(default)]
    development: Development,
    #[serde(default)]
    set: BTreeMap<String, f64>,
    #[serde(default)]
    parameters: Vec<Uncertain>,
    indistinguishable: Option<PathBuf>,
    #[serde(default = "Noise::unmeasured_robot")]
    noise: Noise,
    #[serde(default)]
    objective: Objective,
    #[serde(default = "eight")]
    repeats: usize,
    #[serde(default)]
    failures: Rules,
    #[serde(default)]
    finalists: Finals,
    #[serde(default = "one")]
    seed: u64,
}

fn eight() -> usize {
    8
}

fn one() -> u64 {
    1
}

/// What the caller wants different from the file.
#[derive(Debug, Clone, Default)]
pub struct Wishes {
    /// Fixed values, after the file's own.
    pub set: ParameterSet,
    /// Folder with indistinguishable points in place of the file's.
    pub indistinguishable: Option<PathBuf>,
    /// Seed in place of the file's.
    pub seed: Option<u64>,
}

/// A validated search.
#[derive(Debug, Clone)]
pub struct Hunt {
    /// File stem.
    pub name: String,
    /// The file as written.
    pub text: String,
    /// What it is for.
    pub description: String,
    /// What chooses the robots.
    pub plan: Plan,
    /// How genomes become robots.
    pub body: Body,
    /// Length of each run, seconds.
    pub duration_s: f64,
    /// Fixed values.
    pub set: ParameterSet,
    /// Values that differ from repeat to repeat.
    pub doubt: Doubt,
    /// How else repeats differ.
    pub noise: Noise,
    /// What is to be made large.
    pub objective: Objective,
    /// Runs of every robot.
    pub repeats: usize,
    /// What counts as a failure.
    pub rules: Rules,
    /// How the best are looked at again.
    pub finals: Finals,
    /// Seed of everything random.
    pub seed: u64,
}

/// Most repeats of one robot.
const REPEATS_AT_MOST: usize = 5000;

impl Hunt {
    /// Reads a search file; what it names is relative to it.
    ///
    /// # Errors
    /// A malformed file, settings that cannot be used, files that cannot be read.
    pub fn read(path: impl AsRef<Path>, wishes: &Wishes) -> Result<Self> {
        Self::parse(&Source::read(path, "search")?, wishes)
    }

    /// As [`Hunt::read`], of a text.
    ///
    /// # Errors
    /// As [`Hunt::read`].
    pub fn parse(source: &Source, wishes: &Wishes) -> Result<Self> {
        let file: SearchFile = parse_ron(source)?;
        let at = |field: &str, error: Error| {
            let field = error.field_name().unwrap_or(field).to_owned();
            source.at(&field, error).field(field)
        };
        let folder = source.path().parent().unwrap_or(Path::new(""));
        check_numbers(&file).map_err(|e| at("", e))?;
        file.development.check().map_err(|e| {
            let field = e.field_name().unwrap_or_default();
            let field = format!("development.{field}");
            source.at(&field, e).field(field)
        })?;
        if let Some((field, error)) = file.noise.fault() {
            return Err(source.at(&format!("noise.{field}"), error));
        }
        file.objective
            .check()
            .map_err(|e| source.at("objective", e))?;
        let set: Result<ParameterSet> = file
            .set
            .iter()
            .map(|(name, value)| Assignment::new(name, *value))
            .collect();
        let set = set.map_err(|e| source.at("set", e))?.with_all(&wishes.set);
        let points = match (&wishes.indistinguishable, &file.indistinguishable) {
            (Some(given), _) => read_indistinguishable(given)?,
            (None, Some(named)) => read_indistinguishable(&folder.join(named))?,
            (None, None) => Vec::new(),
        };
        let doubt = Doubt::new(file.parameters, points).map_err(|e| at("parameters", e))?;
        let (origin, development) = match &file.start {
            None => (Origin::Anything, file.development),
            Some(StartFile::Genome(path)) => {
                let specimen = Specimen::read(folder.join(path))?;
                (Origin::Genome(specimen.genome), specimen.development)
            }
            Some(StartFile::Morphology(path)) => {
                let robot = Morphology::read(folder.join(path))?;
                (Origin::Robot(Box::new(robot)), file.development)
            }
        };
        let seed = wishes.seed.unwrap_or(file.seed);
        let (plan, body) =
            Plan::new(file.strategy, &origin, &development, seed).map_err(|e| at("strategy", e))?;
        let stem = source.path().file_stem().unwrap_or_default();
        Ok(Self {
            name: stem.to_string_lossy().into_owned(),
            text: source.text().to_owned(),
            description: file.description,
            plan,
            body,
            duration_s: file.duration_s,
            set,
            doubt,
            noise: file.noise,
            objective: file.objective,
            repeats: file.repeats,
            rules: file.failures,
            finals: file.finalists,
            seed,
        })
    }

    /// The experiment of a robot with the fixed values, without noise.
    pub fn experiment(&self, robot: &Morphology) -> Experiment {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = self.duration_s;
        experiment.sampling = Sampling::Rate(60.0);
        self.set.apply(&experiment)
    }

    /// Everything that decides the results.
    pub fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new()
            .with("realgap", env!("CARGO_PKG_VERSION"))
            .with("engine", crate::simulation::ENGINE_VERSION)
            .with("search", &self.name)
            .with("strategy", format!("{:?}", self.plan))
            .with("body", format!("{:?}", self.body))
            .with("duration_s", self.duration_s)
            .with("set", &self.set)
            .with("uncertain parameters", format!("{:?}", self.doubt))
            .with("noise", format!("{:?}", self.noise))
            .with("objective", self.objective.label())
            .with("repeats", self.repeats)
            .with("failures", format!("{:?}", self.rules))
            .with("seed", self.seed)
    }
}

fn check_numbers(file: &SearchFile) -> Result<()> {
    let check = |field: &str, value: f64, low: f64, high: f64| {
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(Error::invalid("out of range")
            .field(field)
            .found(value)
            .allowed(format!("{low} to {high}")))
    };
    check("duration_s", file.duration_s, 0.01, 3600.0)?;
    let most = REPEATS_AT_MOST as f64;
    check("repeats", file.repeats as f64, 1.0, most)?;
    let finals = &file.finalists;
    check("finalists.count", finals.count as f64, 1.0, 60.0)?;
    check("finalists.repeats", finals.repeats as f64, 1.0, most)?;
    check("finalists.tolerance", finals.tolerance, 0.0, 10.0)?;
    let rules = &file.failures;
    check(
        "failures.flight_body_lengths",
        rules.flight_body_lengths,
        0.0,
        1e6,
    )?;
    check(
        "failures.overlap_body_lengths",
        rules.overlap_body_lengths,
        0.0,
        1e6,
    )
}
