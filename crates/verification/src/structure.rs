//! Checks of the structure of robots: mass properties of rigidly attached modules, their attachments, and hinges under load.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::Settings;
use super::body::{
    BASE_HALF_M, MASS_KG, SIDE_M, STILL, arm, bar, cantilever, corner, tripod, velocity_servo,
};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, largest, measure};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_simulation::JointFormulation;

/// Smallest gap at a hinge that motion capture of the modules would resolve, metres.
const OPENING_M: f64 = 5e-4;
/// Half a degree, the play of the horn of a good hobby servo, radians.
const TILT_RAD: f64 = 0.0087;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = compound(settings)?;
    checks.push(cantilever_sag(settings)?);
    for &kind in settings.kinds() {
        checks.extend(loaded_hinge(settings, kind)?);
        checks.extend(walking_hinge(settings, kind)?);
    }
    Ok(checks)
}

/// Mass, centre of mass and inertia that the engine uses for rigidly attached modules.
fn compound(settings: &Settings) -> Result<Vec<Check>> {
    let (m, a2) = (MASS_KG, SIDE_M * SIDE_M);
    // Four modules in a row are one box of 4 s × s × s.
    let box_about = |p: f64, q: f64| 4.0 * m * a2 * (p * p + q * q) / 12.0;
    let bar_inertia = Matrix3::from_diagonal(&Vector3::new(
        box_about(1.0, 1.0),
        box_about(4.0, 1.0),
        box_about(4.0, 1.0),
    ));
    // Three modules at (0,0), (1,0), (0,1) sides: Σ(y² − ȳ²) = 2/3, Σ(xy − x̄ȳ) = −1/3, and a sixth for each cube.
    let (own, second, product) = (0.5, 2.0 / 3.0, 1.0 / 3.0);
    let corner_inertia = Matrix3::new(
        own + second,
        product,
        0.0,
        product,
        own + second,
        0.0,
        0.0,
        0.0,
        own + 2.0 * second,
    ) * (m * a2);
    let cases = [
        ("bar", bar(), 4.0 * m, Vector3::x() * 1.5, bar_inertia),
        (
            "corner",
            corner(),
            3.0 * m,
            Vector3::new(1.0, 1.0, 0.0) / 3.0,
            corner_inertia,
        ),
    ];
    let mut checks = Vec::new();
    for (name, assembly, mass_kg, centre_sides, inertia) in cases {
        let centre_m = centre_sides * SIDE_M;
        let mut experiment = settings.experiment(assembly, 0.01);
        experiment.start = at_rest(Vector3::zeros(), UnitQuaternion::identity());
        experiment.floor.height_m = -1.0;
        let film = SimulationLog::record(&experiment, &[])?;
        checks.push(Check::new(
            format!("structure.mass.{name}"),
            "mass of rigidly attached modules: the sum of their masses",
            mass_kg,
            measure(film.as_ref(), |film| Some(film.first().parts[0].mass_kg)),
            Unit::Kilogram,
            Tolerance::Relative(1e-6),
        ));
        checks.push(Check::new(
            format!("structure.centre.{name}"),
            "distance of their centre of mass from the weighted mean of the modules' centres: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some((film.first().parts[0].centre_world_m - centre_m).norm())
            }),
            Unit::Metre,
            Tolerance::Absolute(1e-6),
        ));
        checks.push(Check::new(
            format!("structure.inertia.{name}"),
            "largest deviation of their inertia tensor from the box formula or the parallel-axis theorem, as a share: 0",
            0.0,
            measure(film.as_ref(), |film| {
                let deviation = film.first().parts[0].inertia_world_kg_m2 - inertia;
                Some(deviation.amax() / inertia.amax())
            }),
            Unit::One,
            Tolerance::Absolute(1e-6),
        ));
    }
    Ok(checks)
}

/// Ten modules attached in a row to a heavy module that stands on the floor.
fn cantilever_sag(settings: &Settings) -> Result<Check> {
    let mut robot = cantilever()?;
    // The base is tracked. A tip that belonged to another part than the base would mean that an attachment became a joint.
    let tip_from_track = robot.robot_from_track;
    robot.track_part = 0;
    robot.robot_from_track = nalgebra::Isometry3::identity();
    let mut experiment = settings.experiment(robot, 2.0);
    experiment.floor.friction = 1.0;
    experiment.start = at_rest(
        Vector3::new(0.0, 0.0, 0.5 * SIDE_M),
        UnitQuaternion::identity(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    let sag = measure(film.as_ref(), |film| {
        let tip_m = |snapshot: &realgap_simulation::Snapshot| {
            let part = snapshot.parts.last()?;
            let base = &snapshot.parts[0];
            // The tip belongs to the last part; if the attachments are rigid, the last part is the base itself.
            let carrier = if snapshot.parts.len() == 1 {
                base
            } else {
                part
            };
            Some((carrier.world_from_part * tip_from_track).translation.z)
        };
        Some(tip_m(film.first())? - tip_m(film.last())?)
    });
    Ok(Check::new(
        "structure.cantilever",
        "sag of the tip of ten modules attached in a row to a standing base after 2 s: 0",
        0.0,
        sag,
        Unit::Metre,
        Tolerance::Absolute(1e-3),
    ))
}

/// A hinge with a vertical axis carries an arm of one kilogram sideways: the hinge must neither open nor tilt.
fn loaded_hinge(settings: &Settings, kind: JointFormulation) -> Result<[Check; 2]> {
    let name = settings.joint_name(kind);
    let servo = velocity_servo(30.0, 5.0, 8.0);
    let robot = arm(1.0, Vector3::z(), servo, STILL);
    let mut experiment = settings.experiment(robot, 1.0);
    experiment.solver.joint = kind;
    experiment.floor.friction = 1.0;
    experiment.start = at_rest(
        Vector3::new(0.0, 0.0, BASE_HALF_M),
        UnitQuaternion::identity(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok([
        Check::new(
            format!("structure.load.opening.{name}"),
            "largest opening of a hinge that carries 1 kg sideways: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some(largest(film.iter().map(|s| s.hinges[0].opening_m)))
            }),
            Unit::Metre,
            Tolerance::Absolute(1e-4),
        ),
        Check::new(
            format!("structure.load.tilt.{name}"),
            "largest tilt of the hinge's axis under the same load: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some(largest(film.iter().map(|s| s.hinges[0].tilt_rad)))
            }),
            Unit::Radian,
            Tolerance::Absolute(TILT_RAD),
        ),
    ])
}

/// Hinges of the tripod while it walks, which loads them with contacts, servo torques and weight at once.
fn walking_hinge(settings: &Settings, kind: JointFormulation) -> Result<[Check; 2]> {
    let name = settings.joint_name(kind);
    let mut experiment = settings.experiment(tripod()?, 4.0);
    experiment.solver.joint = kind;
    let film = SimulationLog::record(&experiment, &[])?;
    let hinges = |look: fn(&realgap_simulation::HingeState) -> f64| {
        measure(film.as_ref(), |film| {
            Some(largest(film.iter().flat_map(|s| s.hinges.iter().map(look))))
        })
    };
    Ok([
        Check::new(
            format!("structure.walk.opening.{name}"),
            "largest opening of a hinge of the tripod as it walks for 4 s: 0",
            0.0,
            hinges(|h| h.opening_m),
            Unit::Metre,
            Tolerance::Absolute(OPENING_M),
        ),
        Check::new(
            format!("structure.walk.tilt.{name}"),
            "largest tilt of a hinge's axis during the same walk: 0",
            0.0,
            hinges(|h| h.tilt_rad),
            Unit::Radian,
            Tolerance::Absolute(TILT_RAD),
        ),
    ])
}
