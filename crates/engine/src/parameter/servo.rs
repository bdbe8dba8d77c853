//! Servos: limits, gain, latency and play.

use super::{Nudge, Parameter, Scale, field};
use crate::Experiment;
use realgap_core::unit::Unit;
use realgap_robot::morphology::Servo;

/// What the robot's file gives every servo; `None` where they differ or there are none.
fn shared(experiment: &Experiment, own: impl Fn(&Servo) -> f64) -> Option<f64> {
    let mut values = experiment
        .assembly
        .hinges
        .iter()
        .filter_map(|hinge| hinge.actuator.as_ref())
        .map(|actuator| own(&actuator.servo));
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "servo.max_torque_nm",
        unit: Unit::NewtonMetre,
        bounds: (0.0, 1000.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.1),
        doc: "Torque limit of every servo, in place of the robot file's.",
        subject: "",
        get: |e, _| {
            let own = |servo: &Servo| servo.max_torque_nm;
            e.adjustment.max_torque_nm.or_else(|| shared(e, own))
        },
        set: |e, _, value| e.adjustment.max_torque_nm = Some(value),
    },
    Parameter {
        name: "servo.max_speed_rad_s",
        unit: Unit::RadianPerSecond,
        bounds: (0.0, 1000.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.1),
        doc: "Speed limit of every servo, in place of the robot file's.",
        subject: "",
        get: |e, _| {
            let own = |servo: &Servo| servo.max_speed_rad_s;
            e.adjustment.max_speed_rad_s.or_else(|| shared(e, own))
        },
        set: |e, _, value| e.adjustment.max_speed_rad_s = Some(value),
    },
    field!("servo.gain", One, (0.0, 1000.0), Log, Nudge::Share(0.1),
        "Factor on every servo's answer to an angle error: gain of the Velocity law, stiffness of the Torque law.", adjustment.servo_gain_scale),
    field!("servo.latency_s", Second, (0.0, 10.0), Linear, Nudge::Absolute(0.01),
        "Every servo acts on the command of this long ago; until the first arrives it holds the start.", adjustment.servo_latency_s),
    field!("servo.backlash_rad", Radian, (0.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Play between servo and joint, end to end: no torque within it, only the rest of the error counts beyond.", adjustment.servo_backlash_rad),
];
