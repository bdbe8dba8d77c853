//! Bodies of the scene in Rapier: creation, poses, and driven motion.

use nalgebra::{Isometry3, Translation3, Vector3};

use super::driven::Driven;
use super::{RapierWorld, from_pose, to_pose};
use crate::experiment::Experiment;
use crate::scene::SceneMotion;
use rapier3d_f64::prelude::{
    ActiveHooks, CoefficientCombineRule, ColliderBuilder, RigidBodyBuilder,
};

impl RapierWorld {
    /// Adds the bodies of the scene; driven bodies are at the origin until they are placed.
    pub(super) fn set_scene(&mut self, experiment: &Experiment) {
        let steps = experiment.steps();
        for body in experiment.scene.iter().chain(&steps) {
            let (kind, pose, mass_kg) = match &body.motion {
                SceneMotion::Fixed { world_from_body } => {
                    (RigidBodyBuilder::fixed(), *world_from_body, 0.0)
                }
                SceneMotion::Free {
                    world_from_body,
                    mass_kg,
                } => (RigidBodyBuilder::dynamic(), *world_from_body, *mass_kg),
                SceneMotion::Driven { .. } => (
                    RigidBodyBuilder::kinematic_position_based(),
                    Isometry3::identity(),
                    0.0,
                ),
            };
            let is_driven = matches!(body.motion, SceneMotion::Driven { .. });
            let adjusted = &experiment.adjustment;
            let (shift_m, friction) = if is_driven {
                let friction = adjusted.pusher_friction.unwrap_or(body.friction);
                (adjusted.pusher_offset_m, friction)
            } else {
                (Vector3::zeros(), body.friction)
            };
            let handle = self
                .bodies
                .insert(kind.pose(to_pose(&pose)).can_sleep(false).build());
            let volume_m3: f64 = body.boxes.iter().map(|b| b.sides_m.product()).sum();
            for part in &body.boxes {
                let half_m = part.sides_m / 2.0;
                let collider = ColliderBuilder::cuboid(half_m.x, half_m.y, half_m.z)
                    .position(to_pose(&(Translation3::from(shift_m) * part.body_from_box)))
                    .density(mass_kg / volume_m3)
                    // A free body has the robot's friction with the floor; for contacts with the robot, the friction of the pair
                    // is used.
                    .friction(experiment.floor.friction)
                    .restitution(experiment.floor.restitution)
                    .friction_combine_rule(CoefficientCombineRule::Multiply)
                    .restitution_combine_rule(CoefficientCombineRule::Multiply)
                    .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS)
                    .build();
                let collider =
                    self.colliders
                        .insert_with_parent(collider, handle, &mut self.bodies);
                self.hooks.pair_friction.push((collider, friction));
            }
            if is_driven {
                self.hooks.driven.push(Driven::at_rest(handle));
            }
            self.scene.push(handle);
        }
    }

    /// Poses of the bodies of the scene, in the experiment's order.
    pub(super) fn poses_of_scene(&self) -> Vec<Isometry3<f64>> {
        let bodies = self.scene.iter().map(|handle| self.bodies.get(*handle));
        bodies
            .map(|body| body.map_or_else(Isometry3::identity, |body| from_pose(body.position())))
            .collect()
    }

    /// Places a driven body of the scene at its start pose.
    pub(super) fn put_driven(&mut self, index: usize, world_from_body: &Isometry3<f64>) {
        if let Some(body) = self.bodies.get_mut(self.scene[index]) {
            body.set_position(to_pose(world_from_body), true);
        }
    }

    /// Moves a driven body so that it reaches a pose after the next step.
    pub(super) fn guide_driven(&mut self, index: usize, next: &Isometry3<f64>) {
        let handle = self.scene[index];
        let timestep_s = self.parameters.dt;
        let Some(body) = self.bodies.get_mut(handle) else {
            return;
        };
        let here = from_pose(body.position());
        body.set_next_kinematic_position(to_pose(next));
        let known = self.hooks.driven.iter_mut().find(|d| d.body == handle);
        if let Some(driven) = known {
            driven.origin_world_m = here.translation.vector;
            driven.linear_world_m_s =
                (next.translation.vector - here.translation.vector) / timestep_s;
            driven.angular_world_rad_s =
                (next.rotation * here.rotation.inverse()).scaled_axis() / timestep_s;
        }
    }
}
