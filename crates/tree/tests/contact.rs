//! Tests of contacts against closed-form solutions.
#![allow(clippy::unwrap_used)]

use super::common::*;
use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{Collider, Link, World};

fn z(world: &World) -> f64 {
    world.link(0).centre_world_m.z
}

fn slider(friction: f64, speed: f64) -> World {
    let mut world = world(vec![cube(friction, at(0.0, 0.0, 0.03))], vec![floor()]);
    run(&mut world, 0.1);
    let pose = world.link(0).world_from_link;
    world.set_root(0, pose, Vec3::X * speed, Vec3::ZERO);
    world
}

#[test]
fn a_sliding_cube_stops_after_v2_over_2_mu_g() {
    let mut world = slider(0.4, 1.0);
    let start = world.link(0).centre_world_m.x;
    run(&mut world, 1.0);
    let error = (world.link(0).centre_world_m.x - start) / (1.0 / (2.0 * 0.4 * G)) - 1.0;
    println!("slide: {:.3} %", 100.0 * error);
    assert!(error.abs() < 0.01);
}

fn on_slope(links: Vec<Link>, angle: f64, lift: f64) -> World {
    let mut world = world(links, vec![tilted(angle)]);
    let turn = Rot3::from_rotation_y(angle);
    world.set_root(
        0,
        Pose::from_parts(turn * (Vec3::Z * lift), turn),
        Vec3::ZERO,
        Vec3::ZERO,
    );
    world
}

#[test]
fn a_slope_holds_below_the_friction_angle_and_not_above() {
    let mu = 0.5_f64;
    for share in [0.99, 1.01] {
        let angle = (mu * share).atan();
        let mut world = on_slope(vec![cube(mu, Pose::identity())], angle, 0.03);
        run(&mut world, 0.5);
        let start = world.link(0).centre_world_m;
        run(&mut world, 2.0);
        let gone = (world.link(0).centre_world_m - start).length();
        println!("slope at {share}: {:.2e} m in 2 s", gone);
        if share < 1.0 {
            assert!(gone < 1e-5);
        } else {
            let a = G * (angle.sin() - mu * angle.cos());
            let right = 0.5 * a * (2.5_f64.powi(2) - 0.5_f64.powi(2));
            assert!((gone / right - 1.0).abs() < 0.02, "{gone} {right}");
        }
    }
}

#[test]
fn a_cube_on_its_plate_stands_and_does_not_creep() {
    let mu = 0.5_f64;
    let angle = (0.9 * mu).atan();
    let mut world = on_slope(cube_on_plate(mu, 0.0, 0.0), angle, 0.035);
    world.command(1, hold(0.0));
    run(&mut world, 1.0);
    let start = world.link(1).centre_world_m;
    run(&mut world, 9.0);
    let crept = (world.link(1).centre_world_m - start).length();
    println!(
        "creep on a slope at 0.9 of the friction angle: {:.2e} m in 9 s",
        crept
    );
    assert!(crept < 1e-4);

    let mut world = super::common::world(cube_on_plate(mu, 0.0, 0.0), vec![floor()]);
    world.command(1, hold(0.0));
    run(&mut world, 1.0);
    let sag = 0.003 - world.link(1).centre_world_m.z;
    println!("sag of a cube on its plate: {:.2e} m", sag);
    assert!(sag > 0.0 && sag < 2e-5);
    let start = world.link(0).centre_world_m;
    for step in 0..20 * 960 {
        let t = f64::from(step) / 960.0;
        world.command(1, hold(0.7 * (std::f64::consts::TAU * t).sin()));
        world.step();
    }
    let crept = (world.link(0).centre_world_m - start).length();
    println!("creep of a cube whose plate twists 20 s: {:.2e} m", crept);
    assert!(crept < 1e-4);
}

/// Height of the first apex after the first bounce over e² times the drop.
fn bounce(e: f64, link: Link, rest_m: f64, drop_m: f64, rate: f64) -> f64 {
    let mut link = link;
    link.colliders[0].restitution = e;
    let mut m = model(vec![link], vec![floor()], rate);
    m.settings.contact_frequency_hz = 300.0;
    let mut world = World::new(&m).unwrap();
    world.set_root(0, at(0.0, 0.0, rest_m + drop_m), Vec3::ZERO, Vec3::ZERO);
    let (mut bounced, mut top) = (false, 0.0_f64);
    for _ in 0..(2.0 * rate) as usize {
        world.step();
        let v = world.link(0).velocity_world_m_s.z;
        bounced |= v > 0.0;
        if bounced {
            top = top.max(z(&world) - rest_m);
            if v < 0.0 {
                break;
            }
        }
    }
    top / (e * e * drop_m) - 1.0
}

#[test]
fn flat_bounces_rise_to_e_squared() {
    for e in [0.3, 0.5, 0.7, 0.9] {
        for drop in [0.1, 0.237, 0.5] {
            let flat = bounce(e, cube(0.5, Pose::identity()), 0.03, drop, 960.0);
            let mut ball = cube(0.5, Pose::identity());
            ball.colliders = vec![Collider::new(SharedShape::ball(0.03), 0.5)];
            let round = bounce(e, ball, 0.03, drop, 960.0);
            println!(
                "bounce e {e} from {drop} m: cube {:.3} %, ball {:.3} %",
                100.0 * flat,
                100.0 * round
            );
            assert!(flat.abs() < 0.01 && round.abs() < 0.01);
        }
    }
}

#[test]
fn an_oblique_flat_bounce_loses_the_speed_that_coulomb_friction_predicts() {
    let (mu, e) = (0.3, 0.5);
    let mut link = cube(mu, Pose::identity());
    link.colliders[0].restitution = e;
    let (drop, vx) = (0.3_f64, 3.0);
    let mut world = world(vec![link], vec![floor()]);
    world.set_root(0, at(0.0, 0.0, 0.03 + drop), Vec3::X * vx, Vec3::ZERO);
    let vz = (2.0 * G * drop).sqrt();
    while world.link(0).velocity_world_m_s.z <= 0.0 {
        world.step();
    }
    let state = world.link(0);
    let right = vx - mu * (1.0 + e) * vz;
    let speed = state.velocity_world_m_s.x / right - 1.0;
    let direction = |x: f64, z: f64| z.atan2(x).to_degrees();
    // The values are converted to the floor's height: the velocity belongs to the middle of a step, a little above the floor.
    let h = 0.5 / 960.0;
    let height = z(&world) - 0.03 - h * state.velocity_world_m_s.z;
    let leaving = (state.velocity_world_m_s.z.powi(2) + 2.0 * G * height).sqrt();
    let off = direction(state.velocity_world_m_s.x, leaving) - direction(right, e * vz);
    let spin = state.angular_velocity_world_rad_s.y;
    println!(
        "oblique bounce: speed {:.3} %, direction {off:.3} deg, spin {spin:.4} rad/s",
        100.0 * speed
    );
    assert!(speed.abs() < 0.01 && off.abs() < 0.2);
}

#[test]
fn a_central_hit_face_to_face_hardly_turns() {
    for (e, offset) in [(0.7, 0.0), (0.0, 0.0), (0.7, 1e-5)] {
        let mut links: Vec<Link> = (0..2)
            .map(|k| cube(0.5, at(0.1 * f64::from(k), offset * f64::from(k), 0.0)))
            .collect();
        for link in &mut links {
            link.colliders[0].restitution = f64::sqrt(e);
        }
        let mut m = model(links, vec![], 960.0);
        m.gravity_world_m_s2 = Vec3::ZERO;
        let mut world = World::new(&m).unwrap();
        world.set_root(0, Pose::identity(), Vec3::X, Vec3::ZERO);
        run(&mut world, 0.5);
        let (one, two) = (world.link(0), world.link(1));
        let turn = one
            .world_from_link
            .rotation
            .angle_between(Rot3::IDENTITY)
            .to_degrees();
        let separation = two.velocity_world_m_s.x - one.velocity_world_m_s.x;
        let total = two.velocity_world_m_s.x + one.velocity_world_m_s.x;
        println!(
            "central hit e {e}: separation {separation:.5}, total {total:.6}, turned {turn:.4} deg"
        );
        assert!((separation - e).abs() < 0.01 && (total - 1.0).abs() < 1e-6 && turn < 0.1);
    }
}

fn roll(shape: SharedShape, inertia: Mat3, share: f64) -> f64 {
    let angle = 0.2_f64;
    let mut link = cube(0.6, Pose::identity());
    link.inertia_link_kg_m2 = inertia;
    link.colliders = vec![Collider::new(shape, 0.6)];
    let mut world = on_slope(vec![link], angle, 0.03);
    let start = world.link(0).centre_world_m;
    run(&mut world, 1.0);
    let right = 0.5 * share * G * angle.sin();
    (world.link(0).centre_world_m - start).length() / right - 1.0
}

#[test]
fn balls_and_cylinders_roll_down_at_the_acceleration_of_their_inertia() {
    let (m, r) = (0.1, 0.03_f64);
    let ball = roll(
        SharedShape::ball(r),
        Mat3::from_diagonal(Vec3::splat(0.4 * m * r * r)),
        5.0 / 7.0,
    );
    let across = m * (3.0 * r * r + 0.06 * 0.06) / 12.0;
    let cylinder = roll(
        SharedShape::cylinder(0.03, r),
        Mat3::from_diagonal(Vec3::new(across, 0.5 * m * r * r, across)),
        2.0 / 3.0,
    );
    println!(
        "rolling: ball {:.3} %, cylinder {:.3} %",
        100.0 * ball,
        100.0 * cylinder
    );
    assert!(ball.abs() < 0.005 && cylinder.abs() < 0.01);
}

/// Time that a cube on an edge, tipped by 0.02 rad, takes to lean by half a radian: relative error against the closed form.
fn topple(rate: f64) -> f64 {
    let (side, tip, fallen) = (0.06_f64, 0.02_f64, 0.5);
    let mut world = World::new(&model(
        vec![cube(2.0, Pose::identity())],
        vec![floor()],
        rate,
    ))
    .unwrap();
    let radius = side * 0.5_f64.sqrt();
    let turn = Rot3::from_rotation_y(std::f64::consts::FRAC_PI_4 + tip);
    let pose = Pose::from_parts(Vec3::new(0.0, 0.0, radius * tip.cos()), turn);
    world.set_root(0, pose, Vec3::ZERO, Vec3::ZERO);
    let lean = |world: &World| {
        let out = world.link(0).world_from_link.rotation * Vec3::new(1.0, 0.0, 1.0);
        (out.x.atan2(out.z) - std::f64::consts::FRAC_PI_2).abs()
    };
    let first = lean(&world);
    let (mut before, mut now, mut steps) = (first, first, 0);
    while now < fallen && steps < 2000 {
        world.step();
        (before, now) = (now, lean(&world));
        steps += 1;
    }
    let time = (f64::from(steps) - (now - fallen) / (now - before)) / rate;
    // θ'' = m g r sin θ / (I + m r²), by small steps.
    let pull = G * radius / (side * side / 6.0 + radius * radius);
    let (mut theta, mut omega, mut t, h) = (first, 0.0, 0.0, 1e-6);
    while theta < fallen {
        omega += h * pull * f64::sin(theta);
        theta += h * omega;
        t += h;
    }
    time / t - 1.0
}

#[test]
fn a_cube_topples_over_its_edge_in_the_expected_time_and_shorter_steps_are_more_exact() {
    let errors = [120.0, 240.0, 480.0, 960.0].map(topple);
    println!("edge: {:.4?} %", errors.map(|error| 100.0 * error));
    assert!(errors[3].abs() < 5e-4);
    assert!(errors[1].abs() < 0.6 * errors[0].abs() && errors[2].abs() < 0.6 * errors[1].abs());
}

/// A cube with spin hits with one corner; with much friction the corner sticks, and e acts on the normal only.
#[test]
fn a_corner_bounces_with_spin() {
    for (mu, e) in [(0.0, 0.6), (10.0, 0.6), (0.2, 0.5)] {
        let mut link = cube(mu, Pose::identity());
        link.colliders[0].restitution = e;
        let mut m = model(vec![link], vec![floor()], 960.0);
        m.gravity_world_m_s2 = Vec3::ZERO;
        let mut world = World::new(&m).unwrap();
        let turn = Rot3::from_rotation_x(0.5) * Rot3::from_rotation_y(0.7);
        let corner = |turn: Rot3| {
            let mut lowest = Vec3::splat(1.0);
            for k in 0..8 {
                let s = |bit: usize| if k >> bit & 1 == 0 { 0.03 } else { -0.03 };
                let arm = turn * Vec3::new(s(0), s(1), s(2));
                if arm.z < lowest.z {
                    lowest = arm;
                }
            }
            lowest
        };
        let (v0, w0) = (Vec3::new(3.0, 1.0, -1.5), Vec3::new(3.0, -4.0, 6.0));
        world.set_root(0, at(0.0, 0.0, 0.1) * Pose::from_rotation(turn), v0, w0);
        let mut last = turn;
        while (world.link(0).velocity_world_m_s - v0).length() < 1e-9 {
            last = world.link(0).world_from_link.rotation;
            world.step();
        }
        // The expected single impulse at the corner, at its position when it hit.
        let arm = corner(last);
        let (mass, inertia) = (0.1, 0.1 * 0.06 * 0.06 / 6.0);
        let k = Mat3::from_diagonal(Vec3::splat(1.0 / mass + arm.length_squared() / inertia))
            - Mat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z) * (1.0 / inertia);
        let at_corner = v0 + w0.cross(arm);
        let right = if mu > 1.0 {
            k.inverse() * (Vec3::new(0.0, 0.0, -e * at_corner.z) - at_corner)
        } else {
            // With small friction the corner slides during the whole impact.
            let mut p = Vec3::ZERO;
            for _ in 0..1000 {
                let slip = at_corner + k * p;
                let flat = Vec3::new(slip.x, slip.y, 0.0).normalize_or_zero() * mu;
                let unit = Vec3::Z - flat;
                p = unit * (-(1.0 + e) * at_corner.z / (k * unit).z);
            }
            p
        };
        let got = (world.link(0).velocity_world_m_s - v0) * mass;
        let error = (got - right).length() / right.length();
        println!("corner with mu {mu}, e {e}: impulse {:.3} %", 100.0 * error);
        assert!(error < 0.01);
    }
}

#[test]
fn tosses_gain_no_energy() {
    let mut seed = 1_u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    for (name, plate, e) in [
        ("cube", false, 0.5),
        ("cube with a plate", true, 0.5),
        ("cube", false, 0.0),
        ("cube with a plate", true, 0.0),
    ] {
        let mut worst = f64::NEG_INFINITY;
        for _ in 0..40 {
            let mut links = cube_on_plate(0.4, e, 0.0);
            links.truncate(if plate { 2 } else { 1 });
            let mut world = world(links, vec![floor()]);
            let turn = Rot3::from_scaled_axis(Vec3::new(random(), random(), random()) * 3.0);
            let v = Vec3::new(random(), random(), random()) * 2.0;
            let w = Vec3::new(random(), random(), random()) * 25.0;
            world.set_root(0, Pose::from_parts(Vec3::Z * 0.3, turn), v, w);
            if plate {
                world.set_joint(1, 0.0, 30.0 * random());
            }
            let ground = 0.03 * 0.08 * G;
            let start = energy(&world) + ground;
            for _ in 0..2 * 960 {
                world.step();
                worst = worst.max((energy(&world) + ground) / start - 1.0);
            }
            assert!(world.is_finite());
        }
        println!(
            "40 tosses of a {name}, e {e}: energy gains at most {:.4} %",
            100.0 * worst
        );
        assert!(worst < 0.01);
    }
}

#[test]
fn the_same_world_steps_to_the_same_bits() {
    let run_once = || {
        let mut links = cube_on_plate(0.4, 0.3, 0.0);
        links.push(cube(0.5, at(0.02, 0.01, 0.3)));
        let mut world = world(links, vec![floor()]);
        world.command(1, hold(0.5));
        run(&mut world, 2.0);
        (0..3)
            .flat_map(|link| {
                let state = world.link(link);
                let (p, v) = (state.centre_world_m, state.velocity_world_m_s);
                [p.x, p.y, p.z, v.x, v.y, v.z].map(f64::to_bits)
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(run_once(), run_once());
}
