//! Assumed control laws of servos for which a URDF file states only the limits.

use crate::morphology::ServoLaw;

/// Gain of the assumed servo: angular speed per angle error, 1/s.
const GAIN_1_S: f64 = 20.0;
/// Angle error at which the assumed spring reaches the effort limit, radians: position loops of small servos saturate at about
/// ten degrees.
const FULL_RAD: f64 = 0.2;

/// The control law that is assumed for a servo of which only the limits are known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AssumedLaw {
    /// The servo turns towards its command at a rate that is proportional to its angle error, independent of the load.
    #[default]
    Velocity,
    /// The servo is a spring with damping, as the position loops of most small servos are: a load deflects it.
    Torque,
    /// The motor exerts the torque that is commanded.
    Direct,
}

impl AssumedLaw {
    /// The control law of a servo with this largest torque.
    pub(super) fn of(self, max_torque_nm: f64) -> ServoLaw {
        match self {
            Self::Velocity => ServoLaw::Velocity {
                gain_per_s: GAIN_1_S,
            },
            Self::Torque => ServoLaw::Torque {
                stiffness_nm_rad: max_torque_nm / FULL_RAD,
                damping_nm_s_rad: max_torque_nm / FULL_RAD / GAIN_1_S,
            },
            Self::Direct => ServoLaw::Direct,
        }
    }

    /// Description of the assumed law, as the predicate of a sentence about a servo.
    pub(super) fn words(self) -> String {
        match self {
            Self::Velocity => format!(
                "turns to its command at {GAIN_1_S} 1/s times its error, without a speed limit where no velocity above 0 is stated"
            ),
            Self::Torque => format!(
                "is a spring that exerts its effort limit at an error of {FULL_RAD}, damped to follow at {GAIN_1_S} 1/s"
            ),
            Self::Direct => "exerts the commanded torque".to_owned(),
        }
    }
}
