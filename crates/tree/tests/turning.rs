//! Tests of friction against rolling and spinning against closed-form solutions.
#![allow(clippy::unwrap_used)]

use super::common::*;
use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{Attachment, Collider, Cone, Fixture, Link, TurningFriction, World};

const RADIUS_M: f64 = 0.03;
const MASS_KG: f64 = 0.1;
const LAW: TurningFriction = TurningFriction {
    rolling_m: 0.002,
    torsional_m: 0.001,
};
/// I / m r² of a ball.
const SHARE: f64 = 0.4;
const INERTIA_KG_M2: f64 = SHARE * MASS_KG * RADIUS_M * RADIUS_M;

fn ball(turning: TurningFriction, pose: Pose) -> Link {
    Link {
        attachment: Attachment::Free {
            world_from_link: pose,
        },
        mass_kg: MASS_KG,
        centre_link_m: Vec3::ZERO,
        inertia_link_kg_m2: Mat3::from_diagonal(Vec3::splat(INERTIA_KG_M2)),
        compensated: (0.0, Vec3::ZERO),
        colliders: vec![Collider {
            turning,
            ..Collider::new(SharedShape::ball(RADIUS_M), 0.8)
        }],
    }
}

/// A cylinder, upright or on its side, which touches the floor in several points.
fn cylinder(turning: TurningFriction, friction: f64, pose: Pose) -> Link {
    let (along, across) = (0.5, (3.0 + 4.0) / 12.0);
    let inertia = Vec3::new(across, along, across) * (MASS_KG * RADIUS_M * RADIUS_M);
    Link {
        inertia_link_kg_m2: Mat3::from_diagonal(inertia),
        colliders: vec![Collider {
            turning,
            ..Collider::new(SharedShape::cylinder(RADIUS_M, RADIUS_M), friction)
        }],
        ..ball(turning, pose)
    }
}

fn rolling(link: Link, speed_m_s: f64) -> World {
    let Attachment::Free { world_from_link } = link.attachment else {
        panic!("a free link");
    };
    let mut world = world(vec![link], vec![floor()]);
    let spin = Vec3::Y * (speed_m_s / RADIUS_M);
    world.set_root(0, world_from_link, Vec3::X * speed_m_s, spin);
    world
}

#[test]
fn a_rolling_ball_and_a_rolling_cylinder_stop_after_the_distance_of_the_formula() {
    let speed_m_s = 0.5;
    let on_its_side = Pose::from_parts(Vec3::Z * RADIUS_M, Rot3::IDENTITY);
    let links = [
        ("ball", SHARE, ball(LAW, at(0.0, 0.0, RADIUS_M))),
        ("cylinder", 0.5, cylinder(LAW, 0.8, on_its_side)),
    ];
    for (name, share, link) in links {
        let slows_m_s2 = LAW.rolling_m / RADIUS_M * G / (1.0 + share);
        let right_m = speed_m_s * speed_m_s / (2.0 * slows_m_s2);
        let mut world = rolling(link, speed_m_s);
        let mut last_m_s = speed_m_s;
        let steps = (1.2 * speed_m_s / slows_m_s2 * 960.0) as usize;
        let mut still = 0;
        for _ in 0..steps {
            world.step();
            let state = world.link(0);
            let now_m_s = state.velocity_world_m_s.x;
            // It never turns round and never speeds up.
            assert!(now_m_s > -1e-9, "{name}: {now_m_s}");
            assert!(now_m_s <= last_m_s + 1e-9, "{name}: {now_m_s} {last_m_s}");
            last_m_s = now_m_s;
            still += usize::from(now_m_s.abs() < 1e-12);
        }
        let found_m = world.link(0).centre_world_m.x;
        println!("{name}: {found_m:.5} m for {right_m:.5} m, at rest in {still} steps");
        assert!((found_m / right_m - 1.0).abs() < 2e-3);
        assert!(still > steps / 10);
    }
}

#[test]
fn a_spinning_ball_and_a_spinning_disc_stop_after_the_time_of_the_formula() {
    let spin_rad_s = 20.0;
    let upright = Pose::from_parts(
        Vec3::Z * RADIUS_M,
        Rot3::from_rotation_x(std::f64::consts::FRAC_PI_2),
    );
    let along_kg_m2 = 0.5 * MASS_KG * RADIUS_M * RADIUS_M;
    let links = [
        ("ball", INERTIA_KG_M2, ball(LAW, at(0.0, 0.0, RADIUS_M))),
        // Without sliding friction, which would brake its rim, too.
        ("disc", along_kg_m2, cylinder(LAW, 0.0, upright)),
    ];
    for (name, inertia_kg_m2, link) in links {
        let right_s = inertia_kg_m2 * spin_rad_s / (LAW.torsional_m * MASS_KG * G);
        let Attachment::Free { world_from_link } = link.attachment else {
            panic!("a free link");
        };
        let mut world = world(vec![link], vec![floor()]);
        world.set_root(0, world_from_link, Vec3::ZERO, Vec3::Z * spin_rad_s);
        let (mut found_s, mut last) = (f64::NAN, spin_rad_s);
        for step in 0..(2.0 * right_s * 960.0) as usize {
            world.step();
            let now = world.link(0).angular_velocity_world_rad_s.z;
            assert!(now > -1e-5 && now <= last + 1e-5, "{name}: {now} {last}");
            if now.abs() < 1e-5 && found_s.is_nan() {
                found_s = f64::from(u32::try_from(step + 1).unwrap()) / 960.0;
            }
            last = now;
        }
        println!("{name}: {found_s:.4} s for {right_s:.4} s");
        // The load grows within the first steps.
        assert!((found_s - right_s).abs() < 3.0 / 960.0);
    }
}

#[test]
fn a_ball_on_a_slope_rests_below_the_rolling_angle_and_rolls_above_it() {
    for (share, seconds) in [(0.95, 3.0), (1.5, 0.5)] {
        let angle = (share * LAW.rolling_m / RADIUS_M).atan();
        let mut model = model(
            vec![ball(LAW, at(0.0, 0.0, RADIUS_M))],
            vec![floor()],
            960.0,
        );
        model.gravity_world_m_s2 = Vec3::new(angle.sin(), 0.0, -angle.cos()) * G;
        let mut world = World::new(&model).unwrap();
        // The load grows within the first steps, so that the ball begins to roll even below the angle.
        let settling_s = if share < 1.0 { 0.5 } else { 0.0 };
        run(&mut world, settling_s);
        let from_m = world.link(0).centre_world_m.x;
        run(&mut world, seconds);
        let found_m = world.link(0).centre_world_m.x - from_m;
        let lost = LAW.rolling_m / RADIUS_M * angle.cos();
        let right_m = 0.5 * G * (angle.sin() - lost).max(0.0) / (1.0 + SHARE) * seconds * seconds;
        println!("{share} of the angle: {found_m:.6} m for {right_m:.6} m");
        match share < 1.0 {
            true => assert!(found_m.abs() < 1e-9, "{found_m}"),
            false => assert!((found_m / right_m - 1.0).abs() < 0.01),
        }
    }
}

#[test]
fn energy_never_grows_while_shapes_roll_spin_and_tumble() {
    let turned = Rot3::from_scaled_axis(Vec3::new(0.3, 0.5, 0.2));
    let links = [
        ball(LAW, at(0.0, 0.0, RADIUS_M + 0.02)),
        cylinder(LAW, 0.6, Pose::from_parts(Vec3::Z * 0.08, turned)),
        Link {
            colliders: vec![Collider {
                turning: LAW,
                ..cube(0.5, Pose::IDENTITY).colliders[0].clone()
            }],
            ..cube(0.5, Pose::from_parts(Vec3::Z * 0.08, turned))
        },
    ];
    for link in links {
        let Attachment::Free { world_from_link } = link.attachment else {
            panic!("a free link");
        };
        let mut world = world(vec![link], vec![floor()]);
        let spin = Vec3::new(3.0, 15.0, 20.0);
        world.set_root(0, world_from_link, Vec3::new(0.4, 0.1, 0.0), spin);
        let (start_j, mut last_j, mut worst_j) = (energy(&world), energy(&world), 0.0_f64);
        for _ in 0..4 * 960 {
            world.step();
            let now_j = energy(&world);
            worst_j = worst_j.max(now_j - last_j);
            last_j = now_j;
        }
        println!(
            "largest growth in a step: {:.1e} of the start",
            worst_j / start_j
        );
        assert!(worst_j < 1e-9 * start_j, "{worst_j} of {start_j}");
        assert!(
            world.kinetic_energy_j() < 1e-9,
            "{}",
            world.kinetic_energy_j()
        );
        assert_eq!(world.frictionless_steps(), 0);
    }
}

#[test]
fn a_couple_between_two_free_bodies_conserves_angular_momentum() {
    let mut one = ball(LAW, at(0.0, 0.0, 0.0));
    let mut two = ball(LAW, at(0.0, 0.0, 2.0 * RADIUS_M));
    for link in [&mut one, &mut two] {
        // Without sliding friction only the couple turns them.
        link.colliders[0].friction = 0.0;
    }
    let mut model = model(vec![one, two], Vec::new(), 960.0);
    model.gravity_world_m_s2 = Vec3::ZERO;
    let mut world = World::new(&model).unwrap();
    world.set_root(0, at(0.0, 0.0, 0.0), Vec3::ZERO, Vec3::Z * 10.0);
    let press = |world: &mut World| {
        let up = world.link(0).centre_world_m;
        let down = world.link(1).centre_world_m;
        world.push(0, Vec3::Z, up, Vec3::ZERO);
        world.push(1, -Vec3::Z, down, Vec3::ZERO);
        world.step();
    };
    let spins = |world: &World| [0, 1].map(|k| world.link(k).angular_velocity_world_rad_s.z);
    for _ in 0..5 {
        press(&mut world);
    }
    let [first, second] = spins(&world);
    assert!(second > 0.1 && first < 9.9, "{first} {second}");
    for _ in 0..960 {
        press(&mut world);
    }
    let [first, second] = spins(&world);
    println!("a ball that spins at 10 rad/s drives another one: {first:.6} and {second:.6} rad/s");
    assert!((first - 5.0).abs() < 1e-6 && (second - 5.0).abs() < 1e-6);
}

#[test]
fn a_turntable_takes_a_ball_along_as_fast_as_the_couple_allows() {
    let mut table = floor();
    table.angular_velocity_world_rad_s = Vec3::Z * 5.0;
    let ball = ball(LAW, at(0.0, 0.0, RADIUS_M));
    let mut world = world(vec![ball], vec![table]);
    run(&mut world, 0.05);
    let gains = LAW.torsional_m * MASS_KG * G / INERTIA_KG_M2;
    let early = world.link(0).angular_velocity_world_rad_s.z;
    assert!((early / (0.05 * gains) - 1.0).abs() < 0.02, "{early}");
    run(&mut world, 1.0);
    let late = world.link(0).angular_velocity_world_rad_s.z;
    assert!((late - 5.0).abs() < 1e-6, "{late}");
}

#[test]
fn coefficients_of_both_shapes_add_up_and_each_of_them_changes_the_motion() {
    let stop_m = |own: f64, floors: f64| {
        let turning = |rolling_m: f64| TurningFriction {
            rolling_m,
            torsional_m: 0.0,
        };
        let mut ground: Fixture = floor();
        ground.collider.turning = turning(floors);
        let mut world = world(
            vec![ball(turning(own), at(0.0, 0.0, RADIUS_M))],
            vec![ground],
        );
        let spin = Vec3::Y * (0.3 / RADIUS_M);
        world.set_root(0, at(0.0, 0.0, RADIUS_M), Vec3::X * 0.3, spin);
        run(&mut world, 2.0);
        world.link(0).centre_world_m.x
    };
    let both = stop_m(0.001, 0.002);
    assert!((both / stop_m(0.003, 0.0) - 1.0).abs() < 1e-9);
    assert!((both / stop_m(0.0, 0.003) - 1.0).abs() < 1e-9);
    assert!(stop_m(0.0, 0.0) > 0.59, "nothing brakes it");
}

#[test]
fn coefficients_of_zero_change_nothing_and_wrong_ones_are_refused() {
    let path = |turning: TurningFriction| {
        let turned = Rot3::from_scaled_axis(Vec3::new(0.3, 0.5, 0.2));
        let pose = Pose::from_parts(Vec3::Z * 0.08, turned);
        let mut world = world(vec![cylinder(turning, 0.6, pose)], vec![floor()]);
        world.set_root(0, pose, Vec3::X, Vec3::new(3.0, 15.0, 20.0));
        run(&mut world, 1.0);
        let state = world.link(0);
        (state.centre_world_m, state.angular_velocity_world_rad_s)
    };
    assert_eq!(path(TurningFriction::default()), {
        let law = TurningFriction {
            rolling_m: 0.0,
            torsional_m: 0.0,
        };
        path(law)
    });
    for (rolling_m, torsional_m) in [(-1e-3, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0)] {
        let law = TurningFriction {
            rolling_m,
            torsional_m,
        };
        let wrong = model(vec![ball(law, Pose::IDENTITY)], vec![floor()], 960.0);
        let message = World::new(&wrong).err().unwrap().message;
        assert!(message.contains("rolling"), "{message}");
    }
    let mut relaxed = model(vec![ball(LAW, Pose::IDENTITY)], vec![floor()], 960.0);
    relaxed.settings.cone = Cone::Relaxed;
    let message = World::new(&relaxed).err().unwrap().message;
    assert!(message.contains("relaxed"), "{message}");
}
