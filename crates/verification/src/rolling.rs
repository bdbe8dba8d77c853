//! Checks the acceleration of a ball and a cylinder that roll down a slope.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::Settings;
use super::body::{MASS_KG, block, robot};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, centre_world_m, measure};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Shape, Solid};

const RADIUS_M: f64 = 0.03;
const SLOPE_RAD: f64 = 0.2;
const SECONDS: f64 = 1.0;

/// A body that rolls without slip goes down with g sin a / (1 + I / m r^2).
pub(super) fn checks(settings: &Settings) -> Result<[Check; 2]> {
    let sphere = Shape::Sphere { radius_m: RADIUS_M };
    let cylinder = Shape::Cylinder {
        radius_m: RADIUS_M,
        half_length_m: RADIUS_M,
    };
    Ok([
        roll(settings, "sphere", sphere, [0.4, 0.4])?,
        // Across its axis m (3 r^2 + l^2) / 12 with l = 2 r.
        roll(settings, "cylinder", cylinder, [0.5, 7.0 / 12.0])?,
    ])
}

/// Checks one shape. `shares` are I / m r^2 about the axis of rolling, which is the z axis of the shape, and about an axis across
/// it.
fn roll(settings: &Settings, name: &str, shape: Shape, shares: [f64; 2]) -> Result<Check> {
    let [along, across] = shares.map(|share| share * MASS_KG * RADIUS_M * RADIUS_M);
    let on_its_side = UnitQuaternion::rotation_between(&Vector3::z(), &Vector3::y());
    let solid = Solid {
        shape,
        robot_from_solid: Isometry3::from_parts(
            Vector3::zeros().into(),
            on_its_side.unwrap_or_default(),
        ),
        inertia_kg_m2: Matrix3::from_diagonal(&Vector3::new(across, across, along)),
        ..block(Vector3::zeros(), Vector3::repeat(RADIUS_M), MASS_KG)
    };
    let mut experiment = settings.experiment(robot(vec![vec![solid]], Vec::new()), SECONDS);
    experiment.floor.friction = 0.8;
    experiment.floor.slope_rad = SLOPE_RAD;
    let normal = experiment.floor.normal_world();
    experiment.start = at_rest(normal * RADIUS_M, UnitQuaternion::identity());
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        format!("friction.roll.{name}"),
        format!(
            "acceleration of a {name} that rolls down a slope, over g sin a: 1 / (1 + I / m r^2)"
        ),
        1.0 / (1.0 + shares[0]),
        measure(film.as_ref(), |film| {
            let (first, last) = (film.first(), film.last());
            let way_m = (centre_world_m(last) - centre_world_m(first)).norm();
            Some(2.0 * way_m / (last.time_s.powi(2) * GRAVITY_M_S2 * SLOPE_RAD.sin()))
        }),
        Unit::One,
        Tolerance::Relative(0.01),
    ))
}
