//! Tests of limits, friction, springs and motors of joints.

use super::common::*;
use realgap_tree::parry::math::{Pose, Vec3};
use realgap_tree::{Attachment, Command, Joint, JointType, Link, World};

/// A cube of 0.1 kg on a joint to the mount, with an arm of 0.1 m unless the joint is prismatic.
fn mounted(joint: Joint) -> Vec<Link> {
    let mut link = cube(0.5, Pose::identity());
    if joint.kind != JointType::Prismatic {
        link.centre_link_m = Vec3::new(0.1, 0.0, 0.0);
    }
    link.attachment = Attachment::Joint(joint);
    vec![mount(), link]
}

/// Weight of the arm about its hinge, N m.
const LOAD: f64 = 0.1 * G * 0.1;

#[test]
fn limits_stop_what_falls_into_them() {
    let turning = Joint {
        limits: Some((-0.2, 0.3)),
        ..Joint::new(0, JointType::Revolute, Vec3::Y)
    };
    let sliding = Joint {
        limits: Some((-0.05, 0.1)),
        ..Joint::new(0, JointType::Prismatic, Vec3::Z)
    };
    for (joint, lowest) in [(turning, 0.3), (sliding, -0.05)] {
        let mut world = world(mounted(joint), vec![]);
        let mut beyond = 0.0_f64;
        for _ in 0..960 {
            world.step();
            let position = world.joint(1).0;
            beyond = beyond.max((position - lowest) * lowest.signum());
        }
        let (position, speed) = world.joint(1);
        println!(
            "limit {lowest}: {:.2e} beyond at worst, {:.2e} at rest",
            beyond,
            (position - lowest) * lowest.signum()
        );
        assert!(beyond < 1e-4 && speed.abs() < 1e-6);
        // At rest the joint is supported by a spring of stiffness m ω².
        let (load, inertia) = if lowest > 0.0 {
            (
                LOAD * f64::cos(lowest),
                0.1 * 0.06 * 0.06 / 6.0 + 0.1 * 0.01,
            )
        } else {
            (0.1 * G, 0.1)
        };
        let sag = load / (inertia * (300.0 * std::f64::consts::TAU).powi(2));
        assert!(((position - lowest).abs() / sag - 1.0).abs() < 0.02);
        let held = world.joint_impulse(1).limit * 960.0;
        let weight = if lowest > 0.0 {
            LOAD * f64::cos(lowest)
        } else {
            0.1 * G
        };
        assert!((held.abs() / weight - 1.0).abs() < 1e-3, "{held} {weight}");
    }
}

#[test]
fn dry_friction_holds_up_to_its_limit_and_brakes_beyond_it() {
    for share in [1.01, 0.99] {
        let joint = Joint {
            dry_friction: share * LOAD,
            ..Joint::new(0, JointType::Continuous, Vec3::Y)
        };
        let mut world = world(mounted(joint), vec![]);
        run(&mut world, 1.0);
        let moved = world.joint(1).0;
        println!("dry friction of {share} of the load: {moved:.2e} rad in 1 s");
        assert!(if share > 1.0 {
            moved.abs() < 1e-9
        } else {
            moved > 0.01
        });
    }
    // Without gravity a spinning link stops after I ω / τ.
    let mut joint = Joint::new(0, JointType::Continuous, Vec3::Z);
    joint.dry_friction = 0.001;
    let mut world = world(mounted(joint), vec![]);
    world.set_joint(1, 0.0, 2.0);
    let inertia = 0.1 * 0.06 * 0.06 / 6.0 + 0.1 * 0.01;
    let right = inertia * 2.0 * 2.0 / (2.0 * 0.001);
    run(&mut world, 3.0);
    let (angle, speed) = world.joint(1);
    println!(
        "dry friction stops after {:.4} %",
        100.0 * (angle / right - 1.0)
    );
    assert!(speed.abs() < 1e-9 && (angle / right - 1.0).abs() < 0.002);
}

#[test]
fn viscous_friction_lets_speed_decay() {
    let joint = Joint {
        viscous_friction: 0.001,
        ..Joint::new(0, JointType::Continuous, Vec3::Z)
    };
    let mut world = world(mounted(joint), vec![]);
    world.set_joint(1, 0.0, 2.0);
    run(&mut world, 1.0);
    let inertia = 0.1 * 0.06 * 0.06 / 6.0 + 0.1 * 0.01;
    let right = 2.0 * (-0.001_f64 / inertia).exp();
    assert!((world.joint(1).1 / right - 1.0).abs() < 2e-3);
}

fn commanded(world: &mut World, command: Command, time_s: f64) -> (f64, f64) {
    world.command(1, command);
    run(world, time_s);
    world.joint(1)
}

#[test]
fn a_servo_holds_its_load_up_to_its_torque_limit() {
    let joint = Joint::new(0, JointType::Continuous, Vec3::Y);
    let servo = |max_torque| Command::Servo {
        target: 0.2,
        stiffness: 50.0,
        damping: 1.0,
        max_torque,
    };
    let mut strong = world(mounted(joint.clone()), vec![]);
    let (angle, _) = commanded(&mut strong, servo(1.0), 2.0);
    // Stiffness × lag = load.
    let right = LOAD * angle.cos() / 50.0;
    println!("servo lag {:.4} %", 100.0 * ((angle - 0.2) / right - 1.0));
    assert!(((angle - 0.2) / right - 1.0).abs() < 1e-3);
    let torque = strong.joint_impulse(1).motor * 960.0;
    assert!((torque / (-LOAD * angle.cos()) - 1.0).abs() < 1e-3);

    let mut weak = world(mounted(joint.clone()), vec![]);
    weak.command(1, servo(0.5 * LOAD));
    for _ in 0..240 {
        weak.step();
        assert!(weak.joint_impulse(1).motor.abs() * 960.0 <= 0.5 * LOAD * (1.0 + 1e-9));
    }
    assert!(weak.joint(1).0 > 0.25, "{}", weak.joint(1).0);
    // Constant torque while it turns: half the load's acceleration at first.
    let mut motor = world(
        mounted(Joint::new(0, JointType::Continuous, Vec3::Z)),
        vec![],
    );
    let drive = Command::Velocity {
        target: 5.0,
        gain: 1.0,
        max_torque: 0.002,
    };
    let inertia = 0.1 * 0.06 * 0.06 / 6.0 + 0.1 * 0.01;
    let (_, speed) = commanded(&mut motor, drive, 1.0);
    assert!((speed / (0.002 / inertia) - 1.0).abs() < 1e-6, "{speed}");
    let (_, speed) = commanded(&mut motor, drive, 3.0);
    assert!((speed - 5.0).abs() < 1e-6, "{speed}");
}

#[test]
fn the_work_of_all_joint_impulses_equals_the_change_of_energy() {
    let joint = Joint {
        dry_friction: 0.01,
        viscous_friction: 0.001,
        stiffness: 0.3,
        rest: 0.1,
        limits: Some((-1.0, 0.4)),
        ..Joint::new(0, JointType::Revolute, Vec3::Y)
    };
    let mut world = world(mounted(joint), vec![]);
    let mut work = 0.0;
    let start = world.kinetic_energy_j() + world.potential_energy_j();
    let mut most = 0.0_f64;
    for step in 0..2 * 960 {
        let t = f64::from(step) / 960.0;
        world.command(
            1,
            Command::Servo {
                target: (5.0 * t).sin(),
                stiffness: 5.0,
                damping: 0.05,
                max_torque: 0.15,
            },
        );
        let before = world.joint(1).1;
        world.step();
        let done = world.joint_impulse(1);
        let all = done.motor + done.limit + done.dry_friction + done.viscous_friction + done.spring;
        work += all * 0.5 * (before + world.joint(1).1);
        most = most.max(work.abs());
    }
    let gained = world.kinetic_energy_j() + world.potential_energy_j() - start;
    println!("work {work:.6} J, energy {gained:.6} J");
    assert!((work - gained).abs() < 0.02 * most);
}
