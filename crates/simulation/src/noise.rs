//! What makes repeats of one experiment differ: random starts, servos, masses and frictions, and the camera that sees them.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::camera::{Camera, fault_of};
use super::distribution::{Distribution, Use, normal};
use super::experiment::{Experiment, Perturbation};
use realgap_core::error::{Error, Result};
use realgap_core::random::Numbered;
use realgap_path::trajectory::Trajectory;

/// Distributions of the errors that a repeat draws, all independent. A field that is not named is no error.
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
    /// Start height above where the robot would just touch, metres (below 0 counts as 0 for settled starts).
    pub start_height_m: Distribution,
    /// Start tilt about a random horizontal axis, radians.
    pub start_tilt_rad: Distribution,
    /// Start heading, radians.
    pub start_heading_rad: Distribution,
    /// Velocity of a stated start along each axis, m/s; nothing where the robot settles first.
    pub start_velocity_m_s: Distribution,
    /// Angular velocity of a stated start about each axis, rad/s; nothing where the robot settles first.
    pub start_spin_rad_s: Distribution,
    /// Zero of each servo, radians.
    pub servo_zero_rad: Distribution,
    /// Gain (stiffness for the torque law) of each servo, relative.
    pub servo_gain_relative: Distribution,
    /// Phase of each servo's command, radians.
    pub servo_phase_rad: Distribution,
    /// Age of the command that each servo acts on, added to the experiment's own, seconds.
    pub servo_latency_s: Distribution,
    /// How much later than recorded each single command of a recorded track arrives, seconds; none overtakes another.
    pub command_jitter_s: Distribution,
    /// Mass (and with it inertia) of each module, relative.
    pub mass_relative: Distribution,
    /// Friction of each module, its plate included, relative.
    pub friction_cube_relative: Distribution,
    /// Friction of each plate on top of its module's, relative. A plate of its cube's size carries as much as the cube does,
    /// and only a difference of the two decides which of them slips.
    pub friction_plate_relative: Distribution,
    /// Friction of all modules in this run, relative.
    pub friction_run_relative: Distribution,
    /// Errors of the camera that records the repeat. It changes what is seen, not what happens: [`Noise::perturb`] knows
    /// nothing of it, [`Noise::record`] applies it.
    pub camera: Camera,
}

impl Noise {
    /// How exactly a robot can be put down by hand: 1 mm, 1° of tilt and heading.
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

    /// What to expect of a robot that nobody has measured yet: [`Noise::careful_repeat`], servo gains within 3 %,
    /// phases within 1°, latencies up to one 50 Hz servo frame (20 ms), masses within 2 %, and friction within
    /// 5 % from cube to cube, from plate to cube and from run to run. Estimates, to be replaced by what a laboratory knows.
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

    /// Checks that every distribution is sound and suits its field.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<()> {
        self.fault().map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The first field that is not sound, by name, and what is wrong with it.
    pub fn fault(&self) -> Option<(&'static str, Error)> {
        self.uses().into_iter().find_map(fault_of)
    }

    /// The experiment of repeat number `repeat`, everything random drawn from this noise.
    ///
    /// Repeat k is the same whatever the other repeats are, so any one can be replayed.
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

    /// What the camera makes of the motion of repeat number `repeat`; the motion itself where no camera is stated.
    ///
    /// # Errors
    /// None for a valid trajectory.
    pub fn record(&self, motion: Trajectory, seed: u64, repeat: u64) -> Result<Trajectory> {
        if self.camera.is_zero() {
            return Ok(motion);
        }
        self.camera.record(&motion, seed, repeat)
    }

    /// The same noise seen by nobody: what a robot does, whoever looks.
    #[must_use]
    pub fn without_camera(&self) -> Self {
        Self {
            camera: Camera::default(),
            ..*self
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
        // A stream a kind of error: changing one kind must not change the others.
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
        // Drawn whether asked for or not, so that one does not change the other.
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
            draw: experiment.vehicle.as_ref().map(|_| (seed, repeat)),
        }
    }
}
