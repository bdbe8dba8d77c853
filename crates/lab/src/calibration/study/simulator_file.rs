//! The RON form of a study's own simulator, and the consent that its command needs.

use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use serde::Deserialize;

use crate::calibration::study::file::outside;
use crate::calibration::study::mujoco_file::MujocoFile;
use realgap_core::range::Range;
use realgap_core::{Error, Result};
use realgap_guest::{CommandLine, Guest, ParameterDeclaration, Pool, Unasked};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{
    Assignment, Declared, FOREIGN, Parameter, ParameterSet, by_name, foreign_parameter,
};
use realgap_simulation::{Experiment, Simulator, SimulatorChoice};

/// Somebody else's simulator in place of a robot; it has to speak the protocol of `docs/simulator.md`.
#[derive(Debug, Clone, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(in crate::calibration) enum SimulatorFile {
    /// A command: the program and its arguments, started in the folder of this file, e.g. `Command(["python", "walk.py"])`.
    Command(Vec<String>),
    /// A command with more to say about it.
    Program {
        /// The program and its arguments, started in the folder of this file.
        command: Vec<String>,
        /// Further files that decide what it does, relative to this file: models, modules. A changed one is noticed.
        #[serde(default)]
        files: Vec<String>,
        /// Longest time until it says who it is, seconds; else 60.
        start_limit_s: Option<f64>,
        /// Longest time of one run, seconds; else 60.
        answer_limit_s: Option<f64>,
    },
    /// A model of MuJoCo, which the Python package runs (`pip install mujoco`): the parameters of the study are its own fields, e.g.
    /// `joint.elbow.damping`.
    Mujoco(String),
    /// A model of MuJoCo with more to say about it.
    MujocoModel {
        /// The model, relative to this file.
        model: String,
        /// The body or site whose pose is compared; else the first body with a free joint.
        track: Option<String>,
        /// Gains of the controller that turns commanded angles into torques of motors: (N m/rad, N m s/rad).
        pd: Option<(f64, f64)>,
        /// The keyframe in which runs start that do not start from recordings.
        keyframe: Option<String>,
        /// Time with the first command before each run, seconds.
        settle_s: Option<f64>,
        /// Whether the base is held: free joints are taken out of the model.
        #[serde(default)]
        hold: bool,
        /// Further files that decide what it does, e.g. meshes; included files are found. A changed one is noticed.
        #[serde(default)]
        files: Vec<String>,
        /// The Python that has realgap and mujoco; else `python3`.
        python: Option<String>,
        /// Whether parameters are not tested for changing anything before the study.
        #[serde(default)]
        no_probe: bool,
    },
}

/// Whether the command that a study names may be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CommandConsent {
    /// A study that names a command is refused.
    #[default]
    Refused,
    /// The study is read, but its command is not run.
    ReadOnly,
    /// The command is run.
    Given,
}

/// Allowed limits of time.
const LIMIT: Range = Range::within(0.01, 86_400.0, "s");

impl SimulatorFile {
    /// The command that the file names; `varied` are the names of the parameters that the study varies or sets.
    ///
    /// # Errors
    /// No words, limits out of range, files that cannot be read.
    pub fn command(&self, folder: &Path, varied: &[&str]) -> Result<CommandLine> {
        match self {
            Self::Command(words) => CommandLine::new(words.clone(), folder, &[]),
            Self::Mujoco(model) => {
                let file = MujocoFile {
                    model,
                    ..MujocoFile::default()
                };
                file.command(folder, varied)
            }
            Self::MujocoModel {
                model,
                track,
                pd,
                keyframe,
                settle_s,
                hold,
                files,
                python,
                no_probe,
            } => {
                let file = MujocoFile {
                    model,
                    track: track.as_deref(),
                    pd: *pd,
                    keyframe: keyframe.as_deref(),
                    settle_s: *settle_s,
                    hold: *hold,
                    files,
                    python: python.as_deref(),
                    no_probe: *no_probe,
                };
                file.command(folder, varied)
            }
            Self::Program {
                command,
                files,
                start_limit_s,
                answer_limit_s,
            } => {
                let mut line = CommandLine::new(command.clone(), folder, files)?;
                if let Some(limit_s) = *start_limit_s {
                    LIMIT.check(limit_s, "start_limit_s")?;
                    line.start_limit = Duration::from_secs_f64(limit_s);
                }
                if let Some(limit_s) = *answer_limit_s {
                    LIMIT.check(limit_s, "answer_limit_s")?;
                    line.answer_limit = Duration::from_secs_f64(limit_s);
                }
                Ok(line)
            }
        }
    }
}

/// A study's own simulator, in place of a robot.
#[derive(Clone)]
pub struct OwnSimulator {
    choice: SimulatorChoice,
    /// What the simulator says of itself; `None` where it was not asked.
    guest: Option<Arc<Guest>>,
    /// The command, and in a function's place nothing.
    command: Option<CommandLine>,
}

impl fmt::Debug for OwnSimulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("OwnSimulator").field(&self.choice).finish()
    }
}

impl OwnSimulator {
    /// The simulator of a command.
    ///
    /// # Errors
    /// No consent; a command that does not say who it is.
    pub(in crate::calibration) fn of_command(
        command: CommandLine,
        consent: CommandConsent,
    ) -> Result<Self> {
        let own = match consent {
            CommandConsent::Refused => return Err(Unasked::refusal(&command)),
            CommandConsent::ReadOnly => Self {
                choice: SimulatorChoice::new(Arc::new(Unasked::new(command.clone()))),
                guest: None,
                command: None,
            },
            CommandConsent::Given => {
                let pool = Pool::new(command.clone());
                Self::of_guest(Arc::new(Guest::new(Arc::new(pool))?))
            }
        };
        Ok(Self {
            command: Some(command),
            ..own
        })
    }

    /// A simulator that has said who it is, e.g. a function of the same program.
    pub fn of_guest(guest: Arc<Guest>) -> Self {
        let simulator: Arc<dyn Simulator> = Arc::<Guest>::clone(&guest);
        Self {
            choice: SimulatorChoice::new(simulator),
            guest: Some(guest),
            command: None,
        }
    }

    /// What the simulator says of itself; `None` where it was not asked.
    pub fn guest(&self) -> Option<&Guest> {
        self.guest.as_deref()
    }

    /// The command; `None` for a function.
    pub fn command(&self) -> Option<&CommandLine> {
        self.command.as_ref()
    }

    /// Name of the simulator, or of its command where it was not asked.
    pub fn name(&self) -> String {
        match (&self.guest, &self.command) {
            (Some(guest), _) => guest.hello().name.clone(),
            (None, Some(command)) => command.to_string(),
            (None, None) => FOREIGN.to_owned(),
        }
    }

    /// Body length, metres, where the simulator states it.
    pub(in crate::calibration) fn body_length_m(&self) -> Option<f64> {
        self.guest()?.hello().body_length_m
    }

    /// Has an experiment simulated by this simulator, with its default values.
    pub(in crate::calibration) fn give_to(&self, experiment: &mut Experiment) {
        experiment.simulator = self.choice.clone();
        if let Some(guest) = &self.guest {
            experiment.foreign.values = guest.defaults();
        }
    }

    /// The parameter with this name in a study, where `sim.` may be left out.
    ///
    /// # Errors
    /// A name that the simulator does not declare.
    pub(in crate::calibration) fn parameter(&self, name: &str) -> Result<&'static Parameter> {
        if is_of_recordings(name) {
            return by_name(name);
        }
        match &self.guest {
            Some(guest) => guest.parameter(name).map(|(_, parameter)| parameter),
            None => {
                let own = name.strip_prefix("sim.").unwrap_or(name);
                Ok(foreign_parameter(&Declared::unknown(own)))
            }
        }
    }

    /// A value of a parameter.
    ///
    /// # Errors
    /// As [`OwnSimulator::parameter`], and values that the simulator does not allow.
    pub(in crate::calibration) fn assignment(&self, name: &str, value: f64) -> Result<Assignment> {
        let parameter = self.parameter(name)?;
        parameter.check(value)?;
        Ok(Assignment { parameter, value })
    }

    /// What stands for the robot: a cube with the simulator's name and body length.
    pub(in crate::calibration) fn outside(&self) -> Result<Morphology> {
        // A simulator may be called anything, and a robot may not.
        let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let letters = self
            .name()
            .chars()
            .map(|c| if is_letter(c) { c } else { '_' })
            .take(64)
            .collect::<String>();
        let name = match letters.trim_matches('_') {
            "" => "simulator",
            name => name,
        };
        outside(name, self.body_length_m().unwrap_or(1.0))
    }

    /// All parameters that the simulator declares; none where it was not asked.
    pub(in crate::calibration) fn parameters(&self) -> Vec<&'static Parameter> {
        let guest = self.guest.iter();
        let all = guest.flat_map(|guest| &guest.hello().parameters);
        all.map(|declared| foreign_parameter(&declared.declared()))
            .collect()
    }

    /// What the simulator declares of a parameter.
    pub(in crate::calibration) fn declaration(&self, name: &str) -> Option<&ParameterDeclaration> {
        let (declared, _) = self.guest.as_ref()?.parameter(name).ok()?;
        Some(declared)
    }

    /// Values that were stated without knowing this simulator.
    ///
    /// # Errors
    /// Values of parameters that the simulator does not have, or that it does not allow.
    pub(in crate::calibration) fn adopt(&self, set: &ParameterSet) -> Result<ParameterSet> {
        let all = set.iter().map(|assignment| {
            let name = assignment.parameter.name;
            if self.guest.is_some() && !is_foreign(name) && !is_of_recordings(name) {
                return Err(
                    Error::invalid("the study's own simulator has its own parameters")
                        .field(name)
                        .allowed(format!(
                            "{FOREIGN}.NAME, with a name that the simulator declares"
                        )),
                );
            }
            self.assignment(name, assignment.value)
        });
        all.collect()
    }
}

/// Whether a parameter is one of a study's own simulator.
fn is_foreign(name: &str) -> bool {
    name.strip_prefix(FOREIGN)
        .is_some_and(|rest| rest.starts_with('.'))
}

/// Whether a parameter is about the recordings, whoever simulates.
pub(super) fn is_of_recordings(name: &str) -> bool {
    name.starts_with("recording.")
}
