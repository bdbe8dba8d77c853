//! The engine `tree`: an adapter of the crate `realgap-tree`, a solver for trees in reduced coordinates, without code of Rapier.
//!
//! Both engines use Parry's shapes, and the same natural frequency and damping ratio of contacts. The number of solves per step
//! is 2/3 of the experiment's substeps, rounded up: 960 solves per second with the defaults.

mod ground;

use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use realgap_tree::parry::math::{Pose, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{
    Attachment, Collider, Cone, Fixture, Joint, JointType, Link, Model, Partner, Settings,
    TurningFriction,
};

use super::engine::{Engine, EngineChoice, Load, Setup, World};
use super::experiment::{Experiment, FrictionModel, JointFormulation};
use super::ground::GroundMap;
use super::kinematics::{compensated, joint_turns, robot_from_part_at_zero};
use super::motor::Effort;
use super::mount::held;
use super::part_state::PartState;
use super::rapier::{
    LEAST_SHARE, PartMotion, Surface, from_pose, from_vector, to_matrix, to_pose, to_vector,
    total_kg, weighable,
};
use super::scene::SceneMotion;
use super::servo::Command;
use ground::floor;
use realgap_core::error::{Error, Result};
use realgap_robot::morphology::{Assembly, ClusterMass, Freedom, Hinge, Part, Role};

/// The tree solver.
#[derive(Debug, Clone, Copy)]
pub struct Tree;

/// The instance of the engine.
pub static TREE: Tree = Tree;

impl Engine for Tree {
    fn name(&self) -> &'static str {
        "tree"
    }

    fn version(&self) -> &'static str {
        concat!("realgap-tree ", env!("CARGO_PKG_VERSION"))
    }

    fn refusal(&self, experiment: &Experiment) -> Option<String> {
        if experiment.vehicle.is_some() {
            return Some("a vehicle is not a tree of links".to_owned());
        }
        if experiment.assembly.is_compliant() {
            return Some("its hinges cannot be compliant (hinge.bearing_hz)".to_owned());
        }
        // A long chain starts in this engine by default, so settings that only Rapier has count as a choice of Rapier.
        let solver = &experiment.solver;
        let asks_for_rapier = solver.joint == JointFormulation::Impulse
            || solver.relaxations > 0
            || experiment.contact.friction_model == FrictionModel::Simplified;
        let is_suited = EngineChoice::suited_to(&experiment.assembly) != EngineChoice::default();
        (asks_for_rapier && is_suited).then(|| {
            "it has no impulse joints, relaxations or simplified friction (solver.joint, solver.relaxations, contact.friction_model)"
                .to_owned()
        })
    }

    fn build(&self, setup: &Setup<'_>) -> Result<Box<dyn World>> {
        Ok(Box::new(TreeWorld::new(setup)?))
    }
}

/// Representation of a body of the scene in the solver.
#[derive(Debug, Clone, Copy)]
enum SceneHandle {
    /// Fixtures with indices from the first (included) to the second (excluded).
    Fixtures(usize, usize),
    /// A link of its own.
    Link(usize),
}

/// A world of the tree solver with one robot.
struct TreeWorld {
    world: realgap_tree::World,
    /// Number of solves per step.
    solves: usize,
    timestep_s: f64,
    masses: Vec<ClusterMass>,
    hinges: Vec<Hinge>,
    scene: Vec<SceneHandle>,
    /// Contact impulses of the previous step, if the energy balance is computed.
    loads: Option<Vec<Load>>,
    /// Impulse of each hinge's motor during the previous step, N m s, if instruments are read.
    motor_impulses: Option<Vec<f64>>,
    /// The ground, and the fixtures that it consists of, where regions have friction of their own.
    ground: Option<(GroundMap, usize)>,
    /// Whether a contact ever touched each region of the ground.
    touched: Vec<bool>,
}

impl TreeWorld {
    fn new(setup: &Setup<'_>) -> Result<Self> {
        let Setup {
            experiment,
            assembly,
            world_from_parts,
            joints,
            motion,
        } = *setup;
        let solver = &experiment.solver;
        let solves = (2 * solver.substeps).div_ceil(3);
        let contact = &experiment.contact;
        let mut model = Model {
            gravity_world_m_s2: Vec3::new(0.0, 0.0, -experiment.gravity_m_s2),
            fixtures: floor(experiment),
            links: Vec::new(),
            collision_exclude: assembly
                .collision_exclude
                .iter()
                .map(|&(a, b)| (a as u64, b as u64))
                .collect(),
            settings: Settings {
                timestep_s: solver.timestep_s / solves as f64,
                sweeps: solver.sweeps,
                contact_frequency_hz: contact.natural_frequency_hz,
                contact_damping_ratio: contact.damping_ratio,
                cone: match contact.friction_model {
                    FrictionModel::Relaxed => Cone::Relaxed,
                    FrictionModel::Simplified | FrictionModel::Coulomb => Cone::Exact,
                },
                prediction_m: contact.prediction_m,
                ..Settings::default()
            },
        };
        let least_kg = LEAST_SHARE * total_kg(assembly);
        let masses: Vec<ClusterMass> = (0..assembly.parts.len())
            .map(|part| {
                let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
                weighable(assembly.parts[part].mass(&part_from_robot), least_kg)
            })
            .collect();
        for (index, part) in assembly.parts.iter().enumerate() {
            let attachment = match assembly.hinges.iter().position(|h| h.child_part == index) {
                Some(hinge) => Attachment::Joint(joint(assembly, hinge, joints[hinge].angle_rad)),
                None if index == 0 && assembly.world_from_mount.is_some() => {
                    held(experiment, assembly, &world_from_parts[index])
                }
                None => Attachment::Free {
                    world_from_link: to_pose(&world_from_parts[index]),
                },
            };
            let mass = &masses[index];
            let (lifted_kg, lifted_m) = compensated(assembly, index);
            model.links.push(Link {
                attachment,
                mass_kg: mass.mass_kg,
                centre_link_m: to_vector(&mass.centre_m),
                inertia_link_kg_m2: to_matrix(&mass.inertia_kg_m2),
                compensated: (lifted_kg, to_vector(&lifted_m)),
                colliders: colliders(experiment, assembly, index, part),
            });
        }
        let floors = model.fixtures.len();
        let scene = add_scene(&mut model, experiment);
        let mut world = realgap_tree::World::new(&model).map_err(|error| {
            Error::invalid(error.to_string())
                .hint("give every part a mass and an inertia, or choose the engine `rapier`")
        })?;
        let turns = joint_turns(assembly, world_from_parts, joints);
        let rooted = |part: &usize| !assembly.hinges.iter().any(|h| h.child_part == *part);
        for part in (0..assembly.parts.len()).filter(rooted) {
            let at = world_from_parts[part];
            let moves = PartMotion {
                robot: motion,
                joints: turns[part],
                is_held: part == 0 && assembly.world_from_mount.is_some(),
            };
            if moves.is_held && experiment.base.is_some() {
                let arm_m = at.translation.vector - motion.about_world_m;
                let turn = motion.angular_world_rad_s;
                let linear = motion.linear_world_m_s + turn.cross(&arm_m);
                world.start_led(part, to_vector(&linear), to_vector(&turn));
                continue;
            }
            let centre_world_m = at * Point3::from(masses[part].centre_m);
            let (linear, angular) = moves.at(&centre_world_m.coords);
            world.set_root(part, to_pose(&at), to_vector(&linear), to_vector(&angular));
        }
        for (hinge, joint) in assembly.hinges.iter().zip(joints) {
            world.set_joint(hinge.child_part, joint.angle_rad, joint.speed_rad_s);
        }
        Ok(Self {
            world,
            solves,
            timestep_s: solver.timestep_s,
            masses,
            hinges: assembly.hinges.clone(),
            scene,
            loads: experiment.energy_from_s.map(|_| Vec::new()),
            motor_impulses: (!experiment.instruments.is_empty())
                .then(|| vec![0.0; assembly.hinges.len()]),
            ground: GroundMap::of(experiment).map(|map| (map, floors)),
            touched: vec![false; experiment.ground.regions.len()],
        })
    }

    /// Adds the contact impulses of the last solve.
    fn collect_loads(&mut self) {
        let Some(loads) = &mut self.loads else {
            return;
        };
        for contact in self.world.contacts() {
            let normal = contact.normal_world * contact.impulse_world_n_s.dot(contact.normal_world);
            let across = contact.impulse_world_n_s - normal;
            let partner = match contact.partner {
                Partner::Link(link) => Some(link),
                Partner::Fixture(_) => None,
            };
            for (link, sign) in [(Some(contact.link), 1.0), (partner, -1.0)] {
                let Some(part) = link.filter(|link| *link < self.masses.len()) else {
                    continue;
                };
                let centre = self.world.link(part).centre_world_m;
                loads.push(Load {
                    part,
                    arm_world_m: from_vector(contact.point_world_m - centre),
                    normal_world_n_s: from_vector(normal * sign),
                    friction_world_n_s: from_vector(across * sign),
                    couple_world_n_m_s: from_vector(contact.couple_world_n_m_s * sign),
                });
            }
        }
    }

    fn link_of(&self, hinge: usize) -> usize {
        self.hinges[hinge].child_part
    }
}

impl World for TreeWorld {
    fn step(&mut self) {
        if let Some(loads) = &mut self.loads {
            loads.clear();
        }
        if let Some(impulses) = &mut self.motor_impulses {
            impulses.fill(0.0);
        }
        for _ in 0..self.solves {
            self.world.step();
            self.collect_loads();
            self.mark_regions();
            for (impulse, hinge) in self.motor_impulses.iter_mut().flatten().zip(&self.hinges) {
                *impulse += self.world.joint_impulse(hinge.child_part).motor;
            }
        }
    }

    fn motor_torque_nm(&self, hinge: usize) -> Option<f64> {
        let impulses = self.motor_impulses.as_ref()?;
        Some(impulses[hinge] / self.timestep_s)
    }

    fn part(&self, part: usize) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
        let link = self.world.link(part);
        let pose = from_pose(&link.world_from_link);
        let angular = from_vector(link.angular_velocity_world_rad_s);
        let arm_m = pose.rotation * self.masses[part].centre_m;
        let linear = from_vector(link.velocity_world_m_s) - angular.cross(&arm_m);
        (pose, linear, angular)
    }

    fn part_state(&self, part: usize) -> PartState {
        let link = self.world.link(part);
        let mass = &self.masses[part];
        let world_from_part = from_pose(&link.world_from_link);
        let turn = world_from_part.rotation.to_rotation_matrix();
        PartState {
            world_from_part,
            centre_world_m: from_vector(link.centre_world_m),
            velocity_world_m_s: from_vector(link.velocity_world_m_s),
            angular_velocity_world_rad_s: from_vector(link.angular_velocity_world_rad_s),
            mass_kg: mass.mass_kg,
            inertia_world_kg_m2: turn * mass.inertia_kg_m2 * turn.transpose(),
        }
    }

    fn push(&mut self, part: usize, velocity_world_m_s: &Vector3<f64>) {
        let link = self.world.link(part);
        self.world.set_root(
            part,
            link.world_from_link,
            link.velocity_world_m_s + to_vector(velocity_world_m_s),
            link.angular_velocity_world_rad_s,
        );
    }

    fn hinge_angle_rad(&self, hinge: usize, near_rad: f64) -> f64 {
        let (angle_rad, _) = self.world.joint(self.link_of(hinge));
        if self.hinges[hinge].freedom == Freedom::Slide {
            return angle_rad;
        }
        let turns = ((near_rad - angle_rad) / std::f64::consts::TAU).round();
        angle_rad + turns * std::f64::consts::TAU
    }

    fn hinge_speed_rad_s(&self, hinge: usize) -> f64 {
        self.world.joint(self.link_of(hinge)).1
    }

    fn drive(&mut self, hinge: usize, _angle_rad: f64, command: Command) {
        let link = self.link_of(hinge);
        let command = match command {
            Command::Velocity {
                target_rad_s,
                damping_nm_s_rad,
                max_torque_nm,
            } => realgap_tree::Command::Velocity {
                target: target_rad_s,
                gain: damping_nm_s_rad,
                max_torque: max_torque_nm,
            },
            Command::Spring {
                error_rad,
                stiffness_nm_rad,
                damping_nm_s_rad,
                max_torque_nm,
            } => realgap_tree::Command::Servo {
                target: self.world.joint(link).0 + error_rad,
                stiffness: stiffness_nm_rad,
                damping: damping_nm_s_rad,
                max_torque: max_torque_nm,
            },
        };
        self.world.command(link, command);
    }

    fn exert(&mut self, hinge: usize, effort: &Effort) {
        let link = self.link_of(hinge);
        let bearing = &self.hinges[hinge].bearing;
        let dry_nm = bearing.dry_nm + effort.dry_nm();
        let viscous_nm_s_rad = bearing.viscous_nm_s_rad + effort.viscous_nm_s_rad;
        self.world.set_friction(link, dry_nm, viscous_nm_s_rad);
        let armature_kg_m2 = bearing.armature_kg_m2 + effort.armature_kg_m2;
        self.world.set_armature(link, armature_kg_m2);
        let command = realgap_tree::Command::Velocity {
            target: effort.shifted_target_rad_s(),
            gain: effort.damping_nm_s_rad,
            max_torque: f64::INFINITY,
        };
        self.world.command(link, command);
    }

    fn loads(&self, loads: &mut Vec<Load>) {
        loads.clear();
        loads.extend(self.loads.iter().flatten());
    }

    fn scene_poses(&self) -> Vec<Isometry3<f64>> {
        let pose = |place: &SceneHandle| match *place {
            SceneHandle::Fixtures(first, _) => self.world.fixture(first),
            SceneHandle::Link(link) => self.world.link(link).world_from_link,
        };
        self.scene
            .iter()
            .map(|place| from_pose(&pose(place)))
            .collect()
    }

    fn touched_regions(&self) -> &[bool] {
        &self.touched
    }

    fn lead_base(&mut self, next: &Isometry3<f64>) {
        let here = from_pose(&self.world.link(0).world_from_link);
        let (linear, angular) = velocity_between(&here, next, self.timestep_s);
        self.world
            .lead_root(0, to_vector(&linear), to_vector(&angular));
    }

    fn place_driven(&mut self, index: usize, world_from_body: &Isometry3<f64>) {
        if let SceneHandle::Fixtures(first, end) = self.scene[index] {
            for fixture in first..end {
                self.world
                    .lead(fixture, to_pose(world_from_body), Vec3::ZERO, Vec3::ZERO);
            }
        }
    }

    fn lead_driven(&mut self, index: usize, next: &Isometry3<f64>) {
        let SceneHandle::Fixtures(first, end) = self.scene[index] else {
            return;
        };
        let here = from_pose(&self.world.fixture(first));
        let (linear, angular) = velocity_between(&here, next, self.timestep_s);
        for fixture in first..end {
            let pose = to_pose(&here);
            self.world
                .lead(fixture, pose, to_vector(&linear), to_vector(&angular));
        }
    }
}

/// The velocity, of the origin and angular, that takes a body from one pose to another within a time.
fn velocity_between(
    here: &Isometry3<f64>,
    next: &Isometry3<f64>,
    time_s: f64,
) -> (Vector3<f64>, Vector3<f64>) {
    (
        (next.translation.vector - here.translation.vector) / time_s,
        (next.rotation * here.rotation.inverse()).scaled_axis() / time_s,
    )
}

/// Friction against rolling and spinning of everything that robot and free bodies move over.
fn turning_of_floor(experiment: &Experiment) -> TurningFriction {
    TurningFriction {
        rolling_m: experiment.floor.rolling_m.unwrap_or(0.0),
        torsional_m: experiment.floor.torsional_m.unwrap_or(0.0),
    }
}

fn joint(assembly: &Assembly, hinge: usize, start: f64) -> Joint {
    let hinge = &assembly.hinges[hinge];
    let anchor = |part: usize| {
        let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
        let anchor_part_m = part_from_robot * Point3::from(hinge.anchor_robot_m);
        Pose::from_translation(to_vector(&anchor_part_m.coords))
    };
    let kind = match (hinge.freedom, hinge.bearing.limits_rad) {
        (Freedom::Slide, _) => JointType::Prismatic,
        (Freedom::Turn, Some(_)) => JointType::Revolute,
        (Freedom::Turn, None) => JointType::Continuous,
    };
    let motor = hinge.actuator.as_ref().and_then(|a| a.servo.law.motor());
    let bearing = &hinge.bearing;
    Joint {
        parent_from_joint: anchor(hinge.parent_part),
        link_from_joint: anchor(hinge.child_part),
        limits: bearing.limits_rad,
        start,
        viscous_friction: bearing.viscous_nm_s_rad,
        dry_friction: bearing.dry_nm,
        armature: bearing.armature_kg_m2 + motor.map_or(0.0, |motor| motor.armature_kg_m2),
        stiffness: bearing.spring.map_or(0.0, |spring| spring.stiffness_nm_rad),
        rest: bearing.spring.map_or(0.0, |spring| spring.rest_rad),
        ..Joint::new(
            hinge.parent_part,
            kind,
            to_vector(&hinge.axis_robot.into_inner()),
        )
    }
}

fn colliders(
    experiment: &Experiment,
    assembly: &Assembly,
    index: usize,
    part: &Part,
) -> Vec<Collider> {
    let part_from_robot = robot_from_part_at_zero(assembly, index).inverse();
    let solids = part
        .solids
        .iter()
        .filter(|solid| solid.collides && experiment.contact.is_on);
    let collider = |solid: &realgap_robot::morphology::Solid| {
        let edge_radius_m = match solid.role {
            Role::Cube => experiment.adjustment.edge_radius_m,
            Role::Plate => 0.0,
        };
        let surface = Surface::new(&solid.shape, edge_radius_m)?;
        let pose = surface.pose(part_from_robot * solid.robot_from_solid);
        let factor = experiment
            .perturbation
            .friction_factor_of(solid.module, solid.role);
        Some(Collider {
            owner_from_shape: to_pose(&pose),
            restitution: experiment.floor.restitution,
            spot_factor: factor,
            mark: solid.module as u64,
            turning: TurningFriction {
                rolling_m: solid.turning.rolling_m,
                torsional_m: solid.turning.torsional_m,
            },
            tyre: solid.tyre.map(|tyre| realgap_tree::Tyre {
                slip_stiffness_1_rad: tyre.slip_stiffness_1_rad,
                shape: tyre.shape,
            }),
            ..Collider::new(surface.shape, experiment.floor.friction * factor)
        })
    };
    solids.filter_map(collider).collect()
}

/// Adds the bodies of the scene; driven bodies are at the origin until they are placed.
fn add_scene(model: &mut Model, experiment: &Experiment) -> Vec<SceneHandle> {
    let adjusted = &experiment.adjustment;
    let mut places = Vec::new();
    let steps = experiment.steps();
    for body in experiment.scene.iter().chain(&steps) {
        let is_driven = matches!(body.motion, SceneMotion::Driven { .. });
        let (shift_m, friction) = if is_driven {
            let friction = adjusted.pusher_friction.unwrap_or(body.friction);
            (adjusted.pusher_offset_m, friction)
        } else {
            (Vector3::zeros(), body.friction)
        };
        // What does not move freely has the floor's friction against rolling and spinning.
        let turning = match body.motion {
            SceneMotion::Free { .. } => TurningFriction::default(),
            SceneMotion::Fixed { .. } | SceneMotion::Driven { .. } => turning_of_floor(experiment),
        };
        let colliders = body.boxes.iter().map(|part| {
            let half = to_vector(&(part.sides_m / 2.0));
            Collider {
                owner_from_shape: to_pose(&(Translation3::from(shift_m) * part.body_from_box)),
                restitution: experiment.floor.restitution,
                mark: u64::MAX,
                pair_friction: Some(friction),
                turning,
                ..Collider::new(
                    SharedShape::cuboid(half.x, half.y, half.z),
                    experiment.floor.friction,
                )
            }
        });
        let pose = match &body.motion {
            SceneMotion::Fixed { world_from_body } => *world_from_body,
            SceneMotion::Driven { .. } => Isometry3::identity(),
            SceneMotion::Free {
                world_from_body,
                mass_kg,
            } => {
                places.push(SceneHandle::Link(model.links.len()));
                let (centre_m, inertia_kg_m2) = body.uniform(*mass_kg);
                model.links.push(Link {
                    attachment: Attachment::Free {
                        world_from_link: to_pose(world_from_body),
                    },
                    mass_kg: *mass_kg,
                    centre_link_m: to_vector(&centre_m),
                    inertia_link_kg_m2: to_matrix(&inertia_kg_m2),
                    compensated: (0.0, Vec3::ZERO),
                    colliders: colliders.collect(),
                });
                continue;
            }
        };
        let first = model.fixtures.len();
        let fixtures = colliders.map(|collider| Fixture::at_rest(collider, to_pose(&pose)));
        model.fixtures.extend(fixtures);
        places.push(SceneHandle::Fixtures(first, model.fixtures.len()));
    }
    places
}
