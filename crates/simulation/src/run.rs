//! Simulation of one run: settling, stepping, sampling, and detection of diverged states.

mod progress;

use std::time::Duration;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::adjustment::HingeAdjustment;
use super::command::Quantity;
use super::command_source::CommandSource;
use super::control::{Feedback, Log, Steer, steered};
use super::energy::{EnergyBalance, EnergyMeter};
use super::engine::{Motion, Setup, World};
use super::experiment::{Experiment, JointState, Start};
use super::instrument::Instruments;
use super::kinematics::{lowest_m, part_from_track, robot_from_part_at_zero, robot_from_parts};
use super::motor::{Effort, Supply, duty, effort, position_duty};
use super::outcome::Outcome;
use super::rolling;
use super::scene::{DrivenPath, SceneMotion};
use super::servo::{Command, NOTHING, command, error_beyond_play};
use super::vehicle;
use super::watch::{Observer, Push, RunHooks, Snapshot};
use realgap_core::error::{Error, Result};
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::{Actuator, Assembly, Hinge};

/// Result of one simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The motion of the tracked module, or the reason why the run diverged.
    pub outcome: Outcome<Trajectory>,
    /// Steps taken after settling.
    pub steps: u64,
    /// Steps taken to settle.
    pub settle_steps: u64,
    /// CPU time of this thread, settling included.
    pub cpu: Duration,
    /// Root mean square of command minus angle over all servos and steps, radians; 0 without servos.
    pub servo_rms_rad: f64,
    /// Energy balance, if [`Experiment::energy_from_s`] is stated and the run was completed.
    pub energy: Option<EnergyBalance>,
    /// Warnings about the run.
    pub warnings: Vec<Warning>,
}

/// Distance from the start beyond which a run counts as diverged, metres.
const FARTHEST_M: f64 = 1e3;
/// Speed above which a run counts as diverged, m/s.
const FASTEST_M_S: f64 = 1e3;
/// Angular speed above which a run counts as diverged, rad/s.
const FASTEST_RAD_S: f64 = 1e5;
/// Longest settling, seconds.
const SETTLE_LIMIT_S: f64 = 3.0;
/// A robot that moves and turns less than this within `REST_WINDOW_S` is at rest. The criterion uses poses and not velocities,
/// because in the solver a light plate can vibrate in place.
const REST_M: f64 = 2e-4;
const REST_RAD: f64 = 4e-3;
const REST_WINDOW_S: f64 = 0.1;

/// Simulates the experiment.
///
/// # Errors
/// Settings that cannot be simulated (see [`Experiment::check`]). A simulation that diverges is not an
/// error but an [`Outcome`].
pub fn run(experiment: &Experiment) -> Result<Run> {
    run_with(experiment, RunHooks::default()).map(|(run, _)| run)
}

/// Simulates an experiment with hooks (observer, feedback, clock), and returns the log of its controller, which is empty without
/// a controller.
///
/// # Errors
/// As [`run`]; errors of the clock and of the feedback; an observer of a vehicle, feedback without a controller.
pub fn run_with(experiment: &Experiment, hooks: RunHooks<'_>) -> Result<(Run, Log)> {
    pushed(experiment, &[], hooks)
}

fn pushed(experiment: &Experiment, pushes: &[Push], hooks: RunHooks<'_>) -> Result<(Run, Log)> {
    experiment.check()?;
    experiment.simulator.get().run(experiment, pushes, hooks)
}

/// Simulates an experiment with the engines of this crate.
pub(super) fn run_built_in(
    experiment: &Experiment,
    pushes: &[Push],
    mut hooks: RunHooks<'_>,
) -> Result<(Run, Log)> {
    let started = thread_cpu_time();
    let (mut run, log) = if let Some(vehicle) = &experiment.vehicle {
        if hooks.observer.is_some() {
            return Err(Error::invalid("a vehicle has no parts to watch"));
        }
        (vehicle::run(experiment, vehicle)?, Log::default())
    } else if let Some(controller) = &experiment.controller {
        if !pushes.is_empty() {
            return Err(Error::invalid("a robot with a controller is not pushed"));
        }
        steered(experiment, controller, hooks)?
    } else {
        if hooks.feedback.is_some() {
            return Err(no_controller());
        }
        let assembly = experiment.adjusted_assembly();
        for push in pushes {
            push.check(&assembly)?;
        }
        let mut rollout = Rollout::new(experiment, &assembly)?;
        for push in pushes {
            rollout.world.push(push.part, &push.velocity_world_m_s);
        }
        let run = rollout.run(experiment, &mut hooks)?;
        (run, Log::default())
    };
    run.cpu = thread_cpu_time().saturating_sub(started);
    Ok((run, log))
}

fn no_controller() -> Error {
    Error::invalid("the experiment has no controller").hint("give it one with `with_controller`")
}

/// Simulates an experiment with its controller, and returns the log of readings and decisions; `feedback` may override every
/// decision. `observer` is called for every step as in [`watch`].
///
/// # Errors
/// As [`run_with`]; an experiment without a controller.
pub fn steer<'a>(
    experiment: &Experiment,
    observer: Observer<'a>,
    feedback: Option<Feedback<'a>>,
) -> Result<(Run, Log)> {
    if experiment.controller.is_none() {
        return Err(no_controller());
    }
    let hooks = RunHooks {
        observer,
        feedback,
        clock: None,
    };
    run_with(experiment, hooks)
}

/// Simulates the experiment and calls `observer` with the state of every part and hinge: at time 0 and after every step (settling
/// excluded). `pushes` add to the velocities of parts at time 0.
///
/// # Errors
/// As [`run`]; a push of a part that does not exist or that has a hinge, because the speed of its joint would have to change,
/// too.
pub fn watch(
    experiment: &Experiment,
    pushes: &[Push],
    observer: &mut dyn FnMut(&Snapshot),
) -> Result<Run> {
    let hooks = RunHooks {
        observer: Some(observer),
        ..RunHooks::default()
    };
    pushed(experiment, pushes, hooks).map(|(run, _)| run)
}

/// CPU time of the calling thread; wall time where the platform has no such clock.
#[cfg(unix)]
fn thread_cpu_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(
        now.tv_sec.unsigned_abs(),
        u32::try_from(now.tv_nsec).unwrap_or(0),
    )
}

/// CPU time of the calling thread; wall time where the platform has no such clock.
#[cfg(not(unix))]
fn thread_cpu_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

pub(super) use progress::RunProgress;

/// A run in progress: the engine's world, and the state of the servos.
pub(super) struct Rollout<'a> {
    experiment: &'a Experiment,
    assembly: &'a Assembly,
    world: Box<dyn World>,
    part_from_track: Isometry3<f64>,
    /// Driven bodies of the scene, by index.
    driven_paths: Vec<(usize, DrivenPath<'a>)>,
    records_joints: bool,
    angles_rad: Vec<f64>,
    squared_error_rad2: f64,
    commands: Vec<CommandSource<'a>>,
    /// Commands of the controller in place of the servos' own commands, by hinge.
    steering: Vec<Steer>,
    meter: Option<EnergyMeter>,
    /// Effort of every motor behind a gear during the previous step.
    efforts: Vec<Option<Effort>>,
    /// Duty of every motor during the previous step.
    duties: Vec<f64>,
    /// Command of every servo without a gear during the previous step.
    drives: Vec<Option<Command>>,
    /// Sensors that are recorded beside pose and joints.
    instruments: Instruments,
    /// Adjustments of the hinges, with total latencies and offsets.
    changes: Vec<HingeAdjustment>,
    timestep_s: f64,
    steps: u64,
    settle_steps: u64,
    warnings: Vec<Warning>,
}

/// Start angle of a joint for which the experiment states none, as its encoder reads it: the servo's first command, or without a servo
/// that follows angles what the robot's file states, else 0; limited to the joint's range.
fn start_rad(experiment: &Experiment, index: usize, hinge: &Hinge) -> f64 {
    let change = experiment.hinge_adjustment(index);
    let commands = CommandSource::new(experiment, hinge);
    let asked_rad = match commands.quantity() {
        Quantity::Position if hinge.actuator.is_some() => commands.value(0.0) + change.offset_rad,
        Quantity::Position
        | Quantity::Velocity
        | Quantity::Torque
        | Quantity::Current
        | Quantity::Duty => hinge.start_rad.unwrap_or(0.0),
    };
    match hinge.bearing.limits_rad {
        Some((low_rad, high_rad)) if !experiment.assembly.is_modular => {
            asked_rad.clamp(low_rad + change.zero_rad, high_rad + change.zero_rad)
        }
        _ => asked_rad,
    }
}

/// Total adjustment of a hinge: that of the study, the latency of the servo itself, and the deviations of this repeat.
fn total_change(experiment: &Experiment, assembly: &Assembly, hinge: usize) -> HingeAdjustment {
    let drawn = &experiment.perturbation;
    let Hinge { name, actuator, .. } = &assembly.hinges[hinge];
    let mut change = experiment.hinge_adjustment(hinge);
    let own_s = actuator.map_or(0.0, |actuator| actuator.servo.delay_s);
    change.latency_s = change.latency_s + drawn.latency_s_of(hinge) + own_s;
    // For a gait, its offset already contains the error of the servo's zero position.
    if experiment.commands.contains_key(name) {
        change.offset_rad += drawn.servo_zero_rad.get(hinge).unwrap_or(&0.0);
    }
    change
}

/// Pose and velocity of the robot at time 0.
fn placed(
    experiment: &Experiment,
    assembly: &Assembly,
    robot_from_parts: &[Isometry3<f64>],
) -> (Isometry3<f64>, Motion) {
    let perturbation = &experiment.perturbation;
    let turn = UnitQuaternion::from_scaled_axis(perturbation.turn_world_rad);
    if let Some(base) = &experiment.base {
        let world_from_robot = base.world_from_robot(experiment, 0.0);
        let (linear_world_m_s, angular_world_rad_s) = base.start_velocity(experiment);
        let motion = Motion {
            about_world_m: world_from_robot.translation.vector,
            linear_world_m_s,
            angular_world_rad_s,
        };
        return (world_from_robot, motion);
    }
    match (experiment.start, assembly.world_from_mount) {
        (_, Some(world_from_mount)) => (world_from_mount, Motion::REST),
        (Start::Settled, None) => {
            let turned: Vec<_> = robot_from_parts.iter().map(|pose| turn * pose).collect();
            let normal = experiment.floor.normal_world();
            // The floor passes through (0, 0, height). The robot is lifted along z until it just touches the floor.
            let above_m = lowest_m(assembly, &turned, &normal) / normal.z;
            let mut shift_m = perturbation.shift_world_m;
            let place_m = [shift_m.x, shift_m.y];
            let lift_m = experiment.lift_m(assembly, &turned, place_m) / normal.z;
            // The robot never starts inside the floor.
            shift_m.z = shift_m.z.max(0.0) + experiment.floor.height_m - above_m + lift_m;
            (Isometry3::from_parts(shift_m.into(), turn), Motion::REST)
        }
        (Start::State(recorded), None) => {
            let state = recorded.scaled(1.0 / experiment.recording_length_scale);
            let world_from_track = Isometry3::from_parts(
                (state.position_world_m + perturbation.shift_world_m).into(),
                turn * state.orientation_world_from_body,
            );
            let robot_from_track =
                robot_from_parts[assembly.track_part] * part_from_track(assembly);
            let motion = Motion {
                about_world_m: world_from_track.translation.vector,
                linear_world_m_s: state.velocity_world_m_s + perturbation.velocity_world_m_s,
                angular_world_rad_s: world_from_track.rotation * state.angular_velocity_body_rad_s
                    + perturbation.spin_world_rad_s,
            };
            (world_from_track * robot_from_track.inverse(), motion)
        }
    }
}

impl<'a> Rollout<'a> {
    pub(super) fn new(experiment: &'a Experiment, assembly: &'a Assembly) -> Result<Self> {
        let mut joints: Vec<JointState> = assembly
            .hinges
            .iter()
            .enumerate()
            .map(|(index, hinge)| {
                let mut joint = match experiment.start_joints.get(index) {
                    Some(joint) => *joint,
                    None => JointState {
                        angle_rad: start_rad(experiment, index, hinge),
                        speed_rad_s: 0.0,
                    },
                };
                joint.angle_rad -= experiment.hinge_adjustment(index).zero_rad;
                joint
            })
            .collect();
        let angles_rad: Vec<f64> = joints.iter().map(|joint| joint.angle_rad).collect();
        let robot_from_parts = robot_from_parts(assembly, &angles_rad);
        let (world_from_robot, motion) = placed(experiment, assembly, &robot_from_parts);
        let poses: Vec<_> = robot_from_parts
            .iter()
            .map(|pose| world_from_robot * pose)
            .collect();
        rolling::start(experiment, assembly, &poses, motion, &mut joints);
        let mut warnings = experiment.warnings();
        let (engine, refusal) = experiment.solver.engine.able(experiment);
        if let Some(why) = refusal {
            let chosen = experiment.solver.engine;
            warnings.push(Code::EngineFallback.warning(format!(
                "{} simulates in place of {chosen:?}: {why}",
                engine.name()
            )));
        }
        let mut world = engine.build(&Setup {
            experiment,
            assembly,
            world_from_parts: &poses,
            joints: &joints,
            motion,
        })?;
        let mut driven_paths = Vec::new();
        for (index, body) in experiment.scene.iter().enumerate() {
            if let SceneMotion::Driven { track } = &body.motion {
                let track = track.as_deref();
                let mut driven_path = DrivenPath::new(track, experiment.recording_length_scale);
                world.place_driven(index, &driven_path.pose(0.0));
                driven_paths.push((index, driven_path));
            }
        }
        Ok(Self {
            experiment,
            assembly,
            world,
            part_from_track: part_from_track(assembly),
            driven_paths,
            records_joints: experiment.records_joints,
            angles_rad,
            squared_error_rad2: 0.0,
            commands: assembly
                .hinges
                .iter()
                .map(|hinge| CommandSource::new(experiment, hinge))
                .collect(),
            steering: vec![Steer::Own; assembly.hinges.len()],
            meter: experiment
                .energy_from_s
                .map(|from_s| EnergyMeter::new(experiment, assembly, from_s)),
            efforts: vec![None; assembly.hinges.len()],
            duties: vec![0.0; assembly.hinges.len()],
            drives: vec![None; assembly.hinges.len()],
            instruments: Instruments::new(experiment, assembly)?,
            timestep_s: experiment.solver.timestep_s,
            changes: (0..assembly.hinges.len())
                .map(|hinge| total_change(experiment, assembly, hinge))
                .collect(),
            steps: 0,
            settle_steps: 0,
            warnings,
        })
    }

    /// Applies the command of every servo for the time from `from_s` to `end_s` (delayed by the servo's latency), moves every
    /// driven body to its pose at `end_s`, and advances the world by one step.
    fn step(&mut self, from_s: f64, end_s: f64) {
        // The command at the middle of the step is used for the whole step.
        let t_s = 0.5 * (from_s + end_s);
        for (index, driven_path) in &mut self.driven_paths {
            self.world.lead_driven(*index, &driven_path.pose(end_s));
        }
        if let Some(base) = &self.experiment.base {
            let world_from_robot = base.world_from_robot(self.experiment, end_s);
            self.world
                .lead_base(&(world_from_robot * robot_from_part_at_zero(self.assembly, 0)));
        }
        for (index, hinge) in self.assembly.hinges.iter().enumerate() {
            let angle_rad = self.world.hinge_angle_rad(index, self.angles_rad[index]);
            self.angles_rad[index] = angle_rad;
            let Some(Actuator { servo, .. }) = &hinge.actuator else {
                continue;
            };
            let commands = &self.commands[index];
            let change = &self.changes[index];
            let quantity = commands.quantity();
            let steer = self.steering[index];
            let asked = |at_s: f64| match steer {
                Steer::Own => commands.value(at_s),
                Steer::Gait(gait) => gait.angle_rad(at_s),
                Steer::Hold(value) => value,
            };
            let mut target = match steer {
                Steer::Own => commands.over(from_s, end_s, change.latency_s),
                _ => asked((t_s - change.latency_s).max(0.0)),
            };
            if quantity == Quantity::Position {
                // The servo turns until its encoder reads the commanded angle.
                let lead_rad = change.offset_rad - change.zero_rad;
                self.squared_error_rad2 += (asked(t_s) + lead_rad - angle_rad).powi(2);
                target += lead_rad;
            }
            let is_on = commands.is_on(t_s);
            let Some(motor) = servo.law.motor() else {
                let command = if is_on {
                    command(servo, change.backlash_rad, quantity, target, angle_rad)
                } else {
                    NOTHING
                };
                self.drives[index] = Some(command);
                self.world.drive(index, angle_rad, command);
                continue;
            };
            // Within the backlash, and when it is switched off, the motor exerts no torque.
            let asked = match quantity {
                Quantity::Position => {
                    let error_rad = error_beyond_play(change.backlash_rad, target, angle_rad);
                    error_rad.map(|error_rad| position_duty(motor, error_rad))
                }
                Quantity::Duty => Some(target),
                Quantity::Velocity | Quantity::Torque | Quantity::Current => None,
            };
            let asked = asked.filter(|_| is_on);
            let duty = asked.map(|asked| duty(motor, asked, self.duties[index], self.timestep_s));
            self.duties[index] = duty.unwrap_or(0.0);
            let speed_rad_s = self.world.hinge_speed_rad_s(index);
            let supply = match (quantity, duty) {
                (Quantity::Torque, _) if is_on => Supply::Torque(target),
                (Quantity::Current, _) if is_on => {
                    Supply::Torque(motor.torque_constant_nm_a * target)
                }
                (_, Some(duty)) => Supply::Duty(duty),
                (_, None) => Supply::Off,
            };
            let effort = effort(motor, supply, servo.max_torque_nm, speed_rad_s);
            self.efforts[index] = Some(effort);
            self.world.exert(index, &effort);
        }
        self.instruments.before_step(self.world.as_ref());
        self.world.step();
        let drives = (self.drives.as_slice(), self.efforts.as_slice());
        let timestep_s = self.timestep_s;
        self.instruments
            .read(self.world.as_ref(), drives, timestep_s);
    }

    /// The present angle of a hinge, as its encoder reads it.
    fn angle_rad(&self, index: usize) -> f64 {
        self.world.hinge_angle_rad(index, self.angles_rad[index]) + self.changes[index].zero_rad
    }

    /// State of the tracked module, and of the joints if they are recorded.
    fn sample(&self) -> (State, Vec<JointState>) {
        let joints = if self.records_joints {
            self.angles_rad.len()
        } else {
            0
        };
        let joint = |index: usize| JointState {
            angle_rad: self.angle_rad(index),
            speed_rad_s: self.world.hinge_speed_rad_s(index),
        };
        (self.track(), (0..joints).map(joint).collect())
    }

    pub(super) fn track(&self) -> State {
        let (pose, velocity_world_m_s, angular_world_rad_s) =
            self.world.part(self.assembly.track_part);
        let world_from_track = pose * self.part_from_track;
        let offset_world_m = pose.rotation * self.part_from_track.translation.vector;
        State {
            position_world_m: world_from_track.translation.vector,
            orientation_world_from_body: world_from_track.rotation,
            velocity_world_m_s: velocity_world_m_s + angular_world_rad_s.cross(&offset_world_m),
            angular_velocity_body_rad_s: world_from_track.rotation.inverse() * angular_world_rad_s,
        }
    }

    /// The reason why the present state counts as diverged; `None` if it is plausible.
    fn divergence_reason(&self, origin_world_m: &Vector3<f64>) -> Option<String> {
        let name = |part: usize| {
            let solid = self.assembly.parts[part].solids.first();
            let body = solid.and_then(|solid| self.assembly.module_names.get(solid.module));
            body.map_or_else(
                || format!("part {part}"),
                |body| format!("part {part} (`{body}`)"),
            )
        };
        for part in 0..self.assembly.parts.len() {
            let (pose, linear, angular) = self.world.part(part);
            let distance_m = (pose.translation.vector - origin_world_m).norm();
            // NaN counts as beyond every limit.
            let beyond = |value: f64, limit: f64| value.is_nan() || value > limit;
            if beyond(distance_m, FARTHEST_M) {
                return Some(format!(
                    "{} is {distance_m:.3e} m from the start",
                    name(part)
                ));
            }
            if beyond(linear.norm(), FASTEST_M_S) {
                return Some(format!("{} moves at {:.3e} m/s", name(part), linear.norm()));
            }
            if beyond(angular.norm(), FASTEST_RAD_S) {
                return Some(format!(
                    "{} turns at {:.3e} rad/s",
                    name(part),
                    angular.norm()
                ));
            }
            if !pose.rotation.coords.iter().all(|v| v.is_finite()) {
                return Some(format!("{} has no orientation any more", name(part)));
            }
        }
        None
    }

    pub(super) fn poses(&self) -> Vec<Isometry3<f64>> {
        (0..self.assembly.parts.len())
            .map(|part| self.world.part(part).0)
            .collect()
    }

    /// Holds the servos at their first command until the robot is at rest; returns the reason if the state diverges.
    fn settle(&mut self, timestep_s: f64, origin_world_m: &Vector3<f64>) -> Option<String> {
        let limit = (SETTLE_LIMIT_S / timestep_s).ceil() as u64;
        let window = (REST_WINDOW_S / timestep_s).ceil() as u64;
        let mut before = self.poses();
        for taken in 1..=limit {
            self.step(0.0, 0.0);
            self.settle_steps = taken;
            if let Some(why) = self.divergence_reason(origin_world_m) {
                return Some(why);
            }
            if taken % window == 0 {
                let now = self.poses();
                let at_rest = before.iter().zip(&now).all(|(a, b)| {
                    (b.translation.vector - a.translation.vector).norm() < REST_M
                        && a.rotation.angle_to(&b.rotation) < REST_RAD
                });
                if at_rest {
                    return None;
                }
                before = now;
            }
        }
        self.warnings.push(Code::NotSettled.warning(format!(
            "the robot was still moving after {SETTLE_LIMIT_S} s of settling; the run starts from there"
        )));
        None
    }
}
