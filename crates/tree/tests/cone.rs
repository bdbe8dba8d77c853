//! Tests of the relaxed friction cone against the equations of Anitescu and Todorov.
#![allow(clippy::unwrap_used)]

use super::common::*;
use realgap_tree::parry::math::Vec3;
use realgap_tree::{Cone, World};

const OMEGA_1_S: f64 = 500.0;
const STEPS_1_S: f64 = 2000.0;
const FRICTION: f64 = 0.4;

/// A cube of 6 cm that penetrates the floor by this depth, with this speed.
fn slider(cone: Cone, depth_m: f64, speed_m_s: f64) -> World {
    let pose = at(0.0, 0.0, 0.03 - depth_m);
    let mut model = model(vec![cube(FRICTION, pose)], vec![floor()], STEPS_1_S);
    let settings = &mut model.settings;
    (settings.cone, settings.contact_damping_ratio) = (cone, 1.0);
    settings.contact_frequency_hz = OMEGA_1_S / std::f64::consts::TAU;
    let mut world = World::new(&model).unwrap();
    world.set_root(0, pose, Vec3::X * speed_m_s, Vec3::ZERO);
    world
}

/// Fraction of a velocity that an implicit step of the spring and damper removes.
fn taken() -> f64 {
    let turn = OMEGA_1_S / STEPS_1_S;
    1.0 - 1.0 / (1.0 + turn * (turn + 2.0))
}

/// Compliance of the rows as a fraction of their inverse mass: an impedance of 0.97.
const GIVES: f64 = 0.03;

#[test]
fn a_resting_cube_penetrates_as_deep_as_compliant_rows_require() {
    let mut world = slider(Cone::Relaxed, 0.0, 0.0);
    run(&mut world, 1.0);
    let depth_m = 0.03 - world.link(0).centre_world_m.z;
    let right_m = GIVES * G / (OMEGA_1_S.powi(2) * (1.0 - taken()));
    assert!(
        (depth_m / right_m - 1.0).abs() < 0.01,
        "{depth_m} {right_m}"
    );
}

#[test]
fn a_sliding_cube_is_lifted_by_friction_times_the_slip_that_a_step_removes() {
    let (depth_m, speed_m_s) = (1e-9, 1.0);
    let vertical = |cone| {
        let mut world = slider(cone, depth_m, speed_m_s);
        world.step();
        world.link(0).velocity_world_m_s.z
    };
    // The normal row: v + GIVES (v + g h) = µ (taken · speed - µ (v + g h)); in the first step gravity acts for half of the step.
    let fallen_m_s = 0.5 * G / STEPS_1_S;
    let give = FRICTION.powi(2) + GIVES;
    let right_m_s = (FRICTION * taken() * speed_m_s - give * fallen_m_s) / (1.0 + give);
    let found_m_s = vertical(Cone::Relaxed);
    assert!(
        (found_m_s / right_m_s - 1.0).abs() < 0.01,
        "{found_m_s} {right_m_s}"
    );
    assert!(vertical(Cone::Exact).abs() < 0.02 * right_m_s);
}

#[test]
fn a_hopping_cube_slides_as_far_as_coulomb_friction_predicts() {
    let share = |cone| {
        let mut world = slider(cone, 0.0, 1.0);
        let (mut touching, mut steps) = (0, 0);
        while world.link(0).velocity_world_m_s.x > 0.2 {
            world.step();
            steps += 1;
            touching += usize::from(world.contacts().any(|c| c.impulse_world_n_s.z > 0.0));
        }
        let far_m = world.link(0).centre_world_m.x;
        let right_m = (1.0 - 0.2_f64.powi(2)) / (2.0 * FRICTION * G);
        assert!(
            (far_m / right_m - 1.0).abs() < 0.05,
            "{cone:?}: {far_m} {right_m}"
        );
        f64::from(touching as u32) / f64::from(steps)
    };
    let [exact, relaxed] = [Cone::Exact, Cone::Relaxed].map(share);
    println!("in touch: {exact:.2} and {relaxed:.2} of the time");
    assert!(exact > 0.99 && relaxed < 0.9);
}
