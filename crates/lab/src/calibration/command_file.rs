//! The RON form of recorded commands, and the commands, gain and switching-off of a recording.

use std::sync::Arc;

use serde::Deserialize;

use super::matching::name_matches;
use realgap_core::error::{Error, Result};
use realgap_core::file::unknown_name;
use realgap_engine::{CommandTrack, Experiment};
use realgap_path::trajectory::Recording;

/// What the recordings of a study say of its servos.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Commands")]
pub struct Commands {
    /// Recorded columns that hold what a hinge was told, `NAME_rad` without the ending.
    pub columns: Vec<CommandColumn>,
    /// What stands before the position gain in a recording's name, e.g. `kp` in `kp200_lift`; the gain is what the robot's file or
    /// a parameter says where a name does not have it.
    #[serde(default)]
    pub gain_after: Option<String>,
    /// When servos are switched off.
    #[serde(default)]
    pub off: Vec<Off>,
}

/// The commands of one hinge.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CommandColumn {
    /// Name of the hinge.
    pub hinge: String,
    /// Name of the column, without `_rad`.
    pub column: String,
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
    /// Whether a recorded column is a command.
    pub(super) fn is_command(&self, column: &str) -> bool {
        self.columns.iter().any(|command| command.column == column)
    }

    /// Has the experiment's servos do what the recording says that they were told.
    ///
    /// # Errors
    /// A hinge or column that is not there, or a number that is none in a name.
    pub(super) fn set_up(&self, experiment: &mut Experiment, recording: &Recording) -> Result<()> {
        let motion = &recording.trajectory;
        let start_s = motion.times_s()[0];
        let off = self
            .off
            .iter()
            .find(|off| name_matches(&off.recordings, &recording.name));
        for CommandColumn { hinge, column } in &self.columns {
            let hinges = experiment.assembly.hinges.iter();
            let servos = hinges.filter(|hinge| hinge.actuator.is_some());
            if !servos.clone().any(|known| known.name == *hinge) {
                let names = servos.map(|known| known.name.as_str());
                return Err(unknown_name("hinge with a servo", hinge, names).field("commands"));
            }
            let Some(commands) = motion.joint(column) else {
                let names = motion.joints().iter().map(|joint| joint.name.as_str());
                return Err(unknown_name("recorded command", column, names)
                    .at_file(&recording.path)
                    .or_hint("a command stands in a column NAME_rad"));
            };
            let track = CommandTrack::new(
                motion.times_s().iter().map(|t| t - start_s).collect(),
                commands.angles_rad.clone(),
                off.map(|off| off.from_s - start_s),
            )
            .map_err(|e| e.at_file(&recording.path))?;
            experiment.commands.insert(hinge.clone(), Arc::new(track));
        }
        if let Some(gain) = self.gain(&recording.name)? {
            let hinges = &mut Arc::make_mut(&mut experiment.assembly).hinges;
            for actuator in hinges
                .iter_mut()
                .filter_map(|hinge| hinge.actuator.as_mut())
            {
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
