//! Doubts about gains that fit neither the robot nor its recordings: most of them are numbers of a firmware's registers, which have no unit.

use std::cell::LazyCell;

use crate::calibration::{Case, Definition};
use realgap_core::unit::number;
use realgap_core::{Code, Warning};
use realgap_robot::morphology::{Hinge, ServoLaw};
use realgap_simulation::Quantity;

/// The share of the recorded samples in which gains ask a servo for more than it has, from which on they are doubted: a real servo would
/// then have been at its limit most of the time, and a fit could not see its gains.
const BEYOND: f64 = 0.5;
/// Position loops of robots are slower than 50 Hz, because belts, gears and links give below that. Twice as fast is no robot's.
const FASTEST_HZ: f64 = 100.0;
/// A joint follows its command in damping over stiffness, in tenths of a second at most. Later than this, its motion is another one.
const LATEST_S: f64 = 0.5;
/// Joints that are named.
const NAMED: usize = 3;

/// What is implausible about the gains of a joint.
enum Doubt {
    /// More torque than the servo has is asked for in this share of the samples: the median of what is asked, and the limit, N m.
    Saturated { share: f64, asked: f64, limit: f64 },
    /// The loop with the inertia of all that the joint carries, in its own posture at zero, kg m², has this natural frequency.
    Fast { hz: f64, inertia: f64 },
    /// The joint would lag so far behind its commands, seconds.
    Late { lag_s: f64 },
}

/// What is implausible about the gains of a joint, if anything is.
///
/// `inertia` is that of all that the joint carries about its axis, with its rotor, kg m² (of a slide its mass, kg).
fn doubt(
    hinge: &Hinge,
    has_stated_damping: bool,
    inertia: impl Fn() -> f64,
    cases: &[Case],
) -> Option<Doubt> {
    let actuator = hinge.actuator.as_ref()?;
    let ServoLaw::Torque {
        stiffness_nm_rad,
        damping_nm_s_rad,
    } = actuator.servo.law
    else {
        return None;
    };
    let mut asked_nm = Vec::new();
    for case in cases {
        let track = case.experiment.commands.get(&hinge.name);
        let Some(track) = track.filter(|track| track.quantity() == Quantity::Position) else {
            continue;
        };
        for motion in case.targets.iter().map(|target| &target.motion) {
            let Some(joint) = motion.joint(&hinge.name) else {
                continue;
            };
            let angles = motion.times_s().iter().zip(&joint.angles_rad);
            asked_nm.extend(angles.map(|(t, angle_rad)| {
                let command = track.value(t - motion.times_s()[0]);
                stiffness_nm_rad * (actuator.command.apply(command) - angle_rad).abs()
            }));
        }
    }
    if asked_nm.is_empty() {
        return None;
    }
    asked_nm.sort_by(f64::total_cmp);
    let limit = actuator.servo.max_torque_nm;
    let within = asked_nm.partition_point(|asked| *asked <= limit);
    let share = 1.0 - within as f64 / asked_nm.len() as f64;
    if share > BEYOND {
        return Some(Doubt::Saturated {
            share,
            asked: asked_nm[asked_nm.len() / 2],
            limit,
        });
    }
    let lag_s = damping_nm_s_rad / stiffness_nm_rad;
    if has_stated_damping && lag_s > LATEST_S {
        return Some(Doubt::Late { lag_s });
    }
    let inertia = inertia();
    let hz = (stiffness_nm_rad / inertia).sqrt() / std::f64::consts::TAU;
    (hz > FASTEST_HZ).then_some(Doubt::Fast { hz, inertia })
}

/// A warning about gains that the study or the robot's file states and that are implausible for this robot and these recordings. Gains
/// that the study varies are not stated.
pub(super) fn doubts(definition: &Definition, cases: &[Case]) -> Option<Warning> {
    let robot = cases.first()?.experiment.adjusted_assembly();
    let is_varied = |joint: &str, quantity: &str| {
        let mut varied = definition.parameters.iter();
        varied.any(|parameter| {
            parameter.robot().is_none_or(|own| own == robot.name)
                && parameter.sets_servo(joint, quantity)
        })
    };
    // Few studies ask for it: its cost grows with the cube of the number of joints.
    let mass_matrix = LazyCell::new(|| robot.dynamics(&vec![0.0; robot.hinges.len()]).mass_matrix);
    let joints = robot.hinges.iter().enumerate();
    let stated = joints.filter(|(_, hinge)| !is_varied(&hinge.name, "stiffness_nm_rad"));
    let found = stated.filter_map(|(index, hinge)| {
        let inertia = || mass_matrix[index][index];
        let has_stated_damping = !is_varied(&hinge.name, "damping_nm_s_rad");
        Some((hinge, doubt(hinge, has_stated_damping, inertia, cases)?))
    });
    let found: Vec<String> = found.map(|(hinge, doubt)| said(hinge, &doubt)).collect();
    let more = match found.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!("; likewise {more} more"),
    };
    let named = found[..found.len().min(NAMED)].join("; ");
    (!found.is_empty()).then(|| {
        Code::ImplausibleGains.warning(format!(
            "{named}{more}: are these numbers of a firmware's registers, which have no unit?"
        ))
    })
}

/// The doubt in words.
fn said(hinge: &Hinge, doubt: &Doubt) -> String {
    let (name, law) = (&hinge.name, hinge.actuator.map(|a| a.servo.law));
    let gains = match law {
        Some(ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        }) => format!(
            "with {} N m/rad and {} N m s/rad",
            number(stiffness_nm_rad),
            number(damping_nm_s_rad)
        ),
        _ => String::new(),
    };
    match doubt {
        Doubt::Saturated {
            share,
            asked,
            limit,
        } => format!(
            "{gains} the recorded commands ask `{name}` for {} N m in the middle, and for more than its limit of {} N m in {:.0} % of the samples",
            number(*asked),
            number(*limit),
            100.0 * share
        ),
        Doubt::Fast { hz, inertia } => format!(
            "{gains} and the {} kg m² that it moves, `{name}` swings at {} Hz, and no robot's joint at more than {FASTEST_HZ} Hz (or does the robot's file lack its rotor, armature_kg_m2?)",
            number(*inertia),
            number(*hz)
        ),
        Doubt::Late { lag_s } => format!(
            "{gains} `{name}` is {} s behind its commands, and joints that are commanded in angles at most {LATEST_S} s",
            number(*lag_s)
        ),
    }
}
