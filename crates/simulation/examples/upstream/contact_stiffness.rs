//! Defect of Rapier: a cube on a light plate sinks deeper into the floor if the two are connected by a joint.

use rapier3d_f64::prelude::*;

/// Sag of a 100 g cube on a 12 g plate that is fixed to it, after 2 s on the floor, micrometres.
fn sag(multibody: bool, one_body: bool) -> f64 {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::new(0.0, 0.0, -9.81);
    let p = &mut world.integration_parameters;
    p.dt = 1.0 / 960.0;
    p.num_solver_iterations = 8;
    p.num_internal_stabilization_iterations = 0;
    p.static_contact_softness = SpringCoefficients::new(60.0, 10.0);
    world.insert_collider(
        ColliderBuilder::new(SharedShape::halfspace(Vector::Z)),
        None,
    );
    let slab = |half: Vector, mass| ColliderBuilder::cuboid(half.x, half.y, half.z).mass(mass);
    let plate = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.0, 0.003))
            .can_sleep(false),
    );
    world.insert_collider(slab(Vector::new(0.03, 0.03, 0.003), 0.012), Some(plate));
    let cube_half = Vector::splat(0.03);
    if one_body {
        let above = Vector::new(0.0, 0.0, 0.033);
        world.insert_collider(slab(cube_half, 0.1).translation(above), Some(plate));
    } else {
        let cube = world.bodies.insert(
            RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.0, 0.0, 0.036))
                .can_sleep(false),
        );
        world.insert_collider(slab(cube_half, 0.1), Some(cube));
        let joint = FixedJointBuilder::new()
            .local_anchor1(Vector::new(0.0, 0.0, 0.033))
            .contacts_enabled(false);
        if multibody {
            world.multibody_joints.insert(plate, cube, joint, true);
        } else {
            world.impulse_joints.insert(plate, cube, joint, true);
        }
    }
    for _ in 0..1920 {
        world.step();
    }
    (0.003 - world.bodies[plate].translation().z) * 1e6
}

pub fn main() {
    println!("one body          {:6.1} micrometres", sag(false, true));
    println!("multibody joint   {:6.1} micrometres", sag(true, false));
    println!("impulse joint     {:6.1} micrometres", sag(false, false));
}
