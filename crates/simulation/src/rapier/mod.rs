//! The engine Rapier, the default and the reference for all results: rigid bodies, multibodies, impulse joints and contacts.

mod compensation;
mod driven;
mod friction;
mod ground;
mod hook;
mod integration;
mod joint;
mod load;
mod mass;
mod pose;
mod scene;
mod surface;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use super::engine::{Engine, Load, Motion, Setup, World};
use super::experiment::{Experiment, FrictionModel, JointFormulation};
use super::kinematics::{Turn, joint_turns, robot_from_part_at_zero};
use super::motor::Effort;
use super::part_state::PartState;
use super::servo::Command;
use compensation::Compensation;
use friction::Friction;
use hook::{Hooks, module_mark};
use joint::{JointFrame, RapierJoint, rotor_inertia_kg_m2};
use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::{
    ActiveHooks, BroadPhaseBvh, CCDSolver, CoefficientCombineRule, ColliderBuilder, ColliderSet,
    ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet, NarrowPhase,
    PhysicsPipeline, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, SoftBodySet,
};
use realgap_core::error::Result;
use realgap_robot::morphology::{ClusterMass, Part, Role};

use mass::mass_properties;
pub(super) use mass::{LEAST_SHARE, total_kg, weighable};
use pose::from_rotation;
pub(super) use pose::{from_pose, from_vector, to_matrix, to_pose, to_vector};

/// Version of the engine, which determines the results bit for bit.
pub const ENGINE_VERSION: &str = "rapier3d-f64 0.36.1";
pub(super) use rapier3d_f64::parry;
pub(super) use surface::{Surface, field_shape};

/// Velocity of one part at the start.
pub(super) struct PartMotion {
    /// Rigid motion of the whole robot.
    pub robot: Motion,
    /// Additional motion due to the joints between the root and this part.
    pub joints: Turn,
    /// Whether the part is fixed to the world.
    pub is_held: bool,
}

impl PartMotion {
    /// Linear velocity of a point and angular velocity, world frame.
    pub fn at(&self, point_world_m: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        if self.is_held {
            return (Vector3::zeros(), Vector3::zeros());
        }
        let robot = &self.robot;
        let linear = robot.linear_world_m_s
            + robot
                .angular_world_rad_s
                .cross(&(point_world_m - robot.about_world_m));
        if self.joints == Turn::REST {
            return (linear, robot.angular_world_rad_s);
        }
        (
            linear + self.joints.velocity_at(point_world_m),
            robot.angular_world_rad_s + self.joints.angular_world_rad_s,
        )
    }
}

/// A part of the robot in Rapier.
///
/// The origin of Rapier's body is at the part's centre of mass, because a free root of a multibody would otherwise rotate about
/// its origin (docs/upstream/multibody_root.md).
#[derive(Debug, Clone, Copy)]
struct RapierPart {
    body: RigidBodyHandle,
    /// Centre of mass in the part's frame, metres: the origin of Rapier's body.
    centre_part_m: Vector3<f64>,
}

impl RapierPart {
    /// Pose of the part's frame in the body's frame.
    fn body_from_part(&self) -> Isometry3<f64> {
        Translation3::from(-self.centre_part_m).into()
    }
}

/// The engine Rapier.
#[derive(Debug, Clone, Copy)]
pub struct Rapier;

/// The instance of the engine.
pub static RAPIER: Rapier = Rapier;

impl Engine for Rapier {
    fn name(&self) -> &'static str {
        "rapier"
    }

    fn version(&self) -> &'static str {
        ENGINE_VERSION
    }

    fn refusal(&self, experiment: &Experiment) -> Option<String> {
        if experiment.base.is_some() {
            return Some("it does not lead the root of a robot along a motion".to_owned());
        }
        if experiment.mount.is_some() {
            return Some("it holds robots rigidly only (mount.stiffness_n_m)".to_owned());
        }
        if experiment.has_turning_friction() {
            return Some(
                "it has no rolling and torsional friction (floor.rolling_m, floor.torsional_m, `turning` of shapes)"
                    .to_owned(),
            );
        }
        let has_tyres = experiment.assembly.has_tyres() && experiment.contact.is_on;
        has_tyres.then(|| "it has no tyres, whose friction grows with the slip".to_owned())
    }

    fn build(&self, setup: &Setup<'_>) -> Result<Box<dyn World>> {
        Ok(Box::new(RapierWorld::new(setup)))
    }
}

/// A world of Rapier with one robot.
struct RapierWorld {
    gravity: Vector,
    parameters: IntegrationParameters,
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd: CCDSolver,
    parts: Vec<RapierPart>,
    joints_of_hinges: Vec<RapierJoint>,
    hooks: Hooks,
    /// Bodies of the scene, in its order, then steps.
    scene: Vec<RigidBodyHandle>,
    /// Whether a contact ever touched each region of the ground.
    touched: Vec<bool>,
    compensations: Vec<Compensation>,
}

impl RapierWorld {
    /// Builds the world: parts at their start poses, hinges at the state `joints`, and everything moving as one rigid body apart
    /// from that.
    fn new(setup: &Setup<'_>) -> Self {
        let Setup {
            experiment,
            assembly,
            world_from_parts,
            joints,
            motion,
        } = *setup;
        let mut world = Self {
            gravity: Vector::new(0.0, 0.0, -experiment.gravity_m_s2),
            parameters: integration::parameters(experiment),
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            impulse_joints: ImpulseJointSet::new(),
            multibody_joints: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            parts: Vec::with_capacity(assembly.parts.len()),
            joints_of_hinges: Vec::with_capacity(assembly.hinges.len()),
            hooks: Hooks {
                friction: (experiment.contact.friction_model != FrictionModel::Simplified)
                    .then(Friction::default),
                collision_exclude: assembly.collision_exclude.iter().copied().collect(),
                ..Hooks::default()
            },
            scene: Vec::new(),
            touched: vec![false; experiment.ground.regions.len()],
            compensations: Vec::new(),
        };
        world.lay_floor(experiment);
        let kind = experiment.joint_kind();
        let turns = joint_turns(assembly, world_from_parts, joints);
        let least_kg = LEAST_SHARE * total_kg(assembly);
        for (index, part) in assembly.parts.iter().enumerate() {
            let part_from_robot = robot_from_part_at_zero(assembly, index).inverse();
            let is_held = index == 0 && assembly.world_from_mount.is_some();
            let rotors_kg_m2 = match kind {
                JointFormulation::Impulse => rotor_inertia_kg_m2(assembly, index, &part_from_robot),
                JointFormulation::Multibody | JointFormulation::Auto => Matrix3::zeros(),
            };
            let mut mass = weighable(part.mass(&part_from_robot), least_kg);
            mass.inertia_kg_m2 += rotors_kg_m2;
            world.place_part(
                experiment,
                part,
                &part_from_robot,
                &world_from_parts[index],
                &PartMotion {
                    robot: motion,
                    joints: turns[index],
                    is_held,
                },
                &mass,
            );
        }
        world.compensations = Compensation::of(assembly, &world.parts);
        for (hinge, joint) in assembly.hinges.iter().zip(joints) {
            let parent_from_robot = robot_from_part_at_zero(assembly, hinge.parent_part).inverse();
            let anchor_parent_m = parent_from_robot * nalgebra::Point3::from(hinge.anchor_robot_m);
            let frame = Isometry3::from_parts(
                anchor_parent_m.coords.into(),
                UnitQuaternion::rotation_between(&Vector3::x(), &hinge.axis_robot).unwrap_or_else(
                    || UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI),
                ),
            );
            let child_from_parent =
                world_from_parts[hinge.child_part].inverse() * world_from_parts[hinge.parent_part];
            let (parent, child) = (
                world.parts[hinge.parent_part],
                world.parts[hinge.child_part],
            );
            let frames = [
                JointFrame {
                    body: parent.body,
                    body_from_hinge: parent.body_from_part() * frame,
                },
                JointFrame {
                    body: child.body,
                    body_from_hinge: child.body_from_part() * child_from_parent * frame,
                },
            ];
            world.joints_of_hinges.push(RapierJoint::new(
                kind,
                hinge,
                frames,
                joint.angle_rad,
                &mut world.impulse_joints,
                &mut world.multibody_joints,
            ));
        }
        world.start_multibody();
        for (joint_of_hinge, joint) in world.joints_of_hinges.iter().zip(joints) {
            joint_of_hinge.start(&mut world.multibody_joints, joint.speed_rad_s);
        }
        world.set_scene(experiment);
        world
    }

    fn place_part(
        &mut self,
        experiment: &Experiment,
        part: &Part,
        part_from_robot: &Isometry3<f64>,
        world_from_part: &Isometry3<f64>,
        motion: &PartMotion,
        mass: &ClusterMass,
    ) {
        let centre_part_m = mass.centre_m;
        let centre_world_m = world_from_part * nalgebra::Point3::from(centre_part_m);
        let (velocity, angular_world_rad_s) = motion.at(&centre_world_m.coords);
        let mut member = RapierPart {
            body: RigidBodyHandle::invalid(),
            centre_part_m,
        };
        let body_from_part = member.body_from_part();
        let kind = if motion.is_held {
            RigidBodyBuilder::fixed()
        } else {
            RigidBodyBuilder::dynamic()
        };
        let body = kind
            .pose(to_pose(&(world_from_part * body_from_part.inverse())))
            .linvel(to_vector(&velocity))
            .angvel(to_vector(&angular_world_rad_s))
            .additional_mass_properties(mass_properties(mass))
            .can_sleep(false)
            .build();
        member.body = self.bodies.insert(body);
        let is_on = experiment.contact.is_on;
        for solid in part.solids.iter().filter(|solid| solid.collides && is_on) {
            let edge_radius_m = match solid.role {
                Role::Cube => experiment.adjustment.edge_radius_m,
                Role::Plate => 0.0,
            };
            let Some(surface) = Surface::new(&solid.shape, edge_radius_m) else {
                continue;
            };
            let factor = experiment
                .perturbation
                .friction_factor_of(solid.module, solid.role);
            let body_from_solid = body_from_part * part_from_robot * solid.robot_from_solid;
            let pose = surface.pose(body_from_solid);
            let collider = ColliderBuilder::new(surface.shape)
                .position(to_pose(&pose))
                .density(0.0)
                .friction(experiment.floor.friction * factor)
                .restitution(experiment.floor.restitution)
                .friction_combine_rule(CoefficientCombineRule::Multiply)
                .restitution_combine_rule(CoefficientCombineRule::Multiply)
                .active_hooks(self.active_hooks_of(solid.module))
                .user_data(module_mark(solid.module, factor))
                .build();
            self.colliders
                .insert_with_parent(collider, member.body, &mut self.bodies);
        }
        // Without this call the engine would compute masses only in the first step.
        if let Some(body) = self.bodies.get_mut(member.body) {
            body.recompute_mass_properties_from_colliders(&self.colliders);
        }
        self.parts.push(member);
    }

    /// The callbacks that the engine needs for contacts of a module.
    fn active_hooks_of(&self, module: usize) -> ActiveHooks {
        let mut excluded = self.hooks.collision_exclude.iter();
        if excluded.any(|&(a, b)| a == module || b == module) {
            ActiveHooks::MODIFY_SOLVER_CONTACTS | ActiveHooks::FILTER_CONTACT_PAIRS
        } else {
            ActiveHooks::MODIFY_SOLVER_CONTACTS
        }
    }

    /// Sets the initial velocity of a multibody, which ignores the velocities of its bodies, and removes its default joint
    /// damping.
    fn start_multibody(&mut self) {
        let Some(root) = self.parts.first() else {
            return;
        };
        let Some(link) = self.multibody_joints.rigid_body_link(root.body).copied() else {
            return;
        };
        let body = &self.bodies[root.body];
        let (linear, angular) = (body.linvel(), body.angvel());
        if let Some(multibody) = self.multibody_joints.get_multibody_mut(link.multibody) {
            multibody.damping_mut().fill(0.0);
            let mut velocity = multibody.generalized_velocity_mut();
            for (row, value) in [
                linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
            ]
            .into_iter()
            .enumerate()
            {
                velocity[row] = value;
            }
        }
    }
}

impl World for RapierWorld {
    fn step(&mut self) {
        if let Some(friction) = &mut self.hooks.friction {
            friction.refresh(&self.multibody_joints);
        }
        for joint_of_hinge in &self.joints_of_hinges {
            joint_of_hinge.brake(&mut self.impulse_joints, &self.bodies);
            joint_of_hinge.spring(&mut self.bodies, &self.parameters);
        }
        Compensation::push(&self.compensations, &mut self.bodies, -self.gravity.z);
        self.pipeline.step(
            self.gravity,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &self.hooks,
            &(),
        );
        for joint_of_hinge in &self.joints_of_hinges {
            joint_of_hinge.reset_forces(&mut self.bodies);
        }
        Compensation::reset(&self.compensations, &mut self.bodies);
        self.mark_regions();
    }

    fn part(&self, part: usize) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
        let member = &self.parts[part];
        let body = &self.bodies[member.body];
        let pose = from_pose(body.position()) * member.body_from_part();
        let angular = from_vector(body.angvel());
        let linear =
            from_vector(body.linvel()) - angular.cross(&(pose.rotation * member.centre_part_m));
        (pose, linear, angular)
    }

    fn part_state(&self, part: usize) -> PartState {
        let member = &self.parts[part];
        let body = &self.bodies[member.body];
        let local = &body.mass_properties().local_mprops;
        let inertia = local.reconstruct_inertia_matrix();
        let column = |v: Vector| from_vector(v);
        let inertia_part = Matrix3::from_columns(&[
            column(inertia.x_axis),
            column(inertia.y_axis),
            column(inertia.z_axis),
        ]);
        let turn = from_rotation(&body.position().rotation).to_rotation_matrix();
        PartState {
            world_from_part: from_pose(body.position()) * member.body_from_part(),
            centre_world_m: from_vector(body.center_of_mass()),
            velocity_world_m_s: from_vector(body.linvel()),
            angular_velocity_world_rad_s: from_vector(body.angvel()),
            mass_kg: body.mass(),
            inertia_world_kg_m2: turn * inertia_part * turn.transpose(),
        }
    }

    // The velocities of the bodies of a multibody are one substep old, because the engine computes them before it solves contacts
    // and joints. The generalised velocities of the multibody are those after the last substep.
    fn part_now(&self, part: usize) -> PartState {
        let mut state = self.part_state(part);
        let Some(link) = self.multibody_joints.rigid_body_link(self.parts[part].body) else {
            return state;
        };
        let Some(multibody) = self.multibody_joints.get_multibody(link.multibody) else {
            return state;
        };
        let speeds = multibody.generalized_velocity();
        let jacobian = multibody.body_jacobian(link.id);
        // Before the first step there is no Jacobian, and the velocities are those of the start.
        if jacobian.ncols() == speeds.len() {
            let row = |row: usize| jacobian.row(row).tr_dot(&speeds);
            state.velocity_world_m_s = Vector3::new(row(0), row(1), row(2));
            state.angular_velocity_world_rad_s = Vector3::new(row(3), row(4), row(5));
        }
        state
    }

    fn push(&mut self, part: usize, velocity_world_m_s: &Vector3<f64>) {
        if let Some(body) = self.bodies.get_mut(self.parts[part].body) {
            let velocity = body.linvel() + to_vector(velocity_world_m_s);
            body.set_linvel(velocity, true);
        }
    }

    fn hinge_angle_rad(&self, hinge: usize, near_rad: f64) -> f64 {
        self.joints_of_hinges[hinge].angle_rad(&self.bodies, near_rad)
    }

    fn hinge_speed_rad_s(&self, hinge: usize) -> f64 {
        self.joints_of_hinges[hinge].speed_rad_s(&self.bodies)
    }

    fn drive(&mut self, hinge: usize, angle_rad: f64, command: Command) {
        self.joints_of_hinges[hinge].drive(
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            angle_rad,
            command,
        );
    }

    fn exert(&mut self, hinge: usize, effort: &Effort) {
        self.joints_of_hinges[hinge].exert(
            &mut self.bodies,
            &mut self.multibody_joints,
            effort,
            self.parameters.dt,
        );
    }

    fn loads(&self, loads: &mut Vec<Load>) {
        self.read_loads(loads);
    }

    fn touched_regions(&self) -> &[bool] {
        &self.touched
    }

    fn scene_poses(&self) -> Vec<Isometry3<f64>> {
        self.poses_of_scene()
    }

    fn place_driven(&mut self, index: usize, world_from_body: &Isometry3<f64>) {
        self.put_driven(index, world_from_body);
    }

    fn lead_driven(&mut self, index: usize, next: &Isometry3<f64>) {
        self.guide_driven(index, next);
    }
}
