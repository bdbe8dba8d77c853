//! Simulates a robot, rigid or jointed, that slides to a stop.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::film::{SimulationLog, centre_world_m, moving};
use realgap_core::error::Result;
use realgap_core::unit::GRAVITY_M_S2;
use realgap_robot::morphology::Assembly;
use realgap_simulation::JointFormulation;

/// Speed at the start, m/s.
pub(super) const SPEED_M_S: f64 = 0.6;

/// Distance over which friction stops a sliding body: v² / 2 µ g.
pub(super) fn stopping_distance_m(friction: f64) -> f64 {
    SPEED_M_S * SPEED_M_S / (2.0 * friction * GRAVITY_M_S2)
}

/// How far a robot slid until it came to rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slide {
    /// Distance along the initial velocity, metres.
    pub along_m: f64,
    /// Distance across the initial velocity, metres.
    pub across_m: f64,
}

/// Slides a robot whose lowest point is `foot_m` below its origin along +x, turned by `yaw_rad`.
pub(super) fn slide(
    settings: &Settings,
    kind: JointFormulation,
    assembly: Assembly,
    foot_m: f64,
    friction: f64,
    yaw_rad: f64,
) -> Result<Slide> {
    let stop_s = SPEED_M_S / (friction * GRAVITY_M_S2);
    let mut experiment = settings.experiment(assembly, 1.5 * stop_s + 0.1);
    experiment.solver.joint = kind;
    experiment.floor.friction = friction;
    experiment.start = moving(
        Vector3::new(0.0, 0.0, foot_m),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad),
        Vector3::new(SPEED_M_S, 0.0, 0.0),
        Vector3::zeros(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    let travel = film.map_or(Vector3::repeat(f64::NAN), |film| {
        centre_world_m(film.last()) - centre_world_m(film.first())
    });
    Ok(Slide {
        along_m: travel.x,
        across_m: travel.y.abs(),
    })
}
