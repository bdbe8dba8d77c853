//! The RON form of a search.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::strategy::StrategyFile;
use super::{
    FailureRules, FinalsSettings, GaitTuning, Objective, Search, SearchBuilder, SettingsChoice,
};
use crate::prediction::{UncertainRange, read_posterior};
use realgap_core::Result;
use realgap_core::file::{Source, name_of_file, parse_ron, unique_keys};
use realgap_robot::genome::{Development, Individual};
use realgap_robot::morphology::Morphology;
use realgap_simulation::Noise;
use realgap_simulation::parameter::ParameterSet;

/// What a body or a gait is taken from.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum StartFile {
    /// A genome's file, relative to this one.
    Genome(PathBuf),
    /// A robot's file, relative to this one.
    Morphology(PathBuf),
}

/// A search file as written.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Search")]
pub struct SearchFile {
    /// What the search is for, for readers.
    #[serde(default)]
    description: String,
    /// The strategy.
    strategy: StrategyFile,
    /// The body or gait from which the search starts; some strategies need none.
    start: Option<StartFile>,
    /// Time of each run, seconds.
    duration_s: f64,
    /// How genes become a robot.
    #[serde(default)]
    development: Development,
    /// Parameters with a fixed value, by name; `realgap study parameters` lists all.
    #[serde(default, deserialize_with = "unique_keys")]
    set: BTreeMap<String, f64>,
    /// Parameters that are not known exactly: every repeat draws values from these ranges.
    #[serde(default)]
    parameters: Vec<UncertainRange>,
    /// Results folder of a sweep, relative to this file: repeats draw from the points of its confidence set.
    indistinguishable: Option<PathBuf>,
    /// How repeats differ.
    noise: Option<Noise>,
    /// The objective, which the search maximises.
    #[serde(default)]
    objective: Objective,
    /// Runs of each robot.
    #[serde(default = "eight")]
    repeats: usize,
    /// Rules for failures.
    #[serde(default)]
    failures: FailureRules,
    /// The settings of engine and steps of the repeats.
    #[serde(default)]
    settings: SettingsChoice,
    /// How the gait of every body is tuned before the body is judged; without it, bodies are judged with the gait of their
    /// genome.
    gait: Option<GaitTuning>,
    /// How the best robots are judged again.
    #[serde(default)]
    finalists: FinalsSettings,
    /// Seed of everything random.
    #[serde(default = "one")]
    seed: u64,
}

fn eight() -> usize {
    8
}

fn one() -> u64 {
    1
}

/// Settings of a caller that take the place of those in the file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Fixed values, after the file's own.
    pub set: ParameterSet,
    /// Folder with a confidence set, in place of the file's.
    pub indistinguishable: Option<PathBuf>,
    /// Draws that files of parameters carry: every repeat takes one of each group, where there is no such folder.
    pub draws: Vec<Vec<ParameterSet>>,
    /// Seed in place of the file's.
    pub seed: Option<u64>,
}

impl Search {
    /// Reads a search file; what it names is relative to it.
    ///
    /// # Errors
    /// A malformed file, settings that cannot be used, files that cannot be read.
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        Self::parse(&Source::read(path, "search")?, overrides)
    }

    /// As [`Search::read`], from a text.
    ///
    /// # Errors
    /// As [`Search::read`].
    pub fn parse(source: &Source, overrides: &Overrides) -> Result<Self> {
        let file: SearchFile = parse_ron(source)?;
        let builder = builder(source, file, overrides)?;
        builder.build().map_err(|error| {
            let field = error.field_name().unwrap_or_default().to_owned();
            source.at(&field, error)
        })
    }
}

fn builder(source: &Source, file: SearchFile, overrides: &Overrides) -> Result<SearchBuilder> {
    let folder = source.path().parent().unwrap_or(Path::new(""));
    let name = name_of_file(source.path(), "a search")?;
    let points = match (&overrides.indistinguishable, &file.indistinguishable) {
        (Some(given), _) => read_posterior(given)?,
        (None, Some(named)) => read_posterior(&folder.join(named))?,
        (None, None) => Vec::new(),
    };
    let from = overrides
        .indistinguishable
        .as_ref()
        .or(file.indistinguishable.as_ref());
    let posterior_from = from.map(|folder| folder.display().to_string());
    let (mut development, mut robot, mut genome) = (file.development, None, None);
    match &file.start {
        None => {}
        Some(StartFile::Genome(path)) => {
            let specimen = Individual::read(folder.join(path))?;
            (development, genome) = (specimen.development, Some(specimen.genome));
        }
        Some(StartFile::Morphology(path)) => robot = Some(Morphology::read(folder.join(path))?),
    }
    Ok(SearchBuilder {
        name,
        text: source.text().to_owned(),
        description: file.description,
        strategy: file.strategy.0,
        development,
        robot,
        genome,
        duration_s: file.duration_s,
        set: file.set.into_iter().collect(),
        overruling: overrides.set.clone(),
        // A posterior that the caller names is known better than the file's ranges.
        ranges: match (&overrides.indistinguishable, points.first()) {
            (Some(_), Some(point)) => {
                let is_open = |range: &UncertainRange| point.value(&range.name).is_none();
                file.parameters.into_iter().filter(is_open).collect()
            }
            _ => file.parameters,
        },
        // A folder of points is named for this purpose, so the draws in files of values are left out then.
        posterior_from,
        points: match points.is_empty() {
            true => overrides.draws.clone(),
            false => vec![points],
        },
        noise: file.noise.map(|noise| (noise, file_name(source))),
        objective: file.objective,
        repeats: file.repeats,
        failures: file.failures,
        settings: file.settings,
        gait: file.gait,
        finals: file.finalists,
        seed: overrides.seed.unwrap_or(file.seed),
    })
}

fn file_name(source: &Source) -> String {
    let name = source.path().file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
