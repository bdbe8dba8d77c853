//! Checks that only external forces move the centre of mass of a jointed robot whose root is off balance.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{CUBE_ON_PLATE_M, STILL, module, stool, velocity_servo};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, centre_world_m, largest, measure, moving};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_robot::morphology::{Assembly, Gait};
use realgap_simulation::JointFormulation;

/// A tenth of what a motion-capture system resolves in a toss.
const DRIFT_M: f64 = 1e-4;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for &kind in settings.kinds() {
        checks.push(tumble(settings, kind)?);
        checks.push(ice(settings, kind)?);
    }
    Ok(checks)
}

/// Three rigidly attached modules on a plate that a servo swings; their centre of mass is off the first module's centre.
fn lopsided_stool() -> Assembly {
    let modules = vec![
        module(0.0, 0.0, 0.0),
        module(1.0, 0.0, 0.0),
        module(1.0, 0.0, 1.0),
    ];
    let gait = Gait {
        amplitude_rad: 1.0,
        frequency_hz: 1.0,
        ..STILL
    };
    stool(modules, velocity_servo(30.0, 0.2, 8.0), gait)
}

/// The robot tumbles without weight while its servo works.
fn tumble(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let mut experiment = settings.experiment(lopsided_stool(), 0.6);
    experiment.solver.joint = kind;
    experiment.gravity_m_s2 = 0.0;
    experiment.floor.height_m = -10.0;
    experiment.start = moving(
        Vector3::zeros(),
        UnitQuaternion::identity(),
        Vector3::new(0.5, 0.0, 1.0),
        Vector3::new(6.0, 6.0, 5.0),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        format!("energy.centre.tumble.{}", settings.joint_name(kind)),
        "how far the centre of mass of a tumbling, weightless robot with a lopsided root leaves its straight path in 0.6 s: 0",
        0.0,
        measure(film.as_ref(), |film| {
            let first = film.first();
            let start_m = centre_world_m(first);
            let mass_kg: f64 = first.parts.iter().map(|p| p.mass_kg).sum();
            let momentum: Vector3<f64> =
                first.parts.iter().map(|p| p.momentum_world_kg_m_s()).sum();
            let velocity_m_s = momentum / mass_kg;
            Some(largest(film.iter().map(|s| {
                (centre_world_m(s) - start_m - velocity_m_s * s.time_s).norm()
            })))
        }),
        Unit::Metre,
        Tolerance::Absolute(DRIFT_M),
    ))
}

/// The robot stands on ice and works its servo.
fn ice(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let mut experiment = settings.experiment(lopsided_stool(), 2.0);
    experiment.solver.joint = kind;
    experiment.floor.friction = 0.0;
    experiment.start = at_rest(
        Vector3::new(0.0, 0.0, CUBE_ON_PLATE_M),
        UnitQuaternion::identity(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        format!("energy.centre.ice.{}", settings.joint_name(kind)),
        "how far the centre of mass of the same robot moves sideways on a floor without friction in 2 s: 0",
        0.0,
        measure(film.as_ref(), |film| {
            let start_m = centre_world_m(film.first());
            Some(largest(
                film.iter()
                    .map(|s| (centre_world_m(s) - start_m).xy().norm()),
            ))
        }),
        Unit::Metre,
        Tolerance::Absolute(DRIFT_M),
    ))
}
