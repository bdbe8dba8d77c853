//! Camera model: measurement errors of recorded positions, orientations and times.

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::distribution::{Distribution, Use, normal};
use realgap_core::error::{Error, Result};
use realgap_core::random::Numbered;
use realgap_path::trajectory::{Interpolator, Trajectory};

/// Distributions of a camera's (or any tracker's) errors, independent from sample to sample. A field that is left out stands for
/// no error.
///
/// ```
/// use realgap_simulation::{Camera, Distribution};
///
/// let camera = Camera { position_m: Distribution::Normal(1e-3), ..Camera::default() };
/// assert!(camera.check().is_ok() && !camera.is_zero());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "Camera")]
pub struct Camera {
    /// Error of each recorded position, each axis, metres.
    pub position_m: Distribution,
    /// Error of each recorded orientation, a turn about a random axis, radians.
    pub angle_rad: Distribution,
    /// Delay between a sample's time stamp and the moment at which it was taken, seconds.
    pub time_s: Distribution,
}

impl Camera {
    /// A careful guess for a camera that nobody measured: a millimetre, and 0.3°.
    pub fn careful() -> Self {
        Self {
            position_m: Distribution::Normal(1e-3),
            angle_rad: Distribution::Normal(5e-3),
            time_s: Distribution::default(),
        }
    }

    /// Every field with its name as in a noise section, in the order of the struct.
    pub(super) fn uses(&self) -> [(&'static str, Distribution, Use); 3] {
        [
            ("camera.position_m", self.position_m, Use::Offset),
            ("camera.angle_rad", self.angle_rad, Use::Offset),
            ("camera.time_s", self.time_s, Use::Offset),
        ]
    }

    /// Whether the camera has no errors.
    pub fn is_zero(&self) -> bool {
        self.uses().iter().all(|(_, field, _)| field.is_zero())
    }

    /// Checks that every distribution is valid.
    ///
    /// # Errors
    /// The first field with an invalid distribution.
    pub fn check(&self) -> Result<()> {
        let fault = self.uses().into_iter().find_map(fault_of);
        fault.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The trajectory that the camera would have recorded: positions and orientations with errors, no velocities.
    ///
    /// Errors of positions and orientations are drawn from one random stream and errors of times from another, so that the first
    /// two do not depend on the third.
    ///
    /// # Errors
    /// None for a valid trajectory.
    pub fn record(&self, truth: &Trajectory, seed: u64, repeat: u64) -> Result<Trajectory> {
        let mut rng = Numbered::Camera.generator(seed, repeat);
        let mut clock = Numbered::CameraTime.generator(seed, repeat);
        let mut taken = Interpolator::new(truth);
        // Three independent errors of this size about the axes have the same size as one error about a random axis.
        let about_each = self.angle_rad.divided_by(3.0_f64.sqrt());
        let mut positions = Vec::with_capacity(truth.len());
        let mut orientations = Vec::with_capacity(truth.len());
        for (index, time_s) in truth.times_s().iter().enumerate() {
            let late_s = self.time_s.draw(normal(&mut clock));
            let at_s = (late_s != 0.0).then(|| time_s - truth.times_s()[0] + late_s);
            let position = match at_s {
                Some(at_s) => taken.position_world_m(at_s),
                None => truth.positions_world_m()[index],
            };
            let mut error =
                |field: Distribution| Vector3::from_fn(|_, _| field.draw(normal(&mut rng)));
            positions.push(position + error(self.position_m));
            if let Some(world_from_body) = truth.orientations_world_from_body() {
                let true_turn = at_s.and_then(|at_s| taken.orientation_world_from_body(at_s));
                orientations.push(
                    UnitQuaternion::from_scaled_axis(error(about_each))
                        * true_turn.unwrap_or(world_from_body[index]),
                );
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

/// The error of a field, if its distribution is invalid.
pub(super) fn fault_of(
    (name, field, purpose): (&'static str, Distribution, Use),
) -> Option<(&'static str, Error)> {
    Some((name, field.check(name, purpose).err()?))
}
