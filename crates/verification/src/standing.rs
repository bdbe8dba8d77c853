//! Checks that a cube that stands on a light plate neither sinks nor creeps, at rest or while it turns the plate.

use nalgebra::{UnitQuaternion, Vector3};

use super::body::{
    CUBE_ON_PLATE_M, MASS_KG, PLATE_HALF_M, PLATE_KG, STILL, on_plate, velocity_servo,
};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, centre_world_m, largest, measure};
use super::{Settings, balance, topple};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Gait, Servo};
use realgap_simulation::{Experiment, JointFormulation};

const FRICTION: f64 = 0.5;
/// A cube on a square plate that is nearly a quarter turn off stands on an edge 5 mm wide: 20 micrometres of sag
/// tilt it by 0.2 degrees there.
const SAG_M: f64 = 2e-5;
/// Largest speed of creep, m/s: 1 mm in 10 s, as for a cube on a slope.
const CREEP_M_S: f64 = 1e-4;
/// Speed below which a camera at 100 Hz does not see the plate tremble, m/s (10 micrometres a frame).
const TREMBLE_M_S: f64 = 1e-3;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for &kind in settings.kinds() {
        checks.extend(rest(settings, kind)?);
        checks.push(slope(settings, kind)?);
        checks.push(twist(settings, kind)?);
    }
    checks.extend(topple::checks(settings)?);
    checks.extend(balance::checks(settings)?);
    Ok(checks)
}

/// Torque that friction can exert on the plate, N m: µ (M + m) g times the distance of the corners.
pub(super) fn friction_torque_nm() -> f64 {
    FRICTION * (MASS_KG + PLATE_KG) * GRAVITY_M_S2 * PLATE_HALF_M * std::f64::consts::SQRT_2
}

/// A servo with ten times the torque that friction can resist with.
fn servo() -> Servo {
    velocity_servo(30.0, 10.0 * friction_torque_nm(), 8.0)
}

fn standing(settings: &Settings, kind: JointFormulation, gait: Gait, seconds: f64) -> Experiment {
    let mut experiment = settings.experiment(on_plate(servo(), gait), seconds);
    experiment.solver.joint = kind;
    experiment.floor.friction = FRICTION;
    experiment.start = at_rest(
        Vector3::new(0.0, 0.0, CUBE_ON_PLATE_M),
        UnitQuaternion::identity(),
    );
    experiment
}

/// A cube on its plate, the servo holding still.
fn rest(settings: &Settings, kind: JointFormulation) -> Result<[Check; 2]> {
    let name = settings.joint_name(kind);
    let film = SimulationLog::record(&standing(settings, kind, STILL, 3.0), &[])?;
    Ok([
        Check::new(
            format!("standing.sag.{name}"),
            "how deep a cube on a light hinged plate sinks into the floor in 3 s, worst of the last second: 0",
            0.0,
            measure(film.as_ref(), |film| {
                let sunk = |z: f64| (CUBE_ON_PLATE_M - z).abs();
                Some(largest(
                    film.since(2.0).map(|s| sunk(s.parts[0].centre_world_m.z)),
                ))
            }),
            Unit::Metre,
            Tolerance::Absolute(SAG_M),
        ),
        Check::new(
            format!("standing.tremble.{name}"),
            "fastest motion of the plate's centre in the last second of the same rest: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some(largest(
                    film.since(2.0)
                        .map(|s| s.parts[1].velocity_world_m_s.norm()),
                ))
            }),
            Unit::MetrePerSecond,
            Tolerance::Absolute(TREMBLE_M_S),
        ),
    ])
}

/// A cube on its plate, the servo holding still, on a slope that is too flat for sliding.
fn slope(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let seconds = 9.0;
    let slope_rad = (0.9 * FRICTION).atan();
    let mut experiment = standing(settings, kind, STILL, seconds + 1.0);
    experiment.floor.slope_rad = slope_rad;
    experiment.start = at_rest(
        experiment.floor.normal_world() * CUBE_ON_PLATE_M,
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope_rad),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        format!("standing.slope.{}", settings.joint_name(kind)),
        "mean speed of a cube on a hinged plate on a slope with tan = 0.9 mu over 9 s, from 1 s on: it sticks",
        0.0,
        measure(film.as_ref(), |film| {
            let travel = centre_world_m(film.last()) - centre_world_m(film.at(1.0));
            Some(travel.norm() / seconds)
        }),
        Unit::MetrePerSecond,
        Tolerance::Absolute(CREEP_M_S),
    ))
}

/// The plate swings under the cube, which stays where it is by symmetry.
fn twist(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let seconds = 20.0;
    let gait = Gait {
        amplitude_rad: 1.0,
        frequency_hz: 1.0,
        ..STILL
    };
    let film = SimulationLog::record(&standing(settings, kind, gait, seconds), &[])?;
    Ok(Check::new(
        format!("standing.twist.{}", settings.joint_name(kind)),
        "mean speed of a cube whose plate swings in place below it by 1 rad at 1 Hz for 20 s: 0 by symmetry",
        0.0,
        measure(film.as_ref(), |film| {
            let travel = centre_world_m(film.last()) - centre_world_m(film.first());
            Some(travel.xy().norm() / seconds)
        }),
        Unit::MetrePerSecond,
        Tolerance::Absolute(CREEP_M_S),
    ))
}
