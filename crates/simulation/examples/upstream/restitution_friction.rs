//! Defect of Rapier: the speed along the floor after an oblique bounce differs from Coulomb's law.

use rapier3d_f64::prelude::*;

/// Speed along the floor after the bounce of a cube that falls flat from 0.3 m while it moves at 3 m/s along the floor, with
/// friction 0.3.
fn after(e: f64, hertz: f64, substeps: usize) -> f64 {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::new(0.0, 0.0, -9.81);
    let p = &mut world.integration_parameters;
    p.dt = 1.0 / hertz;
    p.num_solver_iterations = substeps;
    p.num_internal_stabilization_iterations = 0;
    p.normalized_prediction_distance = 0.002;
    p.friction_model = FrictionModel::Coulomb;
    let floor = ColliderBuilder::new(SharedShape::halfspace(Vector::Z)).friction(0.3);
    world.insert_collider(floor, None);
    let body = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.0, 0.33))
            .linvel(Vector::new(3.0, 0.0, 0.0))
            .can_sleep(false),
    );
    let cube = ColliderBuilder::cuboid(0.03, 0.03, 0.03)
        .mass(0.1)
        .friction(0.3)
        .restitution(e)
        .restitution_combine_rule(CoefficientCombineRule::Max);
    world.insert_collider(cube, Some(body));
    while world.bodies[body].linvel().z <= 0.0 && world.bodies[body].linvel().x > 0.01 {
        world.step();
    }
    world.bodies[body].linvel().x
}

pub fn main() {
    for e in [0.3, 0.5, 0.7] {
        let right = 3.0 - 0.3 * (1.0 + e) * f64::sqrt(2.0 * 9.81 * 0.3);
        for (hertz, substeps) in [(240.0, 4), (480.0, 3), (1920.0, 1)] {
            let x = after(e, hertz, substeps);
            let said = format!("{x:.3} m/s, Coulomb's law says {right:.3}");
            println!("e = {e}, 1/{hertz} s x {substeps}: {said}");
        }
    }
}
