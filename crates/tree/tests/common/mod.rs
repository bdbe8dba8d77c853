//! Models and helper functions that the tests share.
#![allow(dead_code, clippy::unwrap_used)]

use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{
    Attachment, Collider, Command, Fixture, Joint, JointType, Link, Model, Settings, World,
};

pub const G: f64 = 9.81;

/// Inertia of a solid box.
pub fn box_inertia(mass_kg: f64, size_m: Vec3) -> Mat3 {
    let s = size_m * size_m;
    Mat3::from_diagonal(Vec3::new(s.y + s.z, s.x + s.z, s.x + s.y) * (mass_kg / 12.0))
}

/// A free box of this size.
pub fn block(mass_kg: f64, size_m: Vec3, friction: f64, pose: Pose) -> Link {
    let half = size_m * 0.5;
    Link {
        attachment: Attachment::Free {
            world_from_link: pose,
        },
        mass_kg,
        centre_link_m: Vec3::ZERO,
        inertia_link_kg_m2: box_inertia(mass_kg, size_m),
        compensated: (0.0, Vec3::ZERO),
        colliders: vec![Collider::new(
            SharedShape::cuboid(half.x, half.y, half.z),
            friction,
        )],
    }
}

pub fn cube(friction: f64, pose: Pose) -> Link {
    block(0.1, Vec3::splat(0.06), friction, pose)
}

/// A half-space below z = 0.
pub fn floor() -> Fixture {
    tilted(0.0)
}

/// A half-space that slopes down towards +x.
pub fn tilted(angle_rad: f64) -> Fixture {
    let turn = Rot3::from_rotation_y(angle_rad);
    Fixture::at_rest(
        Collider {
            restitution: 1.0,
            ..Collider::new(SharedShape::halfspace(Vec3::Z), 1.0)
        },
        Pose::from_parts(Vec3::ZERO, turn),
    )
}

pub fn model(links: Vec<Link>, fixtures: Vec<Fixture>, steps_1_s: f64) -> Model {
    Model {
        gravity_world_m_s2: Vec3::new(0.0, 0.0, -G),
        links,
        fixtures,
        collision_exclude: Vec::new(),
        settings: Settings {
            timestep_s: 1.0 / steps_1_s,
            ..Settings::default()
        },
    }
}

pub fn world(links: Vec<Link>, fixtures: Vec<Fixture>) -> World {
    World::new(&model(links, fixtures, 960.0)).unwrap()
}

pub fn run(world: &mut World, time_s: f64) {
    let steps = (time_s / world.settings().timestep_s).round() as usize;
    for _ in 0..steps {
        world.step();
    }
}

pub fn energy(world: &World) -> f64 {
    world.kinetic_energy_j() + world.potential_energy_j() + world.spring_energy_j()
}

pub fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::translation(x, y, z)
}

/// A uniform rod of length 1 m and mass 1 kg along −z from its joint.
pub fn rod(attachment: Attachment) -> Link {
    Link {
        attachment,
        mass_kg: 1.0,
        centre_link_m: Vec3::new(0.0, 0.0, -0.5),
        inertia_link_kg_m2: Mat3::from_diagonal(Vec3::new(1.0 / 12.0, 1.0 / 12.0, 1e-4)),
        compensated: (0.0, Vec3::ZERO),
        colliders: Vec::new(),
    }
}

pub fn mount() -> Link {
    Link {
        attachment: Attachment::Mounted {
            world_from_link: Pose::identity(),
        },
        mass_kg: 0.0,
        centre_link_m: Vec3::ZERO,
        inertia_link_kg_m2: Mat3::ZERO,
        compensated: (0.0, Vec3::ZERO),
        colliders: Vec::new(),
    }
}

/// A hinge about y at this point of the parent, at the child's origin.
pub fn hinge_y(parent: usize, x: f64, y: f64, z: f64) -> Joint {
    Joint {
        parent_from_joint: at(x, y, z),
        ..Joint::new(parent, JointType::Continuous, Vec3::Y)
    }
}

/// A cube on a plate that turns about z, like a module of a robot: the plate is below, and its lower face is at z = `above_m`.
pub fn cube_on_plate(friction: f64, restitution: f64, above_m: f64) -> Vec<Link> {
    let thickness_m = 0.006;
    let mut body = block(
        0.068,
        Vec3::splat(0.058),
        friction,
        at(0.0, 0.0, above_m + thickness_m + 0.029),
    );
    let plate_size = Vec3::new(0.058, 0.058, thickness_m);
    let mut plate = block(0.012, plate_size, friction, Pose::identity());
    plate.attachment = Attachment::Joint(Joint {
        parent_from_joint: at(0.0, 0.0, -0.029 - 0.5 * thickness_m),
        ..Joint::new(0, JointType::Continuous, Vec3::Z)
    });
    body.colliders[0].restitution = restitution;
    plate.colliders[0].restitution = restitution;
    vec![body, plate]
}

pub fn hold(target: f64) -> Command {
    Command::Servo {
        target,
        stiffness: 30.0,
        damping: 1.0,
        max_torque: 0.2,
    }
}
