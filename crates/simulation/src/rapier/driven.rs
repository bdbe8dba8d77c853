//! Velocities of bodies that are driven along tracks, for the computation of contacts.

use nalgebra::Vector3;

use super::{from_vector, to_vector};
use rapier3d_f64::dynamics::RigidBodyHandle;
use rapier3d_f64::math::Vector;

/// A body that is driven along a track. The velocity is stored here because the engine computes contacts before it updates the
/// body's velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Driven {
    /// Handle of the body.
    pub body: RigidBodyHandle,
    /// Velocity of the body's origin, world frame, m/s.
    pub linear_world_m_s: Vector3<f64>,
    /// Angular velocity, world frame, rad/s.
    pub angular_world_rad_s: Vector3<f64>,
    /// The body's origin, world frame, metres.
    pub origin_world_m: Vector3<f64>,
}

impl Driven {
    /// A body that has not moved yet.
    pub fn at_rest(body: RigidBodyHandle) -> Self {
        Self {
            body,
            linear_world_m_s: Vector3::zeros(),
            angular_world_rad_s: Vector3::zeros(),
            origin_world_m: Vector3::zeros(),
        }
    }

    /// Velocity at a point of the world, m/s.
    pub fn velocity_at(&self, point: Vector) -> Vector {
        let arm = from_vector(point) - self.origin_world_m;
        to_vector(&(self.linear_world_m_s + self.angular_world_rad_s.cross(&arm)))
    }
}
