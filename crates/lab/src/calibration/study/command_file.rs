//! The RON form of recorded commands: which columns command the servos, their gain, and when they are switched off.

use std::sync::Arc;

use serde::Deserialize;

use crate::calibration::recording::file_pattern::name_matches;
use crate::calibration::study::command_check::check_commands;
use realgap_core::file::unknown_name;
use realgap_core::{Error, Result};
use realgap_path::trajectory::{COMMAND, COMMAND_SIGNALS, Recording, Trajectory};
use realgap_robot::morphology::{Actuator, Hinge};
use realgap_simulation::{Between, CommandTrack, Experiment, Quantity};

/// What the recordings of a study say of its servos: `Commands()` where columns are called after the joints, `NAME_command_rad`
/// (angles), `NAME_command_rad_s` (speeds), `NAME_command_nm` (torques), `NAME_command_a` (currents) or `NAME_command_duty` (shares
/// of the full voltage, -1 to 1), each joint by the column that it has, and `NAME_on` where servos are switched.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Commands")]
pub struct Commands {
    /// Recorded columns that hold the commands of a hinge, where they are not named after the hinge.
    #[serde(default)]
    pub columns: Vec<CommandColumn>,
    /// What is in force between two recorded commands.
    #[serde(default)]
    pub between: BetweenCommands,
    /// What stands before the position gain in a recording's name, e.g. `kp` in `kp200_lift`; the gain is what the robot's file or
    /// a parameter says where a name does not have it.
    #[serde(default)]
    pub gain_after: Option<String>,
    /// When servos are switched off.
    #[serde(default)]
    pub off: Vec<Off>,
}

/// What is in force between two recorded commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum BetweenCommands {
    /// The earlier one, as real servos do.
    #[default]
    Held,
    /// A straight line from one to the other.
    Interpolated,
}

/// The commands of one hinge.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CommandColumn {
    /// Name of the hinge, or of several: `*` stands for any letters.
    pub hinge: String,
    /// Name of the column, without `_rad` where it holds angles. A column whose name states no unit holds commands of the
    /// actuator's own kind (angles, torques, or shares of a throttle), which `command` of the actuator states in the robot's file.
    pub column: String,
    /// Name of a column that switches the servo: it is on where the value is not 0. Without it, that is NAME_on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
}

impl CommandColumn {
    /// The commands of every hinge with a servo that the name fits; this one where none does, so that the name is refused later.
    fn of_all(&self, hinges: &[Hinge]) -> Vec<Self> {
        let servos = hinges.iter().filter(|hinge| hinge.actuator.is_some());
        let named = servos.filter(|hinge| name_matches(&self.hinge, &hinge.name));
        let mut all: Vec<Self> = named
            .map(|hinge| Self {
                hinge: hinge.name.clone(),
                ..self.clone()
            })
            .collect();
        if all.is_empty() {
            all.push(self.clone());
        }
        all
    }
}

/// Endings of a command column after the name of the joint, and the quantity that is commanded.
const ENDINGS: [(&str, Quantity); 5] = [
    (COMMAND, Quantity::Position),
    (COMMAND_SIGNALS[0], Quantity::Velocity),
    (COMMAND_SIGNALS[1], Quantity::Torque),
    (COMMAND_SIGNALS[2], Quantity::Current),
    (COMMAND_SIGNALS[3], Quantity::Duty),
];

/// What a column of commands is called after, and the quantity that it commands; `None` for another column. The name of a column of angles
/// ends in `_rad`, as it does in files.
///
/// ```
/// use realgap_lab::calibration::commanded;
/// use realgap_simulation::Quantity;
///
/// assert_eq!(commanded("knee_command_rad"), Some(("knee", Quantity::Position)));
/// assert_eq!(commanded("knee_command_nm"), Some(("knee", Quantity::Torque)));
/// assert_eq!(commanded("knee_rad"), None);
/// ```
pub fn commanded(column: &str) -> Option<(&str, Quantity)> {
    ENDINGS.iter().find_map(|(ending, quantity)| {
        let column = match quantity {
            Quantity::Position => column.strip_suffix("_rad")?,
            _ => column,
        };
        Some((column.strip_suffix(ending)?, *quantity))
    })
}

/// A column that is called after a joint of a robot and commands it, whether or not the joint has a servo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedCommand {
    /// Name of the joint.
    pub hinge: String,
    /// Name of the column, without `_rad` where it holds angles.
    pub column: String,
    /// What is commanded.
    pub quantity: Quantity,
}

impl RecordedCommand {
    /// The command of the joint of this name in a recording; of several columns for one joint, angles come before speeds, torques,
    /// currents and duties.
    pub fn of(name: &str, motion: &Trajectory) -> Option<Self> {
        ENDINGS.iter().find_map(|(ending, quantity)| {
            let column = format!("{name}{ending}");
            with_unit(motion, &column).map(|_| Self {
                hinge: name.to_owned(),
                column,
                quantity: *quantity,
            })
        })
    }

    /// The commands of these joints in a recording, as [`RecordedCommand::of`].
    pub fn all_of(hinges: &[Hinge], motion: &Trajectory) -> Vec<Self> {
        let each = hinges.iter().map(|hinge| Self::of(&hinge.name, motion));
        each.flatten().collect()
    }

    /// The recorded numbers.
    pub fn values<'a>(&self, motion: &'a Trajectory) -> Option<&'a [f64]> {
        with_unit(motion, &self.column).map(|(values, _)| values)
    }
}

/// Commands so long before and after a window are part of its run, seconds.
const AROUND_S: f64 = 1.0;

/// Ending of a switch column after the name of the joint.
pub(in crate::calibration) const ON: &str = "_on";

/// The recorded numbers and the quantity of a column of commands whose name states the unit.
fn with_unit<'a>(motion: &'a Trajectory, column: &str) -> Option<(&'a [f64], Quantity)> {
    if let Some(joint) = motion.joint(column) {
        return Some((&joint.angles_rad, Quantity::Position));
    }
    let (_, quantity) = ENDINGS[1..].iter().find(|(e, _)| column.ends_with(e))?;
    let signal = motion.signal(column)?;
    Some((&signal.values, *quantity))
}

/// The recorded numbers and the quantity of a column of commands. What a column without a unit commands, only the robot's file can
/// say.
fn recorded<'a>(
    motion: &'a Trajectory,
    column: &str,
    actuator: &Actuator,
) -> Option<(&'a [f64], Quantity)> {
    let stated = !actuator.command.is_none();
    let own = || {
        let signal = motion.signal(column).filter(|_| stated)?;
        Some((&*signal.values, Quantity::of(&actuator.servo.law)))
    };
    with_unit(motion, column).or_else(own)
}

/// Recordings in which all servos are switched off from some time on.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Off {
    /// A pattern with `*` for names of recordings.
    pub recordings: String,
    /// From when on, seconds of the recording's own clock.
    pub from_s: f64,
}

impl Commands {
    /// The columns without a unit that command joints, and those that switch them.
    pub(in crate::calibration) fn unitless(&self) -> Vec<String> {
        let is_known = |name: &str| ENDINGS.iter().any(|(ending, _)| name.ends_with(ending));
        let columns = self.columns.iter();
        let named = columns.flat_map(|one| [Some(one.column.clone()), one.on.clone()]);
        let mut all: Vec<String> = named.flatten().filter(|name| !is_known(name)).collect();
        all.sort();
        all.dedup();
        all
    }

    /// The columns of a recording that command hinges of a robot.
    pub fn columns_of(&self, hinges: &[Hinge], motion: &Trajectory) -> Vec<CommandColumn> {
        if !self.columns.is_empty() {
            return self
                .columns
                .iter()
                .flat_map(|one| one.of_all(hinges))
                .collect();
        }
        let is_servo = |name: &str| {
            let mut hinges = hinges.iter();
            hinges.any(|hinge| hinge.name == name && hinge.actuator.is_some())
        };
        let commands = RecordedCommand::all_of(hinges, motion).into_iter();
        let commands = commands.filter(|command| is_servo(&command.hinge));
        commands
            .map(|RecordedCommand { hinge, column, .. }| CommandColumn {
                hinge,
                column,
                on: None,
            })
            .collect()
    }

    /// Sets the commands of the experiment's servos to the recorded commands.
    ///
    /// # Errors
    /// A hinge or column that does not exist, or a gain in a recording's name that is not a number.
    pub(in crate::calibration) fn set_up(
        &self,
        experiment: &mut Experiment,
        recording: &Recording,
    ) -> Result<()> {
        let (own, whole) = (&recording.trajectory, recording.log.as_deref());
        let motion = whole.unwrap_or(own);
        let start_s = own.times_s()[0];
        // Commands before and after a window matter as long as actuators lag and commands are late or early.
        let (from_s, to_s) = (start_s - AROUND_S, start_s + own.duration_s() + AROUND_S);
        let span = motion.times_s().partition_point(|t| *t < from_s)
            ..motion.times_s().partition_point(|t| *t <= to_s);
        let mut off = self.off.iter();
        let off = off.find(|off| name_matches(&off.recordings, &recording.name));
        let columns = self.columns_of(&experiment.assembly.hinges, motion);
        for CommandColumn { hinge, column, on } in &columns {
            let hinges = experiment.assembly.hinges.iter();
            let servos = hinges.filter_map(|known| Some((known, known.actuator?)));
            let Some((_, actuator)) = servos.clone().find(|(known, _)| known.name == *hinge) else {
                let names = servos.map(|(known, _)| known.name.as_str());
                return Err(unknown_name("hinge with a servo", hinge, names).field("commands"));
            };
            let Some((values, quantity)) = recorded(motion, column, &actuator) else {
                if motion.signal(column).is_some() {
                    let what =
                        format!("nothing says what a command of `{column}` means for `{hinge}`");
                    return Err(Error::invalid(what)
                        .at_file(&recording.path)
                        .found("a column without a unit, and an actuator without `command`")
                        .hint("state `command: (factor: ...)` of the actuator in the robot's file, or name the column after its unit, e.g. NAME_command_rad"));
                }
                let joints = motion.joints().iter().map(|joint| joint.name.as_str());
                let signals = motion.signals().iter().map(|signal| signal.name.as_str());
                return Err(unknown_name("recorded command", column, joints.chain(signals))
                    .at_file(&recording.path)
                    .or_hint("a command stands in a column NAME_rad, NAME_command_rad_s, NAME_command_nm, NAME_command_a or NAME_command_duty"));
            };
            let values = &values[span.clone()];
            let passed: Vec<f64> = match quantity == Quantity::of(&actuator.servo.law) {
                true => values.iter().map(|v| actuator.command.apply(*v)).collect(),
                false => values.to_vec(),
            };
            check_commands(&actuator.servo, quantity, (hinge, &passed))
                .map_err(|e| e.at_file(&recording.path).field(column))?;
            let mut track = CommandTrack::new(
                motion.times_s()[span.clone()]
                    .iter()
                    .map(|t| t - start_s)
                    .collect(),
                values.to_vec(),
                off.map(|off| off.from_s - start_s),
            )
            .map_err(|e| e.at_file(&recording.path))?
            .of(quantity)
            .with(match self.between {
                BetweenCommands::Held => Between::Held,
                BetweenCommands::Interpolated => Between::Interpolated,
            });
            let switch = on.clone().unwrap_or_else(|| format!("{hinge}{ON}"));
            match motion.signal(&switch) {
                Some(signal) => track = track.switched(&signal.values[span.clone()]),
                None if on.is_none() => {}
                None => {
                    let signals = motion.signals().iter().map(|signal| signal.name.as_str());
                    return Err(unknown_name("recorded column", &switch, signals)
                        .or_hint("name a column of numbers that the recording has")
                        .at_file(&recording.path)
                        .field("commands.columns.on"));
                }
            }
            experiment.commands.insert(hinge.clone(), Arc::new(track));
        }
        if let Some(gain) = self.gain(&recording.name)? {
            let hinges = &mut Arc::make_mut(&mut experiment.assembly).hinges;
            for actuator in hinges.iter_mut().filter_map(|h| h.actuator.as_mut()) {
                if let Some(motor) = actuator.servo.law.motor_mut() {
                    motor.position_gain = gain;
                }
            }
        }
        Ok(())
    }

    /// The position gain that a recording's name states.
    fn gain(&self, name: &str) -> Result<Option<f64>> {
        let Some(before) = &self.gain_after else {
            return Ok(None);
        };
        let Some((_, rest)) = name.split_once(before.as_str()) else {
            return Ok(None);
        };
        let digits: String = rest
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        match digits.trim_end_matches('.').parse::<f64>() {
            Ok(gain) => Ok(Some(gain)),
            Err(_) => Err(Error::invalid("no position gain in a recording's name")
                .field("commands.gain_after")
                .found(format!("{name:?}"))
                .allowed(format!("a number after {before:?}"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands() -> Commands {
        Commands {
            columns: Vec::new(),
            between: BetweenCommands::default(),
            gain_after: Some("kp".to_owned()),
            off: Vec::new(),
        }
    }

    #[test]
    fn a_gain_is_read_from_a_name_and_nothing_else_is() {
        assert_eq!(commands().gain("kp400_lift_and_drop").unwrap(), Some(400.0));
        assert_eq!(commands().gain("run_kp12.5").unwrap(), Some(12.5));
        assert_eq!(commands().gain("lift").unwrap(), None);
        assert!(commands().gain("kpfast").is_err());
    }
}
