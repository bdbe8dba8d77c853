//! Defect of Rapier: sliding boxes stop at wrong positions, because friction is not opposite to the slip.

use rapier3d_f64::prelude::*;

/// Position at which a box stops that slides at 0.6 m/s along +x with friction 0.5.
fn stop(half: Vector, yaw: f64) -> Vector {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::new(0.0, 0.0, -9.81);
    let p = &mut world.integration_parameters;
    p.dt = 1.0 / 240.0;
    p.num_solver_iterations = 16;
    p.num_internal_stabilization_iterations = 0;
    p.friction_model = FrictionModel::Coulomb;
    world.insert_collider(
        ColliderBuilder::new(SharedShape::halfspace(Vector::Z)).friction(0.5),
        None,
    );
    let body = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.0, half.z))
            .rotation(Vector::new(0.0, 0.0, yaw))
            .linvel(Vector::new(0.6, 0.0, 0.0))
            .can_sleep(false),
    );
    let collider = ColliderBuilder::cuboid(half.x, half.y, half.z)
        .mass(0.1)
        .friction(0.5);
    world.insert_collider(collider, Some(body));
    for _ in 0..120 {
        world.step();
    }
    world.bodies[body].translation()
}

pub fn main() {
    let expected = 0.6 * 0.6 / (2.0 * 0.5 * 9.81);
    for (name, half) in [
        ("cube", Vector::splat(0.03)),
        ("bar", Vector::new(0.12, 0.03, 0.03)),
    ] {
        for yaw in [0.0, 0.35, 0.79] {
            let end = stop(half, yaw);
            let (along, across) = (end.x / expected, end.y / expected);
            println!("{name} at {yaw} rad: {along:.3} of v^2/2 mu g along, {across:+.3} across");
        }
    }
}
