//! The ground in the tree solver: the flat floor, a height field, and what differs from place to place.

use std::sync::Arc;

use realgap_tree::parry::math::{Pose, Vec3};
use realgap_tree::parry::shape::SharedShape;
use realgap_tree::{Collider, Fixture, Partner, Spot, SpotMap};

use super::{TreeWorld, turning_of_floor};
use crate::experiment::Experiment;
use crate::ground::GroundMap;
use crate::rapier::{field_shape, from_vector, to_pose, to_vector};

/// The flat floor, and the height field that takes its place where there is one.
pub(super) fn floor(experiment: &Experiment) -> Vec<Fixture> {
    let floor = &experiment.floor;
    let surface = |shape: SharedShape, pose: Pose| {
        let mut collider = Collider::new(shape, 1.0);
        collider.restitution = 1.0;
        collider.turning = turning_of_floor(experiment);
        collider.mark = u64::MAX;
        Fixture::at_rest(collider, pose)
    };
    let mut plane = surface(
        SharedShape::halfspace(to_vector(&floor.normal_world())),
        Pose::from_translation(Vec3::new(0.0, 0.0, floor.height_m)),
    );
    plane.spots = spots(experiment, true);
    let mut floors = vec![plane];
    if let Some(field) = &experiment.ground.heights {
        let (shape, field_from_shape) = field_shape(field, experiment.heights_scale);
        let pose = experiment.world_from_heights(field) * field_from_shape;
        let mut rough = surface(shape, to_pose(&pose));
        rough.spots = spots(experiment, false);
        floors.push(rough);
    }
    floors
}

/// Friction and restitution from place to place; the flat floor is left out where there is a height field.
fn spots(experiment: &Experiment, is_flat: bool) -> Option<SpotMap> {
    let map = GroundMap::of(experiment)?;
    let own = experiment.ground.regions.iter().map(|region| Spot::Own {
        friction: region.friction,
        restitution: region.restitution,
    });
    let own: Vec<Spot> = own.collect();
    Some(Arc::new(move |point_world_m| {
        let point_world_m = from_vector(point_world_m);
        if is_flat && map.is_hole(&point_world_m) {
            return Spot::Hole;
        }
        let region = map.region_at(&point_world_m);
        region.map_or(Spot::Plain, |region| own[region])
    }))
}

impl TreeWorld {
    /// Marks the regions that the contacts of the last solve touched.
    pub(super) fn mark_regions(&mut self) {
        let Some((map, floors)) = &self.ground else {
            return;
        };
        if self.touched.iter().all(|touched| *touched) {
            return;
        }
        for contact in self.world.contacts() {
            let is_floor = matches!(contact.partner, Partner::Fixture(index) if index < *floors);
            if is_floor && contact.impulse_world_n_s.dot(contact.normal_world) > 0.0 {
                let place = map.region_at(&from_vector(contact.point_world_m));
                if let Some(touched) = place.and_then(|index| self.touched.get_mut(index)) {
                    *touched = true;
                }
            }
        }
    }
}
