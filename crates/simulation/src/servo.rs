//! Control law of a servo: computes the command of a joint's motor from commanded and measured angle.

use super::command::Quantity;
use realgap_robot::morphology::{Servo, ServoLaw};

/// Command of a joint's motor for one step, within its torque limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Follow a joint velocity: torque = damping · (target − velocity).
    Velocity {
        /// Joint velocity, rad/s.
        target_rad_s: f64,
        /// Damping, N m s/rad.
        damping_nm_s_rad: f64,
        /// Torque limit, N m.
        max_torque_nm: f64,
    },
    /// Spring and damper: torque = stiffness · (target − angle) − damping · velocity.
    Spring {
        /// Target minus present angle, rad.
        error_rad: f64,
        /// Stiffness, N m/rad.
        stiffness_nm_rad: f64,
        /// Damping, N m s/rad.
        damping_nm_s_rad: f64,
        /// Torque limit, N m.
        max_torque_nm: f64,
    },
}

impl Command {
    /// The torque of this command at a speed, after the joint moved so far since the command was given, N m.
    pub(super) fn torque_nm(&self, moved_rad: f64, speed_rad_s: f64) -> f64 {
        match *self {
            Self::Velocity {
                target_rad_s,
                damping_nm_s_rad,
                max_torque_nm,
            } => (damping_nm_s_rad * (target_rad_s - speed_rad_s))
                .clamp(-max_torque_nm, max_torque_nm),
            Self::Spring {
                error_rad,
                stiffness_nm_rad,
                damping_nm_s_rad,
                max_torque_nm,
            } => (stiffness_nm_rad * (error_rad - moved_rad) - damping_nm_s_rad * speed_rad_s)
                .clamp(-max_torque_nm, max_torque_nm),
        }
    }
}

/// Stiffness of the speed control of a velocity servo: its full torque acts at a speed error of this fraction of its top speed.
const SPEED_SLACK: f64 = 1.0 / 40.0;
/// Top speed that stands in for "unlimited" when the stiffness is chosen, rad/s.
const UNLIMITED_RAD_S: f64 = 10.0;

/// No torque at all.
pub(super) const NOTHING: Command = Command::Velocity {
    target_rad_s: 0.0,
    damping_nm_s_rad: 0.0,
    max_torque_nm: 0.0,
};

/// The part of the error beyond half of the backlash; `None` within the backlash.
pub(super) fn error_beyond_play(backlash_rad: f64, target_rad: f64, angle_rad: f64) -> Option<f64> {
    let whole_error_rad = target_rad - angle_rad;
    let beyond_rad = whole_error_rad.abs() - 0.5 * backlash_rad;
    (backlash_rad <= 0.0 || beyond_rad > 0.0).then(|| beyond_rad.copysign(whole_error_rad))
}

/// A torque that hardly depends on the speed, as a speed command with a very distant target speed, rad/s.
fn torque(torque_nm: f64) -> Command {
    const FAR_RAD_S: f64 = 1e6;
    Command::Velocity {
        target_rad_s: FAR_RAD_S.copysign(torque_nm),
        damping_nm_s_rad: torque_nm.abs() / FAR_RAD_S,
        max_torque_nm: torque_nm.abs(),
    }
}

/// Damping of a servo with speed control: torque per speed error, N m s/rad.
pub(super) fn speed_damping_nm_s_rad(servo: &Servo) -> f64 {
    let top_rad_s = if servo.max_speed_rad_s.is_finite() {
        servo.max_speed_rad_s
    } else {
        UNLIMITED_RAD_S
    };
    servo.max_torque_nm / (SPEED_SLACK * top_rad_s.max(f64::MIN_POSITIVE))
}

/// The motor command of a servo at `angle_rad` whose commanded quantity (an angle, a speed, a torque, a current or a duty) is
/// `target`. A servo without a torque constant or without a top speed is refused before it gets a current or a duty.
///
/// While its speed limit does not bind, the velocity law is passed to the engine as a spring (with stiffness = gain · damping it
/// is the same law). The engine evaluates the angle in every substep, so the gain is exact for any length of the step
/// (docs/validation.md).
///
/// `backlash_rad` is the play between servo and joint from end to end. The servo's own shaft is assumed to be at the commanded
/// angle; while the joint is within half of the play of it, no torque is transmitted.
pub(super) fn command(
    servo: &Servo,
    backlash_rad: f64,
    quantity: Quantity,
    target: f64,
    angle_rad: f64,
) -> Command {
    let max_torque_nm = servo.max_torque_nm;
    match quantity {
        Quantity::Torque => return torque(target.clamp(-max_torque_nm, max_torque_nm)),
        Quantity::Current => {
            let asked_nm = servo.torque_per_current_nm_a().unwrap_or(0.0) * target;
            return torque(asked_nm.clamp(-max_torque_nm, max_torque_nm));
        }
        Quantity::Duty if servo.law == ServoLaw::Throttle => {
            let share = target.clamp(-1.0, 1.0);
            let most_nm = share.abs() * max_torque_nm;
            return Command::Velocity {
                target_rad_s: servo.max_speed_rad_s.copysign(share),
                damping_nm_s_rad: most_nm / servo.max_speed_rad_s,
                max_torque_nm: most_nm,
            };
        }
        Quantity::Duty => {
            // The line from the full torque at standstill to none at the top speed; the torque limit caps braking.
            return Command::Velocity {
                target_rad_s: target.clamp(-1.0, 1.0) * servo.max_speed_rad_s,
                damping_nm_s_rad: max_torque_nm / servo.max_speed_rad_s,
                max_torque_nm,
            };
        }
        Quantity::Velocity => {
            let damping_nm_s_rad = match servo.law {
                ServoLaw::Torque {
                    damping_nm_s_rad, ..
                } if servo.law.follows_speeds() => damping_nm_s_rad,
                _ => speed_damping_nm_s_rad(servo),
            };
            return Command::Velocity {
                target_rad_s: target.clamp(-servo.max_speed_rad_s, servo.max_speed_rad_s),
                damping_nm_s_rad,
                max_torque_nm,
            };
        }
        Quantity::Position => {}
    }
    let Some(error_rad) = error_beyond_play(backlash_rad, target, angle_rad) else {
        return NOTHING;
    };
    match servo.law {
        ServoLaw::Velocity { gain_per_s } => {
            let damping_nm_s_rad = speed_damping_nm_s_rad(servo);
            if (gain_per_s * error_rad).abs() > servo.max_speed_rad_s {
                let target_rad_s = servo.max_speed_rad_s.copysign(error_rad);
                return Command::Velocity {
                    target_rad_s,
                    damping_nm_s_rad,
                    max_torque_nm,
                };
            }
            Command::Spring {
                error_rad,
                stiffness_nm_rad: gain_per_s * damping_nm_s_rad,
                damping_nm_s_rad,
                max_torque_nm,
            }
        }
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => Command::Spring {
            error_rad,
            stiffness_nm_rad,
            damping_nm_s_rad,
            max_torque_nm,
        },
        // A motor is controlled by its effort (see motor.rs), and a direct law by torque commands, so neither gets an angle
        // command.
        ServoLaw::Motor(_) | ServoLaw::Direct | ServoLaw::Throttle => NOTHING,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo(max_speed_rad_s: f64) -> Servo {
        Servo {
            law: ServoLaw::Velocity { gain_per_s: 30.0 },
            max_torque_nm: 0.2,
            max_speed_rad_s,
            delay_s: 0.0,
            torque_constant_nm_a: None,
        }
    }

    #[test]
    fn within_the_speed_limit_the_gain_decides() {
        let Command::Spring {
            error_rad,
            stiffness_nm_rad,
            damping_nm_s_rad,
            ..
        } = command(&servo(8.0), 0.0, Quantity::Position, 0.2, 0.1)
        else {
            panic!("not a spring")
        };
        // Without load, torque 0 means velocity = stiffness / damping · error = gain · error.
        assert!((stiffness_nm_rad / damping_nm_s_rad * error_rad - 3.0).abs() < 1e-12);
    }

    #[test]
    fn beyond_it_the_limit_decides() {
        let Command::Velocity { target_rad_s, .. } =
            command(&servo(8.0), 0.0, Quantity::Position, -1.0, 0.0)
        else {
            panic!("not a velocity")
        };
        assert_eq!(target_rad_s, -8.0);
        assert!(matches!(
            command(&servo(f64::INFINITY), 0.0, Quantity::Position, -1.0, 0.0),
            Command::Spring { .. }
        ));
    }

    #[test]
    fn within_the_backlash_no_torque_is_transmitted_and_beyond_it_the_rest_of_the_error_acts() {
        let Command::Velocity { max_torque_nm, .. } =
            command(&servo(8.0), 0.1, Quantity::Position, 0.04, 0.0)
        else {
            panic!("not free")
        };
        assert_eq!(max_torque_nm, 0.0);
        let Command::Spring { error_rad, .. } =
            command(&servo(8.0), 0.1, Quantity::Position, -0.15, 0.0)
        else {
            panic!("not a spring")
        };
        assert!((error_rad + 0.1).abs() < 1e-12);
    }
}
