//! State of one rigid part: pose, velocities and mass properties.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// State of one rigid part in the engine.
#[derive(Debug, Clone, PartialEq)]
pub struct PartState {
    /// Pose of the part frame (centre of its first solid, axes of the robot at zero angles).
    pub world_from_part: Isometry3<f64>,
    /// Centre of mass, world frame, metres.
    pub centre_world_m: Vector3<f64>,
    /// Velocity of the centre of mass, world frame, m/s.
    pub velocity_world_m_s: Vector3<f64>,
    /// Angular velocity, world frame, rad/s.
    pub angular_velocity_world_rad_s: Vector3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia about the centre of mass, along the world's axes, kg m².
    pub inertia_world_kg_m2: Matrix3<f64>,
}

impl PartState {
    /// Kinetic energy, J.
    pub fn kinetic_energy_j(&self) -> f64 {
        let spin = self.angular_velocity_world_rad_s;
        0.5 * self.mass_kg * self.velocity_world_m_s.norm_squared()
            + 0.5 * spin.dot(&(self.inertia_world_kg_m2 * spin))
    }

    /// Momentum, kg m/s.
    pub fn momentum_world_kg_m_s(&self) -> Vector3<f64> {
        self.velocity_world_m_s * self.mass_kg
    }

    /// Angular momentum about the world's origin, kg m²/s.
    pub fn angular_momentum_world_kg_m2_s(&self) -> Vector3<f64> {
        self.inertia_world_kg_m2 * self.angular_velocity_world_rad_s
            + self.centre_world_m.cross(&self.momentum_world_kg_m_s())
    }
}
