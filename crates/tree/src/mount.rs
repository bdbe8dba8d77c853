//! A root on a spring: the stand of a robot gives a little.
//!
//! Spring and damper act between the world and a point of the root, in all directions alike, and are treated implicitly, as those of a joint
//! are: a mean of the positions before and after the step (Newmark 1959, average acceleration), so that a stiff stand neither gains nor
//! loses energy. At the start the stand carries what weighs on it: the robot begins at rest where it was placed.

use parry3d_f64::math::{Mat3, Pose, Vec3};

use crate::forest::{Body, Forest};
use crate::kinematics::Node;
use crate::spatial::{Spatial, Symmetric};

/// Stiffness and damping of a mount, in all directions alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MountSpring {
    /// The point on which the spring acts, in the link's frame.
    pub at_link_m: Vec3,
    /// Force per displacement, N/m.
    pub stiffness_n_m: f64,
    /// Force per velocity, N s/m.
    pub damping_n_s_m: f64,
    /// Torque per rotation, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Torque per angular velocity, N m s/rad.
    pub damping_nm_s_rad: f64,
}

impl MountSpring {
    /// Whether all numbers are finite and not negative.
    pub(crate) fn is_sound(&self) -> bool {
        let all = [
            self.stiffness_n_m,
            self.damping_n_s_m,
            self.stiffness_nm_rad,
            self.damping_nm_s_rad,
        ];
        all.iter().all(|value| *value >= 0.0 && value.is_finite())
    }

    /// From the reference of the tree to the point on which the spring acts.
    fn arm_m(&self, node: &Node) -> Vec3 {
        node.origin_world_m + node.rotation * self.at_link_m - node.reference_world_m
    }

    /// What damper and spring add to the inertia of the root over a step: a damper at a point has the form of a mass at that point.
    pub(crate) fn grip(&self, node: &Node, time_s: f64) -> Symmetric {
        let grip = |stiffness: f64, damping: f64| time_s * (damping + 0.25 * time_s * stiffness);
        let turning = grip(self.stiffness_nm_rad, self.damping_nm_s_rad);
        Symmetric::rigid(
            grip(self.stiffness_n_m, self.damping_n_s_m),
            self.arm_m(node),
            &(Mat3::IDENTITY * turning),
        )
    }

    /// Displacement of the point and rotation (rotation vector) from the rest pose, world frame.
    fn displacement(&self, rest: &Pose, node: &Node) -> (Vec3, Vec3) {
        let at_rest_m = rest.translation + rest.rotation * self.at_link_m;
        let by_m = node.reference_world_m + self.arm_m(node) - at_rest_m;
        let turn = node.rotation * rest.rotation.inverse();
        (by_m, turn.to_scaled_axis())
    }

    /// The impulse of spring and damper over a time, at the velocity before the step.
    pub(crate) fn impulse(&self, body: &Body, node: &Node, time_s: f64) -> Spatial {
        let (by_m, turned_rad) = self.displacement(&body.start, node);
        let arm_m = self.arm_m(node);
        let force_n =
            by_m * -self.stiffness_n_m - node.velocity.velocity_at(arm_m) * self.damping_n_s_m;
        let torque_nm =
            turned_rad * -self.stiffness_nm_rad - node.velocity.angular() * self.damping_nm_s_rad;
        let mut impulse = Spatial::ZERO;
        let force = Spatial::at(arm_m, force_n) + Spatial::new(torque_nm, Vec3::ZERO);
        impulse.add_scaled(&force, time_s);
        impulse
    }

    /// The energy of the spring, without that of the load that it carries at the start, J.
    pub(crate) fn energy_j(&self, body: &Body, node: &Node) -> f64 {
        let (by_m, turned_rad) = self.displacement(&body.start, node);
        0.5 * (self.stiffness_n_m * by_m.length_squared()
            + self.stiffness_nm_rad * turned_rad.length_squared())
    }

    /// The force at the mount, and the torque about it, that carry the tree of this root.
    pub(crate) fn load(
        &self,
        forest: &Forest,
        nodes: &[Node],
        root: usize,
        gravity_world_m_s2: Vec3,
    ) -> (Vec3, Vec3) {
        let at_world_m = nodes[root].reference_world_m + self.arm_m(&nodes[root]);
        let (mut force_n, mut torque_nm) = (Vec3::ZERO, Vec3::ZERO);
        for (body, node) in forest.bodies.iter().zip(nodes) {
            if body.root == root {
                let lift_n = gravity_world_m_s2 * -body.mass_kg;
                force_n += lift_n;
                torque_nm += (node.centre_world_m() - at_world_m).cross(lift_n);
            }
        }
        (force_n, torque_nm)
    }

    /// The impulse of a load over a time.
    pub(crate) fn carried(&self, node: &Node, load: (Vec3, Vec3), time_s: f64) -> Spatial {
        let mut impulse = Spatial::ZERO;
        let force = Spatial::at(self.arm_m(node), load.0) + Spatial::new(load.1, Vec3::ZERO);
        impulse.add_scaled(&force, time_s);
        impulse
    }
}
