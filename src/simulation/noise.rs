//! What makes repeats of one experiment differ: random starts, servo zeros and camera errors.

use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::experiment::{Experiment, Perturbation};
use crate::error::{Error, Result};
use crate::trajectory::Trajectory;

/// Standard deviations of the errors that a repeat draws, all normal and independent.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Start position, each axis, metres (a lift below 0 counts as 0 for settled starts).
    pub start_position_m: f64,
    /// Start tilt about a random horizontal axis, radians.
    pub start_tilt_rad: f64,
    /// Start heading, radians.
    pub start_heading_rad: f64,
    /// Zero of each servo, radians.
    pub servo_zero_rad: f64,
    /// Error of each recorded position, each axis, metres.
    pub camera_m: f64,
    /// Error of each recorded orientation about a random axis, radians.
    pub camera_rad: f64,
}

impl Default for Noise {
    /// No noise at all.
    fn default() -> Self {
        Self {
            start_position_m: 0.0,
            start_tilt_rad: 0.0,
            start_heading_rad: 0.0,
            servo_zero_rad: 0.0,
            camera_m: 0.0,
            camera_rad: 0.0,
        }
    }
}

/// Streams of random numbers of one repeat: changing the number of samples must not change the start.
const START_STREAM: u64 = 1;
const CAMERA_STREAM: u64 = 2;

impl Noise {
    /// How exactly a robot can be put down by hand: 1 mm, 1° of tilt and heading.
    pub fn careful_start() -> Self {
        let degree = 1.0_f64.to_radians();
        Self {
            start_position_m: 1e-3,
            start_tilt_rad: degree,
            start_heading_rad: degree,
            ..Self::default()
        }
    }

    /// A careful repeat with another robot of the same make: [`Noise::careful_start`] and 1° of servo zero.
    pub fn careful_repeat() -> Self {
        Self {
            servo_zero_rad: 1.0_f64.to_radians(),
            ..Self::careful_start()
        }
    }

    /// Checks that every standard deviation is finite and not negative.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<()> {
        for (field, value) in [
            ("start_position_m", self.start_position_m),
            ("start_tilt_rad", self.start_tilt_rad),
            ("start_heading_rad", self.start_heading_rad),
            ("servo_zero_rad", self.servo_zero_rad),
            ("camera_m", self.camera_m),
            ("camera_rad", self.camera_rad),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(
                    Error::invalid("a standard deviation must be finite and not negative")
                        .field(field)
                        .found(value)
                        .allowed("0 or more"),
                );
            }
        }
        Ok(())
    }

    /// The experiment of repeat number `repeat`: start and servo zeros drawn from this noise.
    ///
    /// Repeat k is the same whatever the other repeats are, so any one can be replayed.
    pub fn perturb(&self, experiment: &Experiment, seed: u64, repeat: u64) -> Experiment {
        let mut rng = generator(seed, repeat, START_STREAM);
        let mut draw = |sd: f64| sd * normal(&mut rng);
        let shift_world_m = Vector3::from_fn(|_, _| draw(self.start_position_m));
        let direction_rad = draw(std::f64::consts::TAU);
        let tilt_rad = draw(self.start_tilt_rad);
        let heading_rad = draw(self.start_heading_rad);
        let tilt_axis = nalgebra::Unit::new_unchecked(Vector3::new(
            direction_rad.cos(),
            direction_rad.sin(),
            0.0,
        ));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad)
            * UnitQuaternion::from_axis_angle(&tilt_axis, tilt_rad);
        let servo_zero_rad = experiment
            .assembly
            .hinges
            .iter()
            .map(|_| draw(self.servo_zero_rad))
            .collect();
        Experiment {
            perturbation: Perturbation {
                shift_world_m,
                turn_world_rad: turn.scaled_axis(),
                servo_zero_rad,
            },
            ..experiment.clone()
        }
    }

    /// What a camera would have recorded: positions and orientations with errors, no velocities.
    ///
    /// # Errors
    /// None for a valid trajectory.
    pub fn record(&self, truth: &Trajectory, seed: u64, repeat: u64) -> Result<Trajectory> {
        let mut rng = generator(seed, repeat, CAMERA_STREAM);
        let mut draw = |sd: f64| sd * normal(&mut rng);
        let mut positions = Vec::with_capacity(truth.len());
        let mut orientations = Vec::with_capacity(truth.len());
        for index in 0..truth.len() {
            positions.push(
                truth.positions_world_m()[index] + Vector3::from_fn(|_, _| draw(self.camera_m)),
            );
            if let Some(world_from_body) = truth.orientations_world_from_body() {
                let error = Vector3::from_fn(|_, _| draw(self.camera_rad / 3.0_f64.sqrt()));
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

fn generator(seed: u64, repeat: u64, stream: u64) -> ChaCha8Rng {
    let mut key = [0_u8; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&repeat.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(stream);
    rng
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}
