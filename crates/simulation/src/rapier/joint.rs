//! A hinge in the engine's hands: its joint, its motor, its friction and limits.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::{from_rotation, from_vector, to_pose, to_vector};
use crate::experiment::JointFormulation;
use crate::motor::Effort;
use crate::servo::Command;
use rapier3d_f64::prelude::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, ImpulseJointSet, IntegrationParameters,
    JointAxesMask, JointAxis, MotorModel, MultibodyJointHandle, MultibodyJointSet, RigidBody,
    RigidBodyHandle, RigidBodySet, SpringCoefficients,
};
use realgap_robot::morphology::{Assembly, Bearing, Freedom, Hinge};

/// A hinge in the engine's hands.
#[derive(Debug, Clone, Copy)]
enum Joint {
    Multibody(MultibodyJointHandle),
    Impulse(ImpulseJointHandle),
}

/// Where a hinge's motor finds its parts.
#[derive(Debug, Clone)]
pub(super) struct RapierJoint {
    joint: Joint,
    /// The joint whose motor brakes: friction where the joint is an impulse joint. Where a servo has the motor of the hinge's own
    /// joint, it is a second joint with nothing but a motor, which the solver holds less firmly.
    brake: Option<ImpulseJointHandle>,
    bearing: Bearing,
    /// What a motor on an impulse joint exerted last.
    exerted: Option<Exerted>,
    /// Whether a motor behind a gear drives it.
    has_gear: bool,
    /// Turning or sliding: what the engine calls the axis.
    axis: JointAxis,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
    /// A point on the axis, in the frame of the parent's body, metres.
    anchor_parent_m: Vector3<f64>,
    /// The same point at the start, in the frame of the child's body, metres.
    anchor_child_m: Vector3<f64>,
    /// Axis in the parent's frame, which equals the child's at zero angle.
    axis_part: Vector3<f64>,
    /// Joint coordinate 0 is the angle the robot started with.
    start_rad: f64,
}

/// One of the two bodies of a hinge, and where the hinge sits in it.
pub(super) struct JointFrame {
    /// The body.
    pub body: RigidBodyHandle,
    /// The hinge's frame, x along the axis, in the body's frame at the start.
    pub body_from_hinge: Isometry3<f64>,
}

/// What a motor exerted during a step.
#[derive(Debug, Clone, Copy)]
struct Exerted {
    /// On the child, N m.
    torque_nm: f64,
    /// Speed before the step, rad/s.
    speed_rad_s: f64,
}

/// Inertia of the rotors that turn a part by impulse joints, about the origin of its frame, kg m²: they have none of their own
/// there. A rotor then turns with the part and not with the difference of two; the same where the other stands still.
pub(super) fn rotor_inertia_kg_m2(
    assembly: &Assembly,
    part: usize,
    part_from_robot: &Isometry3<f64>,
) -> Matrix3<f64> {
    let hinges = assembly.hinges.iter();
    let rotors = hinges
        .filter(|hinge| hinge.child_part == part)
        .filter_map(|hinge| {
            let motor = hinge.actuator.as_ref().and_then(|a| a.servo.law.motor());
            let own_kg_m2 = hinge.bearing.armature_kg_m2;
            let armature_kg_m2 = own_kg_m2 + motor.map_or(0.0, |motor| motor.armature_kg_m2);
            let turns = hinge.freedom == Freedom::Turn && armature_kg_m2 > 0.0;
            let axis = part_from_robot.rotation * hinge.axis_robot.into_inner();
            turns.then(|| axis * axis.transpose() * armature_kg_m2)
        });
    rotors.sum()
}

/// Dry friction of an impulse joint acts in full above this speed, rad/s: below it the hinge creeps instead of sticking.
const CREEP_RAD_S: f64 = 1e-4;

impl RapierJoint {
    /// Joins two bodies that are where they start, `start_rad` apart.
    pub fn new(
        kind: JointFormulation,
        hinge: &Hinge,
        seats: [JointFrame; 2],
        start_rad: f64,
        impulse_joints: &mut ImpulseJointSet,
        multibody_joints: &mut MultibodyJointSet,
    ) -> Self {
        let bearing = hinge.bearing;
        let joint_with = |locked: JointAxesMask| {
            GenericJointBuilder::new(locked)
                .local_frame1(to_pose(&seats[0].body_from_hinge))
                .local_frame2(to_pose(&seats[1].body_from_hinge))
                .contacts_enabled(false)
        };
        let (axis, locked) = match hinge.freedom {
            Freedom::Turn => (JointAxis::AngX, JointAxesMask::LOCKED_REVOLUTE_AXES),
            Freedom::Slide => (JointAxis::LinX, JointAxesMask::LOCKED_PRISMATIC_AXES),
        };
        let mut data = joint_with(locked);
        if let Some((low_rad, high_rad)) = bearing.limits_rad {
            data = data.limits(
                axis,
                [low_rad, high_rad].map(|limit_rad| limit_rad - start_rad),
            );
        }
        if bearing.is_compliant() {
            data = data.softness(SpringCoefficients::new(
                bearing.compliance.frequency_hz,
                bearing.compliance.damping_ratio,
            ));
        }
        let data: GenericJoint = data.build();
        let (parent, child) = (seats[0].body, seats[1].body);
        let multibody = (kind == JointFormulation::Multibody)
            .then(|| multibody_joints.insert(parent, child, data, true))
            .flatten();
        // `insert` refuses only loops, and hinges form a tree.
        let joint = match multibody {
            Some(handle) => Joint::Multibody(handle),
            None => Joint::Impulse(impulse_joints.insert(parent, child, data, true)),
        };
        let has_gear = hinge
            .actuator
            .is_some_and(|actuator| actuator.servo.law.motor().is_some());
        let brake = match joint {
            Joint::Impulse(_)
                if bearing.has_friction() && hinge.actuator.is_some() && !has_gear =>
            {
                let free = joint_with(JointAxesMask::empty()).build();
                Some(impulse_joints.insert(parent, child, free, true))
            }
            Joint::Impulse(handle) if bearing.has_friction() && !has_gear => Some(handle),
            _ => None,
        };
        Self {
            joint,
            brake,
            bearing,
            exerted: None,
            has_gear,
            axis,
            parent,
            child,
            anchor_parent_m: seats[0].body_from_hinge.translation.vector,
            anchor_child_m: seats[1].body_from_hinge.translation.vector,
            axis_part: hinge.axis_robot.into_inner(),
            start_rad,
        }
    }

    /// Whether it slides.
    fn slides(&self) -> bool {
        self.axis == JointAxis::LinX
    }

    /// Axis, and the anchors that parent and child carry, world frame, metres.
    fn places(&self, bodies: &RigidBodySet) -> (Vector3<f64>, [Vector3<f64>; 2]) {
        let [parent, child] = [self.parent, self.child].map(|handle| bodies[handle].position());
        let anchors_world_m = [
            from_vector(*parent * to_vector(&self.anchor_parent_m)),
            from_vector(*child * to_vector(&self.anchor_child_m)),
        ];
        (
            from_rotation(&parent.rotation) * self.axis_part,
            anchors_world_m,
        )
    }

    /// Angle, radians, continued from `near_rad` so that it does not jump at half turns; of a slide the distance, metres.
    pub fn angle_rad(&self, bodies: &RigidBodySet, near_rad: f64) -> f64 {
        if self.slides() {
            let (axis_world, [here_m, there_m]) = self.places(bodies);
            return self.start_rad + (there_m - here_m).dot(&axis_world);
        }
        let parent = from_rotation(&bodies[self.parent].position().rotation);
        let child = from_rotation(&bodies[self.child].position().rotation);
        let relative: UnitQuaternion<f64> = parent.inverse() * child;
        let along = relative.imag().dot(&self.axis_part);
        let angle_rad = 2.0 * along.atan2(relative.w);
        let turns = ((near_rad - angle_rad) / TAU).round();
        angle_rad + turns * TAU
    }

    /// Speed, rad/s; of a slide m/s.
    pub fn speed_rad_s(&self, bodies: &RigidBodySet) -> f64 {
        if self.slides() {
            let (axis_world, [_, at_m]) = self.places(bodies);
            let velocity = |handle| {
                let body: &RigidBody = &bodies[handle];
                let arm_m = at_m - from_vector(body.center_of_mass());
                from_vector(body.linvel()) + from_vector(body.angvel()).cross(&arm_m)
            };
            return (velocity(self.child) - velocity(self.parent)).dot(&axis_world);
        }
        let [parent, child] = [self.parent, self.child].map(|handle| &bodies[handle]);
        let axis_world = from_rotation(&parent.position().rotation) * self.axis_part;
        (from_vector(child.angvel()) - from_vector(parent.angvel())).dot(&axis_world)
    }

    /// Tells a multibody the speed of the hinge and what resists it; an impulse joint has a brake.
    pub fn start(&self, joints: &mut MultibodyJointSet, speed_rad_s: f64) {
        let Joint::Multibody(handle) = self.joint else {
            return;
        };
        let Some((multibody, link)) = joints.get_mut(handle) else {
            return;
        };
        let Some(row) = multibody.link(link).map(|link| link.assembly_id()) else {
            return;
        };
        multibody.damping_mut()[row] = self.bearing.viscous_nm_s_rad;
        multibody.frictions_mut()[row] = self.bearing.dry_nm;
        multibody.armature_mut()[row] = self.bearing.armature_kg_m2;
        multibody.generalized_velocity_mut()[row] = speed_rad_s;
    }

    /// Has a motor and its gear act during the next step.
    ///
    /// A multibody has a motor, dry friction, damping and armature at every joint. Friction of an impulse joint does not
    /// converge on a long arm, so there all of it is a torque on both parts: the motor and viscous friction by the speed before
    /// the step, dry friction as what would stop the hinge within the step, with what else acted on it during the step before,
    /// and at most its budget. The rotor's inertia is the child's there ([`rotor_inertia_kg_m2`]).
    pub fn exert(
        &mut self,
        bodies: &mut RigidBodySet,
        multibody_joints: &mut MultibodyJointSet,
        effort: &Effort,
        timestep_s: f64,
    ) {
        let Bearing {
            viscous_nm_s_rad,
            dry_nm,
            ..
        } = self.bearing;
        let viscous_nm_s_rad = viscous_nm_s_rad + effort.viscous_nm_s_rad;
        let Joint::Multibody(handle) = self.joint else {
            let speed_rad_s = self.speed_rad_s(bodies);
            // What stops the parts within a step.
            let stop_nm_s_rad = self.reduced_inertia_kg_m2(bodies) / timestep_s;
            let others_nm = self.exerted.map_or(0.0, |exerted| {
                stop_nm_s_rad * (speed_rad_s - exerted.speed_rad_s) - exerted.torque_nm
            });
            let slope_nm_s_rad = (effort.damping_nm_s_rad + viscous_nm_s_rad).min(stop_nm_s_rad);
            let drive_nm =
                effort.damping_nm_s_rad * effort.target_rad_s - slope_nm_s_rad * speed_rad_s;
            let stop_nm = stop_nm_s_rad * speed_rad_s + drive_nm + others_nm;
            let held_nm = stop_nm.clamp(-effort.backwards_nm - dry_nm, effort.forwards_nm + dry_nm);
            let torque_nm = drive_nm - held_nm;
            self.exerted = Some(Exerted {
                torque_nm,
                speed_rad_s,
            });
            self.push(bodies, torque_nm);
            return;
        };
        let Some((multibody, link)) = multibody_joints.get_mut(handle) else {
            return;
        };
        if let Some(row) = multibody.link(link).map(|link| link.assembly_id()) {
            multibody.damping_mut()[row] = viscous_nm_s_rad;
            multibody.frictions_mut()[row] = dry_nm + effort.dry_nm();
            multibody.armature_mut()[row] = self.bearing.armature_kg_m2 + effort.armature_kg_m2;
        }
        let Some(link) = multibody.link_mut(link) else {
            return;
        };
        // A motor of the engine that damps nothing is rigid.
        let most_nm = if effort.damping_nm_s_rad > 0.0 {
            f64::MAX
        } else {
            0.0
        };
        let data = &mut link.joint.data;
        data.set_motor_model(self.axis, MotorModel::ForceBased);
        data.set_motor_velocity(
            self.axis,
            effort.shifted_target_rad_s(),
            effort.damping_nm_s_rad,
        );
        data.set_motor_max_force(self.axis, most_nm);
    }

    /// Torque on the child and against the parent; of a slide a force at its anchor.
    fn push(&self, bodies: &mut RigidBodySet, torque_nm: f64) {
        let (axis_world, [_, at_m]) = self.places(bodies);
        for (part, torque_nm) in [(self.child, torque_nm), (self.parent, -torque_nm)] {
            let Some(body) = bodies.get_mut(part) else {
                continue;
            };
            let along = to_vector(&(axis_world * torque_nm));
            if self.slides() {
                body.add_force_at_point(along, to_vector(&at_m), false);
            } else {
                body.add_torque(along, false);
            }
        }
    }

    /// Has the spring of the joint act during the next step.
    ///
    /// The force is that of one step, which the solver takes in substeps. Taken where the joint will be after a share of it, the
    /// spring neither gains nor loses energy: with n substeps a constant acceleration a moves a body by a h² (n + 1) / (2 n), and
    /// the motion keeps its amplitude where the force is that of (n − 1) / (2 n) steps ahead. Where the spring is too stiff for
    /// steps this long, it is held to what would carry the joint to its rest within one.
    pub fn spring(&self, bodies: &mut RigidBodySet, parameters: &IntegrationParameters) {
        let Some(spring) = self.bearing.spring else {
            return;
        };
        let timestep_s = parameters.dt;
        let substeps = parameters.num_solver_iterations as f64;
        let ahead_s = timestep_s * (substeps - 1.0) / (2.0 * substeps);
        let here_rad = self.angle_rad(bodies, spring.rest_rad);
        let then_rad = here_rad + ahead_s * self.speed_rad_s(bodies);
        let inertia_kg_m2 = self.reduced_inertia_kg_m2(bodies) + self.bearing.armature_kg_m2;
        let most_nm_rad = inertia_kg_m2 / (timestep_s * timestep_s);
        let stiffness_nm_rad = spring.stiffness_nm_rad.min(most_nm_rad);
        self.push(bodies, stiffness_nm_rad * (spring.rest_rad - then_rad));
    }

    /// Takes back what a motor or spring exerted on the parts: it was for one step.
    pub fn let_go(&self, bodies: &mut RigidBodySet) {
        let has_pushed = self.has_gear && matches!(self.joint, Joint::Impulse(_));
        if !has_pushed && self.bearing.spring.is_none() {
            return;
        }
        for part in [self.parent, self.child] {
            if let Some(body) = bodies.get_mut(part) {
                body.reset_torques(false);
                body.reset_forces(false);
            }
        }
    }

    /// Inertia of the two parts against turning about the hinge in opposite directions, as if nothing else held them, kg m².
    fn reduced_inertia_kg_m2(&self, bodies: &RigidBodySet) -> f64 {
        let parent = &bodies[self.parent];
        let world_from_parent = parent.position();
        let axis_world = from_rotation(&world_from_parent.rotation) * self.axis_part;
        let anchor_world_m = from_vector(*world_from_parent * to_vector(&self.anchor_parent_m));
        let slides = self.slides();
        let inverse: f64 = [self.parent, self.child]
            .iter()
            .map(|handle| &bodies[*handle])
            .filter(|body| body.is_dynamic())
            .map(|body| {
                if slides {
                    return 1.0 / body.mass();
                }
                let inverse = body.mass_properties().effective_world_inv_inertia;
                let turn = from_vector(inverse * to_vector(&axis_world)).dot(&axis_world);
                let arm_m = from_vector(body.center_of_mass()) - anchor_world_m;
                let across_m2 = arm_m.cross(&axis_world).norm_squared();
                1.0 / (1.0 / turn + body.mass() * across_m2)
            })
            .sum();
        1.0 / inverse
    }

    /// Sets the brake of an impulse joint for the next step.
    ///
    /// A motor that wants speed 0 resists in proportion to the speed (viscous friction), or with at most a given torque (dry
    /// friction): of both together, viscous friction is part of what it may exert, by the speed before the step.
    pub fn brake(&self, joints: &mut ImpulseJointSet, bodies: &RigidBodySet) {
        let Some(joint) = self.brake.and_then(|handle| joints.get_mut(handle, false)) else {
            return;
        };
        let Bearing {
            viscous_nm_s_rad,
            dry_nm,
            ..
        } = self.bearing;
        let (damping_nm_s_rad, most_nm) = if dry_nm > 0.0 {
            let most_nm = dry_nm + viscous_nm_s_rad * self.speed_rad_s(bodies).abs();
            (most_nm / CREEP_RAD_S, most_nm)
        } else if viscous_nm_s_rad > 0.0 {
            (viscous_nm_s_rad, f64::MAX)
        } else {
            // A motor of the engine that damps nothing is rigid.
            (0.0, 0.0)
        };
        let data = &mut joint.data;
        data.set_motor_model(self.axis, MotorModel::ForceBased);
        data.set_motor_velocity(self.axis, 0.0, damping_nm_s_rad);
        data.set_motor_max_force(self.axis, most_nm);
    }

    /// Asks the motor of the hinge, which is at `angle_rad`, to do `command` during the next step.
    pub fn drive(
        &self,
        impulse_joints: &mut ImpulseJointSet,
        multibody_joints: &mut MultibodyJointSet,
        angle_rad: f64,
        command: Command,
    ) {
        let coordinate_rad = angle_rad - self.start_rad;
        let data = match self.joint {
            Joint::Impulse(handle) => {
                // An impulse joint knows its angle only up to whole turns.
                let wrapped_rad = match self.slides() {
                    true => coordinate_rad,
                    false => coordinate_rad - TAU * (coordinate_rad / TAU).round(),
                };
                impulse_joints
                    .get_mut(handle, false)
                    .map(|joint| (&mut joint.data, wrapped_rad))
            }
            Joint::Multibody(handle) => multibody_joints
                .get_mut(handle)
                .and_then(|(multibody, link)| multibody.link_mut(link))
                .map(|link| (&mut link.joint.data, coordinate_rad)),
        };
        let Some((data, here_rad)) = data else { return };
        data.set_motor_model(self.axis, MotorModel::ForceBased);
        match command {
            Command::Velocity {
                target_rad_s,
                damping_nm_s_rad,
                max_torque_nm,
            } => {
                data.set_motor_velocity(self.axis, target_rad_s, damping_nm_s_rad);
                data.set_motor_max_force(self.axis, max_torque_nm);
            }
            Command::Spring {
                error_rad,
                stiffness_nm_rad,
                damping_nm_s_rad,
                max_torque_nm,
            } => {
                data.set_motor_position(
                    self.axis,
                    here_rad + error_rad,
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                );
                data.set_motor_max_force(self.axis, max_torque_nm);
            }
        }
    }
}
