//! Parameters of servos: control law, limits, latency and backlash.

use super::member::{adjust, change, shared};
use super::{Nudge, Parameter, entry};
use crate::HingeAdjustment;
use realgap_robot::morphology::{Hinge, Servo, ServoLaw};

/// Defines a parameter for a value of a servo in the robot's file: the expression yields the field, if the servo's law has it.
macro_rules! servo_parameter {
    ($name:literal, $unit:ident, $high:literal, $doc:literal, $servo:ident => $place:expr) => {
        entry!(
            $name,
            $unit,
            (0.0, $high),
            Log,
            Nudge::Share(0.1),
            $doc,
            |e, of| {
                let own = |$servo: &mut Servo| -> Option<f64> { $place.map(|place| *place) };
                shared(e, of, |hinge, _| own(&mut hinge.actuator?.servo))
            },
            |e, of, value| {
                change(e, of, |hinge| {
                    if let Some(actuator) = &mut hinge.actuator {
                        let $servo = &mut actuator.servo;
                        let place: Option<&mut f64> = $place;
                        if let Some(place) = place {
                            *place = value;
                        }
                    }
                })
            }
        )
    };
}

/// Defines a parameter for a study's adjustment of a servo.
macro_rules! adjusted {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $field:ident) => {
        entry!(
            $name,
            $unit,
            $bounds,
            $scale,
            $nudge,
            $doc,
            |e, of| {
                let own =
                    |hinge: &Hinge, change: &HingeAdjustment| hinge.actuator.map(|_| change.$field);
                let hinges = &e.assembly.hinges;
                let has_none = hinges.iter().all(|hinge| hinge.actuator.is_none());
                shared(e, of, own).or(has_none.then(|| HingeAdjustment::default().$field))
            },
            |e, of, value| adjust(e, of, |change| change.$field = value)
        )
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    servo_parameter!("servo.max_torque_nm", NewtonMetre, 1000.0,
        "Torque limit of every servo, in place of the robot file's.", servo => Some(&mut servo.max_torque_nm)),
    servo_parameter!("servo.max_speed_rad_s", RadianPerSecond, 1000.0,
        "Speed limit of every servo, in place of the robot file's.", servo => Some(&mut servo.max_speed_rad_s)),
    servo_parameter!("servo.gain_1_s", PerSecond, 1e5,
        "Gain of every servo with the Velocity law.", servo => match &mut servo.law {
            ServoLaw::Velocity { gain_per_s } => Some(gain_per_s),
            _ => None,
        }),
    servo_parameter!("servo.stiffness_nm_rad", NewtonMetrePerRadian, 1e6,
        "Stiffness of every servo with the Torque law.", servo => match &mut servo.law {
            ServoLaw::Torque { stiffness_nm_rad, .. } => Some(stiffness_nm_rad),
            _ => None,
        }),
    servo_parameter!("servo.damping_nm_s_rad", NewtonMetreSecondPerRadian, 1e6,
        "Damping of every servo with the Torque law.", servo => match &mut servo.law {
            ServoLaw::Torque { damping_nm_s_rad, .. } => Some(damping_nm_s_rad),
            _ => None,
        }),
    adjusted!("servo.gain", One, (0.0, 1000.0), Log, Nudge::Share(0.1),
        "Factor on the reaction of every servo to an angle error: gain of the Velocity law, stiffness of the Torque law.", gain_scale),
    adjusted!("servo.latency_s", Second, (0.0, 10.0), Linear, Nudge::Absolute(0.01),
        "Delay between a command and the reaction of every servo; before the first command arrives, the servo follows the command of time 0. Also called joint.delay_s.", latency_s),
    adjusted!("servo.backlash_rad", Radian, (0.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Backlash (play) between servo and joint, from end to end: no torque within it, and beyond it only the rest of the error counts.", backlash_rad),
    adjusted!("servo.offset_rad", Radian, (-3.2, 3.2), Linear, Nudge::Absolute(0.01),
        "Offset that every servo adds to commanded angles.", offset_rad),
];
