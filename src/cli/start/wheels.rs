//! The wheels that follow commands of forward speed and turn rate (`cmd_vel`), as the robot's file states them.

use realgap::robot::morphology::{Assembly, Freedom, Hinge};
use realgap::trajectory::{Reading, TwistColumns, Wheel, WheelCommands};

use super::super::kit::*;
use super::Subject;

/// An axle points to the side by at least this share of its length.
const TO_THE_SIDE: f64 = 0.9;
/// A wheel that is no farther off the middle than this has no side, metres.
const MIDDLE_M: f64 = 1e-3;

/// The wheels of a log that holds forward speeds and turn rates, with the evidence; `None` without such columns or wheels. `track_m`
/// is the distance between left and right wheels, where it is stated.
///
/// # Errors
/// A file that cannot be read, a distance that is not above 0.
pub(super) fn find(
    subject: &Subject,
    known: &Reading,
    track_m: Option<f64>,
) -> Result<Option<(WheelCommands, String)>> {
    if let Some(track_m) = track_m.filter(|track_m| !(track_m.is_finite() && *track_m > 0.0)) {
        return Err(Error::usage("the wheels need a distance from each other")
            .field("--track")
            .found(track_m)
            .allowed("more than 0 m"));
    }
    let Some(columns) = TwistColumns::infer(&subject.recordings[0], known)? else {
        return Ok(None);
    };
    let assembly = subject.robot.assemble();
    let mut wheels: Vec<Wheel> = (assembly.hinges.iter())
        .filter_map(|hinge| wheel(&assembly, hinge))
        .collect();
    let is_on = |side: f64| wheels.iter().any(|wheel| wheel.left_m * side > 0.0);
    if !is_on(1.0) || !is_on(-1.0) {
        return Ok(None);
    }
    for wheel in &mut wheels {
        if let Some(track_m) = track_m {
            wheel.left_m = 0.5 * track_m * wheel.left_m.signum();
        }
    }
    let told = wheels.iter().map(|wheel| {
        let side = if wheel.left_m > 0.0 { "left" } else { "right" };
        let (off, radius) = (wheel.left_m.abs(), wheel.radius_m.abs());
        let [off, radius] = [off, radius].map(|m| quantity(m, Unit::Metre));
        format!(
            "{} {off} to the {side} with a radius of {radius}",
            wheel.joint
        )
    });
    let because = format!(
        "{}{}",
        told.collect::<Vec<_>>().join(", "),
        match track_m {
            Some(_) => "; the distance of the wheels is stated",
            None => "; from the robot's file, --track states another distance of the wheels",
        }
    );
    let found = WheelCommands {
        forward: columns.forward.0,
        forward_m_s: columns.forward.1,
        turn: columns.turn.0,
        turn_rad_s: columns.turn.1,
        wheels,
    };
    Ok(Some((found, because)))
}

/// The wheel on a joint that turns without limits about an axle to the side.
fn wheel(assembly: &Assembly, hinge: &Hinge) -> Option<Wheel> {
    let is_free = hinge.freedom == Freedom::Turn && hinge.bearing.limits_rad.is_none();
    let [across, left_m] = [hinge.axis_robot.y, hinge.anchor_robot_m.y];
    if !is_free || across.abs() < TO_THE_SIDE || left_m.abs() < MIDDLE_M {
        return None;
    }
    let part = &assembly.parts[hinge.child_part];
    let solids = part.solids.iter().filter(|solid| solid.collides);
    let below_m = solids.map(|solid| {
        let pose = &solid.robot_from_solid;
        let down_solid = pose.rotation.inverse() * -nalgebra::Vector3::z();
        hinge.anchor_robot_m.z - pose.translation.z + solid.shape.reach_m(&down_solid)
    });
    let radius_m = below_m.fold(0.0, f64::max);
    (radius_m > 0.0).then(|| Wheel {
        joint: hinge.name.clone(),
        left_m,
        radius_m: radius_m.copysign(across),
    })
}
