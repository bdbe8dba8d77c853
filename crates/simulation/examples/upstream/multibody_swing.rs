//! Defect of Rapier: a double pendulum of multibody joints does not conserve its energy.

use rapier3d_f64::prelude::*;

/// Fraction of its swing energy that a double pendulum of two 20 cm rods conserves in 10 s.
fn kept(hertz: f64, substeps: usize) -> f64 {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::new(0.0, 0.0, -9.81);
    let p = &mut world.integration_parameters;
    p.dt = 1.0 / hertz;
    p.num_solver_iterations = substeps;
    p.num_internal_stabilization_iterations = 0;
    // Both rods stretched out to one side, at rest.
    let mut above = world.bodies.insert(RigidBodyBuilder::fixed());
    let mut rods = Vec::new();
    for number in 0..2 {
        let x = 0.1 + 0.2 * f64::from(number);
        let rod = world.bodies.insert(
            RigidBodyBuilder::dynamic()
                .translation(Vector::new(x, 0.0, 0.0))
                .can_sleep(false),
        );
        let solid = ColliderBuilder::cuboid(0.1, 0.01, 0.01).mass(0.1);
        let silent = solid.collision_groups(InteractionGroups::none());
        world.insert_collider(silent, Some(rod));
        let anchor = if number == 0 { 0.0 } else { 0.1 };
        let joint = RevoluteJointBuilder::new(Vector::Y)
            .local_anchor1(Vector::new(anchor, 0.0, 0.0))
            .local_anchor2(Vector::new(-0.1, 0.0, 0.0));
        world.multibody_joints.insert(above, rod, joint, true);
        rods.push(rod);
        above = rod;
    }
    if let Some(link) = world.multibody_joints.rigid_body_link(rods[0]).copied()
        && let Some(multibody) = world.multibody_joints.get_multibody_mut(link.multibody)
    {
        multibody.damping_mut().fill(0.0);
    }
    let lowest = -0.1 * 9.81 * (0.1 + 0.3);
    let energy = |world: &PhysicsWorld| -> f64 {
        let of = |rod: &RigidBodyHandle| {
            let body = &world.bodies[*rod];
            body.kinetic_energy() + 0.1 * 9.81 * body.center_of_mass().z
        };
        rods.iter().map(of).sum::<f64>() - lowest
    };
    world.step();
    let first = energy(&world);
    for _ in 0..(10.0 * hertz) as usize {
        world.step();
    }
    energy(&world) / first
}

pub fn main() {
    for (hertz, substeps) in [
        (480.0, 1),
        (480.0, 3),
        (480.0, 12),
        (1920.0, 1),
        (1920.0, 3),
    ] {
        println!("1/{hertz} s x {substeps}: {:.3}", kept(hertz, substeps));
    }
}
