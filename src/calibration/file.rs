//! The RON form of a study, and its validated form.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::validation::Split;
use crate::calibration::identification::StartState;
use crate::comparison::{self, Components, Metric};
use crate::error::{Error, Result};
use crate::file::{Source, parse_ron};
use crate::optimization::{Grid, MAX_POINTS, Range};
use crate::robot::morphology::Morphology;
use crate::simulation::parameter::{Assignment, ParameterSet, by_name};
use crate::simulation::{Experiment, Noise};
use crate::trajectory::Recording;
use crate::unit::LengthUnit;
use crate::warning::Warning;

/// Where a simulated run starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum StartRule {
    /// At rest on the floor, the same for every recording.
    Settled,
    /// At the first state of each recording.
    FromRecording,
}

/// A study file as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Study")]
struct StudyFile {
    #[serde(default)]
    description: String,
    morphology: PathBuf,
    #[serde(default)]
    recordings: Vec<String>,
    start: StartRule,
    start_state: Option<StartState>,
    duration_s: Option<f64>,
    timestep_s: Option<f64>,
    substeps: Option<usize>,
    joint: Option<Joint>,
    #[serde(default)]
    set: BTreeMap<String, f64>,
    parameters: Vec<RangeFile>,
    #[serde(default = "default_metric")]
    metric: String,
    components: Option<ComponentsFile>,
    #[serde(default = "default_seed")]
    seed: u64,
    #[serde(default)]
    truth: BTreeMap<String, f64>,
    noise: Option<Noise>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
enum Joint {
    Multibody,
    Impulse,
}

#[derive(Debug, Clone, Copy, Deserialize)]
enum ComponentsFile {
    Variance(f64),
    Count(usize),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Range")]
struct RangeFile {
    name: String,
    from: f64,
    to: f64,
    #[serde(default = "default_points")]
    points: usize,
}

fn default_metric() -> String {
    comparison::DEFAULT_METRIC.to_owned()
}

fn default_seed() -> u64 {
    1
}

/// 21 × 21 = 441, as in paper 003, section 2.3.
fn default_points() -> usize {
    21
}

/// A part of the recordings: the `offset`-th of every `every`, in order of their paths, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    every: usize,
    offset: usize,
}

impl Part {
    /// A part; offsets 0 to `every` − 1 together are the whole.
    ///
    /// # Errors
    /// An offset that is not below `every`.
    pub fn new(every: usize, offset: usize) -> Result<Self> {
        if offset < every {
            return Ok(Self { every, offset });
        }
        Err(Error::usage("there is no such part of the recordings")
            .found(format!("offset {offset} of every {every}"))
            .allowed("offsets from 0 to one less than `every`"))
    }

    /// Whether the recording at `index` belongs to it.
    pub fn contains(&self, index: usize) -> bool {
        index % self.every == self.offset
    }
}

/// What the caller wants different from the file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Globs of recordings, relative to the current folder, in place of the file's.
    pub recordings: Vec<String>,
    /// Every so many-th recording only, in order of their paths, counted from an offset.
    pub part: Option<Part>,
    /// Start state in place of the file's.
    pub start_state: Option<StartState>,
    /// Only the first so many recordings.
    pub limit_recordings: Option<usize>,
    /// Metric in place of the file's.
    pub metric: Option<String>,
    /// Points per parameter in place of the file's.
    pub points: Option<usize>,
    /// Seed in place of the file's.
    pub seed: Option<u64>,
    /// Fixed values, after the file's own.
    pub set: ParameterSet,
    /// Unit of length of the recordings.
    pub unit: LengthUnit,
    /// Which recordings are kept from the fit to check it.
    pub split: Option<Split>,
}

/// A validated study with its recordings read.
#[derive(Debug)]
pub struct Study {
    /// File stem.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// The file as written.
    pub text: String,
    /// What it is for.
    pub description: String,
    /// The robot.
    pub morphology: Morphology,
    /// SHA-256 of the morphology file.
    pub morphology_sha256: String,
    /// Globs of the recordings, relative to the file.
    pub recording_globs: Vec<String>,
    /// What reality did.
    pub recordings: Vec<Recording>,
    /// SHA-256 of each recording's file.
    pub recordings_sha256: Vec<String>,
    /// Where simulated runs start.
    pub start: StartRule,
    /// Which state of a recording runs start from, where they start from recordings.
    pub start_state: StartState,
    /// Length of the runs, seconds; `None`: as long as the recordings.
    pub duration_s: Option<f64>,
    /// Unit of length of the recordings' files.
    pub unit: LengthUnit,
    /// Fixed parameter values.
    pub set: ParameterSet,
    /// The parameters that vary.
    pub grid: Grid,
    /// How far apart two trajectories are.
    pub metric: &'static dyn Metric,
    /// How many principal components the `pca` metric keeps.
    pub components: Components,
    /// Seed of everything random.
    pub seed: u64,
    /// Which recordings are kept from the fit to check it.
    pub split: Option<Split>,
    /// Known truth of a stand-in, for marking it in pictures; never used by the fit.
    pub truth: ParameterSet,
    /// How repeats differ, where the study says; used by ensembles, never by a sweep.
    pub noise: Option<Noise>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl Study {
    /// The experiment with everything that the study fixes, before any recording has a say.
    pub fn experiment(&self) -> Experiment {
        let base = Experiment::new(self.morphology.assemble());
        self.set.apply(&base)
    }

    /// Reads a study, its morphology and its recordings.
    ///
    /// # Errors
    /// Any of the files missing or malformed, unknown parameters or metrics, empty ranges, no recordings.
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        let study = Self::read_without_recordings(path, overrides)?;
        let found = super::recording::find(&study, overrides)?;
        Ok(Self {
            recordings: found.recordings,
            recordings_sha256: found.sha256,
            warnings: found.warnings,
            ..study
        })
    }

    /// Reads a study and its morphology but not its recordings: to check the file itself.
    ///
    /// # Errors
    /// As [`Study::read`], recordings apart.
    pub fn read_without_recordings(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        let path = path.as_ref();
        let source = Source::read(path, "study")?;
        let file: StudyFile = parse_ron(&source)?;

        let morphology_path = path
            .parent()
            .unwrap_or(Path::new(""))
            .join(&file.morphology);
        let morphology_source =
            Source::read(&morphology_path, "morphology").map_err(|e| match e.file() {
                Some(_) => e,
                None => source.at("morphology", e),
            })?;
        let morphology = Morphology::parse(&morphology_source)?;

        let mut set = ParameterSet::new();
        let named = [
            ("timestep_s", file.timestep_s),
            ("solver.substeps", file.substeps.map(|n| n as f64)),
            (
                "solver.joint",
                file.joint
                    .map(|joint| f64::from(u8::from(matches!(joint, Joint::Multibody)))),
            ),
        ];
        for (name, value) in named {
            if let Some(value) = value {
                set = set.with(
                    Assignment::new(name, value)
                        .map_err(|e| source.at(name.trim_start_matches("solver."), e))?,
                );
            }
        }
        for (name, value) in &file.set {
            set = set.with(Assignment::new(name, *value).map_err(|e| source.at("set", e))?);
        }
        set = set.with_all(&overrides.set);

        let mut ranges = Vec::new();
        for (index, range) in file.parameters.iter().enumerate() {
            let checked = by_name(&range.name)
                .and_then(|p| {
                    Range::new(
                        p,
                        range.from,
                        range.to,
                        overrides.points.unwrap_or(range.points),
                    )
                })
                .map_err(|e| match overrides.points {
                    Some(points) if !(2..=MAX_POINTS).contains(&points) => {
                        e.field("--points").into_usage()
                    }
                    _ => source.at(&format!("parameters[{index}]"), e),
                })?;
            ranges.push(checked);
        }
        let grid = Grid::new(ranges).map_err(|e| source.at("parameters", e))?;
        let metric_name = overrides.metric.as_deref().unwrap_or(&file.metric);
        let metric = comparison::by_name(metric_name).map_err(|e| match overrides.metric {
            Some(_) => e.field("--metric").into_usage(),
            None => source.at("metric", e),
        })?;
        let components = match file.components {
            None => Components::default(),
            Some(ComponentsFile::Variance(share)) => Components::Variance(share),
            Some(ComponentsFile::Count(count)) => Components::Count(count),
        };
        components.check().map_err(|e| source.at("components", e))?;
        if let Some(duration_s) = file.duration_s
            && !(1e-3..=3600.0).contains(&duration_s)
        {
            let error = Error::invalid("out of range")
                .field("duration_s")
                .found(duration_s)
                .allowed("0.001 to 3600 s");
            return Err(source.at("duration_s", error));
        }
        if let Some((field, error)) = file.noise.and_then(|noise| noise.fault()) {
            return Err(source.at(&format!("noise.{field}"), error));
        }
        let start_state = overrides
            .start_state
            .or(file.start_state)
            .unwrap_or_default();
        if file.start == StartRule::Settled && start_state != StartState::FirstSample {
            let error = Error::invalid("a settled start has no start state to refine")
                .field("start_state")
                .hint("use `start: FromRecording`");
            return Err(source.at("start", error));
        }
        let truth = file
            .truth
            .iter()
            .map(|(name, value)| Assignment::new(name, *value).map_err(|e| source.at("truth", e)))
            .collect::<Result<ParameterSet>>()?;
        Ok(Self {
            name: path
                .file_stem()
                .map(|s| s.to_string_lossy().into_owned())
                .unwrap_or_default(),
            path: path.to_path_buf(),
            text: source.text().to_owned(),
            description: file.description,
            morphology,
            morphology_sha256: morphology_source.sha256(),
            recordings: Vec::new(),
            recordings_sha256: Vec::new(),
            start: file.start,
            start_state,
            duration_s: file.duration_s,
            unit: overrides.unit,
            set,
            grid,
            metric,
            components,
            seed: overrides.seed.unwrap_or(file.seed),
            split: overrides.split,
            truth,
            noise: file.noise,
            recording_globs: file.recordings,
            warnings: Vec::new(),
        })
    }
}
