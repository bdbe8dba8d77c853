//! A study made in Rust, without a file.

use std::path::PathBuf;

use super::basis::BasisRule;
use super::definition::{Definition, ScoreRule, StartRule};
use super::fitted::samples_sha256;
use super::recording::warnings_for;
use super::split::Split;
use super::study::Study;
use crate::calibration::identification::StartState;
use realgap_core::error::{Error, Result};
use realgap_core::file::{check_name, sha256};
use realgap_engine::Noise;
use realgap_engine::parameter::{Assignment, ParameterSet, by_name};
use realgap_optimize::{Grid, Range};
use realgap_path::comparison::{self, Components, DEFAULT_METRIC, Metric};
use realgap_path::trajectory::{Reading, Recording, Trajectory};
use realgap_robot::morphology::Morphology;

/// A study as it is put together; [`Study::builder`] begins one.
///
/// Everything that a study file says can be said; what is not said is as in a file that does not say it.
#[derive(Debug, Clone)]
#[must_use = "nothing is a study before `build`"]
pub struct StudyBuilder {
    name: String,
    robot: Morphology,
    recordings: Vec<Recording>,
    start: StartRule,
    start_state: StartState,
    duration_s: Option<f64>,
    fixed: Vec<(String, f64)>,
    ranges: Vec<(String, f64, f64, usize)>,
    metric: Option<&'static dyn Metric>,
    score: ScoreRule,
    basis: BasisRule,
    components: Components,
    seed: u64,
    split: Option<Split>,
    noise: Option<Noise>,
}

impl Study {
    /// Begins a study of this robot.
    ///
    /// ```
    /// use realgap_optimize::RunOptions;
    /// use realgap_lab::calibration::Study;
    /// use realgap_robot::morphology::Morphology;
    /// use realgap_path::trajectory;
    /// use realgap_core::unit::LengthUnit;
    ///
    /// let real = trajectory::read("../../real_trajectories/tripod_standin/run_00.csv", LengthUnit::Metre)?;
    /// let study = Study::builder("friction", Morphology::read("../../morphologies/tripod.ron")?)
    ///     .recording(real)
    ///     .duration_s(2.0)
    ///     .vary("floor.friction", 0.1, 0.9, 3)
    ///     .metric(realgap_path::comparison::by_name("rms")?)
    ///     .build()?;
    /// let answer = study.sweep(&RunOptions::default())?;
    /// assert_eq!(answer.scores.points.len(), 3);
    /// assert!(answer.to_string().contains("floor.friction"));
    /// # Ok::<(), realgap_core::Error>(())
    /// ```
    pub fn builder(name: impl Into<String>, robot: Morphology) -> StudyBuilder {
        StudyBuilder {
            name: name.into(),
            robot,
            recordings: Vec::new(),
            start: StartRule::Settled,
            start_state: StartState::default(),
            duration_s: None,
            fixed: Vec::new(),
            ranges: Vec::new(),
            metric: None,
            score: ScoreRule::default(),
            basis: BasisRule::default(),
            components: Components::default(),
            seed: 1,
            split: None,
            noise: None,
        }
    }
}

impl StudyBuilder {
    /// One more recording, from a file.
    pub fn recording(mut self, recording: Recording) -> Self {
        self.recordings.push(recording);
        self
    }

    /// One more recording, from anywhere.
    pub fn trajectory(self, name: impl Into<String>, trajectory: Trajectory) -> Self {
        let name = name.into();
        self.recording(Recording {
            path: PathBuf::from(&name),
            name,
            trajectory,
            bodies: Vec::new(),
            meta: None,
            reading: Reading::default(),
            warnings: Vec::new(),
        })
    }

    /// Lets a parameter vary over evenly spaced values, both ends included; at least one has to.
    pub fn vary(mut self, parameter: impl Into<String>, from: f64, to: f64, points: usize) -> Self {
        self.ranges.push((parameter.into(), from, to, points));
        self
    }

    /// Fixes a parameter.
    pub fn set(mut self, parameter: impl Into<String>, value: f64) -> Self {
        self.fixed.push((parameter.into(), value));
        self
    }

    /// How far apart two trajectories are; else `pca`.
    pub fn metric(mut self, metric: &'static dyn Metric) -> Self {
        self.metric = Some(metric);
        self
    }

    /// Where the basis of `pca` comes from; else the recordings and the simulations.
    pub fn basis(mut self, basis: BasisRule) -> Self {
        self.basis = basis;
        self
    }

    /// How many principal components `pca` keeps; else those with 99 % of the variance.
    pub fn components(mut self, components: Components) -> Self {
        self.components = components;
        self
    }

    /// What the score of a point is the mean over; else equally valid settings.
    pub fn score(mut self, score: ScoreRule) -> Self {
        self.score = score;
        self
    }

    /// Length of the runs, seconds; else as long as the recordings.
    pub fn duration_s(mut self, duration_s: f64) -> Self {
        self.duration_s = Some(duration_s);
        self
    }

    /// Runs start from this state of each recording; else at rest on the floor.
    pub fn start_from_recordings(mut self, state: StartState) -> Self {
        (self.start, self.start_state) = (StartRule::FromRecording, state);
        self
    }

    /// Seed of everything random; else 1.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Which recordings are kept from the fit to check it.
    pub fn split(mut self, split: Split) -> Self {
        self.split = Some(split);
        self
    }

    /// How repeats differ, for ensembles and gaps.
    pub fn noise(mut self, noise: Noise) -> Self {
        self.noise = Some(noise);
        self
    }

    /// The study, ready to run.
    ///
    /// # Errors
    /// A name that cannot be that of a folder, no recordings, nothing that varies, unknown parameters, values out of bounds, and as [`Study::new`].
    pub fn build(self) -> Result<Study> {
        check_name(&self.name, "a study")?;
        let parameters = self
            .ranges
            .iter()
            .map(|(name, ..)| by_name(name))
            .collect::<Result<Vec<_>>>()?;
        let ranges = parameters
            .iter()
            .zip(&self.ranges)
            .map(|(parameter, (_, from, to, points))| Range::new(*parameter, *from, *to, *points))
            .collect::<Result<_>>()?;
        let set = self
            .fixed
            .iter()
            .map(|(name, value)| Assignment::new(name, *value))
            .collect::<Result<ParameterSet>>()?;
        self.components.check()?;
        if let Some(duration_s) = self.duration_s
            && !(1e-3..=3600.0).contains(&duration_s)
        {
            return Err(Error::invalid("out of range")
                .field("duration_s")
                .found(duration_s)
                .allowed("0.001 to 3600 s"));
        }
        if let Some((field, error)) = self.noise.and_then(|noise| noise.fault()) {
            return Err(error.field(format!("noise.{field}")));
        }
        let metric = match self.metric {
            Some(metric) => metric,
            None => comparison::by_name(DEFAULT_METRIC)?,
        };
        Study::new(Definition {
            name: self.name,
            path: None,
            text: String::new(),
            description: String::new(),
            morphology_sha256: sha256(format!("{:?}", self.robot).as_bytes()),
            recording_globs: Vec::new(),
            recordings_sha256: self.recordings.iter().map(samples_sha256).collect(),
            warnings: warnings_for(&self.robot, &self.recordings),
            vehicle: None,
            condition: None,
            morphology: self.robot,
            recordings: self.recordings,
            start: self.start,
            start_state: self.start_state,
            only_at_rest: false,
            scene: Vec::new(),
            commands: None,
            duration_s: self.duration_s,
            reading: Reading::default(),
            set,
            grid: Grid::new(ranges)?,
            parameters,
            metric,
            score: self.score,
            basis: self.basis,
            components: self.components,
            seed: self.seed,
            split: self.split,
            truth: ParameterSet::new(),
            noise: self.noise,
        })
    }
}
