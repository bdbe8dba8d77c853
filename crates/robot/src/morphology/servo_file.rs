//! The RON form of servos and gaits.

use serde::{Deserialize, Serialize};

use super::assembly::{Gait, Servo, ServoLaw};
use super::motor::{GearFriction, Motor};

/// A servo as files state it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "servo")]
pub struct ServoFile {
    /// Control law.
    law: LawFile,
    /// Largest torque, N m.
    max_torque_nm: f64,
    /// Largest commanded speed, rad/s; without it there is no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_speed_rad_s: Option<f64>,
    /// Age of the command that it acts on, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    delay_s: Option<f64>,
}

/// A control law as files state it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "law")]
pub enum LawFile {
    /// Velocity command `clamp(gain error, +- max speed)`, followed within the torque.
    Velocity {
        /// Gain, 1/s.
        gain_1_s: f64,
    },
    /// Torque `stiffness error - damping velocity`, within the torque.
    Torque {
        /// Stiffness, N m/rad.
        stiffness_nm_rad: f64,
        /// Damping, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// A motor behind a gear: what a servo is made of.
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
        /// How much the supply gives way while the driver chops, ohm.
        #[serde(default)]
        ripple_ohm: f64,
        /// Inertia of the rotor as the output shaft feels it, kg m2.
        #[serde(default)]
        armature_kg_m2: f64,
        /// Largest change of the duty per second, 1/s; without it the duty may jump.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        slew_1_s: Option<f64>,
        /// What the gear takes.
        #[serde(default)]
        friction: FrictionFile,
    },
    /// The command is the torque itself, N m.
    Direct,
}

/// What is left out is zero, but for the form of the Stribeck curve.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "friction")]
pub struct FrictionFile {
    /// Coulomb friction, N m.
    dry_nm: f64,
    /// Viscous friction, N m s/rad.
    viscous_nm_s_rad: f64,
    /// Further dry friction at standstill, N m.
    #[serde(skip_serializing_if = "Option::is_none")]
    stribeck_nm: Option<f64>,
    /// Speed at which the Stribeck parts have fallen to 1/e, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    stribeck_speed_rad_s: Option<f64>,
    /// How sharply they fall: 1 exponentially, 2 as a bell.
    #[serde(skip_serializing_if = "Option::is_none")]
    stribeck_shape: Option<f64>,
    /// Share of the motor's torque that is lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    motor_load: Option<f64>,
    /// Share of the output's torque that is lost, below 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    output_load: Option<f64>,
    /// Further share of both at standstill.
    #[serde(skip_serializing_if = "Option::is_none")]
    stribeck_load: Option<f64>,
    /// Loss that grows with the square of the motor's torque, 1/(N m).
    #[serde(skip_serializing_if = "Option::is_none")]
    quadratic_1_nm: Option<f64>,
}

impl From<FrictionFile> for GearFriction {
    fn from(file: FrictionFile) -> Self {
        let none = Self::default();
        Self {
            dry_nm: file.dry_nm,
            viscous_nm_s_rad: file.viscous_nm_s_rad,
            stribeck_nm: file.stribeck_nm.unwrap_or(none.stribeck_nm),
            stribeck_speed_rad_s: file
                .stribeck_speed_rad_s
                .unwrap_or(none.stribeck_speed_rad_s),
            stribeck_shape: file.stribeck_shape.unwrap_or(none.stribeck_shape),
            motor_load: file.motor_load.unwrap_or(none.motor_load),
            output_load: file.output_load.unwrap_or(none.output_load),
            stribeck_load: file.stribeck_load.unwrap_or(none.stribeck_load),
            quadratic_1_nm: file.quadratic_1_nm.unwrap_or(none.quadratic_1_nm),
        }
    }
}

impl From<GearFriction> for FrictionFile {
    fn from(friction: GearFriction) -> Self {
        let none = GearFriction::default();
        let said = |value: f64, default: f64| (value != default).then_some(value);
        Self {
            dry_nm: friction.dry_nm,
            viscous_nm_s_rad: friction.viscous_nm_s_rad,
            stribeck_nm: said(friction.stribeck_nm, none.stribeck_nm),
            stribeck_speed_rad_s: said(friction.stribeck_speed_rad_s, none.stribeck_speed_rad_s),
            stribeck_shape: said(friction.stribeck_shape, none.stribeck_shape),
            motor_load: said(friction.motor_load, none.motor_load),
            output_load: said(friction.output_load, none.output_load),
            stribeck_load: said(friction.stribeck_load, none.stribeck_load),
            quadratic_1_nm: said(friction.quadratic_1_nm, none.quadratic_1_nm),
        }
    }
}

/// A gait as files state it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "gait")]
pub struct GaitFile {
    /// Mean angle, radians.
    #[serde(default)]
    offset_rad: f64,
    /// Amplitude, radians.
    amplitude_rad: f64,
    /// Frequency, Hz.
    frequency_hz: f64,
    /// Phase, radians.
    #[serde(default)]
    phase_rad: f64,
}

impl From<ServoFile> for Servo {
    fn from(file: ServoFile) -> Self {
        Self {
            law: match file.law {
                LawFile::Velocity { gain_1_s } => ServoLaw::Velocity { gain_1_s },
                LawFile::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                } => ServoLaw::Torque {
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
                } => ServoLaw::Motor(Motor {
                    position_gain,
                    duty_1_rad,
                    supply_v,
                    torque_constant_nm_a,
                    resistance_ohm,
                    ripple_ohm,
                    armature_kg_m2,
                    slew_1_s: slew_1_s.unwrap_or(f64::INFINITY),
                    friction: friction.into(),
                }),
                LawFile::Direct => ServoLaw::Direct,
            },
            max_torque_nm: file.max_torque_nm,
            max_speed_rad_s: file.max_speed_rad_s.unwrap_or(f64::INFINITY),
            delay_s: file.delay_s.unwrap_or(0.0),
        }
    }
}

impl From<Servo> for ServoFile {
    fn from(servo: Servo) -> Self {
        Self {
            law: match servo.law {
                ServoLaw::Velocity { gain_1_s } => LawFile::Velocity { gain_1_s },
                ServoLaw::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                } => LawFile::Torque {
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                },
                ServoLaw::Motor(motor) => LawFile::Motor {
                    position_gain: motor.position_gain,
                    duty_1_rad: motor.duty_1_rad,
                    supply_v: motor.supply_v,
                    torque_constant_nm_a: motor.torque_constant_nm_a,
                    resistance_ohm: motor.resistance_ohm,
                    ripple_ohm: motor.ripple_ohm,
                    armature_kg_m2: motor.armature_kg_m2,
                    slew_1_s: motor.slew_1_s.is_finite().then_some(motor.slew_1_s),
                    friction: motor.friction.into(),
                },
                ServoLaw::Direct => LawFile::Direct,
            },
            max_torque_nm: servo.max_torque_nm,
            max_speed_rad_s: servo
                .max_speed_rad_s
                .is_finite()
                .then_some(servo.max_speed_rad_s),
            delay_s: (servo.delay_s != 0.0).then_some(servo.delay_s),
        }
    }
}

impl GaitFile {
    /// The gait of a servo that is given none: hold 0 rad.
    pub(super) const HOLD: Self = Self::hold(0.0);

    /// The gait of a servo that holds an angle.
    pub(super) const fn hold(offset_rad: f64) -> Self {
        Self {
            offset_rad,
            amplitude_rad: 0.0,
            frequency_hz: 0.0,
            phase_rad: 0.0,
        }
    }
}

impl From<GaitFile> for Gait {
    fn from(file: GaitFile) -> Self {
        Self {
            offset_rad: file.offset_rad,
            amplitude_rad: file.amplitude_rad,
            frequency_hz: file.frequency_hz,
            phase_rad: file.phase_rad,
        }
    }
}

impl From<Gait> for GaitFile {
    fn from(gait: Gait) -> Self {
        Self {
            offset_rad: gait.offset_rad,
            amplitude_rad: gait.amplitude_rad,
            frequency_hz: gait.frequency_hz,
            phase_rad: gait.phase_rad,
        }
    }
}
