//! The servo law: from commanded and measured angle to what the joint's motor is asked to do.

use crate::morphology::{Servo, ServoLaw};

/// What a joint motor is asked to do during one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Command {
    /// Follow this joint velocity, with at most this torque.
    Velocity { target_rad_s: f64, max_torque_nm: f64 },
    /// Spring and damper about a target angle, with at most this torque.
    Spring { target_rad: f64, stiffness_nm_rad: f64, damping_nm_s_rad: f64, max_torque_nm: f64 },
}

/// The command of a servo at `angle_rad` that should be at `target_rad`.
pub(super) fn command(servo: &Servo, target_rad: f64, angle_rad: f64) -> Command {
    match servo.law {
        ServoLaw::Velocity { gain_1_s } => {
            let limit = servo.max_speed_rad_s;
            Command::Velocity {
                target_rad_s: (gain_1_s * (target_rad - angle_rad)).clamp(-limit, limit),
                max_torque_nm: servo.max_torque_nm,
            }
        }
        ServoLaw::Torque { stiffness_nm_rad, damping_nm_s_rad } => Command::Spring {
            target_rad,
            stiffness_nm_rad,
            damping_nm_s_rad,
            max_torque_nm: servo.max_torque_nm,
        },
    }
}
