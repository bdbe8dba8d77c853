//! Which numbers a robot's file states of a joint, a servo, a body, and under which names.

use nalgebra::{Matrix3, Vector3};

use super::super::assembly::{Assembly, ClusterMass, Freedom, Gait, Hinge, Role, Servo};
use super::super::body::{Body, Surroundings, Tensor};
use super::super::command_scale::CommandScale;
use super::super::law::ServoLaw;
use super::super::module::Module;
use super::super::tyre::Tyre;
use super::super::{Morphology, Shape};
use super::Stated;

/// Numbers before and after a change, by the path of their field.
type Numbers = Vec<(String, Stated, Stated)>;
/// Numbers by the path of their field.
type Named = Vec<(&'static str, f64)>;

/// Smallest relative difference of an inertia that is one: below it, it is that which follows from the mass.
const ROUNDING: f64 = 1e-12;

/// Pairs of the same number before and after; a servo of another law has no common numbers.
fn pairs(prefix: &str, old: Named, new: Named) -> Numbers {
    let both = old.into_iter().zip(new).filter(|(old, new)| old.0 == new.0);
    let named = both.map(|((name, from), (_, to))| {
        (
            format!("{prefix}{name}"),
            Stated::Number(from),
            Stated::Number(to),
        )
    });
    named.collect()
}

/// Passive properties of a joint. The file of a modular robot states no armature.
pub(super) fn drive(old: &Hinge, new: &Hinge, is_of_bodies: bool) -> Numbers {
    let names = match (is_of_bodies, old.freedom) {
        (false, _) => ["viscous_nm_s_rad", "dry_nm", ""],
        (true, Freedom::Turn) => ["viscous_nm_s_rad", "dry_nm", "armature_kg_m2"],
        (true, Freedom::Slide) => ["viscous_n_s_m", "dry_n", "armature_kg"],
    };
    let named = |hinge: &Hinge| -> Named {
        let bearing = &hinge.bearing;
        let numbers = [
            bearing.viscous_nm_s_rad,
            bearing.dry_nm,
            bearing.armature_kg_m2,
        ];
        names
            .into_iter()
            .zip(numbers)
            .filter(|(name, _)| !name.is_empty())
            .collect()
    };
    pairs(
        if is_of_bodies { "kind." } else { "" },
        named(old),
        named(new),
    )
}

pub(super) fn servo(old: &Servo, new: &Servo) -> Numbers {
    let named = |servo: &Servo| -> Named {
        let limits = [
            ("max_torque_nm", servo.max_torque_nm),
            ("max_speed_rad_s", servo.max_speed_rad_s),
            ("delay_s", servo.delay_s),
        ];
        limits.into_iter().chain(law(&servo.law)).collect()
    };
    pairs("servo.", named(old), named(new))
}

fn law(law: &ServoLaw) -> Named {
    match law {
        ServoLaw::Velocity { gain_per_s } => vec![("law.gain_1_s", *gain_per_s)],
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => vec![
            ("law.stiffness_nm_rad", *stiffness_nm_rad),
            ("law.damping_nm_s_rad", *damping_nm_s_rad),
        ],
        ServoLaw::Motor(motor) => {
            let friction = &motor.friction;
            vec![
                ("law.position_gain", motor.position_gain),
                ("law.duty_1_rad", motor.duty_1_rad),
                ("law.supply_v", motor.supply_v),
                ("law.torque_constant_nm_a", motor.torque_constant_nm_a),
                ("law.resistance_ohm", motor.resistance_ohm),
                ("law.ripple_ohm", motor.ripple_ohm),
                ("law.armature_kg_m2", motor.armature_kg_m2),
                ("law.slew_1_s", motor.slew_1_s),
                ("law.friction.dry_nm", friction.dry_nm),
                ("law.friction.viscous_nm_s_rad", friction.viscous_nm_s_rad),
                ("law.friction.stribeck_nm", friction.stribeck_nm),
                (
                    "law.friction.stribeck_speed_rad_s",
                    friction.stribeck_speed_rad_s,
                ),
                ("law.friction.stribeck_shape", friction.stribeck_shape),
                ("law.friction.motor_load", friction.motor_load),
                ("law.friction.output_load", friction.output_load),
                ("law.friction.stribeck_load", friction.stribeck_load),
                ("law.friction.quadratic_1_nm", friction.quadratic_1_nm),
            ]
        }
        ServoLaw::Direct | ServoLaw::Throttle => Vec::new(),
    }
}

pub(super) fn gait(old: &Gait, new: &Gait) -> Numbers {
    let named = |gait: &Gait| {
        vec![
            ("offset_rad", gait.offset_rad),
            ("amplitude_rad", gait.amplitude_rad),
            ("frequency_hz", gait.frequency_hz),
            ("phase_rad", gait.phase_rad),
        ]
    };
    pairs("gait.", named(old), named(new))
}

pub(super) fn command(old: &CommandScale, new: &CommandScale) -> Numbers {
    let named = |scale: &CommandScale| {
        vec![
            ("factor", scale.factor),
            ("offset", scale.offset),
            ("dead_zone", scale.dead_zone),
            ("bend", scale.bend),
            ("ackermann", scale.ackermann),
            ("delay_s", scale.delay_s),
            ("lag_s", scale.lag_s),
        ]
    };
    pairs("command.", named(old), named(new))
}

pub(super) fn tyre(old: &Tyre, new: &Tyre) -> Numbers {
    let named = |tyre: &Tyre| {
        vec![
            ("slip_stiffness_1_rad", tyre.slip_stiffness_1_rad),
            ("shape", tyre.shape),
        ]
    };
    pairs("", named(old), named(new))
}

/// What surrounds a robot, where the changed one states it.
pub(super) fn world(old: &Surroundings, new: &Surroundings) -> Numbers {
    let named = |world: &Surroundings| {
        [
            ("gravity_m_s2", world.gravity_m_s2),
            ("floor_friction", world.floor_friction),
            ("floor_rolling_m", world.floor_rolling_m),
            ("floor_torsional_m", world.floor_torsional_m),
            ("floor_height_m", world.floor_height_m),
            ("floor_slope_rad", world.floor_slope_rad),
        ]
    };
    let both = named(old).into_iter().zip(named(new));
    let stated = both.filter_map(|((name, from), (_, to))| {
        // A number that the file leaves out differs from every number.
        let from = from.unwrap_or(f64::NAN);
        Some((name.to_owned(), Stated::Number(from), Stated::Number(to?)))
    });
    stated.collect()
}

/// Mass properties of a module or a body in its own frame, without its plate.
pub(super) fn mass_of_module(
    robot: &Morphology,
    assembly: &Assembly,
    module: usize,
) -> ClusterMass {
    let all = assembly.parts.iter().flat_map(|part| &part.solids);
    let own = all.filter(|solid| solid.module == module && solid.role == Role::Cube);
    let boxes = match robot.structure() {
        None => robot.modules[module].solid_boxes(),
        Some(_) => Vec::new(),
    };
    // The solid that carries the mass of a body has no shape, and the body's frame.
    let own = own.filter(|solid| robot.structure().is_none() || solid.shape == Shape::Nothing);
    let pieces = own.map(|solid| {
        let centre_m = boxes
            .get(solid.number)
            .map_or(Vector3::zeros(), |part| part.centre_m);
        (
            solid.mass_kg,
            centre_m + solid.centre_of_mass_solid_m,
            solid.inertia_kg_m2,
        )
    });
    together(&pieces.collect::<Vec<_>>())
}

/// Mass properties of pieces with axes in common.
fn together(pieces: &[(f64, Vector3<f64>, Matrix3<f64>)]) -> ClusterMass {
    if let [(mass_kg, centre_m, inertia_kg_m2)] = pieces {
        return ClusterMass {
            mass_kg: *mass_kg,
            centre_m: *centre_m,
            inertia_kg_m2: *inertia_kg_m2,
        };
    }
    let mass_kg: f64 = pieces.iter().map(|(kg, ..)| kg).sum();
    let moment: Vector3<f64> = pieces.iter().map(|(kg, at_m, _)| at_m * *kg).sum();
    let centre_m = moment / mass_kg;
    let about = pieces.iter().map(|(kg, at_m, own)| {
        let d = at_m - centre_m;
        own + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * *kg
    });
    ClusterMass {
        mass_kg,
        centre_m,
        inertia_kg_m2: about.sum(),
    }
}

fn is_same(a: &Matrix3<f64>, b: &Matrix3<f64>) -> bool {
    (a - b).norm() <= ROUNDING * b.norm()
}

fn triple(vector: &Vector3<f64>) -> Stated {
    Stated::Triple([vector.x, vector.y, vector.z])
}

/// Mass and centre of mass; a centre only where it has moved by more than rounding.
fn weight(old: &ClusterMass, new: &ClusterMass) -> Numbers {
    let mut numbers = vec![(
        "mass_kg".to_owned(),
        Stated::Number(old.mass_kg),
        Stated::Number(new.mass_kg),
    )];
    let size_m = (old.inertia_kg_m2.trace() / old.mass_kg.max(f64::MIN_POSITIVE)).sqrt();
    if (new.centre_m - old.centre_m).norm() > ROUNDING * size_m {
        numbers.push((
            "centre_of_mass_m".to_owned(),
            triple(&old.centre_m),
            triple(&new.centre_m),
        ));
    }
    numbers
}

/// Numbers of a body.
pub(super) fn mass_of_body(body: &Body, old: &ClusterMass, new: &ClusterMass) -> Numbers {
    let mut numbers = weight(old, new);
    let follows = match body.inertia_kg_m2 {
        Some(tensor) => tensor.matrix(),
        None => old.inertia_kg_m2 * (new.mass_kg / old.mass_kg),
    };
    if !is_same(&new.inertia_kg_m2, &follows) {
        let tensor = |matrix: &Matrix3<f64>| {
            let Tensor {
                xx,
                yy,
                zz,
                xy,
                xz,
                yz,
            } = Tensor::of(matrix);
            Stated::Tensor([xx, yy, zz, xy, xz, yz])
        };
        let field = "inertia_kg_m2".to_owned();
        numbers.push((
            field,
            tensor(&old.inertia_kg_m2),
            tensor(&new.inertia_kg_m2),
        ));
    }
    numbers
}

/// Numbers of a module.
pub(super) fn mass(module: &Module, old: &ClusterMass, new: &ClusterMass) -> Numbers {
    let mut numbers = weight(old, new);
    let has_moved = numbers.len() > 1;
    let with_mass = Module {
        mass_kg: new.mass_kg,
        centre_of_mass_m: if has_moved {
            Some(new.centre_m)
        } else {
            module.centre_of_mass_m
        },
        ..module.clone()
    };
    let follows = together(&with_mass.box_masses()).inertia_kg_m2;
    let diagonal = new.inertia_kg_m2.diagonal();
    // The file of a module states moments along its axes only.
    if !is_same(&new.inertia_kg_m2, &follows)
        && is_same(&Matrix3::from_diagonal(&diagonal), &new.inertia_kg_m2)
    {
        let field = "inertia_kg_m2".to_owned();
        numbers.push((
            field,
            triple(&old.inertia_kg_m2.diagonal()),
            triple(&diagonal),
        ));
    }
    numbers
}
