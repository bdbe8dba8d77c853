//! Checks of servos: torque and speed limits, droop under load, and tracking of a sine.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{
    ARM_M, BASE_HALF_M, MASS_KG, RUNAWAY, STILL, arm, arm_inertia_kg_m2, velocity_servo,
};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, largest, measure};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Gait, Servo, ServoLaw};
use realgap_simulation::{JointFormulation, Snapshot};

/// Gain of the shipped robots' servos, 1/s.
const GAIN_PER_S: f64 = 30.0;
/// Tolerance: limits and tracking of servos are specified and measured to 1 %.
const SHARE: f64 = 0.01;
/// Half a degree: the dead band of a good hobby servo.
const DROOP_RAD: f64 = 0.0087;
/// Torque of gravity on the horizontal arm, N m.
const LOAD_NM: f64 = MASS_KG * GRAVITY_M_S2 * ARM_M;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for &kind in settings.kinds() {
        let bench = Bench { settings, kind };
        checks.push(bench.torque_limit()?);
        checks.push(bench.holding_torque()?);
        checks.push(bench.speed_limit()?);
        checks.extend(bench.droop()?);
        checks.extend(bench.sine()?);
        checks.push(bench.resonance()?);
    }
    Ok(checks)
}

/// An arm on a heavy base, with or without gravity.
struct Bench<'a> {
    settings: &'a Settings,
    kind: JointFormulation,
}

impl Bench<'_> {
    fn record(
        &self,
        servo: Servo,
        gait: Gait,
        gravity: bool,
        seconds: f64,
    ) -> Result<Option<SimulationLog>> {
        let robot = arm(MASS_KG, Vector3::y(), servo, gait);
        let mut experiment = self.settings.experiment(robot, seconds);
        experiment.solver.joint = self.kind;
        experiment.floor.friction = 1.0;
        experiment.start = at_rest(
            Vector3::new(0.0, 0.0, BASE_HALF_M),
            UnitQuaternion::identity(),
        );
        if !gravity {
            experiment.gravity_m_s2 = 0.0;
            experiment.floor.height_m = -1.0;
        }
        SimulationLog::record(&experiment, &[])
    }

    fn name(&self, check: &str) -> String {
        format!("servo.{check}.{}", self.settings.joint_name(self.kind))
    }

    fn torque_limit(&self) -> Result<Check> {
        let torque_nm = 1e-3;
        let servo = velocity_servo(GAIN_PER_S, torque_nm, f64::INFINITY);
        let film = self.record(servo, RUNAWAY, false, 0.2)?;
        let measured = measure(film.as_ref(), |film| {
            let (from, to) = (film.at(0.05), film.last());
            let change = rate_rad_s(to) - rate_rad_s(from);
            Some(arm_inertia_kg_m2(MASS_KG) * change / (to.time_s - from.time_s))
        });
        Ok(Check::new(
            self.name("torque_limit"),
            "torque of a servo that cannot keep up, from the acceleration of its load: its limit",
            torque_nm,
            measured,
            Unit::NewtonMetre,
            Tolerance::Relative(SHARE),
        ))
    }

    /// The smallest limit that holds the horizontal arm for a second, by bisection.
    fn holding_torque(&self) -> Result<Check> {
        let (mut low, mut high) = (0.9 * LOAD_NM, 1.1 * LOAD_NM);
        for _ in 0..7 {
            let limit_nm = 0.5 * (low + high);
            let servo = velocity_servo(GAIN_PER_S, limit_nm, 8.0);
            let film = self.record(servo, STILL, true, 1.0)?;
            let sagged = measure(film.as_ref(), |film| {
                // A servo that gives way lets the arm swing, and it may be back by the end.
                Some(largest(film.iter().map(|s| s.hinges[0].angle_rad.abs())))
            });
            if sagged < 0.1 {
                high = limit_nm;
            } else {
                low = limit_nm;
            }
        }
        Ok(Check::new(
            self.name("holding_torque"),
            "smallest torque limit that holds a horizontal module against gravity: m g r",
            LOAD_NM,
            0.5 * (low + high),
            Unit::NewtonMetre,
            Tolerance::Relative(SHARE),
        ))
    }

    fn speed_limit(&self) -> Result<Check> {
        let film = self.record(velocity_servo(GAIN_PER_S, 0.2, 8.0), RUNAWAY, false, 0.3)?;
        Ok(Check::new(
            self.name("speed_limit"),
            "speed of a servo whose command runs away from it: its limit",
            8.0,
            measure(film.as_ref(), |film| Some(rate_rad_s(film.last()))),
            Unit::RadianPerSecond,
            Tolerance::Relative(SHARE),
        ))
    }

    /// Angle by which a servo gives way under the weight of a horizontal arm.
    fn droop(&self) -> Result<[Check; 2]> {
        let sag = |servo: Servo| -> Result<f64> {
            let film = self.record(servo, STILL, true, 2.0)?;
            Ok(measure(film.as_ref(), |film| {
                Some(film.last().hinges[0].angle_rad)
            }))
        };
        // Damping of a velocity servo: its torque on 1/40 of its top speed.
        let stiffness_nm_rad = GAIN_PER_S * 40.0 * 0.2 / 8.0;
        let soft_nm_rad = 1.0;
        let spring = Servo {
            law: ServoLaw::Torque {
                stiffness_nm_rad: soft_nm_rad,
                damping_nm_s_rad: 0.02,
            },
            max_torque_nm: 0.2,
            max_speed_rad_s: f64::INFINITY,
            delay_s: 0.0,
            torque_constant_nm_a: None,
        };
        // m g r cos θ = k θ, one Newton step from the small-angle answer is exact to 1e-6.
        let soft_rad = LOAD_NM * (LOAD_NM / soft_nm_rad).cos() / soft_nm_rad;
        Ok([
            Check::new(
                self.name("droop"),
                "angle by which a velocity servo (gain 30/s, 0.2 N m, 8 rad/s) gives way to m g r: m g r / (gain damping)",
                LOAD_NM / stiffness_nm_rad,
                sag(velocity_servo(GAIN_PER_S, 0.2, 8.0))?,
                Unit::Radian,
                Tolerance::Absolute(DROOP_RAD),
            ),
            Check::new(
                self.name("spring"),
                "angle by which a torque servo of 1 N m/rad gives way to m g r: m g r cos / stiffness",
                soft_rad,
                sag(spring)?,
                Unit::Radian,
                Tolerance::Absolute(DROOP_RAD),
            ),
        ])
    }

    /// A velocity servo is a first-order lag: the amplitude is 1 / (1 + (w/k)²)^½ of the command's, and the error is (w/k) of
    /// that amplitude.
    fn sine(&self) -> Result<[Check; 2]> {
        let gait = Gait {
            amplitude_rad: 0.9,
            frequency_hz: 1.25,
            ..STILL
        };
        let ratio = TAU * gait.frequency_hz / GAIN_PER_S;
        let amplitude_rad = gait.amplitude_rad / (1.0 + ratio * ratio).sqrt();
        let film = self.record(velocity_servo(GAIN_PER_S, 5.0, 100.0), gait, false, 4.0)?;
        let measured = measure(film.as_ref(), |film| {
            Some(largest(
                film.since(1.0).map(|s| s.hinges[0].angle_rad.abs()),
            ))
        });
        let lag = measure(film.as_ref(), |film| {
            let squares: Vec<f64> = film
                .since(0.8)
                .map(|s| (gait.angle_rad(s.time_s) - s.hinges[0].angle_rad).powi(2))
                .collect();
            Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        });
        Ok([
            Check::new(
                self.name("sine.amplitude"),
                "amplitude with which a servo of gain 30/s follows 0.9 sin(2 pi 1.25 t): 0.9 / (1 + (w/k)^2)^(1/2)",
                amplitude_rad,
                measured,
                Unit::Radian,
                Tolerance::Relative(SHARE),
            ),
            Check::new(
                self.name("sine.lag"),
                "root mean square of command minus angle during the same motion: amplitude (w/k) / 2^(1/2)",
                amplitude_rad * ratio / SQRT_2,
                lag,
                Unit::Radian,
                Tolerance::Relative(2.0 * SHARE),
            ),
        ])
    }

    /// A soft torque servo near its resonance, where stiffness, damping and inertia all affect the amplitude.
    fn resonance(&self) -> Result<Check> {
        let (k, d, i) = (0.05, 1e-3, arm_inertia_kg_m2(MASS_KG));
        let servo = Servo {
            law: ServoLaw::Torque {
                stiffness_nm_rad: k,
                damping_nm_s_rad: d,
            },
            max_torque_nm: 1.0,
            max_speed_rad_s: f64::INFINITY,
            delay_s: 0.0,
            torque_constant_nm_a: None,
        };
        let gait = Gait {
            amplitude_rad: 0.3,
            frequency_hz: 2.0,
            ..STILL
        };
        let w = TAU * gait.frequency_hz;
        let film = self.record(servo, gait, false, 4.0)?;
        Ok(Check::new(
            self.name("resonance"),
            "amplitude of a soft torque servo (0.05 N m/rad) at 2 Hz near resonance: 0.3 k / ((k - I w^2)^2 + (d w)^2)^(1/2)",
            gait.amplitude_rad * k / (k - i * w * w).hypot(d * w),
            measure(film.as_ref(), |film| {
                Some(largest(
                    film.since(3.0).map(|s| s.hinges[0].angle_rad.abs()),
                ))
            }),
            Unit::Radian,
            Tolerance::Relative(2.0 * SHARE),
        ))
    }
}

/// Rate of the hinge, rad/s.
fn rate_rad_s(snapshot: &Snapshot) -> f64 {
    let parts = &snapshot.parts;
    (parts[1].angular_velocity_world_rad_s - parts[0].angular_velocity_world_rad_s).y
}
