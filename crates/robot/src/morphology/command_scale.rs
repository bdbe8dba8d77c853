//! The relation of recorded commands to the commands of a joint.

use serde::{Deserialize, Serialize};

use super::flaw::{Checked, Flaw, Range};
use realgap_core::Error;

/// How a recorded command becomes the command of a joint: `factor · command + offset`, with the command clamped to `range` first.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "command")]
pub struct CommandScale {
    /// Factor on the recorded command: the inverse of a gear for angles, and the gear for torques.
    #[serde(skip_serializing_if = "is_one")]
    pub factor: f64,
    /// Command of the joint, in radians or newton metres, that a recorded command of 0 means.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub offset: f64,
    /// Smallest and largest command that the actuator takes, in the unit of the recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
}

// serde passes fields by reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

impl Default for CommandScale {
    fn default() -> Self {
        Self {
            factor: 1.0,
            offset: 0.0,
            range: None,
        }
    }
}

impl CommandScale {
    /// Whether commands stay as they are.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The command of the joint.
    pub fn apply(&self, command: f64) -> f64 {
        let (low, high) = self.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        self.factor * command.clamp(low, high) + self.offset
    }

    /// Checks the range of every value; `at` is the path in the file.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        Range::within(-1e9, 1e9, "").check(self.factor, &format!("{at}.factor"))?;
        Range::within(-1e9, 1e9, "").check(self.offset, &format!("{at}.offset"))?;
        if self.factor == 0.0 {
            let error = Error::invalid("with a factor of 0, commands have no effect").found(0);
            return Err(Flaw::new(format!("{at}.factor"), error));
        }
        match self.range {
            Some((low, high)) if !(low < high && low.is_finite() && high.is_finite()) => {
                let error = Error::invalid("not a range of commands")
                    .found(format!("{low} to {high}"))
                    .allowed("two finite numbers, the smaller first");
                Err(Flaw::new(format!("{at}.range"), error))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_clamped_before_it_is_scaled() {
        let scale = CommandScale {
            factor: -2.0,
            offset: 0.5,
            range: Some((-1.0, 3.0)),
        };
        assert_eq!([-9.0, 0.25, 9.0].map(|c| scale.apply(c)), [2.5, 0.0, -5.5]);
        assert!(scale.check("c").is_ok());
        for wrong in [
            CommandScale {
                factor: 0.0,
                ..scale
            },
            CommandScale {
                range: Some((1.0, 1.0)),
                ..scale
            },
            CommandScale {
                offset: f64::NAN,
                ..scale
            },
        ] {
            assert!(wrong.check("c").is_err(), "{wrong:?}");
        }
    }
}
