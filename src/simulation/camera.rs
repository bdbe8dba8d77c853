//! What a camera adds to the truth: errors of recorded positions and orientations.

use nalgebra::{UnitQuaternion, Vector3};

use super::noise::normal;
use crate::error::{Error, Result};
use crate::random::Numbered;
use crate::trajectory::Trajectory;

/// Standard deviations of a camera's errors, normal and independent from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Camera {
    /// Error of each recorded position, each axis, metres.
    pub position_m: f64,
    /// Error of each recorded orientation about a random axis, radians.
    pub orientation_rad: f64,
}

impl Camera {
    /// Checks that both standard deviations are finite and not negative.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<()> {
        for (field, value) in [
            ("position_m", self.position_m),
            ("orientation_rad", self.orientation_rad),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(
                    Error::invalid("a standard deviation must be finite and not negative")
                        .field(format!("camera {field}"))
                        .found(value)
                        .allowed("0 or more"),
                );
            }
        }
        Ok(())
    }

    /// What the camera would have recorded: positions and orientations with errors, no velocities.
    ///
    /// # Errors
    /// None for a valid trajectory.
    pub fn record(&self, truth: &Trajectory, seed: u64, repeat: u64) -> Result<Trajectory> {
        let mut rng = Numbered::Camera.generator(seed, repeat);
        let mut draw = |sd: f64| sd * normal(&mut rng);
        let mut positions = Vec::with_capacity(truth.len());
        let mut orientations = Vec::with_capacity(truth.len());
        for index in 0..truth.len() {
            positions.push(
                truth.positions_world_m()[index] + Vector3::from_fn(|_, _| draw(self.position_m)),
            );
            if let Some(world_from_body) = truth.orientations_world_from_body() {
                let error = Vector3::from_fn(|_, _| draw(self.orientation_rad / 3.0_f64.sqrt()));
                orientations.push(UnitQuaternion::from_scaled_axis(error) * world_from_body[index]);
            }
        }
        let recorded = Trajectory::new(truth.times_s().to_vec(), positions)?;
        if orientations.is_empty() {
            Ok(recorded)
        } else {
            recorded.with_orientations(orientations)
        }
    }
}
