//! Roots that are led along a motion, against closed forms.

use std::f64::consts::TAU;

use super::common::*;
use realgap_tree::parry::math::{Pose, Vec3};
use realgap_tree::{Attachment, Command, Joint, JointType, Link, World};

const ARM_M: f64 = 0.2;

/// A bob of 0.5 kg below a hinge about y at the origin of the root.
fn pendulum(mut root: Link, gravity_m_s2: f64, steps_1_s: f64) -> World {
    let mut bob = cube(0.5, Pose::identity());
    (bob.mass_kg, bob.centre_link_m) = (0.5, Vec3::Z * -ARM_M);
    bob.inertia_link_kg_m2 = box_inertia(0.5, Vec3::splat(0.06));
    bob.colliders.clear();
    bob.attachment = Attachment::Joint(Joint::new(0, JointType::Continuous, Vec3::Y));
    root.colliders.clear();
    let mut model = model(vec![root, bob], vec![], steps_1_s);
    model.gravity_world_m_s2 = Vec3::Z * -gravity_m_s2;
    World::new(&model).unwrap()
}

/// Angles after every step while the root follows a path along x.
fn led(mut world: World, path_m: impl Fn(f64) -> f64, start_m_s: f64, time_s: f64) -> Vec<f64> {
    let step_s = world.settings().timestep_s;
    world.start_led(0, Vec3::X * start_m_s, Vec3::ZERO);
    let steps = (time_s / step_s).round() as usize;
    (0..steps)
        .map(|k| {
            let next_m = path_m((k + 1) as f64 * step_s);
            let here_m = world.link(0).world_from_link.translation.x;
            world.lead_root(0, Vec3::X * ((next_m - here_m) / step_s), Vec3::ZERO);
            world.step();
            assert!((world.link(0).world_from_link.translation.x - next_m).abs() < 1e-12);
            world.joint(1).0
        })
        .collect()
}

#[test]
fn a_pendulum_under_a_pivot_that_accelerates_hangs_at_the_angle_of_both_accelerations() {
    // Released at rest, the angle swings about atan(a / g), with the period of a pendulum in the larger gravity.
    let a = 2.0;
    let mut world = pendulum(mount(), G, 1920.0);
    let hangs_rad = (a / G).atan();
    world.set_joint(1, hangs_rad, 0.0);
    let angles = led(world, |t| 0.5 * a * t * t, 0.0, 3.0);
    let off = angles
        .iter()
        .fold(0.0_f64, |most, angle| most.max((angle - hangs_rad).abs()));
    assert!(off < 1e-4, "{off} {hangs_rad}");
    // From straight down it swings to twice that angle and back.
    let angles = led(pendulum(mount(), G, 1920.0), |t| 0.5 * a * t * t, 0.0, 3.0);
    let most = angles.iter().fold(0.0_f64, |most, angle| most.max(*angle));
    assert!((most / (2.0 * hangs_rad) - 1.0).abs() < 1e-3, "{most}");
    assert!(angles.iter().all(|angle| *angle > -1e-3), "{angles:?}");
}

#[test]
fn a_pendulum_under_a_shaken_pivot_answers_with_its_transfer_function_and_twice_the_shake_is_twice_the_answer()
 {
    // Small angles: (I + m l^2) q'' + c q' + m g l q = m l x'' for a pivot at x, whose steady answer to a sine is known.
    let (mass_kg, shake_1_s, viscous) = (0.5, TAU * 1.7, 0.02);
    let inertia = box_inertia(mass_kg, Vec3::splat(0.06)).y_axis.y + mass_kg * ARM_M * ARM_M;
    let swing = |far_m: f64| {
        let mut world = pendulum(mount(), G, 1920.0);
        world.set_friction(1, 0.0, viscous);
        let path_m = |t: f64| far_m * (shake_1_s * t).sin();
        let angles = led(world, path_m, far_m * shake_1_s, 20.0);
        let last = &angles[angles.len() - 3840..];
        last.iter()
            .fold(0.0_f64, |most, angle| most.max(angle.abs()))
    };
    let lever = mass_kg * ARM_M * shake_1_s.powi(2);
    let stiff = mass_kg * G * ARM_M - inertia * shake_1_s.powi(2);
    let expected = |far_m: f64| lever * far_m / stiff.hypot(viscous * shake_1_s);
    let (once, twice) = (swing(1e-3), swing(2e-3));
    assert!(
        (once / expected(1e-3) - 1.0).abs() < 2e-3,
        "{once} {}",
        expected(1e-3)
    );
    assert!((twice / once - 2.0).abs() < 2e-3, "{once} {twice}");
}

#[test]
fn on_a_root_that_turns_a_bob_is_thrown_outwards_and_its_own_inertia_resists_the_turn() {
    // A bob without gravity on a root that turns steadily about z, the hinge beside that axis: it swings about the outward direction like a
    // pendulum in the field w^2 r. At rest outwards it stays.
    let (beside_m, spin) = (0.3, 6.0);
    let mut world = {
        let mut bob = cube(0.5, Pose::identity());
        (bob.mass_kg, bob.centre_link_m) = (0.5, Vec3::X * ARM_M);
        bob.colliders.clear();
        let mut joint = Joint::new(0, JointType::Continuous, Vec3::Z);
        joint.parent_from_joint = at(beside_m, 0.0, 0.0);
        bob.attachment = Attachment::Joint(joint);
        let mut model = model(vec![mount(), bob], vec![], 3840.0);
        model.gravity_world_m_s2 = Vec3::ZERO;
        World::new(&model).unwrap()
    };
    world.set_joint(1, 0.02, 0.0);
    world.start_led(0, Vec3::ZERO, Vec3::Z * spin);
    let inertia = box_inertia(0.1, Vec3::splat(0.06)).y_axis.y + 0.5 * ARM_M * ARM_M;
    let expected_s = TAU / (0.5 * ARM_M * beside_m * spin * spin / inertia).sqrt();
    let step_s = world.settings().timestep_s;
    let mut crossings = Vec::new();
    let mut before = 0.02;
    for k in 0..(4.0 / step_s) as usize {
        world.step();
        let now = world.joint(1).0;
        if before > 0.0 && now <= 0.0 {
            crossings.push(step_s * (k as f64 + before / (before - now)));
        }
        before = now;
    }
    let periods = crossings.len() - 1;
    let period_s = (crossings[periods] - crossings[0]) / periods as f64;
    assert!(
        (period_s / expected_s - 1.0).abs() < 1e-3,
        "{period_s} {expected_s}"
    );
    let turned = world.link(0).world_from_link.rotation.to_scaled_axis().z;
    let expected_rad = (spin * 4.0_f64 + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    assert!(
        (turned - expected_rad).abs() < 0.01,
        "{turned} {expected_rad}"
    );
    // A motor that holds the hinge feels what the bob weighs when the root speeds up: inertia about z of the bob times the acceleration,
    // and the acceleration of the hinge times the mass and the arm.
    world.set_joint(1, 0.0, 0.0);
    world.start_led(0, Vec3::ZERO, Vec3::ZERO);
    world.command(
        1,
        Command::Servo {
            target: 0.0,
            stiffness: 1e5,
            damping: 50.0,
            max_torque: f64::INFINITY,
        },
    );
    let faster = 3.0;
    let mut torque = 0.0;
    for k in 0..1920 {
        let spin = faster * (k as f64 + 0.5) * step_s;
        world.lead_root(0, Vec3::ZERO, Vec3::Z * spin);
        world.step();
        torque = world.joint_impulse(1).motor / step_s;
    }
    let expected = faster * (inertia + 0.5 * ARM_M * beside_m);
    assert!(
        (torque / expected - 1.0).abs() < 0.01,
        "{torque} {expected}"
    );
}

#[test]
fn a_root_that_is_not_mounted_is_not_led() {
    let mut world = world(vec![cube(0.5, Pose::identity())], vec![]);
    world.lead_root(0, Vec3::X, Vec3::Z);
    world.step();
    assert!(world.link(0).velocity_world_m_s.x.abs() < 1e-12);
}
