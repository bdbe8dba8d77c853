//! Servo limits.

use super::Parameter;
use crate::quantity::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "servo.max_torque_nm",
        unit: Unit::NewtonMetre,
        bounds: (0.0, 1000.0),
        whole: false,
        doc: "Torque limit of every servo, in place of the robot file's.",
        get: |e| e.adjustment.max_torque_nm,
        set: |e, value| e.adjustment.max_torque_nm = Some(value),
    },
    Parameter {
        name: "servo.max_speed_rad_s",
        unit: Unit::RadianPerSecond,
        bounds: (0.0, 1000.0),
        whole: false,
        doc: "Speed limit of every servo, in place of the robot file's.",
        get: |e| e.adjustment.max_speed_rad_s,
        set: |e, value| e.adjustment.max_speed_rad_s = Some(value),
    },
];
