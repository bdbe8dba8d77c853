//! Tests of tyres against closed-form solutions.
#![allow(clippy::unwrap_used)]

use super::common::*;
use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{
    Attachment, Collider, Command, Joint, JointType, Link, Model, ModelError, Tyre, World,
};

const RADIUS_M: f64 = 0.03;
const TYRE: Tyre = Tyre {
    slip_stiffness_1_rad: 5.0,
    shape: 1.4,
};

fn ball(mass_kg: f64, friction: f64, tyre: Option<Tyre>, attachment: Attachment) -> Link {
    Link {
        attachment,
        mass_kg,
        centre_link_m: Vec3::ZERO,
        inertia_link_kg_m2: Mat3::from_diagonal(Vec3::splat(0.4 * mass_kg * RADIUS_M * RADIUS_M)),
        compensated: (0.0, Vec3::ZERO),
        colliders: vec![Collider {
            tyre,
            ..Collider::new(SharedShape::ball(RADIUS_M), friction)
        }],
    }
}

fn free(x: f64, y: f64) -> Attachment {
    Attachment::Free {
        world_from_link: at(x, y, RADIUS_M),
    }
}

/// A wheel on rails: it slides along x, and turns about y by a servo that keeps a speed; the rails carry it, and its weight
/// rests on the floor.
fn wheel_on_rails(friction: f64) -> Model {
    let slide = |parent: usize, axis: Vec3| {
        Attachment::Joint(Joint::new(parent, JointType::Prismatic, axis))
    };
    let light = |attachment: Attachment| Link {
        attachment,
        mass_kg: 0.01,
        centre_link_m: Vec3::ZERO,
        inertia_link_kg_m2: Mat3::from_diagonal(Vec3::splat(1e-6)),
        compensated: (0.0, Vec3::ZERO),
        colliders: Vec::new(),
    };
    let post = light(Attachment::Mounted {
        world_from_link: at(0.0, 0.0, RADIUS_M),
    });
    let wheel = Attachment::Joint(Joint::new(2, JointType::Continuous, Vec3::Y));
    let links = vec![
        post,
        light(slide(0, Vec3::X)),
        light(slide(1, Vec3::Z)),
        ball(0.5, friction, Some(TYRE), wheel),
    ];
    model(links, vec![floor()], 960.0)
}

/// Friction force over load of a wheel that is led at 1 m/s and turns with this slip.
fn measured(slip: f64, friction: f64) -> f64 {
    let mut world = World::new(&wheel_on_rails(friction)).unwrap();
    let (lead_m_s, load_n) = (1.0, (0.5 + 0.01) * G);
    let speed_rad_s = lead_m_s * (1.0 + slip) / RADIUS_M;
    world.set_joint(1, 0.0, lead_m_s);
    world.set_joint(3, 0.0, speed_rad_s);
    let keep = |target: f64| Command::Velocity {
        target,
        gain: 1e4,
        max_torque: f64::INFINITY,
    };
    world.command(1, keep(lead_m_s));
    world.command(3, keep(speed_rad_s));
    run(&mut world, 0.5);
    let steps = 200;
    let mut along_n_s = 0.0;
    for _ in 0..steps {
        world.step();
        along_n_s += world
            .contacts()
            .map(|contact| contact.impulse_world_n_s.x)
            .sum::<f64>();
    }
    along_n_s / (f64::from(steps) * world.settings().timestep_s * load_n)
}

#[test]
fn the_slip_curve_of_a_wheel_is_the_magic_formula() {
    for friction in [0.4, 0.9] {
        for slip in [0.01, 0.03, 0.1, 0.3, -0.05, -0.4] {
            // A driven wheel travels by its rim, a braked one by its hub.
            let over_travel = if slip > 0.0 {
                slip / (1.0 + slip)
            } else {
                slip
            };
            let right = TYRE.force_per_load(over_travel, friction);
            let found = measured(slip, friction);
            println!("friction {friction}, slip {slip}: {found:.4} for {right:.4}");
            assert!((found - right).abs() < 0.005 * friction, "{found} {right}");
        }
    }
}

#[test]
fn lower_friction_lowers_the_limit_and_keeps_the_slip_stiffness_1_rad() {
    let small = 0.004;
    assert!((measured(small, 0.2) / measured(small, 0.9) - 1.0).abs() < 0.03);
    assert!(measured(1.0, 0.2) < 0.25 * measured(1.0, 0.9));
}

#[test]
fn a_wheel_without_friction_neither_drives_nor_steers() {
    assert_eq!(measured(0.3, 0.0), 0.0);
}

#[test]
fn a_law_that_rises_to_coulombs_limit_slides_as_any_other_body() {
    let monotone = Tyre {
        slip_stiffness_1_rad: 1e4,
        shape: 1.0,
    };
    let stop = |tyre: Option<Tyre>| {
        let mut link = ball(0.5, 0.4, tyre, free(0.0, 0.0));
        // A ball that cannot be turned slides.
        link.inertia_link_kg_m2 = Mat3::from_diagonal(Vec3::splat(1e6));
        let mut world = world(vec![link], vec![floor()]);
        world.set_root(0, at(0.0, 0.0, RADIUS_M), Vec3::X, Vec3::ZERO);
        run(&mut world, 1.0);
        world.link(0).centre_world_m.x
    };
    let right = 1.0 / (2.0 * 0.4 * G);
    assert!((stop(None) / right - 1.0).abs() < 0.01);
    assert!((stop(Some(monotone)) / right - 1.0).abs() < 0.01);
}

#[test]
fn a_fast_ball_rolls_on_the_floor_and_not_in_it() {
    let mut world = world(vec![ball(0.5, 0.5, None, free(0.0, 0.0))], vec![floor()]);
    let speed_m_s = 3.0;
    let spin = Vec3::Y * (speed_m_s / RADIUS_M);
    world.set_root(0, at(0.0, 0.0, RADIUS_M), Vec3::X * speed_m_s, spin);
    run(&mut world, 1.0);
    let ball = world.link(0);
    let sunk_m = RADIUS_M - ball.centre_world_m.z;
    println!("a ball that rolls at 3 m/s is {sunk_m:.2e} m inside the floor");
    // At rest the floor gives g / omega^2 = 2.8e-6 m.
    assert!(sunk_m.abs() < 5e-6, "{sunk_m}");
    assert!((ball.velocity_world_m_s.x / speed_m_s - 1.0).abs() < 1e-6);
}

#[test]
fn a_tyre_at_rest_holds_on_a_slope() {
    // The slope acts through gravity, so that the floor stays level.
    let mut model = model(
        vec![ball(0.5, 0.8, Some(TYRE), free(0.0, 0.0))],
        vec![floor()],
        960.0,
    );
    model.links[0].inertia_link_kg_m2 = Mat3::from_diagonal(Vec3::splat(1e6));
    let angle = 0.3_f64;
    model.gravity_world_m_s2 = Vec3::new(angle.sin(), 0.0, -angle.cos()) * G;
    let mut world = World::new(&model).unwrap();
    run(&mut world, 2.0);
    let crept_m = world.link(0).centre_world_m.x;
    println!("creep of a tyre at rest on a slope: {crept_m:.2e} m in 2 s");
    assert!(crept_m.abs() < 1e-3);
}

#[test]
fn a_tyre_without_a_law_is_refused() {
    let refused = |tyre: Tyre| {
        let model = model(
            vec![ball(0.5, 0.8, Some(tyre), free(0.0, 0.0))],
            vec![floor()],
            960.0,
        );
        match World::new(&model) {
            Err(ModelError { message }) => message,
            Ok(_) => panic!("accepted"),
        }
    };
    for (slip_stiffness_1_rad, shape) in [(0.0, 1.4), (f64::NAN, 1.4), (5.0, 0.9), (5.0, 2.0)] {
        let message = refused(Tyre {
            slip_stiffness_1_rad,
            shape,
        });
        assert!(message.contains("tyre"), "{message}");
    }
    let mut relaxed = wheel_on_rails(0.5);
    relaxed.settings.cone = realgap_tree::Cone::Relaxed;
    assert!(World::new(&relaxed).is_err());
}

const WHEELBASE_M: f64 = 0.2;

/// A car on four wheels that roll freely, the front ones turned by an angle.
fn car(friction: f64, steering_rad: f64) -> World {
    let size_m = Vec3::new(WHEELBASE_M, 0.12, 0.02);
    let mut links = vec![block(1.5, size_m, friction, at(0.0, 0.0, RADIUS_M))];
    links[0].colliders.clear();
    for (x, y) in [(0.5, 0.06), (0.5, -0.06), (-0.5, 0.06), (-0.5, -0.06)] {
        let angle_rad = if x > 0.0 { steering_rad } else { 0.0 };
        let wheel = Attachment::Joint(Joint {
            parent_from_joint: Pose::from_parts(
                Vec3::new(x * WHEELBASE_M, y, 0.0),
                Rot3::from_rotation_z(angle_rad),
            ),
            ..Joint::new(0, JointType::Continuous, Vec3::Y)
        });
        links.push(ball(0.02, friction, Some(TYRE), wheel));
    }
    world(links, vec![floor()])
}

/// Speed and turn rate of a car that is kept at a speed, means over the last second of five.
fn circle(friction: f64, steering_rad: f64, speed_m_s: f64) -> (f64, f64) {
    let mut world = car(friction, steering_rad);
    let (mut speed, mut turn) = (0.0, 0.0);
    let steps = 5 * 960;
    for step in 0..steps {
        // It speeds up within two seconds, pushed along its axis, so that its wheels are free to roll.
        let now_m_s = speed_m_s * (f64::from(step) / (2.0 * 960.0)).min(1.0);
        let chassis = world.link(0);
        let ahead = chassis.world_from_link.rotation * Vec3::X;
        let lacking_m_s = now_m_s - chassis.velocity_world_m_s.dot(ahead);
        world.push(
            0,
            ahead * (30.0 * lacking_m_s),
            chassis.centre_world_m,
            Vec3::ZERO,
        );
        world.step();
        if step >= steps - 960 {
            let chassis = world.link(0);
            speed += chassis.velocity_world_m_s.length() / 960.0;
            turn += chassis.angular_velocity_world_rad_s.z / 960.0;
        }
    }
    (speed, turn)
}

#[test]
fn a_slow_car_turns_on_the_circle_of_its_wheels() {
    let (speed, turn) = circle(0.8, 0.2, 0.3);
    let right = 0.2_f64.tan() / WHEELBASE_M;
    println!("curvature {:.3} for {right:.3} 1/m", turn / speed);
    assert!((turn / speed / right - 1.0).abs() < 0.03);
}

#[test]
fn a_fast_car_slides_out_of_its_circle_where_v2_is_mu_g_r() {
    for friction in [0.3, 0.6] {
        let (speed, turn) = circle(friction, 0.2, 3.5);
        let radius_m = speed / turn;
        let across = speed * speed / (friction * G * radius_m);
        println!(
            "friction {friction}: {speed:.2} m/s, radius {radius_m:.2} m, v2 / (mu g r) = {across:.3}"
        );
        // Its wheels would lead it on a circle of 1 m.
        assert!(radius_m > 1.2);
        assert!((0.85..=1.0).contains(&across), "{across}");
    }
}

#[test]
fn a_car_without_friction_neither_accelerates_nor_turns() {
    let mut world = car(0.0, 0.2);
    for wheel in 1..5 {
        let spin = Command::Velocity {
            target: 30.0,
            gain: 0.02,
            max_torque: f64::INFINITY,
        };
        world.command(wheel, spin);
    }
    run(&mut world, 1.0);
    let chassis = world.link(0);
    assert!(chassis.velocity_world_m_s.length() < 1e-9);
    // The wheels that speed up tilt the car a little, and tilting turning wheels turns it: with friction it is 1 rad/s.
    assert!(chassis.angular_velocity_world_rad_s.z.abs() < 1e-3);
}
