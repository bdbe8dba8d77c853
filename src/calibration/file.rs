//! The RON form of a study, and what reading it takes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::definition::{Definition, ScoreRule, StartRule};
use super::overrides::Overrides;
use super::recording;
use crate::calibration::identification::StartState;
use crate::comparison::{self, Components};
use crate::error::{Error, Result};
use crate::file::{Source, name_of_file, parse_ron, unique_keys};
use crate::optimization::{Grid, MAX_POINTS, Range};
use crate::robot::morphology::Morphology;
use crate::simulation::Noise;
use crate::simulation::parameter::{Assignment, ParameterSet, by_name};

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
    #[serde(default, deserialize_with = "unique_keys")]
    set: BTreeMap<String, f64>,
    parameters: Vec<RangeFile>,
    #[serde(default = "default_metric")]
    metric: String,
    components: Option<ComponentsFile>,
    #[serde(default)]
    score: ScoreRule,
    #[serde(default = "default_seed")]
    seed: u64,
    #[serde(default, deserialize_with = "unique_keys")]
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

impl Definition {
    /// Reads a study, its morphology and its recordings.
    ///
    /// # Errors
    /// Any of the files missing or malformed, unknown parameters or metrics, empty ranges, no recordings.
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        let path = path.as_ref();
        let definition = Self::read_without_recordings(path, overrides)?;
        let found = recording::find(path, &definition.recording_globs, overrides)?;
        Ok(Self {
            warnings: recording::warnings_for(&definition.morphology, &found.recordings),
            recordings: found.recordings,
            recordings_sha256: found.sha256,
            ..definition
        })
    }

    /// Reads a study and its morphology but not its recordings: to check the file itself.
    ///
    /// # Errors
    /// As [`Definition::read`], recordings apart.
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

        let (mut ranges, mut parameters) = (Vec::new(), Vec::new());
        for (index, range) in file.parameters.iter().enumerate() {
            let checked = by_name(&range.name)
                .and_then(|p| {
                    let points = overrides.points.unwrap_or(range.points);
                    Ok((p, Range::new(p, range.from, range.to, points)?))
                })
                .map_err(|e| match overrides.points {
                    Some(points) if !(2..=MAX_POINTS).contains(&points) => {
                        e.field("points").into_usage()
                    }
                    _ => source.at(&format!("parameters[{index}]"), e),
                })?;
            parameters.push(checked.0);
            ranges.push(checked.1);
        }
        let grid = Grid::new(ranges).map_err(|e| source.at("parameters", e))?;
        let metric = match overrides.metric {
            Some(metric) => metric,
            None => comparison::by_name(&file.metric).map_err(|e| source.at("metric", e))?,
        };
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
            name: name_of_file(path, "a study")?,
            path: Some(path.to_path_buf()),
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
            parameters,
            metric,
            score: overrides.score.unwrap_or(file.score),
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
