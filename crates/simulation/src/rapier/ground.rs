//! The ground in Rapier: the flat floor, a height field, and a collider for each region.

use super::hook::Layer;
use super::{RapierWorld, field_shape, to_pose, to_vector};
use crate::experiment::Experiment;
use crate::ground::GroundMap;
use rapier3d_f64::geometry::NEW_CONTACT_BIT;
use rapier3d_f64::math::{Pose, Vector};
use rapier3d_f64::prelude::{CoefficientCombineRule, ColliderBuilder, ColliderHandle, SharedShape};

impl RapierWorld {
    /// Adds the flat floor, the height field, and a further collider of both for each region.
    pub(super) fn lay_floor(&mut self, experiment: &Experiment) {
        let floor = &experiment.floor;
        let plane = SharedShape::halfspace(to_vector(&floor.normal_world()));
        let pose = Pose::from_translation(Vector::new(0.0, 0.0, floor.height_m));
        let flat = self.lay(plane.clone(), pose);
        let Some(map) = GroundMap::of(experiment) else {
            return;
        };
        let plain = |collider, is_flat| Layer {
            collider,
            is_flat,
            region: None,
            friction: None,
            restitution: None,
        };
        let mut layers = vec![plain(flat, true)];
        let mut shapes = vec![(plane, pose, true)];
        if let Some(field) = &experiment.ground.heights {
            let (shape, field_from_shape) = field_shape(field, experiment.heights_scale);
            let pose = to_pose(&(experiment.world_from_heights(field) * field_from_shape));
            layers.push(plain(self.lay(shape.clone(), pose), false));
            shapes.push((shape, pose, false));
        }
        for (index, region) in experiment.ground.regions.iter().enumerate() {
            for (shape, pose, is_flat) in &shapes {
                layers.push(Layer {
                    region: Some(index),
                    friction: Some(region.friction),
                    restitution: region.restitution,
                    ..plain(self.lay(shape.clone(), *pose), *is_flat)
                });
            }
        }
        self.hooks.ground = Some((map, layers));
    }

    fn lay(&mut self, shape: SharedShape, pose: Pose) -> ColliderHandle {
        // The floor has the value 1 and the robot has the value of the parameter; with the rule Multiply, the parameter is the
        // value of the pair.
        let collider = ColliderBuilder::new(shape)
            .position(pose)
            .friction(1.0)
            .restitution(1.0)
            .friction_combine_rule(CoefficientCombineRule::Multiply)
            .restitution_combine_rule(CoefficientCombineRule::Multiply)
            .build();
        self.colliders.insert(collider)
    }

    /// Marks the regions whose colliders had a contact with an impulse in the last step.
    pub(super) fn mark_regions(&mut self) {
        let Some((_, layers)) = &self.hooks.ground else {
            return;
        };
        for layer in layers {
            let Some(touched) = layer.region.and_then(|index| self.touched.get_mut(index)) else {
                continue;
            };
            if *touched {
                continue;
            }
            let pairs = self.narrow_phase.contact_pairs_with(layer.collider);
            let mut manifolds = pairs
                .filter_map(|pair| pair.rigid())
                .flat_map(|rigid| rigid.solver_manifolds());
            *touched = manifolds.any(|manifold| {
                manifold.data.solver_contacts.iter().any(|contact| {
                    let index = (contact.contact_id[0] & !NEW_CONTACT_BIT) as usize;
                    (manifold.points.get(index)).is_some_and(|point| point.data.impulse > 0.0)
                })
            });
        }
    }
}
