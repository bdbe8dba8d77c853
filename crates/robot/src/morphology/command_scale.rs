//! The relation of recorded commands to the commands of a joint.

use serde::{Deserialize, Serialize};

use super::flaw::{Checked, Flaw, Range};
use realgap_core::Error;

/// How a recorded command becomes the command of a joint: the command is clamped to `range`, loses its dead zone, is bent,
/// multiplied and shifted, turned into the angle of a steered wheel, and lags behind.
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
    /// Commands of this size or less have no effect, and larger ones that much less, in the unit of the recording.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub dead_zone: f64,
    /// How strongly large commands are compressed, one over the unit of the recording: c becomes tanh(b c) / b; 0 for none.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub bend: f64,
    /// Ackermann steering: how far the steered wheel is to the left of the robot's middle, over the wheelbase; 0 for a wheel that
    /// turns by the command. The command is then the angle a of a wheel in the middle, and this wheel turns by
    /// atan(tan a / (1 - r tan a)), so that all wheels roll about one point.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub ackermann: f64,
    /// How much later than it was recorded a command takes effect, seconds; below 0 where a recorder is late.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub delay_s: f64,
    /// Time constant of the lag with which the actuator follows (first order), seconds.
    #[serde(skip_serializing_if = "super::absent::is_zero")]
    pub lag_s: f64,
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
            dead_zone: 0.0,
            bend: 0.0,
            ackermann: 0.0,
            delay_s: 0.0,
            lag_s: 0.0,
        }
    }
}

impl CommandScale {
    /// Largest lag and delay, seconds.
    pub const LONGEST_LAG_S: f64 = 10.0;

    /// Whether commands stay as they are.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether a command becomes that of its joint by the range, the factor and the offset alone, which other formats can say.
    pub fn is_linear(&self) -> bool {
        let linear = Self {
            factor: self.factor,
            offset: self.offset,
            range: self.range,
            ..Self::default()
        };
        *self == linear
    }

    /// The command of the joint, before the lag.
    pub fn apply(&self, command: f64) -> f64 {
        let (low, high) = self.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let command = command.clamp(low, high);
        let beyond = (command.abs() - self.dead_zone).max(0.0).copysign(command);
        let bent = match self.bend > 0.0 {
            true => (self.bend * beyond).tanh() / self.bend,
            false => beyond,
        };
        let asked = self.factor * bent + self.offset;
        match self.ackermann == 0.0 {
            true => asked,
            false => {
                let (sine, cosine) = asked.sin_cos();
                sine.atan2(cosine - self.ackermann * sine)
            }
        }
    }

    /// Checks the range of every value; `at` is the path in the file.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        Range::within(-1e9, 1e9, "").check(self.factor, &format!("{at}.factor"))?;
        Range::within(-1e9, 1e9, "").check(self.offset, &format!("{at}.offset"))?;
        Range::within(0.0, 1e9, "").check(self.dead_zone, &format!("{at}.dead_zone"))?;
        Range::within(0.0, 1e9, "").check(self.bend, &format!("{at}.bend"))?;
        Range::within(-10.0, 10.0, "").check(self.ackermann, &format!("{at}.ackermann"))?;
        let longest_s = Self::LONGEST_LAG_S;
        Range::within(-longest_s, longest_s, "s").check(self.delay_s, &format!("{at}.delay_s"))?;
        Range::within(0.0, longest_s, "s").check(self.lag_s, &format!("{at}.lag_s"))?;
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
            ..CommandScale::default()
        };
        assert!(scale.is_linear());
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

    #[test]
    fn a_command_within_the_dead_zone_has_no_effect_and_a_large_one_is_bent() {
        let throttle = CommandScale {
            factor: 2.0,
            dead_zone: 0.25,
            ..CommandScale::default()
        };
        assert_eq!(
            [-0.75, -0.25, 0.0, 0.2, 0.5].map(|c| throttle.apply(c)),
            [-1.0, 0.0, 0.0, 0.0, 0.5]
        );
        let steering = CommandScale {
            factor: 0.5,
            bend: 2.0,
            ..CommandScale::default()
        };
        assert!(!throttle.is_linear() && !steering.is_linear());
        assert!((steering.apply(1e-3) - 0.5e-3).abs() < 1e-8);
        assert!((steering.apply(-1.0) + 0.25 * 2.0_f64.tanh()).abs() < 1e-15);
    }

    #[test]
    fn steered_wheels_of_one_axle_roll_about_one_point() {
        // A car with a wheelbase of 1 m and wheels 0.3 m to the left and right turns left by 0.4 rad.
        let wheel = |left_m: f64| CommandScale {
            ackermann: left_m,
            ..CommandScale::default()
        };
        assert!(!wheel(0.3).is_linear());
        let radius_m = 1.0 / 0.4_f64.tan();
        for left_m in [0.3, -0.3] {
            // The centre of the turn is on the rear axle, so that the wheel is perpendicular to the way to it.
            let right = (1.0 / (radius_m - left_m)).atan();
            assert!((wheel(left_m).apply(0.4) - right).abs() < 1e-12);
            assert!((wheel(left_m).apply(-0.4) + wheel(-left_m).apply(0.4)).abs() < 1e-12);
        }
    }
}
