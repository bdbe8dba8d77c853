//! Checks of wheels: the force of a tyre over its slip, and the speed at which a car slides out of its circle.

use nalgebra::{Matrix3, Point3, Unit as UnitVector, UnitQuaternion, Vector3};

use super::Settings;
use super::body::{block, robot};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, centre_world_m, measure, moving, worst};
use super::turning::in_tree;
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Bearing, Freedom, Hinge, Shape, Solid, Tyre};
use realgap_simulation::{JointState, Snapshot};

/// Radius of the wheels of the car, metres.
const RADIUS_M: f64 = 0.03;
/// Radius of the wheel whose curve is measured, metres.
const LARGE_M: f64 = 0.3;
const TYRE: Tyre = Tyre {
    slip_stiffness_1_rad: 5.0,
    shape: 1.4,
};
/// Tolerance of forces: friction is fitted to two digits.
const SHARE: f64 = 0.01;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for friction in [0.3, 0.8] {
        for (name, rim_m_s, hub_m_s) in [("drive", 10.0, 4.0), ("brake", 4.0, 10.0)] {
            checks.push(curve(settings, name, friction, rim_m_s, hub_m_s)?);
        }
    }
    checks.push(rigid_circle(settings)?);
    checks.push(tyred_circle(settings)?);
    Ok(checks)
}

/// A wheel in the form of a ball, with this moment of inertia.
fn wheel(
    centre_m: Vector3<f64>,
    radius_m: f64,
    mass_kg: f64,
    inertia_kg_m2: f64,
    tyre: Option<Tyre>,
) -> Solid {
    Solid {
        shape: Shape::Sphere { radius_m },
        inertia_kg_m2: Matrix3::from_diagonal_element(inertia_kg_m2),
        tyre,
        ..block(centre_m, Vector3::repeat(radius_m), mass_kg)
    }
}

/// The Magic Formula, force over load.
fn magic_formula(slip: f64, friction: f64) -> f64 {
    let Tyre {
        slip_stiffness_1_rad,
        shape,
    } = TYRE;
    friction * (shape * (slip_stiffness_1_rad * slip / (shape * friction)).atan()).sin()
}

/// A wheel whose inertia keeps its rim at one speed is put on the floor at another one: as it takes up the speed of its rim, it passes
/// through all slips. It is so fast that its slip changes little in a step: a small slip decays within v / (k g), 80 ms at 4 m/s.
fn curve(
    settings: &Settings,
    name: &str,
    friction: f64,
    rim_m_s: f64,
    hub_m_s: f64,
) -> Result<Check> {
    let heavy = wheel(Vector3::zeros(), LARGE_M, 0.1, 1e4, Some(TYRE));
    let mut experiment = in_tree(settings.experiment(robot(vec![vec![heavy]], Vec::new()), 5.0));
    experiment.floor.friction = friction;
    experiment.start = moving(
        Vector3::z() * LARGE_M,
        UnitQuaternion::identity(),
        Vector3::x() * hub_m_s,
        Vector3::y() * (rim_m_s / LARGE_M),
    );
    let log = SimulationLog::record(&experiment, &[])?;
    let speed_m_s = |snapshot: &Snapshot| snapshot.parts[0].velocity_world_m_s.x;
    let slip_at = |hub_m_s: f64| (rim_m_s - hub_m_s) / rim_m_s.max(hub_m_s);
    let mut shares = Vec::new();
    for slip in [0.5, 0.3, 0.2, 0.1, 0.05, 0.02_f64] {
        shares.push(measure(log.as_ref(), |log| {
            let is_past = |s: &&Snapshot| slip_at(speed_m_s(s)).abs() < slip;
            let from = log.iter().find(is_past)?;
            let to = log.at(from.time_s + 4.0 * settings.solver.timestep_s);
            let seconds = to.time_s - from.time_s;
            let found = (speed_m_s(to) - speed_m_s(from)) / (seconds * GRAVITY_M_S2);
            let middle = slip_at(0.5 * (speed_m_s(from) + speed_m_s(to)));
            Some(found / magic_formula(middle, friction))
        }));
    }
    Ok(Check::new(
        format!("friction.slip_curve.{name}.{friction}.tree"),
        format!(
            "force of a tyre (slip stiffness 5, shape 1.4, friction {friction}) over that of the Magic Formula, {name}, worst of slips from 0.5 to 0.02: 1"
        ),
        1.0,
        worst(shares, 1.0),
        Unit::One,
        Tolerance::Relative(SHARE),
    ))
}

const FRICTION: f64 = 0.5;
/// Radius of the circle, metres.
const CIRCLE_M: f64 = 1.0;
/// Half the distances between the axles and between the wheels of one axle, metres.
const HALF_M: (f64, f64) = (0.08, 0.06);
/// A car on a circle about a point to its left: the axles of its four wheels point at that point, so that it rolls on the circle by
/// itself, without a drive.
fn car(tyre: Option<Tyre>) -> (Vec<Vec<Solid>>, Vec<Hinge>) {
    let mut chassis = block(Vector3::zeros(), Vector3::new(0.08, 0.04, 0.01), 1.5);
    chassis.collides = false;
    let (mut parts, mut hinges) = (vec![vec![chassis]], Vec::new());
    for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let hub_m = Vector3::new(x * HALF_M.0, y * HALF_M.1, 0.0);
        let to_middle_m = Vector3::y() * CIRCLE_M - hub_m;
        let inertia_kg_m2 = 0.4 * 0.02 * RADIUS_M * RADIUS_M;
        parts.push(vec![wheel(hub_m, RADIUS_M, 0.02, inertia_kg_m2, tyre)]);
        hinges.push(Hinge {
            name: format!("wheel{}", hinges.len()),
            module: 0,
            parent_part: 0,
            child_part: parts.len() - 1,
            anchor_robot_m: hub_m,
            axis_robot: UnitVector::new_normalize(to_middle_m),
            freedom: Freedom::Turn,
            actuator: None,
            bearing: Bearing::default(),
            is_stated: true,
            start_rad: None,
        });
    }
    (parts, hinges)
}

/// The car on its circle, at a speed at which it needs this share of its friction.
fn on_circle(
    settings: &Settings,
    tyre: Option<Tyre>,
    share: f64,
    seconds: f64,
) -> Result<Option<SimulationLog>> {
    let speed_m_s = (share * FRICTION * GRAVITY_M_S2 * CIRCLE_M).sqrt();
    let (parts, hinges) = car(tyre);
    let mut experiment = in_tree(settings.experiment(robot(parts, hinges), seconds));
    experiment.floor.friction = FRICTION;
    let turn_rad_s = speed_m_s / CIRCLE_M;
    let middle = Point3::new(0.0, CIRCLE_M, 0.0);
    let hinges = experiment.assembly.hinges.iter();
    experiment.start_joints = hinges
        .map(|hinge| JointState {
            angle_rad: 0.0,
            speed_rad_s: turn_rad_s * (middle.coords - hinge.anchor_robot_m).norm() / RADIUS_M,
        })
        .collect();
    experiment.start = moving(
        Vector3::z() * RADIUS_M,
        UnitQuaternion::identity(),
        Vector3::x() * speed_m_s,
        Vector3::z() * turn_rad_s,
    );
    SimulationLog::record(&experiment, &[])
}

/// Curvature of the car's path over that of its circle, from its third twentieth of a second on, before it has slid so far that it loses
/// speed.
fn curvature(log: &SimulationLog) -> Option<f64> {
    let [a, b, c] = [0.05, 0.15, 0.25].map(|time_s| centre_world_m(log.at(time_s)).xy());
    // Three points of a circle: its curvature is four times the area of the triangle over the product of its sides.
    let (ab, bc, ca) = (b - a, c - b, a - c);
    Some(2.0 * ab.perp(&bc) / (ab.norm() * bc.norm() * ca.norm()) * CIRCLE_M)
}

/// The largest v^2 / (mu g r) at which a car with rigid wheels keeps its circle, by bisection.
fn rigid_circle(settings: &Settings) -> Result<Check> {
    let (mut holds, mut slides) = (0.5, 1.5);
    for _ in 0..10 {
        let middle = 0.5 * (holds + slides);
        let log = on_circle(settings, None, middle, 0.25)?;
        match measure(log.as_ref(), curvature) > 0.995 {
            true => holds = middle,
            false => slides = middle,
        }
    }
    Ok(Check::new(
        "friction.circle.rigid.tree",
        "largest v^2 / (mu g r) at which a car with rigid wheels keeps on a circle of 1 m, friction 0.5, by bisection: 1",
        1.0,
        0.5 * (holds + slides),
        Unit::One,
        Tolerance::Relative(SHARE),
    ))
}

/// A car with tyres drifts before it slides; what bounds it is the same: its acceleration across its path. The wheels pass their largest
/// forces one after the other, drift by 4 degrees and point 5 degrees off the middle, which explains 1 %: hence a tolerance of 2 %.
fn tyred_circle(settings: &Settings) -> Result<Check> {
    let tyre = Tyre {
        slip_stiffness_1_rad: 20.0,
        ..TYRE
    };
    let log = on_circle(settings, Some(tyre), 1.3, 1.0)?;
    Ok(Check::new(
        "friction.circle.tyre.tree",
        "largest acceleration across its path, over mu g, of a car with tyres that enters a circle with 1.3 times mu g, friction 0.5: 1",
        1.0,
        measure(log.as_ref(), |log| {
            // Over 20 ms, so that single steps do not count.
            let each = log
                .iter()
                .filter(|from| from.time_s < log.last().time_s - 0.02);
            let across_m_s2 = each.map(|from| {
                let to = log.at(from.time_s + 0.02);
                let [a, b] = [from, to].map(|s| s.parts[0].velocity_world_m_s.xy());
                let turn_rad = a.perp(&b).atan2(a.dot(&b));
                0.5 * (a.norm() + b.norm()) * turn_rad / (to.time_s - from.time_s)
            });
            across_m_s2
                .max_by(f64::total_cmp)
                .map(|most_m_s2| most_m_s2 / (FRICTION * GRAVITY_M_S2))
        }),
        Unit::One,
        Tolerance::Relative(0.02),
    ))
}
