//! Checks of friction: stopping distance, the slope at which a cube begins to slip, and creep at rest.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{SIDE_M, STILL, bar, corner, cube, tripod};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, largest, measure, worst};
use super::slide::{slide, stopping_distance_m};
use super::{rolling, spin, turning, wheel};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};

/// Tolerance of stopping distances. Friction is fitted to two digits, and an error of 1 % in distance is one of 1 % in friction.
const SHARE: f64 = 0.01;
/// A robot that rests must not wander more than 1 mm in 10 s.
const CREEP_M_S: f64 = 1e-4;
const FRICTION: f64 = 0.5;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = stopping(settings)?;
    checks.extend(jointed(settings)?);
    checks.extend(slope(settings)?);
    checks.extend(spin::checks(settings)?);
    checks.extend(rolling::checks(settings)?);
    checks.extend(turning::checks(settings)?);
    checks.extend(wheel::checks(settings)?);
    Ok(checks)
}

/// A body that slides over a level floor.
fn stopping(settings: &Settings) -> Result<Vec<Check>> {
    let yaws_deg = [0.0_f64, 20.0, 45.0, 70.0];
    let mut checks = Vec::new();
    for (name, assembly) in [("cube", cube()), ("corner", corner()), ("bar", bar())] {
        let mut across = Vec::new();
        for friction in [0.2, 0.5, 0.8] {
            let expected = stopping_distance_m(friction);
            let mut along = Vec::new();
            for yaw_deg in yaws_deg {
                let end = slide(
                    settings,
                    settings.solver.joint,
                    assembly.clone(),
                    0.5 * SIDE_M,
                    friction,
                    yaw_deg.to_radians(),
                )?;
                along.push(end.along_m);
                across.push(end.across_m / expected);
            }
            checks.push(Check::new(
                format!("friction.stop.{name}.{friction}"),
                format!("stopping distance from 0.6 m/s at friction {friction}, worst of 4 headings: v^2 / 2 mu g"),
                expected,
                worst(along, expected),
                Unit::Metre,
                Tolerance::Relative(SHARE),
            ));
        }
        checks.push(Check::new(
            format!("friction.straight.{name}"),
            "sideways drift of the same slides as a share of their length, worst: friction opposes slip, so none",
            0.0,
            largest(across.into_iter()),
            Unit::One,
            Tolerance::Absolute(SHARE),
        ));
    }
    Ok(checks)
}

/// The tripod with its servos holding still slides on its three plates.
fn jointed(settings: &Settings) -> Result<Vec<Check>> {
    let friction = 0.3;
    let expected = stopping_distance_m(friction);
    let mut robot = tripod()?;
    for hinge in &mut robot.hinges {
        if let Some(actuator) = &mut hinge.actuator {
            actuator.gait = STILL;
        }
    }
    let mut checks = Vec::new();
    for &kind in settings.kinds() {
        let (mut along, mut across) = (Vec::new(), Vec::new());
        for step in 0..6 {
            let yaw_rad = f64::from(step) * 60_f64.to_radians() + 0.2;
            let end = slide(settings, kind, robot.clone(), 0.033, friction, yaw_rad)?;
            along.push(end.along_m);
            across.push(end.across_m / expected);
        }
        let name = settings.joint_name(kind);
        checks.push(Check::new(
            format!("friction.stop.tripod.{name}"),
            "stopping distance of the tripod from 0.6 m/s, servos holding, friction 0.3, worst of 6 headings: v^2 / 2 mu g",
            expected,
            worst(along, expected),
            Unit::Metre,
            Tolerance::Relative(SHARE),
        ));
        checks.push(Check::new(
            format!("friction.straight.tripod.{name}"),
            "sideways drift of the same slides as a share of their length, worst: none",
            0.0,
            largest(across.into_iter()),
            Unit::One,
            Tolerance::Absolute(SHARE),
        ));
    }
    Ok(checks)
}

/// A cube on a slope with friction 0.5 sticks if the tangent of the slope is below the friction coefficient, and slips otherwise.
fn slope(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for (share, seconds) in [(0.5, 5.0), (0.98, 2.0)] {
        let drifts = downhill_m(settings, share, seconds)?.map(|m| m / seconds);
        checks.push(Check::new(
            format!("friction.stick.{share}"),
            format!("mean speed of a cube on a slope with tan = {share} mu over {seconds} s, worst of 3 headings: it sticks"),
            0.0,
            worst(drifts, 0.0),
            Unit::MetrePerSecond,
            Tolerance::Absolute(CREEP_M_S),
        ));
    }
    for share in [1.02, 1.3] {
        let tan = share * FRICTION;
        let cos = (1.0 + tan * tan).sqrt().recip();
        let effective = downhill_m(settings, share, 1.0)?
            .map(|distance_m| tan - 2.0 * distance_m / (GRAVITY_M_S2 * cos));
        checks.push(Check::new(
            format!("friction.slip.{share}"),
            format!("friction seen by a cube that slides down a slope with tan = {share} mu for 1 s, worst of 3 headings: tan - a / (g cos) = mu"),
            FRICTION,
            worst(effective, FRICTION),
            Unit::One,
            Tolerance::Relative(SHARE),
        ));
    }
    Ok(checks)
}

/// Distance that a cube slides down a slope with tan = `share` · friction, for three headings.
fn downhill_m(settings: &Settings, share: f64, seconds: f64) -> Result<[f64; 3]> {
    let slope_rad = (share * FRICTION).atan();
    let mut distances = [f64::NAN; 3];
    for (distance, yaw_deg) in distances.iter_mut().zip([0.0_f64, 30.0, 45.0]) {
        let mut experiment = settings.experiment(cube(), seconds);
        experiment.floor.friction = FRICTION;
        experiment.floor.slope_rad = slope_rad;
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope_rad);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_deg.to_radians());
        experiment.start = at_rest(experiment.floor.normal_world() * (0.5 * SIDE_M), tilt * yaw);
        let downhill = tilt * Vector3::x();
        *distance = measure(SimulationLog::record(&experiment, &[])?.as_ref(), |film| {
            let travel = film.last().parts[0].centre_world_m - film.first().parts[0].centre_world_m;
            Some(travel.dot(&downhill))
        });
    }
    Ok(distances)
}
