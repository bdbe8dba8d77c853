//! Model of a real servo: a position loop, a direct-current motor on a supply, and a gear with friction.

use serde::{Deserialize, Serialize};

use super::absent::is_zero;
use super::flaw::{Checked, Range};

/// A position loop that sets the duty of a direct-current motor behind a gear. All quantities are referred to the output shaft.
///
/// duty = clamp(gain · duty per gain · error, ±1), torque = kt / R · (duty · supply − kt · speed). [`GearFriction`] describes the
/// loss of torque in the gear. A motor that is switched off exerts no torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// Gain of the position loop, in the units of the servo's firmware.
    pub position_gain: f64,
    /// Duty per radian of error and unit of gain, 1/rad.
    pub duty_1_rad: f64,
    /// Voltage of the supply, V.
    pub supply_v: f64,
    /// Torque per current behind the gear, N m/A; the same number is the back-EMF per speed, V s/rad.
    pub torque_constant_nm_a: f64,
    /// Resistance of winding and driver, ohm.
    pub resistance_ohm: f64,
    /// Resistance that models the voltage drop of the supply while the driver switches (pulse-width modulation): the voltage
    /// during the on-time is lower by this value times current times duty · (1 − duty), as for the ripple of a capacitor, ohm; 0
    /// for a stiff supply.
    pub ripple_ohm: f64,
    /// Inertia of the rotor, reflected to the output shaft (times the square of the gear ratio), kg m².
    pub armature_kg_m2: f64,
    /// Largest change of the duty per second, 1/s; infinite if the duty may jump.
    pub slew_1_s: f64,
    /// Friction of the gear.
    pub friction: GearFriction,
}

impl Motor {
    /// Loss of motor torque per speed of the output, due to the back-EMF, N m s/rad.
    pub fn damping_nm_s_rad(&self) -> f64 {
        self.torque_constant_nm_a.powi(2) / self.resistance_ohm
    }

    /// Effective resistance at a duty, including the voltage drop of the supply: duty · (supply − ripple · current · duty (1 −
    /// duty)) drives the current, so the ripple acts as a resistance, ohm.
    pub fn resistance_at_ohm(&self, duty: f64) -> f64 {
        let duty = duty.abs();
        self.resistance_ohm + self.ripple_ohm * duty * duty * (1.0 - duty)
    }

    /// Torque per angle error while the duty is below its limit, N m/rad.
    pub fn stiffness_nm_rad(&self) -> f64 {
        self.position_gain * self.duty_1_rad * self.stall_nm()
    }

    /// Torque at full duty and standstill, before gear friction, N m.
    pub fn stall_nm(&self) -> f64 {
        self.torque_constant_nm_a * self.supply_v / self.resistance_ohm
    }
}

/// Friction of a gear as a budget: the largest torque with which the gear opposes a motion, or the torque that would cause a
/// motion.
///
/// budget = dry + viscous · |speed| + motor load · |motor| + output load · |output| + quadratic · motor², The dry part and the
/// load shares have an additional Stribeck part that acts only near standstill, scaled by exp(−(|speed| / Stribeck speed)^shape).
/// If all values are zero, the gear has no friction. The terms are those of Duclusaud, Passault et al. ("Extended friction models
/// for the physics simulation of servo actuators", 2024), except for the output torque: here it is the torque that the gear
/// itself passes on (motor minus friction), so that the budget does not depend on torques of the previous step.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "friction")]
pub struct GearFriction {
    /// Coulomb friction, N m.
    pub dry_nm: f64,
    /// Viscous friction, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Additional dry friction at standstill, N m.
    #[serde(skip_serializing_if = "is_zero")]
    pub stribeck_nm: f64,
    /// Speed at which the Stribeck parts have fallen to 1/e, rad/s.
    #[serde(skip_serializing_if = "is_usual_speed")]
    pub stribeck_speed_rad_s: f64,
    /// Exponent of the decay of the Stribeck parts: 1 is exponential, 2 is Gaussian.
    #[serde(skip_serializing_if = "is_usual_shape")]
    pub stribeck_shape: f64,
    /// Fraction of the motor's torque that is lost to friction.
    #[serde(skip_serializing_if = "is_zero")]
    pub motor_load: f64,
    /// Fraction of the output torque that is lost to friction, below 1.
    #[serde(skip_serializing_if = "is_zero")]
    pub output_load: f64,
    /// Additional fraction of both torques that is lost at standstill.
    #[serde(skip_serializing_if = "is_zero")]
    pub stribeck_load: f64,
    /// Loss that grows with the square of the motor's torque, 1/(N m).
    #[serde(skip_serializing_if = "is_zero")]
    pub quadratic_1_nm: f64,
}

fn is_usual_speed(value: &f64) -> bool {
    *value == GearFriction::default().stribeck_speed_rad_s
}

fn is_usual_shape(value: &f64) -> bool {
    *value == GearFriction::default().stribeck_shape
}

impl Default for GearFriction {
    fn default() -> Self {
        Self {
            dry_nm: 0.0,
            viscous_nm_s_rad: 0.0,
            stribeck_nm: 0.0,
            stribeck_speed_rad_s: 0.1,
            stribeck_shape: 1.0,
            motor_load: 0.0,
            output_load: 0.0,
            stribeck_load: 0.0,
            quadratic_1_nm: 0.0,
        }
    }
}

/// Checks a motor; `at` is the path of its law.
pub(super) fn check_motor(motor: &Motor, at: &str) -> Checked<()> {
    let Motor {
        position_gain,
        duty_1_rad,
        supply_v,
        torque_constant_nm_a,
        resistance_ohm,
        ripple_ohm,
        armature_kg_m2,
        slew_1_s,
        friction,
    } = *motor;
    let path = |field: &str| format!("{at}.{field}");
    Range::within(0.0, 1e6, "").check(position_gain, &path("position_gain"))?;
    Range::above(0.0, 1e6, "1/rad").check(duty_1_rad, &path("duty_1_rad"))?;
    Range::within(0.0, 1000.0, "V").check(supply_v, &path("supply_v"))?;
    Range::above(0.0, 1000.0, "N m/A")
        .check(torque_constant_nm_a, &path("torque_constant_nm_a"))?;
    Range::above(0.0, 1e6, "ohm").check(resistance_ohm, &path("resistance_ohm"))?;
    Range::within(0.0, 1e6, "ohm").check(ripple_ohm, &path("ripple_ohm"))?;
    Range::within(0.0, 1000.0, "kg m^2").check(armature_kg_m2, &path("armature_kg_m2"))?;
    // Infinity is the value for "no limit"; in files the field is left out.
    if slew_1_s.is_nan() || slew_1_s < f64::INFINITY {
        Range::above(0.0, 1e6, "1/s").check(slew_1_s, &path("slew_1_s"))?;
    }
    let path = |field: &str| format!("{at}.friction.{field}");
    let GearFriction {
        dry_nm,
        viscous_nm_s_rad,
        stribeck_nm,
        stribeck_speed_rad_s,
        stribeck_shape,
        motor_load,
        output_load,
        stribeck_load,
        quadratic_1_nm,
    } = friction;
    Range::within(0.0, 1e4, "N m").check(dry_nm, &path("dry_nm"))?;
    Range::within(0.0, 1e4, "N m s/rad").check(viscous_nm_s_rad, &path("viscous_nm_s_rad"))?;
    Range::within(0.0, 1e4, "N m").check(stribeck_nm, &path("stribeck_nm"))?;
    Range::above(0.0, 1000.0, "rad/s")
        .check(stribeck_speed_rad_s, &path("stribeck_speed_rad_s"))?;
    Range::within(0.1, 10.0, "").check(stribeck_shape, &path("stribeck_shape"))?;
    // With an output share of 1 the gear would be self-locking at any load.
    for (field, value) in [
        ("motor_load", motor_load),
        ("output_load", output_load),
        ("stribeck_load", stribeck_load),
    ] {
        Range::within(0.0, MOST_LOAD, "").check(value, &path(field))?;
    }
    Range::within(0.0, 1000.0, "1/(N m)").check(quadratic_1_nm, &path("quadratic_1_nm"))?;
    Ok(())
}

/// Largest allowed fraction of a load that a gear loses to friction.
pub const MOST_LOAD: f64 = 0.95;
