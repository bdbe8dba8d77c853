//! Noise model: random deviations between repeats of one experiment in start, servos, masses and friction, and errors of the
//! camera.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::camera::{Camera, fault_of};
use super::distribution::{Distribution, Use, normal};
use super::experiment::{Experiment, Perturbation};
use realgap_core::error::{Error, Result};
use realgap_core::random::Numbered;
use realgap_path::trajectory::Trajectory;

/// Distributions of the errors that a repeat draws, all independent. A field that is left out stands for no error.
///
/// Relative fields are factors: 1 + draw, or the draw itself for a `LogNormal`.
///
/// ```
/// use realgap_simulation::{Distribution, Noise};
///
/// let noise = Noise {
///     start_heading_rad: Distribution::Normal(0.0175),
///     servo_latency_s: Distribution::Uniform(0.0, 0.02),
///     mass_relative: Distribution::LogNormal(0.02),
///     ..Noise::default()
/// };
/// assert!(noise.check().is_ok() && !noise.is_zero());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "Noise")]
pub struct Noise {
    /// Start position, x and y each, metres.
    pub start_position_m: Distribution,
    /// Start height above the height at which the robot would just touch the floor, metres (values below 0 count as 0 for settled
    /// starts).
    pub start_height_m: Distribution,
    /// Start tilt about a random horizontal axis, radians.
    pub start_tilt_rad: Distribution,
    /// Start heading, radians.
    pub start_heading_rad: Distribution,
    /// Velocity of a stated start along each axis, m/s; no effect on a settled start.
    pub start_velocity_m_s: Distribution,
    /// Angular velocity of a stated start about each axis, rad/s; no effect on a settled start.
    pub start_spin_rad_s: Distribution,
    /// Error of the zero position of each servo, radians.
    pub servo_zero_rad: Distribution,
    /// Gain (stiffness for the torque law) of each servo, relative.
    pub servo_gain_relative: Distribution,
    /// Error of the phase of each servo's command, radians.
    pub servo_phase_rad: Distribution,
    /// Latency of each servo, added to the experiment's own, seconds.
    pub servo_latency_s: Distribution,
    /// Delay of each single command of a recorded track, seconds; no command overtakes another.
    pub command_jitter_s: Distribution,
    /// Mass (and with it inertia) of each module, relative.
    pub mass_relative: Distribution,
    /// Friction of each module, its plate included, relative.
    pub friction_cube_relative: Distribution,
    /// Friction of each plate on top of its module's, relative. A plate as large as its cube carries as much load as the cube, so
    /// which of the two slips depends only on the difference of their friction coefficients.
    pub friction_plate_relative: Distribution,
    /// Friction of all modules in this run, relative.
    pub friction_run_relative: Distribution,
    /// Errors of the camera that records the repeat. They change the recording and not the simulation: [`Noise::perturb`] ignores
    /// them, and [`Noise::record`] applies them.
    pub camera: Camera,
}

impl Noise {
    /// Noise of a robot that is placed by hand: 1 mm of position, 1° of tilt and heading.
    pub fn careful_start() -> Self {
        let degree = Distribution::Normal(1.0_f64.to_radians());
        Self {
            start_position_m: Distribution::Normal(1e-3),
            start_height_m: Distribution::Normal(1e-3),
            start_tilt_rad: degree,
            start_heading_rad: degree,
            ..Self::default()
        }
    }

    /// A careful repeat with another robot of the same make: [`Noise::careful_start`] and 1° of servo zero.
    pub fn careful_repeat() -> Self {
        Self {
            servo_zero_rad: Distribution::Normal(1.0_f64.to_radians()),
            ..Self::careful_start()
        }
    }

    /// Default noise for a robot without measurements: [`Noise::careful_repeat`], servo gains within 3 %, phases within 1°,
    /// latencies up to one 50 Hz servo frame (20 ms), masses within 2 %, and friction within 5 % from cube to cube, from plate to
    /// cube and from run to run. The values are estimates, to be replaced by measurements.
    pub fn unmeasured_robot() -> Self {
        Self {
            servo_gain_relative: Distribution::LogNormal(0.03),
            servo_phase_rad: Distribution::Normal(1.0_f64.to_radians()),
            servo_latency_s: Distribution::Uniform(0.0, 0.02),
            mass_relative: Distribution::LogNormal(0.02),
            friction_cube_relative: Distribution::LogNormal(0.05),
            friction_plate_relative: Distribution::LogNormal(0.05),
            friction_run_relative: Distribution::LogNormal(0.05),
            ..Self::careful_repeat()
        }
    }

    /// Every field with its name, in the order of the struct.
    pub fn fields(&self) -> [(&'static str, Distribution); 18] {
        self.uses().map(|(name, field, _)| (name, field))
    }

    fn uses(&self) -> [(&'static str, Distribution, Use); 18] {
        let [position, angle, time] = self.camera.uses();
        [
            ("start_position_m", self.start_position_m, Use::Offset),
            ("start_height_m", self.start_height_m, Use::Offset),
            ("start_tilt_rad", self.start_tilt_rad, Use::Offset),
            ("start_heading_rad", self.start_heading_rad, Use::Offset),
            ("start_velocity_m_s", self.start_velocity_m_s, Use::Offset),
            ("start_spin_rad_s", self.start_spin_rad_s, Use::Offset),
            ("servo_zero_rad", self.servo_zero_rad, Use::Offset),
            ("servo_gain_relative", self.servo_gain_relative, Use::Factor),
            ("servo_phase_rad", self.servo_phase_rad, Use::Offset),
            ("servo_latency_s", self.servo_latency_s, Use::Delay),
            ("command_jitter_s", self.command_jitter_s, Use::Delay),
            ("mass_relative", self.mass_relative, Use::Factor),
            (
                "friction_cube_relative",
                self.friction_cube_relative,
                Use::Factor,
            ),
            (
                "friction_plate_relative",
                self.friction_plate_relative,
                Use::Factor,
            ),
            (
                "friction_run_relative",
                self.friction_run_relative,
                Use::Factor,
            ),
            position,
            angle,
            time,
        ]
    }

    /// Whether all repeats are the same.
    pub fn is_zero(&self) -> bool {
        self.fields().iter().all(|(_, field)| field.is_zero())
    }

    /// Checks that every distribution is valid and suits its field.
    ///
    /// # Errors
    /// The first field with an invalid or unsuitable distribution.
    pub fn check(&self) -> Result<()> {
        self.fault().map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The name and the error of the first field that is not valid.
    pub fn fault(&self) -> Option<(&'static str, Error)> {
        self.uses().into_iter().find_map(fault_of)
    }

    /// The experiment of repeat number `repeat`, with all deviations drawn from this noise.
    ///
    /// Repeat k does not depend on the other repeats, so any single repeat can be reproduced.
    pub fn perturb(&self, experiment: &Experiment, seed: u64, repeat: u64) -> Experiment {
        let mut drawn = Experiment {
            perturbation: self.draw(experiment, seed, repeat),
            ..experiment.clone()
        };
        if !self.command_jitter_s.is_zero() {
            let mut rng = Numbered::CommandJitter.generator(seed, repeat);
            for track in drawn.commands.values_mut() {
                *track = Arc::new(track.late(|| self.command_jitter_s.draw(normal(&mut rng))));
            }
        }
        drawn
    }

    /// The recording of the motion of repeat number `repeat` by the camera; the motion itself if the camera has no errors.
    ///
    /// # Errors
    /// None for a valid trajectory.
    pub fn record(&self, motion: Trajectory, seed: u64, repeat: u64) -> Result<Trajectory> {
        if self.camera.is_zero() {
            return Ok(motion);
        }
        self.camera.record(&motion, seed, repeat)
    }

    /// The same noise without the errors of the camera.
    #[must_use]
    pub fn without_camera(&self) -> Self {
        Self {
            camera: Camera::default(),
            ..*self
        }
    }

    /// The same noise with all errors of start, servos, masses and friction this many times as large; the camera is the same.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let times = |field: Distribution| field.divided_by(1.0 / factor);
        Self {
            start_position_m: times(self.start_position_m),
            start_height_m: times(self.start_height_m),
            start_tilt_rad: times(self.start_tilt_rad),
            start_heading_rad: times(self.start_heading_rad),
            start_velocity_m_s: times(self.start_velocity_m_s),
            start_spin_rad_s: times(self.start_spin_rad_s),
            servo_zero_rad: times(self.servo_zero_rad),
            servo_gain_relative: times(self.servo_gain_relative),
            servo_phase_rad: times(self.servo_phase_rad),
            servo_latency_s: times(self.servo_latency_s),
            command_jitter_s: times(self.command_jitter_s),
            mass_relative: times(self.mass_relative),
            friction_cube_relative: times(self.friction_cube_relative),
            friction_plate_relative: times(self.friction_plate_relative),
            friction_run_relative: times(self.friction_run_relative),
            camera: self.camera,
        }
    }

    fn draw(&self, experiment: &Experiment, seed: u64, repeat: u64) -> Perturbation {
        let hinges = experiment.assembly.hinges.len();
        let modules = experiment.assembly.module_names.len();
        let mut rng = Numbered::Start.generator(seed, repeat);
        let shift_x_m = self.start_position_m.draw(normal(&mut rng));
        let shift_y_m = self.start_position_m.draw(normal(&mut rng));
        let lift_m = self.start_height_m.draw(normal(&mut rng));
        let direction_rad = std::f64::consts::TAU * normal(&mut rng);
        let tilt_rad = self.start_tilt_rad.draw(normal(&mut rng));
        let heading_rad = self.start_heading_rad.draw(normal(&mut rng));
        let tilt_axis = nalgebra::Unit::new_unchecked(Vector3::new(
            direction_rad.cos(),
            direction_rad.sin(),
            0.0,
        ));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad)
            * UnitQuaternion::from_axis_angle(&tilt_axis, tilt_rad);
        let servo_zero_rad = (0..hinges)
            .map(|_| self.servo_zero_rad.draw(normal(&mut rng)))
            .collect();
        // Each kind of error has its own random stream, so that a change of one kind does not change the draws of the others.
        let normals = |stream: Numbered, count: usize| {
            let mut rng = stream.generator(seed, repeat);
            (0..count).map(move |_| normal(&mut rng))
        };
        let draws = |field: Distribution, stream: Numbered, count: usize| -> Vec<f64> {
            normals(stream, count).map(|z| field.draw(z)).collect()
        };
        let factors = |field: Distribution, stream: Numbered, count: usize| -> Vec<f64> {
            normals(stream, count).map(|z| field.factor(z)).collect()
        };
        let mut motion = Numbered::StartMotion.generator(seed, repeat);
        // Both vectors are always drawn, so that one does not change the other.
        let mut vector =
            |field: Distribution| Vector3::from_fn(|_, _| field.draw(normal(&mut motion)));
        Perturbation {
            shift_world_m: Vector3::new(shift_x_m, shift_y_m, lift_m),
            turn_world_rad: turn.scaled_axis(),
            velocity_world_m_s: vector(self.start_velocity_m_s),
            spin_world_rad_s: vector(self.start_spin_rad_s),
            servo_zero_rad,
            servo_gain_factor: factors(self.servo_gain_relative, Numbered::ServoGain, hinges),
            servo_phase_rad: draws(self.servo_phase_rad, Numbered::ServoPhase, hinges),
            servo_latency_s: draws(self.servo_latency_s, Numbered::ServoLatency, hinges),
            mass_factor: factors(self.mass_relative, Numbered::ModuleMass, modules),
            friction_factor: factors(
                self.friction_cube_relative,
                Numbered::ModuleFriction,
                modules,
            ),
            plate_friction_factor: factors(
                self.friction_plate_relative,
                Numbered::PlateFriction,
                modules,
            ),
            run_friction_factor: factors(self.friction_run_relative, Numbered::RunFriction, 1)[0],
            draw: (!experiment.has_engine()).then_some((seed, repeat)),
        }
    }
}
