//! Defect of Rapier: the height and the rotation of the bounce of a cube that falls flat are wrong.

use rapier3d_f64::prelude::*;

/// First bounce of a cube that falls flat from 0.1 m: height over e^2 h, rate of turn after it.
fn bounce(e: f64, substeps: usize) -> (f64, f64) {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::new(0.0, 0.0, -9.81);
    let p = &mut world.integration_parameters;
    p.dt = 1.0 / 240.0;
    p.num_solver_iterations = substeps;
    p.num_internal_stabilization_iterations = 0;
    p.normalized_prediction_distance = 0.002;
    p.friction_model = FrictionModel::Coulomb;
    let rule = CoefficientCombineRule::Max;
    let floor = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
        .restitution(0.0)
        .friction(0.0);
    world.insert_collider(floor, None);
    let body = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.0, 0.13))
            .can_sleep(false),
    );
    let cube = ColliderBuilder::cuboid(0.03, 0.03, 0.03)
        .mass(0.1)
        .friction(0.0);
    world.insert_collider(
        cube.restitution(e).restitution_combine_rule(rule),
        Some(body),
    );
    let (mut hit, mut top, mut spin) = (false, 0.0_f64, 0.0);
    for _ in 0..240 {
        world.step();
        let b = &world.bodies[body];
        if !hit && b.linvel().z > 0.0 {
            (hit, spin) = (true, b.angvel().length());
        }
        if hit {
            top = top.max(b.translation().z - 0.03);
            if b.linvel().z < 0.0 {
                break;
            }
        }
    }
    (top / (e * e * 0.1), spin)
}

pub fn main() {
    for e in [0.3, 0.5, 0.8] {
        for substeps in [4, 8, 32] {
            let (share, spin) = bounce(e, substeps);
            println!(
                "e = {e}, {substeps:2} substeps: {share:.3} of the height, turns at {spin:.2} rad/s"
            );
        }
    }
}
