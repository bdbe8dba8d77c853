//! Roots on a spring against closed forms.

use std::f64::consts::TAU;

use super::common::*;
use realgap_tree::parry::math::{Mat3, Pose, Vec3};
use realgap_tree::{Attachment, Joint, JointType, Link, MountSpring, World};

const SPRING: MountSpring = MountSpring {
    at_link_m: Vec3::ZERO,
    stiffness_n_m: 800.0,
    damping_n_s_m: 0.0,
    stiffness_nm_rad: 30.0,
    damping_nm_s_rad: 0.0,
};

/// A body of 2 kg on a spring, with its centre of mass at this place and the inertia of a ball.
fn stand(spring: MountSpring, centre_link_m: Vec3) -> Link {
    Link {
        attachment: Attachment::Sprung {
            world_from_link: Pose::identity(),
            spring,
        },
        mass_kg: 2.0,
        centre_link_m,
        inertia_link_kg_m2: Mat3::IDENTITY * 0.01,
        compensated: (0.0, Vec3::ZERO),
        colliders: vec![],
    }
}

/// The root's state over time after it was pushed.
fn pushed(mut world: World, velocity: Vec3, angular: Vec3, steps: usize) -> Vec<(Vec3, Vec3)> {
    world.set_root(0, Pose::identity(), velocity, angular);
    (0..steps)
        .map(|_| {
            world.step();
            let pose = world.link(0).world_from_link;
            (pose.translation, pose.rotation.to_scaled_axis())
        })
        .collect()
}

/// Frequency in Hz from the first and the last upward crossing of 0.
fn frequency_hz(values: &[f64], step_s: f64) -> f64 {
    let crossings: Vec<f64> = values
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < 0.0 && w[1] >= 0.0)
        .map(|(k, w)| step_s * (k as f64 + w[0] / (w[0] - w[1])))
        .collect();
    (crossings.len() - 1) as f64 / (crossings[crossings.len() - 1] - crossings[0])
}

const STEP_S: f64 = 1.0 / 960.0;

#[test]
fn a_mass_on_a_mount_oscillates_at_the_root_of_stiffness_over_mass() {
    let run = |spring, velocity, angular| {
        let world = world(vec![stand(spring, Vec3::ZERO)], vec![]);
        pushed(world, velocity, angular, 4800)
    };
    let slides = run(SPRING, Vec3::X * 0.1, Vec3::ZERO);
    let x: Vec<f64> = slides.iter().map(|(at, _)| at.x).collect();
    let expected = (800.0_f64 / 2.0).sqrt() / TAU;
    let found = frequency_hz(&x, STEP_S);
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    // No energy is lost: the last second swings as far as the first.
    let far = |range: &[f64]| range.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let kept = far(&x[3840..]) / far(&x[..960]);
    assert!((kept - 1.0).abs() < 1e-3, "{kept}");
    // It carries its weight from the start.
    assert!(slides.iter().all(|(at, _)| at.z.abs() < 1e-9));
    let turns = run(SPRING, Vec3::ZERO, Vec3::Y * 0.1);
    let about_y: Vec<f64> = turns.iter().map(|(_, turned)| turned.y).collect();
    let expected = (30.0_f64 / 0.01).sqrt() / TAU;
    let found = frequency_hz(&about_y, STEP_S);
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    // Doubled stiffness is another run.
    let stiffer = MountSpring {
        stiffness_n_m: 1600.0,
        ..SPRING
    };
    let slides = run(stiffer, Vec3::X * 0.1, Vec3::ZERO);
    let x: Vec<f64> = slides.iter().map(|(at, _)| at.x).collect();
    let expected = (1600.0_f64 / 2.0).sqrt() / TAU;
    assert!((frequency_hz(&x, STEP_S) / expected - 1.0).abs() < 1e-3);
}

#[test]
fn a_damper_lets_the_swing_decay_at_half_of_damping_over_mass() {
    let spring = MountSpring {
        damping_n_s_m: 4.0,
        ..SPRING
    };
    let world = world(vec![stand(spring, Vec3::ZERO)], vec![]);
    let all = pushed(world, Vec3::X * 0.1, Vec3::ZERO, 2400);
    // Five whole periods apart, so that both parts begin at the same phase.
    let period = (TAU / (400.0_f64 - 1.0).sqrt() / STEP_S).round() as usize;
    let far = |from: usize| {
        let range = all[from..from + period].iter();
        range.fold(0.0_f64, |most, (at, _)| most.max(at.x.abs()))
    };
    let ratio = far(5 * period) / far(0);
    let expected = (-(4.0 / 4.0) * (5 * period) as f64 * STEP_S).exp();
    assert!((ratio / expected - 1.0).abs() < 5e-3, "{ratio} {expected}");
}

#[test]
fn a_mass_beside_a_mount_that_does_not_slide_turns_with_its_inertia_about_the_mount() {
    let spring = MountSpring {
        stiffness_n_m: 1e9,
        ..SPRING
    };
    let mut model = model(vec![stand(spring, Vec3::X * 0.1)], vec![], 960.0);
    model.gravity_world_m_s2 = Vec3::ZERO;
    let world = World::new(&model).unwrap();
    // The velocity is that of the centre of mass.
    let all = pushed(world, Vec3::Y * 0.005, Vec3::Z * 0.05, 4800);
    let about_z: Vec<f64> = all.iter().map(|(_, turned)| turned.z).collect();
    let expected = (30.0_f64 / (0.01 + 2.0 * 0.01)).sqrt() / TAU;
    let found = frequency_hz(&about_z, STEP_S);
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
}

/// A pendulum of 0.5 kg, 0.2 m below a hinge on the root, let go at 1 rad.
fn pendulum(root: Link) -> World {
    let mut bob = cube(0.5, Pose::identity());
    (bob.mass_kg, bob.centre_link_m) = (0.5, Vec3::Z * -0.2);
    bob.attachment = Attachment::Joint(Joint {
        start: 1.0,
        ..Joint::new(0, JointType::Continuous, Vec3::Y)
    });
    let mut world = world(vec![root, bob], vec![]);
    world.set_joint(1, 1.0, 0.0);
    world
}

#[test]
fn a_very_stiff_mount_is_a_fixed_one_and_a_soft_one_is_not() {
    let rigid = MountSpring {
        stiffness_n_m: 1e9,
        damping_n_s_m: 1e4,
        stiffness_nm_rad: 1e8,
        damping_nm_s_rad: 1e3,
        ..SPRING
    };
    let angles = |root: Link| -> Vec<f64> {
        let mut world = pendulum(root);
        let step = |_| {
            world.step();
            world.joint(1).0
        };
        (0..1920).map(step).collect()
    };
    let fixed = angles(mount());
    let apart = |other: &[f64]| {
        let pairs = fixed.iter().zip(other);
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let (stiff, soft) = (
        apart(&angles(stand(rigid, Vec3::ZERO))),
        apart(&angles(stand(SPRING, Vec3::ZERO))),
    );
    assert!(stiff < 1e-4, "{stiff}");
    assert!(soft > 0.02, "{soft}");
}

#[test]
fn energy_stays_in_a_pendulum_on_a_spring() {
    let mut world = pendulum(stand(SPRING, Vec3::ZERO));
    let mut most = [f64::INFINITY, f64::NEG_INFINITY];
    // The spring carries a load that does work, too: the weight of all at the start.
    let weight_n = 2.5 * G;
    let moment_nm = -0.5 * G * 0.2 * 1.0_f64.sin();
    for _ in 0..4800 {
        world.step();
        let pose = world.link(0).world_from_link;
        let carried_j =
            weight_n * pose.translation.z - moment_nm * pose.rotation.to_scaled_axis().y;
        let all_j = world.kinetic_energy_j() + world.potential_energy_j() + world.spring_energy_j()
            - carried_j;
        most = [most[0].min(all_j), most[1].max(all_j)];
    }
    println!("{most:?}");
    let swing_j = 0.5 * G * 0.2;
    assert!((most[1] - most[0]) < 0.05 * swing_j, "{most:?}");
}
