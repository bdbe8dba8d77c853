//! The calibration file of a robot of LeRobot, and what the numbers of its joints are.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use serde::Deserialize;

use realgap_core::error::{Error, Result};

/// Counts per turn of the encoders of Feetech and Dynamixel servos, and how many of them LeRobot takes for 360 degrees.
const PER_TURN: f64 = 4096.0;
const DEGREE_STEPS: f64 = 4095.0;
/// How near to a whole number the counts have to be: float32 has seven digits.
const WHOLE: f64 = 0.02;
/// The share of values that have to be whole counts.
const MOST: f64 = 0.95;
/// The gripper is a share of its range from 0 to 100, in every kind.
const GRIPPER: &str = "gripper";

/// The range of each motor, counts of its encoder.
#[derive(Debug, Deserialize)]
pub(super) struct Calibration(BTreeMap<String, Motor>);

/// One motor; further fields say how it was found.
#[derive(Debug, Deserialize)]
struct Motor {
    range_min: f64,
    range_max: f64,
    #[serde(default)]
    drive_mode: i64,
}

/// What the numbers of joints are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Degrees,
    Shares,
}

/// A number of a joint as an angle: `(value - middle) * rad`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    middle: f64,
    rad: f64,
}

impl Scale {
    pub(super) fn angle_rad(self, value: f64) -> f64 {
        (value - self.middle) * self.rad
    }
}

impl Kind {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Degrees => "degrees",
            Self::Shares => "shares of their ranges from -100 to 100",
        }
    }

    /// The counts from the end of the range, doubled, because the middle of a range may be half a count.
    fn counts(self, motor: &Motor, is_gripper: bool, value: f64) -> f64 {
        match (self, is_gripper) {
            (_, true) => value / 100.0 * motor.span(),
            (Self::Degrees, false) => 2.0 * value * DEGREE_STEPS / 360.0,
            (Self::Shares, false) => (value + 100.0) / 200.0 * motor.span(),
        }
    }
}

impl Motor {
    fn span(&self) -> f64 {
        self.range_max - self.range_min
    }
}

impl Calibration {
    fn motor(&self, joint: &str) -> Result<&Motor> {
        let found = self.0.get(joint).filter(|motor| motor.span() > 0.0);
        found.ok_or_else(|| {
            let known: Vec<&str> = self.0.keys().map(String::as_str).collect();
            Error::invalid("the calibration is of another robot")
                .field("meta/calibration.json")
                .found(format!("no range of {joint}, but of {}", known.join(", ")))
                .allowed("the file that LeRobot wrote when it calibrated this robot")
        })
    }

    /// Whether rows of values of these joints are degrees or shares.
    ///
    /// # Errors
    /// A joint without a range; values that are neither.
    pub(super) fn kind(
        &self,
        joints: &[&str],
        rows: impl Iterator<Item = Vec<f64>>,
    ) -> Result<Kind> {
        let motors: Vec<(&Motor, bool)> = joints
            .iter()
            .map(|joint| Ok((self.motor(joint)?, *joint == GRIPPER)))
            .collect::<Result<_>>()?;
        let kinds = [Kind::Degrees, Kind::Shares];
        let (mut whole, mut count) = ([0_usize; 2], 0_usize);
        for row in rows {
            for ((motor, is_gripper), value) in motors.iter().zip(row) {
                // The gripper is the same in both.
                if *is_gripper {
                    continue;
                }
                count += 1;
                for (kind, whole) in kinds.iter().zip(&mut whole) {
                    let counts = kind.counts(motor, *is_gripper, value);
                    *whole += usize::from((counts - counts.round()).abs() < WHOLE);
                }
            }
        }
        let fits = |whole: usize| whole as f64 >= MOST * count as f64;
        match (fits(whole[0]), fits(whole[1])) {
            (true, false) => Ok(Kind::Degrees),
            (false, true) => Ok(Kind::Shares),
            (both, _) => Err(Error::invalid("the calibration does not fit the recorded joints")
                .field("meta/calibration.json")
                .found(match both {
                    true => "values that are whole counts of the encoders both as degrees and as shares of the ranges".to_owned(),
                    false => format!(
                        "of {count} values {} are whole counts of the encoders as degrees, and {} as shares of the ranges",
                        whole[0], whole[1]
                    ),
                })
                .allowed("the calibration with which the data set was recorded")
                .hint("remove the file, and state the unit of the angles")),
        }
    }

    /// How the numbers of a joint become angles.
    ///
    /// # Errors
    /// A joint without a range.
    pub(super) fn scale(&self, joint: &str, kind: Kind) -> Result<Scale> {
        let motor = self.motor(joint)?;
        // LeRobot turns the direction of shares, not of degrees.
        let is_turned = motor.drive_mode != 0;
        let sign = if is_turned { -1.0 } else { 1.0 };
        let span_rad = motor.span() / PER_TURN * TAU;
        Ok(match (joint == GRIPPER, kind) {
            (true, _) => Scale {
                middle: if is_turned { 100.0 } else { 0.0 },
                rad: sign * span_rad / 100.0,
            },
            (false, Kind::Shares) => Scale {
                middle: 0.0,
                rad: sign * span_rad / 200.0,
            },
            (false, Kind::Degrees) => Scale {
                middle: 0.0,
                rad: DEGREE_STEPS / 360.0 / PER_TURN * TAU,
            },
        })
    }
}
