//! Parameters of servos that are motors behind gears, in place of the values of the robot's file.

use super::member::{change, shared};
use super::{Nudge, Parameter, entry};
use realgap_robot::morphology::MOST_LOAD;

/// Whether a parameter belongs to motors behind gears.
pub(super) fn is_of_motor(parameter: &Parameter) -> bool {
    let mut of_motors = PARAMETERS.iter();
    parameter.group() == "servo" && of_motors.any(|p| p.quantity() == parameter.quantity())
}

macro_rules! motor {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $($field:ident).+) => {
        entry!(
            $name, $unit, $bounds, $scale, $nudge, $doc,
            |e, of| shared(e, of, |h, _| Some(h.actuator?.servo.law.motor()?.$($field).+)),
            |e, of, value| {
                change(e, of, |hinge| {
                    let law = hinge.actuator.as_mut().map(|a| &mut a.servo.law);
                    if let Some(motor) = law.and_then(|law| law.motor_mut()) {
                        motor.$($field).+ = value;
                    }
                })
            })
    };
}

const TENTH: Nudge = Nudge::Share(0.1);

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    motor!("servo.position_gain", One, (0.0, 1e6), Log, TENTH,
        "Gain of the position loop of every motor, in units of its firmware; a recording that states its own gain keeps it.", position_gain),
    motor!("servo.duty_1_rad", PerRadian, (1e-9, 1e6), Log, TENTH,
        "Duty of every motor per radian of error and unit of position gain.", duty_1_rad),
    motor!("servo.supply_v", Volt, (0.0, 1000.0), Linear, TENTH,
        "Supply voltage of every motor.", supply_v),
    entry!("servo.torque_constant_nm_a", NewtonMetrePerAmpere, (1e-6, 1000.0), Log, TENTH,
        "Torque per current (and back-EMF per speed) of every motor behind its gear, and of every servo that states one.",
        |e, of| shared(e, of, |h, _| h.actuator?.servo.torque_per_current_nm_a()),
        |e, of, value| change(e, of, |hinge| {
            let Some(servo) = hinge.actuator.as_mut().map(|a| &mut a.servo) else { return };
            match servo.law.motor_mut() {
                Some(motor) => motor.torque_constant_nm_a = value,
                None => servo.torque_constant_nm_a = servo.torque_constant_nm_a.map(|_| value),
            }
        })),
    motor!("servo.resistance_ohm", Ohm, (1e-6, 1e6), Log, TENTH,
        "Resistance of every motor's winding and driver.", resistance_ohm),
    motor!("servo.ripple_ohm", Ohm, (0.0, 1e6), Linear, TENTH,
        "Voltage drop of every motor's supply while its driver switches, per current and duty (1 - duty).", ripple_ohm),
    motor!("servo.armature_kg_m2", KilogramSquareMetre, (0.0, 1000.0), Linear, TENTH,
        "Inertia of every motor's rotor, reflected to the output of its gear.", armature_kg_m2),
    motor!("servo.slew_1_s", PerSecond, (1e-3, 1e6), Log, TENTH,
        "Largest change of every motor's duty per second.", slew_1_s),
    motor!("servo.dry_nm", NewtonMetre, (0.0, 1e4), Linear, TENTH,
        "Coulomb friction of every motor's gear.", friction.dry_nm),
    motor!("servo.viscous_nm_s_rad", NewtonMetreSecondPerRadian, (0.0, 1e4), Linear, TENTH,
        "Viscous friction of every motor's gear.", friction.viscous_nm_s_rad),
    motor!("servo.stribeck_nm", NewtonMetre, (0.0, 1e4), Linear, TENTH,
        "Additional dry friction of every gear near standstill.", friction.stribeck_nm),
    motor!("servo.stribeck_speed_rad_s", RadianPerSecond, (1e-3, 1000.0), Log, TENTH,
        "Speed at which the friction near standstill has fallen to 1/e.", friction.stribeck_speed_rad_s),
    motor!("servo.stribeck_shape", One, (0.1, 10.0), Log, TENTH,
        "Exponent of the decay of the friction near standstill: 1 is exponential, 2 is Gaussian.", friction.stribeck_shape),
    motor!("servo.motor_load", One, (0.0, MOST_LOAD), Linear, Nudge::Absolute(0.02),
        "Fraction of the motor's torque that every gear loses to friction.", friction.motor_load),
    motor!("servo.output_load", One, (0.0, MOST_LOAD), Linear, Nudge::Absolute(0.02),
        "Fraction of the output torque that every gear loses to friction.", friction.output_load),
    motor!("servo.stribeck_load", One, (0.0, MOST_LOAD), Linear, Nudge::Absolute(0.02),
        "Additional fraction of both torques that every gear loses near standstill.", friction.stribeck_load),
    motor!("servo.quadratic_1_nm", PerNewtonMetre, (0.0, 1000.0), Linear, TENTH,
        "Friction of every gear per square of the motor's torque.", friction.quadratic_1_nm),
];
