//! A hinge in Rapier: its joint, motor, friction, spring and limits.

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

/// Handle of a hinge's joint in Rapier.
#[derive(Debug, Clone, Copy)]
enum Joint {
    Multibody(MultibodyJointHandle),
    Impulse(ImpulseJointHandle),
}

/// A hinge in Rapier: handles of its joint and bodies, and the data for motor, friction and spring.
#[derive(Debug, Clone)]
pub(super) struct RapierJoint {
    joint: Joint,
    /// The joint whose motor models friction, for impulse joints. If a servo already uses the motor of the hinge's own joint,
    /// this is a second joint without constraints, which the solver satisfies less exactly.
    brake: Option<ImpulseJointHandle>,
    bearing: Bearing,
    /// Torque of a motor on an impulse joint during the previous step.
    exerted: Option<Exerted>,
    /// Whether a motor behind a gear drives it.
    has_gear: bool,
    /// The axis of the joint in Rapier, rotational or translational.
    axis: JointAxis,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
    /// A point on the axis, in the frame of the parent's body, metres.
    anchor_parent_m: Vector3<f64>,
    /// The same point at the start, in the frame of the child's body, metres.
    anchor_child_m: Vector3<f64>,
    /// Axis in the parent's frame, which equals the child's at zero angle.
    axis_part: Vector3<f64>,
    /// Hinge angle at the start, which is Rapier's joint coordinate 0.
    start_rad: f64,
}

/// One of the two bodies of a hinge, and the pose of the hinge's frame in it.
pub(super) struct JointFrame {
    /// Handle of the body.
    pub body: RigidBodyHandle,
    /// The hinge's frame, x along the axis, in the body's frame at the start.
    pub body_from_hinge: Isometry3<f64>,
}

/// Torque of a motor during a step.
#[derive(Debug, Clone, Copy)]
struct Exerted {
    /// Torque on the child, N m.
    torque_nm: f64,
    /// Speed before the step, rad/s.
    speed_rad_s: f64,
}

/// Inertia of the rotors that drive a part by impulse joints, about the origin of its frame, kg m². Impulse joints have no
/// armature, so this inertia is added to the part. The rotor then rotates with the part and not with the relative angle of two
/// parts; this makes no difference if the other part is at rest.
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

/// Speed above which the dry friction of an impulse joint acts in full, rad/s: below it the hinge creeps instead of sticking.
const CREEP_RAD_S: f64 = 1e-4;

impl RapierJoint {
    /// Creates the joint between two bodies at their start poses, with the hinge angle `start_rad`.
    pub fn new(
        kind: JointFormulation,
        hinge: &Hinge,
        frames: [JointFrame; 2],
        start_rad: f64,
        impulse_joints: &mut ImpulseJointSet,
        multibody_joints: &mut MultibodyJointSet,
    ) -> Self {
        let bearing = hinge.bearing;
        let joint_with = |locked: JointAxesMask| {
            GenericJointBuilder::new(locked)
                .local_frame1(to_pose(&frames[0].body_from_hinge))
                .local_frame2(to_pose(&frames[1].body_from_hinge))
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
        let (parent, child) = (frames[0].body, frames[1].body);
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
            anchor_parent_m: frames[0].body_from_hinge.translation.vector,
            anchor_child_m: frames[1].body_from_hinge.translation.vector,
            axis_part: hinge.axis_robot.into_inner(),
            start_rad,
        }
    }

    /// Whether it slides.
    fn slides(&self) -> bool {
        self.axis == JointAxis::LinX
    }

    /// Axis, and the anchor points of parent and child, world frame, metres.
    fn axis_and_anchors(&self, bodies: &RigidBodySet) -> (Vector3<f64>, [Vector3<f64>; 2]) {
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

    /// Angle, radians, continued from `near_rad` so that it does not jump at half turns; for a slide the distance, metres.
    pub fn angle_rad(&self, bodies: &RigidBodySet, near_rad: f64) -> f64 {
        if self.slides() {
            let (axis_world, [here_m, there_m]) = self.axis_and_anchors(bodies);
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

    /// Speed, rad/s; for a slide m/s.
    pub fn speed_rad_s(&self, bodies: &RigidBodySet) -> f64 {
        if self.slides() {
            let (axis_world, [_, at_m]) = self.axis_and_anchors(bodies);
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

    /// Sets the initial speed, friction and armature of the hinge in a multibody; impulse joints use a brake instead.
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

    /// Applies the effort of a motor and its gear during the next step.
    ///
    /// A multibody has a motor, dry friction, damping and armature at every joint. For impulse joints, friction as a constraint
    /// does not converge on a long arm, so the whole effort is applied as a torque on both parts: the motor and viscous friction
    /// at the speed before the step, and dry friction as the torque that would stop the hinge within the step, given the other
    /// torques of the previous step, limited by its budget. The inertia of the rotor is then part of the child
    /// ([`rotor_inertia_kg_m2`]).
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
            // Damping that stops the parts within one step.
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
        // A Rapier motor with zero damping acts as a rigid constraint, so its force is limited to 0 in that case.
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

    /// Applies a torque to the child and its opposite to the parent; for a slide, a force at the joint's anchor.
    fn push(&self, bodies: &mut RigidBodySet, torque_nm: f64) {
        let (axis_world, [_, at_m]) = self.axis_and_anchors(bodies);
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

    /// Applies the spring of the joint during the next step.
    ///
    /// The force is constant during a step, which the solver divides into substeps. To conserve energy, the force is taken at the
    /// position that the joint will have later in the step: with n substeps a constant acceleration a moves a body by
    /// a h² (n + 1) / (2 n), and the amplitude of the motion is conserved if the force is that of (n − 1) / (2 n) steps ahead. If the
    /// spring is too stiff for the timestep, its stiffness is limited to the value that brings the joint to its rest position
    /// within one step.
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

    /// Removes the forces of motor and spring from the parts, because they are valid for one step only.
    pub(crate) fn reset_forces(&self, bodies: &mut RigidBodySet) {
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

    /// Reduced inertia of the two parts for rotation about the hinge in opposite directions, without other constraints, kg m².
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
    /// A motor with target speed 0 resists in proportion to the speed (viscous friction), or with a limited torque (dry
    /// friction). If a hinge has both, the torque limit is the sum of dry friction and of viscous friction at the speed before
    /// the step.
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
            // A Rapier motor with zero damping acts as a rigid constraint, so its force is limited to 0 in that case.
            (0.0, 0.0)
        };
        let data = &mut joint.data;
        data.set_motor_model(self.axis, MotorModel::ForceBased);
        data.set_motor_velocity(self.axis, 0.0, damping_nm_s_rad);
        data.set_motor_max_force(self.axis, most_nm);
    }

    /// Sets the command of the hinge's motor for the next step; the hinge is at `angle_rad`.
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
                // An impulse joint measures its angle only up to whole turns.
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
