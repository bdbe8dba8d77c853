//! Finds which known limits of Rapier affect the results of an experiment.

use std::f64::consts::TAU;

use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{Part, Servo, ServoLaw};
use realgap_simulation::{EngineChoice, Experiment, JointFormulation};

/// Sag below which the tilt of a plate is not visible, metres (the tolerance of the check `standing.sag`).
const SAG_M: f64 = 2e-5;

/// Warnings about known limits of the engine that affect the results of this experiment; `tuned` names the parameters that are
/// fitted.
pub fn known_limits(experiment: &Experiment, tuned: &[&str]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    if experiment.solver.engine != EngineChoice::default() {
        return warnings;
    }
    let mut warn = |message: String| warnings.push(Code::KnownLimit.warning(message));
    if tuned.contains(&"floor.restitution") {
        warn("bounces of a flat face come out 7 to 9 % low, so a fitted restitution is that much too high where faces land flat (restitution.flat)".to_owned());
    }
    let hinges = &experiment.assembly.hinges;
    match experiment.joint_kind() {
        _ if hinges.is_empty() => {}
        JointFormulation::Impulse => {
            let sag_m = impulse_sag_m(experiment);
            if sag_m > SAG_M {
                warn(format!(
                    "impulse joints: where the lightest part carries the whole robot, that part sinks into the floor by up to {:.0} micrometres, and by more while the robot moves; with solver.joint = 1 (multibody) it does not sink, but the simulation is slower with {} hinges (standing.sag)",
                    1e6 * sag_m,
                    hinges.len()
                ));
            }
        }
        JointFormulation::Multibody | JointFormulation::Auto => {
            if hinges
                .iter()
                .filter_map(|hinge| hinge.actuator.as_ref())
                .any(|actuator| is_free(&actuator.servo))
            {
                warn("a hinge without torque: free swings of multibody joints gain energy in proportion to the timestep (energy.pendulum); solver.joint = 0 (impulse) conserves the energy".to_owned());
            }
        }
    }
    warnings
}

fn is_free(servo: &Servo) -> bool {
    let answer = match servo.law {
        ServoLaw::Velocity { gain_per_s } => gain_per_s,
        ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        } => stiffness_nm_rad.max(damping_nm_s_rad),
        ServoLaw::Motor(motor) => motor.damping_nm_s_rad(),
        ServoLaw::Direct | ServoLaw::Throttle => 0.0,
    };
    servo.max_torque_nm == 0.0 || answer == 0.0
}

/// Sag of the lightest part under the whole robot with impulse joints: (M/m) (K m/4) g/ω² with the inverse effective mass K
/// at a corner, K m = 7 for a thin square plate, the worst case.
fn impulse_sag_m(experiment: &Experiment) -> f64 {
    let masses = experiment.assembly.parts.iter().map(Part::mass_kg);
    let whole_kg: f64 = masses.clone().sum();
    let least_kg = masses.fold(f64::INFINITY, f64::min);
    let omega = TAU * experiment.contact.natural_frequency_hz;
    whole_kg / least_kg * 7.0 / 4.0 * experiment.gravity_m_s2 / (omega * omega)
}
