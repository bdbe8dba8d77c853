//! Control laws of servos: how a servo reacts to an angle error, and their RON form.

use serde::{Deserialize, Serialize};

use super::absent::{is_unlimited, limit, unlimited};
use super::motor::{GearFriction, Motor};

/// The control law of a servo: how it reacts to an angle error.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "LawFile", into = "LawFile", rename = "law")]
pub enum ServoLaw {
    /// Velocity command `clamp(gain · error, ±max speed)`, followed within the torque limit.
    Velocity {
        /// Gain, 1/s.
        gain_per_s: f64,
    },
    /// Torque `stiffness · error − damping · joint velocity`, clamped to the torque limit. Without stiffness, the servo follows speeds:
    /// torque `damping · (commanded − joint velocity)`.
    Torque {
        /// Stiffness, N m/rad; 0 for a servo of speeds.
        stiffness_nm_rad: f64,
        /// Damping, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// A position loop, a direct-current motor and a gear: the components of a real servo.
    Motor(Motor),
    /// The command is the torque itself, N m.
    Direct,
    /// The command is a share of the full drive, from -1 to 1, of a motor that rolls freely at 0: the torque is the torque limit
    /// times the share at standstill, and falls in proportion to the speed to none at the largest speed.
    Throttle,
}

impl ServoLaw {
    /// Multiplies the reaction to an angle error by a factor: the gain of the velocity law and of a motor's position loop, or the
    /// stiffness of the torque law.
    pub fn scale_gain(&mut self, factor: f64) {
        match self {
            Self::Velocity { gain_per_s } => *gain_per_s *= factor,
            Self::Torque {
                stiffness_nm_rad, ..
            } => *stiffness_nm_rad *= factor,
            Self::Motor(motor) => motor.position_gain *= factor,
            // These laws have no gain: the command is the torque itself, or its share.
            Self::Direct | Self::Throttle => {}
        }
    }

    /// Whether the servo follows speeds alone.
    pub fn follows_speeds(&self) -> bool {
        matches!(self, Self::Torque { stiffness_nm_rad, .. } if *stiffness_nm_rad == 0.0)
    }

    /// The motor, if the law is a motor's.
    pub fn motor(&self) -> Option<&Motor> {
        match self {
            Self::Motor(motor) => Some(motor),
            Self::Velocity { .. } | Self::Torque { .. } | Self::Direct | Self::Throttle => None,
        }
    }

    /// The motor, if the law is a motor's.
    pub fn motor_mut(&mut self) -> Option<&mut Motor> {
        match self {
            Self::Motor(motor) => Some(motor),
            Self::Velocity { .. } | Self::Torque { .. } | Self::Direct | Self::Throttle => None,
        }
    }
}

/// A control law as files state it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "law")]
enum LawFile {
    /// Velocity command `clamp(gain error, +- max speed)`, followed within the torque.
    Velocity {
        /// Gain, 1/s.
        #[serde(rename = "gain_1_s", alias = "gain_per_s")]
        gain_per_s: f64,
    },
    /// Torque `stiffness error - damping velocity`, within the torque; without stiffness `damping (commanded - velocity)`.
    Torque {
        /// Stiffness, N m/rad.
        stiffness_nm_rad: f64,
        /// Damping, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// A position loop, a direct-current motor and a gear: the components of a real servo.
    Motor {
        /// Gain of the position loop, in the units of the servo's firmware.
        position_gain: f64,
        /// Duty per radian of error and unit of gain, 1/rad.
        duty_1_rad: f64,
        /// Voltage of the supply, V.
        supply_v: f64,
        /// Torque per current behind the gear, N m/A.
        torque_constant_nm_a: f64,
        /// Resistance of winding and driver, ohm.
        resistance_ohm: f64,
        /// Resistance that models the voltage drop of the supply while the driver switches (pulse-width modulation), ohm.
        #[serde(default)]
        ripple_ohm: f64,
        /// Inertia of the rotor, reflected to the output shaft, kg m2.
        #[serde(default)]
        armature_kg_m2: f64,
        /// Largest change of the duty per second, 1/s; without this field the duty may jump.
        #[serde(
            default = "unlimited",
            deserialize_with = "limit",
            skip_serializing_if = "is_unlimited"
        )]
        slew_1_s: f64,
        /// Friction of the gear.
        #[serde(default)]
        friction: GearFriction,
    },
    /// The command is the torque itself, N m.
    Direct,
    /// The command is a share of the torque, from -1 to 1, that falls to none at the largest speed; at 0 the joint turns freely.
    Throttle,
}

impl From<LawFile> for ServoLaw {
    fn from(file: LawFile) -> Self {
        match file {
            LawFile::Velocity { gain_per_s } => Self::Velocity { gain_per_s },
            LawFile::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => Self::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            },
            LawFile::Motor {
                position_gain,
                duty_1_rad,
                supply_v,
                torque_constant_nm_a,
                resistance_ohm,
                ripple_ohm,
                armature_kg_m2,
                slew_1_s,
                friction,
            } => Self::Motor(Motor {
                position_gain,
                duty_1_rad,
                supply_v,
                torque_constant_nm_a,
                resistance_ohm,
                ripple_ohm,
                armature_kg_m2,
                slew_1_s,
                friction,
            }),
            LawFile::Direct => Self::Direct,
            LawFile::Throttle => Self::Throttle,
        }
    }
}

impl From<ServoLaw> for LawFile {
    fn from(law: ServoLaw) -> Self {
        match law {
            ServoLaw::Velocity { gain_per_s } => Self::Velocity { gain_per_s },
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => Self::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            },
            ServoLaw::Motor(motor) => Self::Motor {
                position_gain: motor.position_gain,
                duty_1_rad: motor.duty_1_rad,
                supply_v: motor.supply_v,
                torque_constant_nm_a: motor.torque_constant_nm_a,
                resistance_ohm: motor.resistance_ohm,
                ripple_ohm: motor.ripple_ohm,
                armature_kg_m2: motor.armature_kg_m2,
                slew_1_s: motor.slew_1_s,
                friction: motor.friction,
            },
            ServoLaw::Direct => Self::Direct,
            ServoLaw::Throttle => Self::Throttle,
        }
    }
}
