//! Sensors that a run records beside pose and joints: torques and currents of motors, gyroscopes and accelerometers.
//!
//! A reading holds for the step that ends at its time: torques and accelerations are means over the step, so that a sample
//! between two steps has the mean of the step around it.

use nalgebra::{Isometry3, Vector3};

use super::control::carrier;
use super::engine::World;
use super::experiment::Experiment;
use super::kinematics::robot_from_part_at_zero;
use super::motor::Effort;
use super::servo::Command;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::MeasuredQuantity;
use realgap_robot::morphology::Assembly;

/// What an instrument measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// Torque of the motor of this hinge, N m: what the motor's current shows, before the friction of gear and bearing, and
    /// including what accelerates the rotor (armature). Positive along the axis, on the child.
    Torque(usize),
    /// Current of the motor of this hinge, A: its torque over its torque constant.
    Current(usize),
    /// Angular velocity of what carries the sensor, about the carrier's own axis of this index, rad/s.
    TurnRate(usize),
    /// Acceleration of the carrier's origin minus gravity, along the carrier's own axis of this index, m/s².
    SpecificForce(usize),
}

/// A recorded sensor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instrument {
    /// Name of its column.
    pub column: String,
    /// What it measures.
    pub measured: Measured,
    /// The body or mark that carries it; empty for motors.
    pub carrier: String,
}

impl Instrument {
    /// The instrument that a measured column stands for: its name begins with a joint, a body or a mark of the robot.
    ///
    /// # Errors
    /// A column that names no measured quantity, nothing that the robot has, or a joint whose motor cannot have this quantity.
    pub fn of_column(column: &str, assembly: &Assembly) -> Result<Self> {
        let Some((owner, quantity)) = MeasuredQuantity::of_column(column) else {
            return Err(Error::invalid("not a column of a sensor")
                .found(column)
                .allowed("NAME_torque_nm, NAME_current_a of a joint; NAME_gyro_x_rad_s, NAME_accel_x_m_s2 of a body or mark"));
        };
        let measured = match quantity {
            MeasuredQuantity::TurnRate(axis) => Measured::TurnRate(axis),
            MeasuredQuantity::SpecificForce(axis) => Measured::SpecificForce(axis),
            MeasuredQuantity::Torque | MeasuredQuantity::Current => {
                return Self::of_motor(column, owner, quantity, assembly);
            }
        };
        carrier(assembly, owner).map_err(|error| error.field(column))?;
        Ok(Self {
            column: column.to_owned(),
            measured,
            carrier: owner.to_owned(),
        })
    }

    fn of_motor(
        column: &str,
        joint: &str,
        quantity: MeasuredQuantity,
        assembly: &Assembly,
    ) -> Result<Self> {
        let hinges = assembly.hinges.iter();
        let driven = hinges.enumerate().filter(|(_, h)| h.actuator.is_some());
        let named: Vec<&str> = driven.clone().map(|(_, h)| h.name.as_str()).collect();
        let mut found = driven.filter(|(_, hinge)| hinge.name == joint);
        let Some((hinge, own)) = found.next() else {
            return Err(
                Error::invalid("a measured torque or current belongs to no joint with a motor")
                    .field(column)
                    .found(joint)
                    .allowed(named.join(", "))
                    .hint("give the joint an actuator in the robot's file, or rename the column: `reading: (names: {...})`"),
            );
        };
        let constant = own.actuator.and_then(|a| a.servo.torque_per_current_nm_a());
        if quantity == MeasuredQuantity::Current && constant.is_none() {
            return Err(Error::invalid("a current needs the torque constant of its motor")
                .field(column)
                .found(format!("the servo of `{joint}` states none"))
                .hint("add `torque_constant_nm_a: ...` (N m per A at the joint) to `servo` in the robot's file"));
        }
        Ok(Self {
            column: column.to_owned(),
            measured: match quantity {
                MeasuredQuantity::Current => Measured::Current(hinge),
                _ => Measured::Torque(hinge),
            },
            carrier: String::new(),
        })
    }
}

/// A sensor of a body during a run.
#[derive(Debug, Clone, Copy)]
struct BodySensor {
    part: usize,
    part_from_sensor: Isometry3<f64>,
    /// Velocity of the sensor before the step, world frame, m/s.
    velocity_world_m_s: Vector3<f64>,
}

/// The instruments of a run and their last readings.
pub(super) struct Instruments {
    all: Vec<(Instrument, Option<BodySensor>)>,
    /// Torque constant of each hinge's motor, N m/A.
    constants_nm_a: Vec<f64>,
    gravity_world_m_s2: Vector3<f64>,
    readings: Vec<f64>,
    /// State of each hinge before the step, for engines that do not compute torques: angle and speed.
    before: Vec<(f64, f64)>,
}

impl Instruments {
    /// Those of an experiment whose robot is this one.
    ///
    /// # Errors
    /// An instrument on a body that the robot does not have.
    pub fn new(experiment: &Experiment, assembly: &Assembly) -> Result<Self> {
        let place = |instrument: &Instrument| -> Result<Option<BodySensor>> {
            match instrument.measured {
                Measured::Torque(_) | Measured::Current(_) => Ok(None),
                Measured::TurnRate(_) | Measured::SpecificForce(_) => {
                    let (part, robot_from_sensor) = carrier(assembly, &instrument.carrier)?;
                    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
                    Ok(Some(BodySensor {
                        part,
                        part_from_sensor: part_from_robot * robot_from_sensor,
                        velocity_world_m_s: Vector3::zeros(),
                    }))
                }
            }
        };
        let all = experiment.instruments.iter();
        let all = all.map(|instrument| Ok((instrument.clone(), place(instrument)?)));
        let all: Vec<_> = all.collect::<Result<_>>()?;
        let constant = |hinge: &realgap_robot::morphology::Hinge| {
            let servo = hinge.actuator.map(|actuator| actuator.servo);
            servo.and_then(|servo| servo.torque_per_current_nm_a())
        };
        let constants = assembly.hinges.iter().map(constant);
        Ok(Self {
            readings: vec![f64::NAN; all.len()],
            before: vec![(0.0, 0.0); assembly.hinges.len()],
            constants_nm_a: constants.map(|c| c.unwrap_or(f64::NAN)).collect(),
            gravity_world_m_s2: Vector3::new(0.0, 0.0, -experiment.gravity_m_s2),
            all,
        })
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        let all = self.all.iter();
        all.map(|(instrument, _)| instrument.column.clone())
            .collect()
    }

    /// The last readings, in the order of the columns; NaN before the first step.
    pub fn readings(&self) -> &[f64] {
        &self.readings
    }

    /// Keeps what a step is compared with.
    pub fn before_step(&mut self, world: &dyn World) {
        for (instrument, sensor) in &mut self.all {
            match instrument.measured {
                Measured::Torque(hinge) | Measured::Current(hinge) => {
                    let angle = world.hinge_angle_rad(hinge, self.before[hinge].0);
                    self.before[hinge] = (angle, world.hinge_speed_rad_s(hinge));
                }
                Measured::TurnRate(_) | Measured::SpecificForce(_) => {
                    if let Some(sensor) = sensor {
                        sensor.velocity_world_m_s = sensor.motion(world).1;
                    }
                }
            }
        }
    }

    /// Reads all instruments after a step in which servos had these commands and motors behind gears these efforts, by hinge.
    pub fn read(
        &mut self,
        world: &dyn World,
        drives: (&[Option<Command>], &[Option<Effort>]),
        timestep_s: f64,
    ) {
        for index in 0..self.all.len() {
            let (instrument, sensor) = &self.all[index];
            self.readings[index] = match (instrument.measured, sensor) {
                (Measured::Torque(hinge), _) => self.torque_nm(world, hinge, drives),
                (Measured::Current(hinge), _) => {
                    self.torque_nm(world, hinge, drives) / self.constants_nm_a[hinge]
                }
                (Measured::TurnRate(axis), Some(sensor)) => {
                    let (pose, _, angular_world) = sensor.motion(world);
                    (pose.rotation.inverse() * angular_world)[axis]
                }
                (Measured::SpecificForce(axis), Some(sensor)) => {
                    let (pose, now_world_m_s, _) = sensor.motion(world);
                    let change = (now_world_m_s - sensor.velocity_world_m_s) / timestep_s;
                    (pose.rotation.inverse() * (change - self.gravity_world_m_s2))[axis]
                }
                (Measured::TurnRate(_) | Measured::SpecificForce(_), None) => f64::NAN,
            };
        }
    }

    /// Mean torque of a motor during the last step, N m.
    fn torque_nm(
        &self,
        world: &dyn World,
        hinge: usize,
        (commands, efforts): (&[Option<Command>], &[Option<Effort>]),
    ) -> f64 {
        // Half of the difference of the gear's friction budgets is exerted together with the motor's torque (see motor.rs).
        let of_gear_nm = efforts[hinge].map_or(0.0, |e| 0.5 * (e.backwards_nm - e.forwards_nm));
        if let Some(exerted_nm) = world.motor_torque_nm(hinge) {
            return exerted_nm - of_gear_nm;
        }
        let (angle_before, speed_before) = self.before[hinge];
        let angle = world.hinge_angle_rad(hinge, angle_before);
        let speed = 0.5 * (speed_before + world.hinge_speed_rad_s(hinge));
        match (efforts[hinge], commands[hinge]) {
            (Some(effort), _) => effort.damping_nm_s_rad * (effort.target_rad_s - speed),
            (None, Some(command)) => command.torque_nm(0.5 * (angle - angle_before), speed),
            (None, None) => 0.0,
        }
    }
}

impl BodySensor {
    /// Pose, velocity and angular velocity of the sensor, world frame.
    fn motion(&self, world: &dyn World) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
        let (world_from_part, linear, angular) = world.part(self.part);
        let arm_m = world_from_part.rotation * self.part_from_sensor.translation.vector;
        (
            world_from_part * self.part_from_sensor,
            linear + angular.cross(&arm_m),
            angular,
        )
    }
}
