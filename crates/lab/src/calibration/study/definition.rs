//! The definition of a study: robot, recordings, parameters, metric. It is validated, but no simulation is set up yet.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize, Serializer};

use crate::calibration::study::file::prior_of;
use crate::calibration::study::simulator_file::is_of_recordings;
use crate::calibration::{
    BasisRule, Commands, Each, Horizon, Member, OwnSimulator, ScoredColumns, Split, Steering,
    WindowRule,
};
use realgap_core::file::sha256;
use realgap_core::range::Range;
use realgap_core::{Error, Warning};
use realgap_identification::StartState;
use realgap_optimization::Grid;
use realgap_path::comparison::{ChannelSet, Components, Metric, Pca};
use realgap_path::trajectory::{Alignment, Reading, Recording, Source};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{self, Parameter, ParameterSet};
use realgap_simulation::{Experiment, Ground, LONGEST_S, Noise, SceneBody, Vehicle};

/// Where a simulated run starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum StartRule {
    /// At rest on the floor, the same for every recording.
    Settled,
    /// At the first state of each recording.
    FromRecording,
}

/// What holds the root of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum BaseRule {
    /// As the robot's file says: held, or free.
    #[default]
    OfRobot,
    /// It follows the recorded pose, whatever the robot's file says, as that of a robot on a stand that shakes or is carried. Nothing
    /// hinders it, and only the joints are compared.
    Recorded,
}

/// Over what the score of a point is the mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ScoreRule {
    /// Equally valid settings: timesteps and substeps between the study's own and twice as fine, settled starts a
    /// millimetre and a degree off.
    #[default]
    Valid,
    /// So many repeats, with equally valid settings and with the noise of the study's repeats: what an ensemble of real robots
    /// would do.
    Ensemble {
        /// How many repeats the mean is over.
        repeats: usize,
    },
    /// One run with the study's own settings, so that the score contains the chance of a single run.
    Single,
}

/// A validated definition of a study.
#[derive(Debug, Clone)]
pub struct Definition {
    /// File stem.
    pub name: String,
    /// The file; `None` for a study that was built.
    pub path: Option<PathBuf>,
    /// The text of the file; empty for a study that was built.
    pub text: String,
    /// Purpose of the study, for readers.
    pub description: String,
    /// The robot.
    pub morphology: Morphology,
    /// The robots of a study of many, of which `morphology` is the first; empty for a study of one.
    pub robots: Vec<Member>,
    /// The two-wheel robot that is simulated in place of the morphology, which then is only its size.
    pub vehicle: Option<Arc<Vehicle>>,
    /// The study's own simulator, in place of a robot; the morphology then is only a size and a name.
    pub own_simulator: Option<OwnSimulator>,
    /// Which set of recordings is compared, in a file that holds several (`condition,run,…`).
    pub condition: Option<String>,
    /// SHA-256 of the morphology file.
    pub morphology_sha256: String,
    /// Globs of the recordings, relative to the file.
    pub recording_globs: Vec<String>,
    /// The recordings of the real robot.
    pub recordings: Vec<Recording>,
    /// SHA-256 of each recording's file.
    pub recordings_sha256: Vec<String>,
    /// Where simulated runs start.
    pub start: StartRule,
    /// Which state of a recording runs start from, where they start from recordings.
    pub start_state: StartState,
    /// What holds the root of the robot.
    pub base: BaseRule,
    /// Whether recordings that end while moving are left out.
    pub only_at_rest: bool,
    /// The controller: sensors that the robot reads, and rules that it follows.
    pub steering: Option<Steering>,
    /// Other bodies beside the robot.
    pub scene: Vec<SceneBody>,
    /// Regions of the floor, steps and a height field.
    pub ground: Ground,
    /// How recorded columns command the servos.
    pub commands: Option<Commands>,
    /// Joints of the robot that are meant to have no recorded column, and recorded columns that are meant to have no joint; `*`
    /// stands for any letters.
    pub left_out: Vec<String>,
    /// Windows into which recordings are cut, each a recording of its own.
    pub horizon: Option<Horizon>,
    /// Which of the windows are simulated.
    pub windows: WindowRule,
    /// Length of the runs, seconds; `None` for runs as long as the recordings.
    pub duration_s: Option<f64>,
    /// How the recordings' files are read.
    pub reading: Reading,
    /// Fixed parameter values.
    pub set: ParameterSet,
    /// How many of the recordings the fixed values were fitted on; `None` where no fit is known.
    pub seen_by_fit: Option<usize>,
    /// Posterior draws of some of the fixed values, one group per fit: every repeat under noise takes one draw of each group.
    pub draws: Vec<Vec<ParameterSet>>,
    /// The parameters that vary, with their ranges.
    pub grid: Grid,
    /// The parameters of [`Definition::grid`], in its order.
    pub parameters: Vec<&'static Parameter>,
    /// What shares one value of each parameter; empty where that is settled.
    pub each: Vec<Each>,
    /// Prior knowledge of each parameter: median and variance of its coordinate between the ends of its range.
    pub priors: Vec<Option<(f64, f64)>>,
    /// The metric: the distance of two trajectories.
    pub metric: &'static dyn Metric,
    /// The recorded columns that are scored, as the study names them; empty where the metric compares what it always compares.
    pub scored: Vec<ScoredColumns>,
    /// These columns with their noise.
    pub channels: ChannelSet,
    /// Which direction of a path is turned onto +x before paths are compared.
    pub align: Alignment,
    /// Over what the score of a point is the mean.
    pub score: ScoreRule,
    /// Where the basis of the `pca` metric comes from.
    pub basis: BasisRule,
    /// How many principal components the `pca` metric keeps.
    pub components: Components,
    /// Seed of everything random.
    pub seed: u64,
    /// Which recordings are held out of the fit to check it.
    pub split: Option<Split>,
    /// Known truth of a stand-in, for marking it in pictures; never used by the fit.
    pub truth: ParameterSet,
    /// Noise of repeats, where the study states it; ensembles use it, a sweep does only where it scores ensembles or repeats runs
    /// to judge the fit.
    pub noise: Option<Noise>,
    /// Warnings for the reader.
    pub warnings: Vec<Warning>,
}

/// Where the runs of a study start, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartUsed {
    /// The robot starts at rest on the floor.
    Settled,
    /// Every run starts in the state of its recording.
    FromRecording(StartState),
}

impl fmt::Display for StartUsed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Settled => "settled on the floor",
            Self::FromRecording(state) => state.label(),
        })
    }
}

impl Serialize for StartUsed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Allowed lengths of a run.
const DURATION: Range = Range::within(1e-3, LONGEST_S, "s");

impl Definition {
    /// A definition with defaults for everything but the name and the robot; it has no recordings and no varied parameters yet.
    pub(in crate::calibration) fn of(name: String, morphology: Morphology) -> Self {
        Self {
            name,
            path: None,
            text: String::new(),
            description: String::new(),
            morphology_sha256: sha256(format!("{morphology:?}").as_bytes()),
            morphology,
            robots: Vec::new(),
            vehicle: None,
            own_simulator: None,
            condition: None,
            recording_globs: Vec::new(),
            recordings: Vec::new(),
            recordings_sha256: Vec::new(),
            start: StartRule::Settled,
            start_state: StartState::default(),
            base: BaseRule::default(),
            only_at_rest: false,
            steering: None,
            scene: Vec::new(),
            ground: Ground::default(),
            commands: None,
            left_out: Vec::new(),
            horizon: None,
            windows: WindowRule::default(),
            duration_s: None,
            reading: Reading::default(),
            set: ParameterSet::new(),
            seen_by_fit: None,
            draws: Vec::new(),
            grid: Grid::default(),
            parameters: Vec::new(),
            each: Vec::new(),
            priors: Vec::new(),
            metric: &Pca,
            scored: Vec::new(),
            channels: ChannelSet::default(),
            align: Alignment::default(),
            score: ScoreRule::default(),
            basis: BasisRule::default(),
            components: Components::default(),
            seed: 1,
            split: None,
            truth: ParameterSet::new(),
            noise: None,
            warnings: Vec::new(),
        }
    }

    /// What contradicts a base that is led, with the name of its field.
    fn base_fault(&self) -> Option<(&'static str, Error)> {
        let refuse = |field, what: &str, hint: &str| Some((field, Error::invalid(what).hint(hint)));
        if self.base == BaseRule::OfRobot {
            None
        } else if self.start == StartRule::Settled {
            let what = "a base that is led starts where it was recorded";
            refuse("start", what, "use `start: FromRecording`")
        } else if self.start_state != StartState::FirstSample {
            let what = "a base that is led has no start state to refine";
            refuse("start_state", what, "leave `start_state` out")
        } else if !self.metric.needs().joints {
            let what =
                "the pose of a base that is led is given, so only its joints can be compared";
            refuse("metric", what, "use the metric `joints`")
        } else {
            None
        }
    }

    /// The first number that is not allowed, with the name of its field.
    pub(in crate::calibration) fn fault(&self) -> Option<(String, Error)> {
        let components = self.components.check().err();
        let duration = self
            .duration_s
            .and_then(|s| DURATION.refusal(s).map(|e| e.field("duration_s")));
        let noise = self.noise.and_then(|noise| noise.fault());
        if let Some((field, error)) = self.base_fault() {
            return Some((field.to_owned(), error));
        }
        if let Some((field, error)) = self.windows.fault() {
            return Some((format!("windows.{field}"), error));
        }
        components
            .map(|error| ("components".to_owned(), error))
            .or_else(|| duration.map(|error| ("duration_s".to_owned(), error)))
            .or_else(|| noise.map(|(field, error)| (format!("noise.{field}"), error)))
    }

    /// Columns that the study names as switches: of servos, and of windows.
    pub(in crate::calibration) fn switches(&self) -> Vec<String> {
        let commands = self.commands.iter().flat_map(|commands| &commands.columns);
        let of_servos = commands.filter_map(|column| column.on.clone());
        of_servos.chain(self.windows.on.clone()).collect()
    }

    /// The start of the runs, for reports.
    pub(crate) fn start_used(&self) -> StartUsed {
        match self.start {
            StartRule::Settled => StartUsed::Settled,
            StartRule::FromRecording => StartUsed::FromRecording(self.start_state),
        }
    }

    /// Warnings about the robot; none where a study's own simulator stands for it, because its body is not known.
    pub(in crate::calibration) fn robot_warnings(&self) -> Vec<Warning> {
        match self.own_simulator {
            Some(_) => Vec::new(),
            None => self.morphology.warnings(),
        }
    }

    /// Every parameter that the study may set: those of the registry, or those of its own simulator and of recordings.
    pub(in crate::calibration) fn known_parameters(&self) -> Vec<&'static Parameter> {
        let Some(own) = &self.own_simulator else {
            return parameter::all().collect();
        };
        let of_recordings = parameter::all().filter(|p| is_of_recordings(p.name));
        own.parameters().into_iter().chain(of_recordings).collect()
    }

    /// Prior knowledge for a fit by least squares: the study's own, or what its simulator declares where the study states none.
    pub(in crate::calibration) fn priors_of_fit(&self) -> Vec<Option<(f64, f64)>> {
        let own = self.own_simulator.as_ref();
        let all = self.priors.iter().zip(self.grid.ranges());
        all.map(|(stated, range)| {
            stated.or_else(|| {
                let declared = own?.declaration(range.parameter.name)?.prior;
                prior_of(declared, range).ok().flatten()
            })
        })
        .collect()
    }

    /// The source of the recordings.
    pub fn source(&self) -> Source {
        Source::of(&self.recordings)
    }

    /// Whether only joints are compared, whatever the metric: nothing else was recorded, or the root is led along what was.
    pub fn is_of_joints(&self) -> bool {
        let mut recordings = self.recordings.iter();
        self.base == BaseRule::Recorded || recordings.all(|r| r.trajectory.is_of_joints())
    }

    /// The error with the study's file, where the study has a file.
    pub fn at_file(&self, error: Error) -> Error {
        match &self.path {
            Some(path) => error.at_file(path),
            None => error,
        }
    }

    /// The experiment with everything that the study fixes, before a start is taken from a recording.
    pub fn experiment(&self) -> Experiment {
        let mut base = Experiment::new(self.morphology.assemble());
        base.scene = self.scene.clone();
        base.ground = self.ground.clone();
        if let Some(vehicle) = &self.vehicle {
            base.drive = vehicle.drive;
            base.vehicle = Some(Arc::clone(vehicle));
        }
        if let Some(steering) = &self.steering {
            steering.give_to(&mut base);
        }
        if let Some(own) = &self.own_simulator {
            own.give_to(&mut base);
            let robot = Arc::make_mut(&mut base.assembly);
            robot.body_length_m = own.body_length_m().unwrap_or(0.0);
        }
        self.set.apply(&base)
    }
}

#[cfg(feature = "schema")]
realgap_core::string_schema! {
    StartUsed, "StartUsed", "Where the runs of a study start, in words.";
}
