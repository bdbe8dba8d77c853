//! A study made in Rust, without a file.

use std::path::PathBuf;

use crate::calibration::recording::identity::samples_sha256;
use crate::calibration::recording::warnings_for;
use crate::calibration::{
    BaseRule, BasisRule, Commands, Definition, OwnSimulator, ScoreRule, Split, StartRule, Study,
};
use realgap_core::Result;
use realgap_core::file::check_name;
use realgap_identification::StartState;
use realgap_optimization::{Grid, Range};
use realgap_path::comparison::{Components, Metric};
use realgap_path::trajectory::{Alignment, Reading, Recording, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::Noise;
use realgap_simulation::parameter::{Assignment, by_name};

/// A study that is being built; [`Study::builder`] begins one.
///
/// The builder has everything that a study file has; what is not set has the default of a study file.
#[derive(Debug, Clone)]
#[must_use = "nothing is a study before `build`"]
pub struct StudyBuilder {
    definition: Definition,
    fixed: Vec<(String, f64)>,
    ranges: Vec<(String, f64, f64, usize)>,
}

impl Study {
    /// Begins a study of this robot.
    ///
    /// ```
    /// use realgap_optimization::RunOptions;
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
    /// assert_eq!(answer.report.points, 3);
    /// assert!(answer.to_string().contains("floor.friction"));
    /// # Ok::<(), realgap_core::Error>(())
    /// ```
    pub fn builder(name: impl Into<String>, robot: Morphology) -> StudyBuilder {
        StudyBuilder {
            definition: Definition::of(name.into(), robot),
            fixed: Vec::new(),
            ranges: Vec::new(),
        }
    }
}

impl Study {
    /// Begins a study of somebody else's simulator, whose parameters may be named with or without `sim.`.
    ///
    /// # Errors
    /// A simulator whose name cannot stand for a robot.
    pub fn builder_of(name: impl Into<String>, simulator: OwnSimulator) -> Result<StudyBuilder> {
        let mut builder = Self::builder(name, simulator.outside()?);
        builder.definition.own_simulator = Some(simulator);
        Ok(builder)
    }
}

impl StudyBuilder {
    /// One more recording, from a file.
    pub fn recording(mut self, recording: Recording) -> Self {
        self.definition.recordings.push(recording);
        self
    }

    /// One more recording, from anywhere.
    pub fn trajectory(self, name: impl Into<String>, trajectory: Trajectory) -> Self {
        let name = name.into();
        self.recording(Recording {
            path: PathBuf::from(&name),
            name,
            trajectory,
            log: None,
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

    realgap_core::setters! {
        within definition;
        /// The metric; `pca` by default.
        metric: &'static dyn Metric;
        /// Which direction of a path is turned onto +x before paths are compared; the net displacement by default.
        align: Alignment;
        /// Where the basis of `pca` comes from; the recordings and the simulations by default.
        basis: BasisRule;
        /// How many principal components `pca` keeps; by default as many as hold 99 % of the variance.
        components: Components;
        /// Over what the score of a point is the mean; equally valid settings by default.
        score: ScoreRule;
        /// Length of the runs, seconds; by default as long as the recordings.
        duration_s: f64;
        /// Seed of everything random; 1 by default.
        seed: u64;
        /// Which recordings are held out of the fit to check it.
        split: Split;
        /// How repeats differ, for ensembles and gaps.
        noise: Noise;
        /// What holds the root of the robot; by default, what its file says.
        base: BaseRule;
        /// Recorded commands that the servos follow in place of their gaits; by default, none.
        commands: Commands;
    }

    /// Runs start from this state of each recording instead of at rest on the floor.
    pub fn start_from_recordings(mut self, state: StartState) -> Self {
        self.definition.start = StartRule::FromRecording;
        self.definition.start_state = state;
        self
    }

    /// The study, ready to run.
    ///
    /// # Errors
    /// A name that cannot name a folder, no recordings, no parameter that varies, unknown parameters, values out of bounds, and
    /// the errors of [`Study::new`].
    pub fn build(self) -> Result<Study> {
        let mut definition = self.definition;
        check_name(&definition.name, "a study")?;
        let mut ranges = Vec::new();
        for (name, from, to, points) in self.ranges {
            let parameter = match &definition.own_simulator {
                Some(own) => own.parameter(&name)?,
                None => by_name(&name)?,
            };
            ranges.push(Range::new(parameter, from, to, points)?);
            definition.parameters.push(parameter);
        }
        definition.grid = Grid::new(ranges)?;
        for (name, value) in &self.fixed {
            let assignment = match &definition.own_simulator {
                Some(own) => own.assignment(name, *value)?,
                None => Assignment::new(name, *value)?,
            };
            definition.set = definition.set.with(assignment);
        }
        if let Some((field, error)) = definition.fault() {
            return Err(error.field(field));
        }
        let recordings = definition.recordings.iter();
        definition.recordings_sha256 = recordings.map(samples_sha256).collect();
        let robot = match definition.own_simulator {
            Some(_) => None,
            None => Some(&definition.morphology),
        };
        definition.warnings = warnings_for(robot, &definition.recordings, definition.base);
        Study::new(definition)
    }
}
