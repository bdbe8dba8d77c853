//! Checks of friction against rolling and spinning: the distance after which a ball and a cylinder stop rolling, and the time after
//! which a ball and a disc stop spinning.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::Settings;
use super::body::{MASS_KG, block, robot};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, centre_world_m, measure, moving};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Shape, Solid};
use realgap_simulation::{EngineChoice, Experiment, FrictionModel, Snapshot, TREE};

const RADIUS_M: f64 = 0.03;
const SPEED_M_S: f64 = 0.5;
const SPIN_RAD_S: f64 = 20.0;
const ROLLING_M: f64 = 0.002;
const TORSIONAL_M: f64 = 0.001;
/// Tolerance: an error of 1 % is one of 1 % in the coefficient.
const SHARE: f64 = 0.01;

/// An experiment in the tree solver, the only engine with friction against rolling and spinning and with tyres, and with the exact
/// cone, which both need.
pub(super) fn in_tree(mut experiment: Experiment) -> Experiment {
    experiment.solver.engine = EngineChoice::new(&TREE);
    experiment.contact.friction_model = FrictionModel::Coulomb;
    experiment
}

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let sphere = Shape::Sphere { radius_m: RADIUS_M };
    let cylinder = Shape::Cylinder {
        radius_m: RADIUS_M,
        half_length_m: RADIUS_M,
    };
    // Across its axis m (3 r^2 + l^2) / 12 with l = 2 r.
    let of_cylinder = [0.5, 7.0 / 12.0];
    Ok(vec![
        roll(settings, "sphere", sphere.clone(), [0.4, 0.4])?,
        roll(settings, "cylinder", cylinder.clone(), of_cylinder)?,
        spin(settings, "sphere", sphere, [0.4, 0.4], 0.8)?,
        // The friction coefficient is 0, because sliding friction would brake the rim, too.
        spin(settings, "disc", cylinder, of_cylinder, 0.0)?,
    ])
}

/// A body of one shape whose axis has this direction; `shares` are I / m r^2 about the axis and across it.
fn body(shape: Shape, axis: &Vector3<f64>, shares: [f64; 2]) -> Solid {
    let [along, across] = shares.map(|share| share * MASS_KG * RADIUS_M * RADIUS_M);
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), axis).unwrap_or_default();
    Solid {
        shape,
        robot_from_solid: Isometry3::from_parts(Vector3::zeros().into(), turn),
        inertia_kg_m2: Matrix3::from_diagonal(&Vector3::new(across, across, along)),
        ..block(Vector3::zeros(), Vector3::repeat(RADIUS_M), MASS_KG)
    }
}

/// The couple is c N, and the force at the ground brakes the body and speeds up its turning: it slows down with c g / r (1 + I / m r^2).
fn roll(settings: &Settings, name: &str, shape: Shape, shares: [f64; 2]) -> Result<Check> {
    let slows_m_s2 = ROLLING_M / RADIUS_M * GRAVITY_M_S2 / (1.0 + shares[0]);
    let solid = body(shape, &Vector3::y(), shares);
    let seconds = 1.5 * SPEED_M_S / slows_m_s2;
    let mut experiment =
        in_tree(settings.experiment(robot(vec![vec![solid]], Vec::new()), seconds));
    experiment.floor.friction = 0.8;
    experiment.floor.rolling_m = Some(ROLLING_M);
    experiment.start = moving(
        Vector3::z() * RADIUS_M,
        UnitQuaternion::identity(),
        Vector3::x() * SPEED_M_S,
        Vector3::y() * (SPEED_M_S / RADIUS_M),
    );
    let log = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        format!("friction.rolling.{name}.tree"),
        format!(
            "distance after which a {name} that rolls at 0.5 m/s stops, rolling friction c = 2 mm: v^2 r (1 + I / m r^2) / (2 c g)"
        ),
        SPEED_M_S * SPEED_M_S / (2.0 * slows_m_s2),
        measure(log.as_ref(), |log| {
            Some((centre_world_m(log.last()) - centre_world_m(log.first())).x)
        }),
        Unit::Metre,
        Tolerance::Relative(SHARE),
    ))
}

/// The couple about the normal is c N: a body that spins on the spot turns by I w^2 / (2 c m g).
fn spin(
    settings: &Settings,
    name: &str,
    shape: Shape,
    shares: [f64; 2],
    friction: f64,
) -> Result<Check> {
    let inertia_kg_m2 = shares[0] * MASS_KG * RADIUS_M * RADIUS_M;
    let stops_s = inertia_kg_m2 * SPIN_RAD_S / (TORSIONAL_M * MASS_KG * GRAVITY_M_S2);
    let solid = body(shape, &Vector3::z(), shares);
    let mut experiment =
        in_tree(settings.experiment(robot(vec![vec![solid]], Vec::new()), 1.5 * stops_s));
    experiment.floor.friction = friction;
    experiment.floor.torsional_m = Some(TORSIONAL_M);
    experiment.start = moving(
        Vector3::z() * RADIUS_M,
        UnitQuaternion::identity(),
        Vector3::zeros(),
        Vector3::z() * SPIN_RAD_S,
    );
    let log = SimulationLog::record(&experiment, &[])?;
    let spin_rad_s = |snapshot: &Snapshot| snapshot.parts[0].angular_velocity_world_rad_s.z;
    Ok(Check::new(
        format!("friction.torsion.{name}.tree"),
        format!(
            "time after which a {name} that spins at 20 rad/s stops, torsional friction c = 1 mm: I w / (c m g)"
        ),
        stops_s,
        measure(log.as_ref(), |log| {
            // At rest it stays so until the end.
            let moves = log.iter().rev().find(|s| spin_rad_s(s).abs() > 1e-3)?;
            (moves.time_s < log.last().time_s).then_some(moves.time_s)
        }),
        Unit::Second,
        Tolerance::Relative(SHARE),
    ))
}
