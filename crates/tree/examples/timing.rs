//! Benchmark of the tree solver on five robots: CPU time per simulated second, and the distance of the path from that with much
//! finer settings.
//!
//! `cargo run --release --example timing [robot]`
#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "an example prints"
)]

use realgap_tree::parry::math::{Mat3, Pose, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{
    Attachment, Collider, Command, Fixture, Joint, JointType, Link, Model, Settings, World,
};

/// A hinge's servo: torque law (stiffness, damping, limit), or speed law (gain, limit of torque and speed).
#[derive(Clone, Copy)]
enum Law {
    Torque,
    Speed,
}

struct Drive {
    link: usize,
    offset: f64,
    amplitude: f64,
    frequency: f64,
    phase: f64,
}

struct Robot {
    name: &'static str,
    links: Vec<Link>,
    drives: Vec<Drive>,
    law: Law,
    start: Vec<Vec3>,
}

impl Robot {
    fn new(name: &'static str, law: Law) -> Self {
        Self {
            name,
            links: Vec::new(),
            drives: Vec::new(),
            law,
            start: Vec::new(),
        }
    }

    /// Adds a box at this position, free or jointed to a parent at a point of the world.
    fn part(
        &mut self,
        centre: Vec3,
        size: Vec3,
        mass: f64,
        parent: Option<(usize, JointType, Vec3, Vec3)>,
    ) -> usize {
        let s = size * size;
        let attachment = match parent {
            None => Attachment::Free {
                world_from_link: Pose::from_translation(centre),
            },
            Some((parent, kind, at, axis)) => Attachment::Joint(Joint {
                parent_from_joint: Pose::from_translation(at - self.start[parent]),
                link_from_joint: Pose::from_translation(at - centre),
                ..Joint::new(parent, kind, axis)
            }),
        };
        let half = size * 0.5;
        let inertia = Vec3::new(s.y + s.z, s.x + s.z, s.x + s.y) * (mass / 12.0);
        self.links.push(Link {
            attachment,
            mass_kg: mass,
            centre_link_m: Vec3::ZERO,
            inertia_link_kg_m2: Mat3::from_diagonal(inertia),
            compensated: (0.0, Vec3::ZERO),
            colliders: vec![Collider::new(
                SharedShape::cuboid(half.x, half.y, half.z),
                0.5,
            )],
        });
        self.start.push(centre);
        self.links.len() - 1
    }

    fn drive(&mut self, link: usize, offset: f64, amplitude: f64, frequency: f64, phase: f64) {
        self.drives.push(Drive {
            link,
            offset,
            amplitude,
            frequency,
            phase,
        });
    }

    fn command(&self, world: &mut World, time: f64) {
        for d in &self.drives {
            let swing = (std::f64::consts::TAU * d.frequency * time + d.phase).sin();
            let target = d.offset + d.amplitude * swing;
            let command = match self.law {
                Law::Torque => Command::Servo {
                    target,
                    stiffness: 5.0,
                    damping: 0.05,
                    max_torque: 0.5,
                },
                Law::Speed => {
                    let error = target - world.joint(d.link).0;
                    if (30.0 * error).abs() > 8.0 {
                        Command::Velocity {
                            target: 8.0_f64.copysign(error),
                            gain: 1.0,
                            max_torque: 0.2,
                        }
                    } else {
                        Command::Servo {
                            target,
                            stiffness: 30.0,
                            damping: 1.0,
                            max_torque: 0.2,
                        }
                    }
                }
            };
            world.command(d.link, command);
        }
    }
}

/// Number of runs over which the time is averaged.
const REPEATS: u32 = 12;
const CUBE: Vec3 = Vec3::splat(0.06);
const Z: f64 = 0.031;

fn chain(name: &'static str, many: usize, turn: f64, twisted: bool) -> Robot {
    let mut robot = Robot::new(name, Law::Torque);
    for k in 0..many {
        let x = 0.06 * k as f64;
        let axis = if twisted && k % 2 == 0 {
            Vec3::Z
        } else {
            Vec3::Y
        };
        let parent = (k > 0).then(|| {
            (
                k - 1,
                JointType::Continuous,
                Vec3::new(x - 0.03, 0.0, Z),
                axis,
            )
        });
        let link = robot.part(Vec3::new(x, 0.0, Z), CUBE, 0.1, parent);
        if k > 0 {
            robot.drive(link, 0.0, 0.7, 1.0, turn * (k - 1) as f64);
        }
    }
    robot
}

fn spider() -> Robot {
    let mut robot = Robot::new("spider8", Law::Torque);
    let core = [(0.0, 0.0), (0.0, 0.06), (-0.06, 0.06), (-0.06, 0.0)];
    for (k, (x, y)) in core.into_iter().enumerate() {
        let centre = Vec3::new(x, y, Z);
        let parent = (k > 0).then_some((0, JointType::Fixed, centre, Vec3::X));
        robot.part(centre, CUBE, 0.1, parent);
    }
    let arms = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    for (k, (dx, dy)) in arms.into_iter().enumerate() {
        let out = Vec3::new(dx, dy, 0.0);
        let centre = robot.start[k] + out * 0.06;
        let axis = if dx == 0.0 { Vec3::X } else { Vec3::Y };
        let at = robot.start[k] + out * 0.03;
        let arm = robot.part(
            centre,
            CUBE,
            0.1,
            Some((k, JointType::Continuous, at, axis)),
        );
        robot.drive(arm, 0.0, 0.7, 1.0, 0.5 * std::f64::consts::PI * k as f64);
    }
    robot
}

/// Adds a plate on a face of a module; the plate turns about the face's normal.
fn plate(robot: &mut Robot, module: usize, face: Vec3, side: f64, thick: f64, cube: f64) -> usize {
    let at = robot.start[module] + face * (0.5 * cube);
    let flat = Vec3::splat(side) - face.abs() * (side - thick);
    let centre = at + face * (0.5 * thick);
    robot.part(
        centre,
        flat,
        0.012,
        Some((module, JointType::Continuous, at, face)),
    )
}

fn tripod() -> Robot {
    let mut robot = Robot::new("tripod", Law::Speed);
    let z = 0.0335;
    robot.part(Vec3::new(0.0, 0.0, z), CUBE, 0.03, None);
    for (x, y) in [(0.06, 0.0), (0.12, 0.0), (0.0, 0.06)] {
        let centre = Vec3::new(x, y, z);
        robot.part(
            centre,
            CUBE,
            0.068,
            Some((0, JointType::Fixed, centre, Vec3::X)),
        );
    }
    let gaits = [
        (1, -Vec3::Y, 0.8437, 0.7699, 5.588),
        (2, Vec3::X, 0.4451, 0.9525, 3.987),
        (3, -Vec3::X, 0.1305, 1.0447, 5.479),
    ];
    for (module, face, offset, amplitude, phase) in gaits {
        let link = plate(&mut robot, module, face, 0.066, 0.01, 0.06);
        robot.drive(link, offset, amplitude, 1.25, phase);
    }
    robot
}

fn walker() -> Robot {
    let mut robot = Robot::new("walker", Law::Speed);
    robot.part(Vec3::new(0.0, 0.0, 0.0295), Vec3::splat(0.058), 0.068, None);
    let link = plate(&mut robot, 0, -Vec3::Y, 0.058, 0.006, 0.058);
    robot.drive(link, 0.745, 0.989, 0.674, 5.322);
    robot
}

fn model(robot: &Robot, settings: Settings) -> Model {
    Model {
        gravity_world_m_s2: Vec3::new(0.0, 0.0, -9.81),
        links: robot.links.clone(),
        fixtures: vec![Fixture::at_rest(
            Collider::new(SharedShape::halfspace(Vec3::Z), 1.0),
            Pose::identity(),
        )],
        collision_exclude: Vec::new(),
        settings,
    }
}

/// CPU time of this process, s.
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    let first = stat.split_whitespace().next().unwrap_or("0");
    first.parse::<f64>().unwrap_or(0.0) * 1e-9
}

struct Run {
    path: Vec<Vec3>,
    ms_per_s: f64,
    sweeps: f64,
    contacts: f64,
}

/// Simulates a robot and records the positions of its first link 60 times per second.
fn run(robot: &Robot, settings: Settings, time_s: f64) -> Run {
    let mut world = World::new(&model(robot, settings)).unwrap();
    let steps = (time_s / settings.timestep_s).round() as usize;
    let every = (steps as f64 / (60.0 * time_s)).round().max(1.0) as usize;
    let mut path = Vec::with_capacity(steps / every + 1);
    let mut contacts = 0;
    let start = cpu_s();
    for step in 0..steps {
        robot.command(&mut world, step as f64 * settings.timestep_s);
        world.step();
        contacts += world.contacts().count();
        if (step + 1) % every == 0 {
            path.push(world.link(0).centre_world_m);
        }
    }
    Run {
        path,
        ms_per_s: (cpu_s() - start) * 1e3 / time_s,
        sweeps: world.sweeps_done() as f64 / steps as f64,
        contacts: contacts as f64 / steps as f64,
    }
}

fn main() {
    let wanted = std::env::args().nth(1);
    let quarter = 0.5 * std::f64::consts::PI;
    let robots = [
        tripod(),
        walker(),
        chain("chain3", 3, quarter, false),
        spider(),
        chain("chain30", 30, 0.5 * quarter, true),
    ];
    for robot in robots {
        if wanted.as_ref().is_some_and(|name| name != robot.name) {
            continue;
        }
        let hard = Settings {
            timestep_s: 1.0 / 15360.0,
            contact_frequency_hz: 2400.0,
            sweeps: 40,
            impact_sweeps: 200,
            ..Settings::default()
        };
        let time_s = 4.0;
        let limit = run(&robot, hard, time_s);
        let end = limit.path[limit.path.len() - 1] - limit.path[0];
        println!(
            "{:8} limit: {:.4} m, {:.0} ms",
            robot.name,
            end.truncate().length(),
            limit.ms_per_s
        );
        for (rate, frequency_hz, sweeps) in [
            (240.0, 120.0, 4),
            (480.0, 200.0, 4),
            (480.0, 300.0, 4),
            (480.0, 300.0, 8),
            (960.0, 300.0, 4),
            (960.0, 300.0, 8),
        ] {
            let settings = Settings {
                timestep_s: 1.0 / rate,
                contact_frequency_hz: frequency_hz,
                sweeps,
                ..Settings::default()
            };
            let got = run(&robot, settings, time_s);
            // The kernel's clock is coarse, so the time is averaged over several runs.
            let start = cpu_s();
            for _ in 0..REPEATS {
                run(&robot, settings, time_s);
            }
            let again = (cpu_s() - start) * 1e3 / (time_s * f64::from(REPEATS));
            let squares: f64 = got
                .path
                .iter()
                .zip(&limit.path)
                .map(|(a, b)| (*a - *b).truncate().length_squared())
                .sum();
            let rms = (squares / got.path.len() as f64).sqrt();
            let end = got.path[got.path.len() - 1] - got.path[0];
            println!(
                "{:8} {rate:5}/s {frequency_hz:4} Hz x{sweeps}: {again:7.2} ms/s ({:.2} us/step), {:.1} contacts, {:.1} sweeps; {:.4} m, rms {:.2} mm",
                robot.name,
                again * 1e3 / rate,
                got.contacts,
                got.sweeps,
                end.truncate().length(),
                rms * 1e3
            );
        }
    }
}
