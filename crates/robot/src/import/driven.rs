//! Servos for joints that a user's recordings command, although the robot's file states none for them.

use super::note::Notes;
use super::{AssumedLaw, Options};
use crate::morphology::body::{Driver, JointKind, Structure};
use crate::morphology::{Morphology, Servo, ServoLaw};

/// The torque of an assumed servo, as a multiple of the torque that the robot's weight has at its whole length: such a servo does
/// what is commanded, whatever the load.
const STRONG: f64 = 10.0;
/// The torque limit of a joint whose torques are commanded, N m: recorded torques stay within the limits of the real motor anyway.
const UNLIMITED_NM: f64 = 1e4;

/// Adds a servo to every joint of [`Options::driven`] that moves and has none, and gives servos the gains of [`Options::gains`].
pub(super) fn drive(structure: &mut Structure, options: &Options, notes: &mut Notes) {
    if options.driven.is_empty() && options.gains.is_empty() {
        return;
    }
    let Ok(robot) = Morphology::of_bodies(structure.clone()) else {
        // The caller's own call of `Morphology::of_bodies` returns the error.
        return;
    };
    let summary = robot.summary();
    let strong_nm = (STRONG * summary.mass_kg * 9.81 * summary.body_length_m).min(UNLIMITED_NM);
    for (name, law) in &options.driven {
        let is_given = options.gains.contains_key(name);
        if is_given || !moves(structure, name) || driver(structure, name).is_some() {
            continue;
        }
        let max_torque_nm = match law {
            AssumedLaw::Direct => UNLIMITED_NM,
            AssumedLaw::Velocity | AssumedLaw::Torque => strong_nm,
        };
        notes.assumed(
            None,
            format!(
                "the servo of joint `{name}`, which the file does not drive and the recordings command: it {}; it exerts at most {max_torque_nm:.4} N m",
                law.words()
            ),
            "state its motor in the robot's file",
        );
        add(structure, name, law.of(max_torque_nm), max_torque_nm);
    }
    for (name, gains) in &options.gains {
        let law = ServoLaw::Torque {
            stiffness_nm_rad: gains.stiffness_nm_rad,
            damping_nm_s_rad: gains.damping_nm_s_rad,
        };
        let moves = moves(structure, name);
        match driver(structure, name) {
            Some(driver) => {
                // What scaled the torques of a motor does not scale the angles that its firmware takes.
                if driver.servo.law == ServoLaw::Direct {
                    driver.command = None;
                }
                driver.servo.law = law;
            }
            None if moves => add(structure, name, law, strong_nm),
            None => {}
        }
    }
}

fn moves(structure: &Structure, name: &str) -> bool {
    let mut joints = structure.joints.iter();
    joints.any(|joint| joint.name == name && joint.kind != JointKind::Fixed)
}

fn driver<'a>(structure: &'a mut Structure, name: &str) -> Option<&'a mut Driver> {
    let mut drivers = structure.actuators.iter_mut();
    drivers.find(|driver| driver.joint == name)
}

fn add(structure: &mut Structure, name: &str, law: ServoLaw, max_torque_nm: f64) {
    structure.actuators.push(Driver {
        joint: name.to_owned(),
        servo: Servo {
            law,
            max_torque_nm,
            max_speed_rad_s: f64::INFINITY,
            delay_s: 0.0,
            torque_constant_nm_a: None,
        },
        gait: None,
        follows: None,
        command: None,
    });
}
