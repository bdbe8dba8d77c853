//! Checks of energy and momentum in free motion: falling, tumbling, swinging and colliding.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{UnitQuaternion, Vector3};

use super::body::{
    ARM_M, BASE_HALF_M, MASS_KG, SIDE_M, STILL, arm, arm_inertia_kg_m2, cube, lopsided, module,
    no_servo, robot, tripod,
};
use super::check::{Check, Tolerance};
use super::film::{
    ABYSS_M, SimulationLog, at_rest, centre_world_m, largest, measure, moving, weightless,
};
use super::{Settings, centre, euler, pendulum, toss};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_simulation::{JointFormulation, Push, Snapshot};

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = vec![fall(settings)?];
    checks.extend(tumble(settings)?);
    checks.push(euler::check(settings)?);
    for &kind in settings.kinds() {
        checks.extend(swing(settings, kind)?);
        checks.push(pendulum::check(settings, kind)?);
        checks.extend(afloat(settings, kind)?);
    }
    checks.extend(collision(settings)?);
    checks.extend(centre::checks(settings)?);
    checks.extend(toss::checks(settings)?);
    Ok(checks)
}

fn fall(settings: &Settings) -> Result<Check> {
    let seconds = 0.5;
    let mut experiment = settings.experiment(cube(), seconds);
    experiment.floor.height_m = ABYSS_M;
    experiment.start = at_rest(Vector3::zeros(), UnitQuaternion::identity());
    let film = SimulationLog::record(&experiment, &[])?;
    let fallen = measure(film.as_ref(), |film| {
        let last = film.last();
        // The last step may end after the half second.
        let beyond = 0.5 * GRAVITY_M_S2 * (last.time_s.powi(2) - seconds * seconds);
        Some(-last.parts[0].centre_world_m.z - beyond)
    });
    Ok(Check::new(
        "energy.fall",
        "distance fallen in 0.5 s: g t^2 / 2",
        0.5 * GRAVITY_M_S2 * seconds * seconds,
        fallen,
        Unit::Metre,
        Tolerance::Relative(0.005),
    ))
}

/// A body without symmetry tumbles about its middle axis, where spin is unstable.
fn tumble(settings: &Settings) -> Result<[Check; 2]> {
    let mut experiment = weightless(settings.experiment(lopsided(), 5.0));
    experiment.start = moving(
        Vector3::zeros(),
        UnitQuaternion::identity(),
        Vector3::zeros(),
        Vector3::new(6.0, 6.0, 5.0),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    let spin_energy = |s: &Snapshot| {
        let part = &s.parts[0];
        let spin = part.angular_velocity_world_rad_s;
        0.5 * spin.dot(&(part.inertia_world_kg_m2 * spin))
    };
    let momentum =
        |s: &Snapshot| s.parts[0].inertia_world_kg_m2 * s.parts[0].angular_velocity_world_rad_s;
    Ok([
        Check::new(
            "energy.tumble.energy",
            "kinetic energy of a lopsided body after tumbling for 5 s at 10 rad/s, over the first: 1",
            1.0,
            measure(film.as_ref(), |film| {
                Some(spin_energy(film.last()) / spin_energy(film.first()))
            }),
            Unit::One,
            Tolerance::Relative(0.01),
        ),
        Check::new(
            "energy.tumble.angular_momentum",
            "largest change of its angular momentum vector, as a share: 0",
            0.0,
            measure(film.as_ref(), |film| {
                let start = momentum(film.first());
                Some(largest(
                    film.iter()
                        .map(|s| (momentum(s) - start).norm() / start.norm()),
                ))
            }),
            Unit::One,
            Tolerance::Absolute(0.01),
        ),
    ])
}

/// A module swings from the horizontal on a base that stands on the floor.
fn swing(settings: &Settings, kind: JointFormulation) -> Result<[Check; 3]> {
    let name = settings.joint_name(kind);
    let robot = arm(MASS_KG, Vector3::y(), no_servo(), STILL);
    let mut experiment = settings.experiment(robot, 10.0);
    experiment.solver.joint = kind;
    experiment.floor.friction = 1.0;
    experiment.start = at_rest(
        Vector3::new(0.0, 0.0, BASE_HALF_M),
        UnitQuaternion::identity(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    let small_s = TAU * (arm_inertia_kg_m2(MASS_KG) / (MASS_KG * GRAVITY_M_S2 * ARM_M)).sqrt();
    // 2 K(sin 45°) / π with the complete elliptic integral K.
    let expected_s = small_s * 1.180_340_599_016_096;
    // The hinge turns towards −z by a positive angle: it hangs at a quarter turn.
    let period = measure(film.as_ref(), |film| {
        let mut crossings = film.pairs().filter_map(|(a, b)| {
            let (before, after) = (
                a.hinges[0].angle_rad - FRAC_PI_2,
                b.hinges[0].angle_rad - FRAC_PI_2,
            );
            (before < 0.0 && after >= 0.0 && after - before < 1.0)
                .then(|| a.time_s + (b.time_s - a.time_s) * before / (before - after))
        });
        let first = crossings.next()?;
        Some(crossings.next()? - first)
    });
    let energy = |s: &Snapshot| {
        let arm = &s.parts[1];
        let hanging_m = s.parts[0].centre_world_m.z - ARM_M;
        arm.kinetic_energy_j() + arm.mass_kg * GRAVITY_M_S2 * (arm.centre_world_m.z - hanging_m)
    };
    Ok([
        Check::new(
            format!("energy.pendulum.period.{name}"),
            "first period of a module that swings from the horizontal: 1.18034 * 2 pi (I / m g r)^(1/2)",
            expected_s,
            period,
            Unit::Second,
            Tolerance::Relative(0.005),
        ),
        Check::new(
            format!("energy.pendulum.energy.{name}"),
            "its energy after 10 s (19 swings), over the first: 1",
            1.0,
            measure(film.as_ref(), |film| {
                Some(energy(film.last()) / energy(film.first()))
            }),
            Unit::One,
            Tolerance::Relative(0.02),
        ),
        Check::new(
            format!("structure.swing.opening.{name}"),
            "largest opening of the hinge during the same swings: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some(largest(film.iter().map(|s| s.hinges[0].opening_m)))
            }),
            Unit::Metre,
            Tolerance::Absolute(1e-4),
        ),
    ])
}

/// The tripod moves its servos in free space, where internal forces cannot change the total momentum.
fn afloat(settings: &Settings, kind: JointFormulation) -> Result<[Check; 2]> {
    let name = settings.joint_name(kind);
    let mut experiment = weightless(settings.experiment(tripod()?, 4.0));
    experiment.solver.joint = kind;
    experiment.start = at_rest(Vector3::zeros(), UnitQuaternion::identity());
    let film = SimulationLog::record(&experiment, &[])?;
    let total = |s: &Snapshot| -> Vector3<f64> {
        s.parts
            .iter()
            .map(|p| p.angular_momentum_world_kg_m2_s())
            .sum()
    };
    let moved = |s: &Snapshot| {
        s.parts
            .iter()
            .skip(1)
            .map(|p| (p.inertia_world_kg_m2 * p.angular_velocity_world_rad_s).norm())
            .sum::<f64>()
    };
    Ok([
        Check::new(
            format!("energy.afloat.drift.{name}"),
            "drift of the centre of mass of the tripod that moves its servos in free space for 4 s: 0",
            0.0,
            measure(film.as_ref(), |film| {
                Some((centre_world_m(film.last()) - centre_world_m(film.first())).norm())
            }),
            Unit::Metre,
            Tolerance::Absolute(1e-3),
        ),
        Check::new(
            format!("energy.afloat.angular_momentum.{name}"),
            "largest total angular momentum during the same motion, over the largest that its plates carry: 0",
            0.0,
            measure(film.as_ref(), |film| {
                let carried = largest(film.iter().map(moved));
                Some(largest(film.iter().map(|s| total(s).norm())) / carried)
            }),
            Unit::One,
            Tolerance::Absolute(0.05),
        ),
    ])
}

/// Two loose modules in free space: momentum for an off-centre hit, restitution for a central one.
fn collision(settings: &Settings) -> Result<Vec<Check>> {
    let speed_m_s = 1.0;
    let push = Push {
        part: 1,
        velocity_world_m_s: Vector3::new(-speed_m_s, 0.0, 0.0),
    };
    let film = |offset: f64, restitution: f64| -> Result<Option<SimulationLog>> {
        let pair = robot(
            vec![
                vec![module(0.0, 0.0, 0.0)],
                vec![module(1.5, offset, 0.3 * offset)],
            ],
            Vec::new(),
        );
        let mut experiment = weightless(settings.experiment(pair, 0.5));
        experiment.floor.restitution = restitution;
        experiment.floor.friction = 0.5;
        experiment.start = at_rest(Vector3::zeros(), UnitQuaternion::identity());
        SimulationLog::record(&experiment, &[push])
    };
    let oblique = film(0.6, 0.7)?;
    let momentum =
        |s: &Snapshot| -> Vector3<f64> { s.parts.iter().map(|p| p.momentum_world_kg_m_s()).sum() };
    let angular = |s: &Snapshot| -> Vector3<f64> {
        s.parts
            .iter()
            .map(|p| p.angular_momentum_world_kg_m2_s())
            .sum()
    };
    let change = |film: &SimulationLog, of: &dyn Fn(&Snapshot) -> Vector3<f64>, scale: f64| {
        // Without an impact there would be nothing to check.
        let hit = film.last().parts[0].velocity_world_m_s.norm() > 0.1 * speed_m_s;
        hit.then(|| (of(film.last()) - of(film.first())).norm() / scale)
    };
    let scale = MASS_KG * speed_m_s;
    let mut checks = vec![
        Check::new(
            "energy.collision.momentum",
            "change of momentum when a loose module hits another off centre, as a share: 0",
            0.0,
            measure(oblique.as_ref(), |film| change(film, &momentum, scale)),
            Unit::One,
            Tolerance::Absolute(0.001),
        ),
        Check::new(
            "energy.collision.angular_momentum",
            "change of angular momentum in the same hit, over m v s: 0",
            0.0,
            measure(oblique.as_ref(), |film| {
                change(film, &angular, scale * SIDE_M)
            }),
            Unit::One,
            Tolerance::Absolute(0.01),
        ),
    ];
    let restitution: f64 = 0.7;
    let central = film(0.0, restitution)?;
    checks.push(Check::new(
        "energy.collision.restitution",
        "speed of separation over speed of approach in a central hit of two modules: e^2, since e counts on both sides",
        restitution * restitution,
        measure(central.as_ref(), |film| {
            let parts = &film.last().parts;
            Some((parts[1].velocity_world_m_s.x - parts[0].velocity_world_m_s.x) / speed_m_s)
        }),
        Unit::One,
        Tolerance::Relative(0.025),
    ));
    let face_to_face = film(0.0, 0.7_f64.sqrt())?;
    checks.push(Check::new(
        "energy.collision.turn",
        "largest turn of two modules within half a second of meeting face to face at 1 m/s, e = 0.7: 0",
        0.0,
        measure(face_to_face.as_ref(), |film| {
            let turned = |part: usize| {
                let rotation = |s: &Snapshot| s.parts[part].world_from_part.rotation;
                rotation(film.first()).angle_to(&rotation(film.last()))
            };
            Some(turned(0).max(turned(1)))
        }),
        Unit::Radian,
        Tolerance::Absolute(0.1_f64.to_radians()),
    ));
    Ok(checks)
}
