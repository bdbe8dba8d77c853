//! Defect of Rapier: the centre of mass of two hinged bodies drifts while they tumble freely.

use rapier3d_f64::prelude::*;

/// Drift of the centre of mass of two hinged bodies that tumble freely, without gravity, in 0.6 s.
fn drift(root_centre: Vector) -> f64 {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::ZERO;
    world.integration_parameters.dt = 1.0 / 240.0;
    let part = |centre: Vector| {
        RigidBodyBuilder::dynamic()
            .additional_mass_properties(MassProperties::new(centre, 0.1, Vector::splat(6.0e-5)))
            .can_sleep(false)
    };
    let root = world.bodies.insert(part(root_centre));
    let link = world
        .bodies
        .insert(part(Vector::ZERO).translation(Vector::new(0.0, 0.0, 0.1)));
    let hinge = RevoluteJointBuilder::new(Vector::Z).local_anchor1(Vector::new(0.0, 0.0, 0.1));
    world.multibody_joints.insert(root, link, hinge, true);
    // A multibody reads velocities from its generalized coordinates.
    let id = world
        .multibody_joints
        .rigid_body_link(root)
        .unwrap()
        .multibody;
    let multibody = world.multibody_joints.get_multibody_mut(id).unwrap();
    multibody.damping_mut().fill(0.0);
    for (row, value) in [0.0, 0.0, 0.0, 6.0, 6.0, 5.0].into_iter().enumerate() {
        multibody.generalized_velocity_mut()[row] = value;
    }
    let centre = |world: &PhysicsWorld| {
        0.5 * (world.bodies[root].center_of_mass() + world.bodies[link].center_of_mass())
    };
    world.step();
    let (first, t0) = (centre(&world), 1.0 / 240.0);
    world.step();
    let velocity = (centre(&world) - first) / t0;
    let mut worst = 0.0_f64;
    for step in 2..144 {
        world.step();
        let straight = first + velocity * (t0 * step as f64);
        worst = worst.max((centre(&world) - straight).length());
    }
    worst
}

pub fn main() {
    for x in [0.0, 0.03] {
        let drift_m = drift(Vector::new(x, 0.0, 0.0));
        println!("root's centre of mass {x} m off its origin: drift {drift_m:.6} m");
    }
}
