//! What is assumed of a servo of which a file says the limits alone.

use crate::morphology::ServoLaw;

/// How strongly the servo that stands in for the one URDF does not describe answers an error of its angle, 1/s.
const GAIN_1_S: f64 = 20.0;
/// Error at which an assumed spring reaches the effort, radians: position loops of small servos saturate at about ten degrees.
const FULL_RAD: f64 = 0.2;

/// What a servo is taken to be of which only the limits are known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AssumedLaw {
    /// It turns to its command at a rate that is proportional to its error, whatever the load.
    #[default]
    Velocity,
    /// A spring with damping, as the position loops of most small servos are: it gives way under load.
    Torque,
}

impl AssumedLaw {
    /// The law of a servo with that largest torque.
    pub(super) fn of(self, max_torque_nm: f64) -> ServoLaw {
        match self {
            Self::Velocity => ServoLaw::Velocity {
                gain_per_s: GAIN_1_S,
            },
            Self::Torque => ServoLaw::Torque {
                stiffness_nm_rad: max_torque_nm / FULL_RAD,
                damping_nm_s_rad: max_torque_nm / FULL_RAD / GAIN_1_S,
            },
        }
    }

    /// What such a servo does, as the middle of a sentence.
    pub(super) fn words(self) -> String {
        match self {
            Self::Velocity => format!(
                "each turns to its command at {GAIN_1_S} 1/s times its error, as fast as it likes where no velocity above 0 is stated,"
            ),
            Self::Torque => format!(
                "each is a spring that exerts its effort at an error of {FULL_RAD}, damped to follow at {GAIN_1_S} 1/s,"
            ),
        }
    }
}
