//! Tests of contacts between links of one or several trees, for all shapes, and of moving fixtures.
#![allow(clippy::unwrap_used)]

use super::common::*;
use realgap_tree::parry::math::{Mat3, Pose, Rot3, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{
    Attachment, Collider, Command, Fixture, Joint, JointType, Link, Model, Partner, World,
};

/// Random numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    }

    fn below(&mut self, many: usize) -> usize {
        ((0.5 * self.next() + 0.5) * many as f64) as usize % many
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

fn spin_of(world: &World, m: &Model, link: usize) -> Vec3 {
    let state = world.link(link);
    let turn = Mat3::from_quat(state.world_from_link.rotation);
    turn * m.links[link].inertia_link_kg_m2 * turn.transpose() * state.angular_velocity_world_rad_s
}

/// Linear and angular momentum.
fn momenta(world: &World, m: &Model) -> (Vec3, Vec3) {
    let mut sum = (Vec3::ZERO, Vec3::ZERO);
    for (link, its) in m.links.iter().enumerate() {
        let state = world.link(link);
        let p = state.velocity_world_m_s * its.mass_kg;
        sum.0 += p;
        sum.1 += state.centre_world_m.cross(p) + spin_of(world, m, link);
    }
    sum
}

/// A body with two arms of two links, like the claws of a crab, which meet in front of the body.
fn crab(x: f64) -> Vec<Link> {
    let mut links = vec![cube(0.5, at(x, 0.0, 0.0))];
    for side in [1.0, -1.0] {
        let first = links.len();
        for k in 0..2 {
            let mut link = block(0.05, Vec3::new(0.08, 0.02, 0.02), 0.5, Pose::identity());
            let hang = if k == 0 {
                Vec3::new(0.03, 0.05 * side, 0.0)
            } else {
                Vec3::new(0.04, 0.0, 0.0)
            };
            link.attachment = Attachment::Joint(Joint {
                parent_from_joint: Pose::from_translation(hang),
                link_from_joint: at(-0.04, 0.0, 0.0),
                ..Joint::new(
                    if k == 0 { 0 } else { first },
                    JointType::Continuous,
                    Vec3::Z,
                )
            });
            links.push(link);
        }
    }
    links
}

#[test]
fn claws_that_meet_keep_the_momentum_of_the_crab() {
    let mut m = model(crab(0.0), vec![], 3840.0);
    m.gravity_world_m_s2 = Vec3::ZERO;
    let mut world = World::new(&m).unwrap();
    world.set_root(
        0,
        Pose::identity(),
        Vec3::new(0.1, 0.2, 0.3),
        Vec3::new(0.2, 0.1, 0.3),
    );
    world.set_joint(1, 0.0, -3.0);
    world.set_joint(3, 0.0, 3.0);
    let before = momenta(&world, &m);
    let (mut met, mut angular) = (0, 0.0_f64);
    for _ in 0..3840 {
        world.step();
        met += world
            .contacts()
            .filter(|contact| contact.impulse_world_n_s.length() > 0.0)
            .count();
        let now = momenta(&world, &m);
        angular = angular.max((now.1 - before.1).length() / before.1.length());
    }
    // Velocities belong to the middle of a step, positions to its ends.
    let centre = |world: &World| -> Vec3 {
        (0..5)
            .map(|link| world.link(link).centre_world_m * m.links[link].mass_kg)
            .sum()
    };
    let from = centre(&world);
    world.step();
    world.step();
    let path = (centre(&world) - from) * (0.5 * 3840.0);
    let linear = (path - before.0).length() / before.0.length();
    println!(
        "claws met {met} times; momentum off by {linear:.2e}, angular by at most {angular:.2e}"
    );
    assert!(met > 10 && linear < 2e-3 && angular < 0.01 && world.is_finite());
}

#[test]
fn crabs_that_collide_keep_their_momentum() {
    let mut links = crab(0.0);
    for mut link in crab(0.35) {
        if let Attachment::Joint(joint) = &mut link.attachment {
            joint.parent += 5;
        }
        links.push(link);
    }
    let mut m = model(links, vec![], 3840.0);
    m.gravity_world_m_s2 = Vec3::ZERO;
    let mut world = World::new(&m).unwrap();
    world.set_root(
        0,
        Pose::identity(),
        Vec3::new(1.0, 0.05, 0.0),
        Vec3::new(0.2, 0.1, 0.3),
    );
    let before = momenta(&world, &m);
    let start = world.kinetic_energy_j();
    let mut met = 0;
    for _ in 0..3840 {
        world.step();
        met += world
            .contacts()
            .filter(|contact| {
                (contact.link < 5) != matches!(contact.partner, Partner::Link(other) if other < 5)
                    && contact.impulse_world_n_s.length() > 0.0
            })
            .count();
        assert!(world.kinetic_energy_j() < 1.01 * start);
    }
    let after = momenta(&world, &m);
    let linear = (after.0 - before.0).length() / before.0.length();
    println!("crabs met {met} times; momentum off by {linear:.2e}");
    assert!(met > 3 && linear < 2e-3);
}

/// A link of this shape with the mass properties of a cube of its size.
fn lump(shape: SharedShape, pose: Pose) -> Link {
    let mut link = cube(0.6, pose);
    link.colliders = vec![Collider::new(shape, 0.6)];
    link
}

fn hull() -> SharedShape {
    let mut points = Vec::new();
    for k in 0..8 {
        let sign = |bit: usize| if k >> bit & 1 == 0 { 0.03 } else { -0.03 };
        points.push(Vec3::new(sign(0), sign(1), sign(2)));
    }
    SharedShape::convex_hull(&points).unwrap()
}

fn ground_mesh() -> SharedShape {
    let vertices = vec![
        Vec3::new(-1.0, -1.0, 0.0),
        Vec3::new(1.0, -1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(-1.0, 1.0, 0.0),
    ];
    SharedShape::trimesh(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

#[test]
fn every_shape_comes_to_rest_on_every_ground() {
    let upright = Rot3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let shapes = [
        (
            "cuboid",
            SharedShape::cuboid(0.03, 0.03, 0.03),
            Rot3::IDENTITY,
        ),
        ("hull", hull(), Rot3::IDENTITY),
        ("cylinder", SharedShape::cylinder(0.03, 0.03), upright),
        ("ball", SharedShape::ball(0.03), Rot3::IDENTITY),
        (
            "capsule",
            SharedShape::capsule_x(0.03, 0.03),
            Rot3::IDENTITY,
        ),
        (
            "compound",
            SharedShape::compound(vec![
                (at(0.03, 0.0, 0.0), SharedShape::cuboid(0.03, 0.03, 0.03)),
                (at(-0.03, 0.0, 0.0), SharedShape::cuboid(0.03, 0.03, 0.03)),
            ]),
            Rot3::IDENTITY,
        ),
    ];
    let grounds = [
        ("half-space", SharedShape::halfspace(Vec3::Z), 0.0),
        ("block", SharedShape::cuboid(1.0, 1.0, 0.5), -0.5),
        ("mesh", ground_mesh(), 0.0),
    ];
    for (name, shape, turn) in &shapes {
        for (ground_name, ground, height) in &grounds {
            let pose = Pose::from_parts(Vec3::new(0.31, 0.17, 0.05), *turn);
            let fixture =
                Fixture::at_rest(Collider::new(ground.clone(), 1.0), at(0.0, 0.0, *height));
            let mut world = world(vec![lump(shape.clone(), pose)], vec![fixture]);
            run(&mut world, 2.0);
            let state = world.link(0);
            let sag = 0.03 - state.centre_world_m.z;
            let held: f64 = world
                .contacts()
                .map(|contact| contact.impulse_world_n_s.z)
                .sum();
            let weight = 0.1 * G / 960.0;
            println!(
                "{name} on {ground_name}: sag {:.1} um, speed {:.1e}, holds {:.6}",
                1e6 * sag,
                state.velocity_world_m_s.length(),
                held / weight
            );
            assert!(
                (-1e-6..2e-5).contains(&sag),
                "{name} on {ground_name}: {sag}"
            );
            assert!(state.velocity_world_m_s.length() < 1e-3 && (held / weight - 1.0).abs() < 0.01);
        }
    }
}

#[test]
fn a_stack_of_cubes_stands() {
    let links = (0..5)
        .map(|k| cube(0.6, at(0.0, 0.0, 0.0301 + 0.0602 * f64::from(k))))
        .collect();
    let mut world = world(links, vec![floor()]);
    run(&mut world, 5.0);
    let top = world.link(4).centre_world_m;
    println!("stack: top at {top:?}");
    assert!((top - Vec3::new(0.0, 0.0, 0.27)).length() < 1e-3);
}

#[test]
fn a_belt_carries_a_cube_along_and_a_moving_wall_pushes_it() {
    let mut belt = Fixture::at_rest(
        Collider::new(SharedShape::cuboid(2.0, 2.0, 0.5), 1.0),
        at(0.0, 0.0, -0.5),
    );
    belt.velocity_world_m_s = Vec3::X * 0.2;
    let mut m = model(vec![cube(0.5, at(0.0, 0.0, 0.03))], vec![belt], 960.0);
    let mut world = World::new(&m).unwrap();
    run(&mut world, 1.0);
    // The cube slides for the time v / (µ g), and then moves with the belt.
    let right = 0.2 * (1.0 - 0.5 * 0.2 / (0.5 * G));
    let state = world.link(0);
    println!(
        "belt: {:.3} %",
        100.0 * (state.centre_world_m.x / right - 1.0)
    );
    assert!((state.velocity_world_m_s.x - 0.2).abs() < 1e-6);
    assert!((state.centre_world_m.x / right - 1.0).abs() < 0.01);

    let mut wall = Fixture::at_rest(
        Collider::new(SharedShape::cuboid(0.01, 0.2, 0.2), 0.0),
        at(-0.1, 0.0, 0.0),
    );
    wall.velocity_world_m_s = Vec3::X * 0.1;
    m = model(
        vec![cube(0.5, at(0.0, 0.0, 0.03))],
        vec![floor(), wall],
        960.0,
    );
    let mut world = World::new(&m).unwrap();
    run(&mut world, 2.0);
    let state = world.link(0);
    let wall_m = world.fixture(1).translation.x;
    println!(
        "wall pushes: gap {:.2e} m",
        state.centre_world_m.x - wall_m - 0.04
    );
    assert!((state.centre_world_m.x - wall_m - 0.04).abs() < 1e-4 && (wall_m - 0.1).abs() < 1e-9);
}

#[test]
fn excluded_groups_and_pairs_have_no_contacts() {
    let through = |change: &dyn Fn(&mut Model)| {
        let mut m = model(
            vec![cube(0.5, at(0.0, 0.0, 0.03)), cube(0.5, at(0.0, 0.0, 0.2))],
            vec![floor()],
            960.0,
        );
        change(&mut m);
        let mut world = World::new(&m).unwrap();
        run(&mut world, 1.0);
        world.link(1).centre_world_m.z
    };
    assert!(through(&|_| ()) > 0.08);
    let stated = through(&|m| {
        (m.links[0].colliders[0].mark, m.links[1].colliders[0].mark) = (1, 2);
        m.collision_exclude.push((2, 1));
    });
    assert!(stated < 0.031);
    assert!(
        through(&|m| for link in &mut m.links {
            link.colliders[0].group = 7;
        }) < 0.031
    );
}

/// Position of a neighbour at this face, in the frame of the first link with all joints at 0.
fn at_face(links: &[Link], mut parent: usize, face: Vec3) -> Vec3 {
    let mut place = face * 0.06;
    while let Attachment::Joint(joint) = &links[parent].attachment {
        place += joint.parent_from_joint.translation - joint.link_from_joint.translation;
        parent = joint.parent;
    }
    place
}

/// A random robot of cubes and plates on hinges of all kinds, driven at random.
fn creature(random: &mut Random) -> Vec<Link> {
    let many = 2 + random.below(5);
    let mut links = vec![cube(0.5, at(0.0, 0.0, 0.4))];
    let faces = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    // Positions are unique: one neighbour per face, and the robot grows away from its first link.
    let mut taken = Vec::new();
    for _ in 0..100 {
        if links.len() == many {
            break;
        }
        let (parent, face) = (random.below(links.len()), faces[random.below(6)]);
        let place = at_face(&links, parent, face);
        if taken
            .iter()
            .any(|other: &Vec3| other.distance(place) < 0.055)
            || place.length() < 0.055
        {
            continue;
        }
        taken.push(place);
        let plate = random.next() > 0.0;
        let size = if plate {
            Vec3::splat(0.058) - face.abs() * 0.052
        } else {
            Vec3::splat(0.06)
        };
        let mut link = block(if plate { 0.012 } else { 0.1 }, size, 0.5, Pose::identity());
        let axis = if plate { face } else { faces[random.below(6)] };
        let kind = [
            JointType::Continuous,
            JointType::Revolute,
            JointType::Prismatic,
            JointType::Fixed,
        ][random.below(4)];
        let outside = face * 0.03 + face * (size.dot(face.abs()) * 0.5);
        link.attachment = Attachment::Joint(Joint {
            parent_from_joint: Pose::from_translation(face * 0.03),
            link_from_joint: Pose::from_translation(face * 0.03 - outside),
            limits: match kind {
                JointType::Revolute => Some((-1.0, 1.0)),
                JointType::Prismatic => Some((-0.005, 0.03)),
                _ => None,
            },
            dry_friction: 0.01 * random.next().max(0.0),
            viscous_friction: 0.001 * random.next().max(0.0),
            armature: 1e-4 * random.next().max(0.0),
            ..Joint::new(parent, kind, axis)
        });
        link.colliders[0].restitution = 0.5 * random.next().max(0.0);
        links.push(link);
    }
    links
}

#[test]
fn no_random_robot_diverges() {
    let mut random = Random(7);
    let (mut fastest, mut cost, mut frictionless) = (0.0_f64, 0, 0);
    for number in 0..200 {
        let links = creature(&mut random);
        let laws: Vec<(f64, f64, usize)> = links
            .iter()
            .map(|_| (random.next(), random.next(), random.below(4)))
            .collect();
        let rate = [240.0, 480.0, 960.0][number % 3];
        let mut world = World::new(&model(links, vec![floor()], rate)).unwrap();
        world.set_root(
            0,
            at(0.0, 0.0, 0.4),
            random.vector(),
            random.vector() * 10.0,
        );
        let steps = (4.0 * rate) as usize;
        for step in 0..steps {
            let t = step as f64 / rate;
            for (link, (a, b, law)) in laws.iter().enumerate().skip(1) {
                let target = a * (3.0 * t + b).sin();
                world.command(
                    link,
                    match law {
                        0 => Command::Off,
                        1 => Command::Servo {
                            target,
                            stiffness: 5.0,
                            damping: 0.05,
                            max_torque: 0.5,
                        },
                        2 => Command::Servo {
                            target,
                            stiffness: 30.0,
                            damping: 1.0,
                            max_torque: 0.2,
                        },
                        _ => Command::Velocity {
                            target: 8.0 * target.signum(),
                            gain: 1.0,
                            max_torque: 0.2,
                        },
                    },
                );
            }
            world.step();
            assert!(world.is_finite(), "robot {number} step {step}");
        }
        frictionless += world.frictionless_steps();
        cost += world.sweeps_done();
        let speed = world.link(0).velocity_world_m_s.length();
        assert!(speed < 5.0, "robot {number} at {speed} m/s");
        fastest = fastest.max(speed);
    }
    println!(
        "200 random robots: fastest at the end {fastest:.2} m/s, {cost} sweeps, {frictionless} frictionless steps"
    );
}

#[test]
fn a_world_may_move_to_another_thread() {
    fn sent<T: Send>(_: &T) {}
    sent(&world(crab(0.0), vec![floor()]));
}

#[test]
fn an_invalid_model_is_refused_with_a_reason() {
    let mut weightless = cube(0.5, Pose::identity());
    weightless.mass_kg = 0.0;
    let mut orphan = cube(0.5, Pose::identity());
    orphan.attachment = Attachment::Joint(Joint::new(3, JointType::Revolute, Vec3::X));
    for (link, reason) in [
        (weightless, "weighs nothing"),
        (orphan, "before its children"),
    ] {
        let error = World::new(&model(vec![link], vec![], 960.0)).err().unwrap();
        assert!(error.message.contains(reason), "{error}");
    }
}
