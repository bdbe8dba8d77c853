//! Tests of motion without contacts against closed-form solutions.
#![allow(clippy::unwrap_used)]

use super::common::*;
use nalgebra::{DMatrix, Matrix6, Matrix6xX};
use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::{Attachment, Command, Joint, JointType, Link, World};

#[test]
fn a_free_body_falls_along_its_parabola() {
    let mut world = world(vec![cube(0.5, at(0.0, 0.0, 10.0))], vec![]);
    world.set_root(0, at(0.0, 0.0, 10.0), Vec3::new(1.0, 0.0, 2.0), Vec3::ZERO);
    run(&mut world, 1.0);
    let fallen = world.link(0).world_from_link.translation;
    let right = Vec3::new(1.0, 0.0, 12.0 - 0.5 * G);
    println!("parabola: {:e} m", (fallen - right).length());
    assert!((fallen - right).length() < 1e-9);
}

/// Angular momentum about the centre of mass.
fn spin(world: &World, link: usize, inertia: &Mat3) -> Vec3 {
    let state = world.link(link);
    let turn = Mat3::from_quat(state.world_from_link.rotation);
    turn * *inertia * turn.transpose() * state.angular_velocity_world_rad_s
}

/// Euler's equations by Runge and Kutta with a very small step: orientation after a time.
fn tumbled(inertia: Vec3, start: Vec3, time_s: f64) -> (Rot3, Vec3) {
    let rate = |w: Vec3| {
        Vec3::new(
            (inertia.y - inertia.z) * w.y * w.z / inertia.x,
            (inertia.z - inertia.x) * w.z * w.x / inertia.y,
            (inertia.x - inertia.y) * w.x * w.y / inertia.z,
        )
    };
    let (steps, mut w, mut turn) = (100_000, start, Rot3::IDENTITY);
    let h = time_s / f64::from(steps);
    for _ in 0..steps {
        let k1 = rate(w);
        let k2 = rate(w + k1 * (0.5 * h));
        let k3 = rate(w + k2 * (0.5 * h));
        let k4 = rate(w + k3 * h);
        let middle = w + k1 * (0.5 * h);
        turn = (turn * Rot3::from_scaled_axis(middle * h)).normalize();
        w += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    (turn, turn * w)
}

#[test]
fn a_free_body_tumbles_as_eulers_equations_predict() {
    let size = Vec3::new(0.06, 0.12, 0.02);
    let inertia = box_inertia(0.1, size);
    let start = Vec3::new(0.3, 8.0, 0.5);
    let mut angles = Vec::new();
    for rate in [480.0, 960.0] {
        let mut m = model(vec![block(0.1, size, 0.5, Pose::identity())], vec![], rate);
        m.gravity_world_m_s2 = Vec3::ZERO;
        let mut world = World::new(&m).unwrap();
        world.set_root(0, Pose::identity(), Vec3::ZERO, start);
        let (before, energy_before) = (spin(&world, 0, &inertia), world.kinetic_energy_j());
        run(&mut world, 2.0);
        let diagonal = Vec3::new(inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z);
        let (turn, _) = tumbled(diagonal, start, 2.0);
        let angle = turn.angle_between(world.link(0).world_from_link.rotation);
        let momentum = (spin(&world, 0, &inertia) - before).length() / before.length();
        let gain = world.kinetic_energy_j() / energy_before - 1.0;
        println!(
            "tumbling at {rate}/s: {:.4} deg, momentum {momentum:e}, energy {gain:e}",
            angle.to_degrees()
        );
        assert!(momentum < 3e-3 && gain.abs() < 3e-3);
        angles.push(angle.to_degrees());
    }
    assert!(angles[1] < 0.05 && angles[1] < 0.4 * angles[0]);
}

fn double_pendulum(rate: f64) -> World {
    let links = vec![
        mount(),
        rod(Attachment::Joint(hinge_y(0, 0.0, 0.0, 0.0))),
        rod(Attachment::Joint(hinge_y(1, 0.0, 0.0, -1.0))),
    ];
    let mut world = World::new(&model(links, vec![], rate)).unwrap();
    world.set_joint(1, 1.5, 0.0);
    world.set_joint(2, 0.8, 0.0);
    world
}

#[test]
fn a_mounted_double_pendulum_keeps_its_swing() {
    for rate in [240.0, 480.0, 960.0] {
        let mut world = double_pendulum(rate);
        let lowest = -G * (0.5 + 1.5);
        let start = energy(&world) - lowest;
        run(&mut world, 10.0);
        let kept = (energy(&world) - lowest) / start;
        println!("double pendulum at {rate}/s keeps {:.3} %", 100.0 * kept);
        assert!((kept - 1.0).abs() < 0.02);
    }
}

/// Momentum from the displacement of all centres of mass: velocities belong to the middle of a step, positions to its ends.
fn momentum_of_path(world: &mut World, links: usize) -> Vec3 {
    let sum =
        |world: &World| -> Vec3 { (0..links).map(|link| world.link(link).centre_world_m).sum() };
    let before = sum(world);
    world.step();
    world.step();
    (sum(world) - before) / (2.0 * world.settings().timestep_s)
}

#[test]
fn a_free_chain_keeps_momentum_and_energy() {
    let size = Vec3::new(0.2, 0.3, 1.0);
    let mut links = vec![block(1.0, size, 0.5, Pose::identity())];
    for k in 0..3 {
        let axis = if k % 2 == 0 { Vec3::Y } else { Vec3::X };
        let mut link = block(1.0, size, 0.5, Pose::identity());
        link.colliders.clear();
        link.attachment = Attachment::Joint(Joint {
            parent_from_joint: at(0.0, 0.0, -0.5),
            link_from_joint: at(0.0, 0.0, 0.5),
            ..Joint::new(k, JointType::Continuous, axis)
        });
        links.push(link);
    }
    let mut errors = Vec::new();
    for rate in [480.0, 960.0, 1920.0] {
        let mut m = model(links.clone(), vec![], rate);
        m.gravity_world_m_s2 = Vec3::ZERO;
        let mut world = World::new(&m).unwrap();
        world.set_root(0, Pose::identity(), Vec3::X, Vec3::new(1.0, 2.0, 3.0));
        for (link, speed) in [(1, 5.0), (2, -4.0), (3, 6.0)] {
            world.set_joint(link, 0.3, speed);
        }
        let before: Vec3 = (0..4).map(|link| world.link(link).velocity_world_m_s).sum();
        let energy_before = world.kinetic_energy_j();
        run(&mut world, 3.0);
        let error = (momentum_of_path(&mut world, 4) - before).length() / before.length();
        let gain = world.kinetic_energy_j() / energy_before - 1.0;
        println!("free chain at {rate}/s: momentum {error:e}, energy {gain:e}");
        assert!(gain.abs() < 0.02);
        errors.push(error);
    }
    // The method is of second order: half the step gives a quarter of the error.
    assert!(errors[1] < 1e-3 && errors[2] < 0.35 * errors[1]);
}

#[test]
fn a_prismatic_spring_swings_at_its_frequency() {
    let mut weight = cube(0.5, Pose::identity());
    weight.attachment = Attachment::Joint(Joint {
        stiffness: 40.0,
        start: 0.1,
        ..Joint::new(0, JointType::Prismatic, Vec3::X)
    });
    let mut world = world(vec![mount(), weight], vec![]);
    let omega = (40.0_f64 / 0.1).sqrt();
    let (mut crossings, mut before, mut last) = (0, 0.1, 0.0);
    for step in 1..=960 * 4 {
        world.step();
        let now = world.joint(1).0;
        if before > 0.0 && now <= 0.0 {
            crossings += 1;
            last = (f64::from(step) - now / (now - before)) / 960.0;
        }
        before = now;
    }
    let period = (last - 0.25 * std::f64::consts::TAU / omega) / f64::from(crossings - 1);
    let error = period * omega / std::f64::consts::TAU - 1.0;
    println!("prismatic spring: period {:.4} %", 100.0 * error);
    assert!(error.abs() < 2e-3);
}

#[test]
fn a_torque_turns_rotor_and_link() {
    let mut arm = cube(0.5, Pose::identity());
    arm.attachment = Attachment::Joint(Joint {
        armature: 1e-4,
        ..Joint::new(0, JointType::Continuous, Vec3::Z)
    });
    let mut world = world(vec![mount(), arm], vec![]);
    world.command(1, Command::Torque(0.001));
    run(&mut world, 1.0);
    let right = 0.001 / (0.1 * 0.06 * 0.06 / 6.0 + 1e-4);
    assert!((world.joint(1).1 / right - 1.0).abs() < 1e-9);
    let done = world.joint_impulse(1).motor;
    assert!((done - 0.001 / 960.0).abs() < 1e-12);
}

/// Response of the last link from the Jacobians of all links, whose columns are the motion of a link's centre of mass per unit
/// speed of a degree of freedom.
fn response_by_jacobian(
    world: &World,
    m: &realgap_tree::Model,
    joints: &[(usize, Vec3, Vec3)],
) -> Matrix6<f64> {
    let free = 6 + joints.len();
    let root = world.link(0).centre_world_m;
    let mut mass = DMatrix::zeros(free, free);
    let mut last = Matrix6xX::zeros(free);
    for link in 0..m.links.len() {
        let state = world.link(link);
        let mut j = Matrix6xX::zeros(free);
        for k in 0..3 {
            let unit = [Vec3::X, Vec3::Y, Vec3::Z][k];
            let across = unit.cross(state.centre_world_m - root);
            for row in 0..3 {
                j[(row, k)] = unit[row];
                j[(row + 3, k)] = across[row];
                j[(row + 3, k + 3)] = unit[row];
            }
        }
        for (column, (child, anchor, axis)) in joints.iter().enumerate() {
            if *child <= link {
                let across = axis.cross(state.centre_world_m - *anchor);
                for row in 0..3 {
                    j[(row, 6 + column)] = axis[row];
                    j[(row + 3, 6 + column)] = across[row];
                }
            }
        }
        let turn = Mat3::from_quat(state.world_from_link.rotation);
        let inertia = turn * m.links[link].inertia_link_kg_m2 * turn.transpose();
        let mut body = DMatrix::zeros(6, 6);
        for row in 0..3 {
            for column in 0..3 {
                body[(row, column)] = inertia.col(column)[row];
            }
            body[(row + 3, row + 3)] = m.links[link].mass_kg;
        }
        mass += j.transpose() * body * &j;
        last = j;
    }
    &last * mass.try_inverse().unwrap() * last.transpose()
}

#[test]
fn the_response_of_the_last_link_equals_that_from_the_mass_matrix() {
    let mut links = vec![cube(0.5, Pose::identity())];
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.6, 0.8, 0.0)];
    for (k, axis) in axes.into_iter().enumerate() {
        let joint = Joint {
            parent_from_joint: Pose::new(Vec3::new(0.03, 0.01, 0.0), Vec3::new(0.1, 0.2, 0.3)),
            link_from_joint: Pose::new(Vec3::new(-0.03, 0.0, 0.02), Vec3::new(0.0, 0.4, -0.2)),
            ..Joint::new(k, JointType::Continuous, axis)
        };
        let mut link = block(0.1, Vec3::new(0.02, 0.05, 0.03), 0.5, Pose::identity());
        link.attachment = Attachment::Joint(joint);
        link.centre_link_m = Vec3::new(0.01, 0.02, -0.01);
        links.push(link);
    }
    let mut m = model(links, vec![], 1e9);
    m.gravity_world_m_s2 = Vec3::ZERO;
    let mut world = World::new(&m).unwrap();
    for link in 1..5 {
        world.set_joint(link, 0.5 * link as f64, 0.0);
    }
    world.step();
    let mut joints = Vec::new();
    for link in 1..5 {
        let Attachment::Joint(joint) = &m.links[link].attachment else {
            panic!()
        };
        let frame = world.link(link).world_from_link * joint.link_from_joint;
        joints.push((link, frame.translation, frame.rotation * joint.axis_joint));
    }
    let right = response_by_jacobian(&world, &m, &joints);
    let at = world.link(4).centre_world_m;
    let mut worst = 0.0_f64;
    for k in 0..3 {
        let (linear, angular) = world.response(4, [Vec3::X, Vec3::Y, Vec3::Z][k], at);
        for row in 0..3 {
            worst = worst.max((linear[row] - right[(row + 3, k + 3)]).abs());
            worst = worst.max((angular[row] - right[(row, k + 3)]).abs());
        }
    }
    println!("response: {:e} of {:e}", worst, right.abs().max());
    assert!(worst < 1e-9 * right.abs().max());
}

#[test]
fn links_that_are_fixed_are_one_body() {
    let fixed = |parent| {
        Attachment::Joint(Joint {
            parent_from_joint: at(0.06, 0.0, 0.0),
            ..Joint::new(parent, JointType::Fixed, Vec3::X)
        })
    };
    let three: Vec<Link> = (0..3)
        .map(|k: usize| {
            let mut link = cube(0.5, Pose::identity());
            if k > 0 {
                link.attachment = fixed(k - 1);
            }
            link
        })
        .collect();
    let mut bar = world(three, vec![]);
    let mut one = world(
        vec![block(
            0.3,
            Vec3::new(0.18, 0.06, 0.06),
            0.5,
            Pose::identity(),
        )],
        vec![],
    );
    let w = Vec3::new(1.0, 2.0, 3.0);
    bar.set_root(1, Pose::identity(), Vec3::X, w);
    one.set_root(0, Pose::identity(), Vec3::X, w);
    run(&mut bar, 0.5);
    run(&mut one, 0.5);
    let (a, b) = (bar.link(1), one.link(0));
    assert!((a.centre_world_m - b.centre_world_m).length() < 1e-9);
    assert!(
        a.world_from_link
            .rotation
            .angle_between(b.world_from_link.rotation)
            < 1e-6
    );
}

#[test]
fn a_passive_hinge_that_crashes_at_44_m_s_stays_finite() {
    let mut links = vec![cube(0.5, at(0.0, 0.0, 0.5))];
    for k in 0..2 {
        let mut link = cube(0.5, Pose::identity());
        link.attachment = Attachment::Joint(Joint {
            parent_from_joint: at(0.03, 0.0, 0.0),
            link_from_joint: at(-0.03, 0.0, 0.0),
            ..Joint::new(k, JointType::Continuous, [Vec3::Y, Vec3::Z][k])
        });
        links.push(link);
    }
    for rate in [240.0, 960.0] {
        let mut world = World::new(&model(links.clone(), vec![floor()], rate)).unwrap();
        world.set_root(
            0,
            at(0.0, 0.0, 0.5),
            Vec3::new(3.0, 0.0, -44.0),
            Vec3::new(5.0, 3.0, 1.0),
        );
        let start = energy(&world);
        let mut most = 0.0_f64;
        for _ in 0..(10.0 * rate) as usize {
            world.step();
            most = most.max(energy(&world) / start);
        }
        assert!(world.is_finite());
        println!(
            "crash at {rate}/s: energy at most {most:.4} of the start's, left {:.5}",
            energy(&world) / start
        );
        assert!(most < 1.01);
    }
}
