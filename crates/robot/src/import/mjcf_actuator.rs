//! Conversion of MJCF actuators into servos.

use mjcf_rs::extras::{Actuator, ActuatorKind};

use super::mjcf::Robot;
use super::note::Notes;
use crate::morphology::body::{Driver, JointKind};
use crate::morphology::{Servo, ServoLaw};

/// Torque limit of a motor for which the file states none, N m.
const MOST: f64 = 1e4;

impl Robot<'_> {
    pub(super) fn actuators(&mut self, notes: &mut Notes) {
        let mut motors = 0;
        for actuator in &self.model.actuators {
            let name = actuator
                .name
                .clone()
                .unwrap_or_else(|| "without a name".to_owned());
            let joint = actuator
                .joint
                .as_ref()
                .and_then(|joint| self.joint_names.get(joint));
            let Some(joint) = joint.cloned() else {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`, which drives no joint"),
                    "actuators of tendons, sites and bodies are not supported: let an actuator drive a joint",
                );
                continue;
            };
            if self
                .structure
                .actuators
                .iter()
                .any(|driver| driver.joint == joint)
            {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`: joint `{joint}` already has an actuator"),
                    "combine the two actuators into one",
                );
                continue;
            }
            match law(actuator) {
                Some((law, max_torque_nm, viscous)) => {
                    motors += usize::from(law == ServoLaw::Direct);
                    self.add_viscous(&joint, viscous);
                    let servo = Servo {
                        law,
                        max_torque_nm,
                        max_speed_rad_s: f64::INFINITY,
                        delay_s: 0.0,
                        torque_constant_nm_a: None,
                    };
                    self.structure.actuators.push(Driver {
                        joint,
                        servo,
                        gait: None,
                        follows: None,
                    });
                }
                None => notes.left_out(
                    None,
                    format!(
                        "the actuator `{name}`: only motors, position servos and velocity servos are supported"
                    ),
                    "state its servo in `actuators`",
                ),
            }
        }
        if motors > 0 {
            notes.assumed(None, format!("{motors} motors take torques as commands, but no command is stated: they exert no torque"), "state a gait in `actuators`; its offset and amplitude are then torques");
        }
    }

    /// Adds the damping of an actuator to its joint.
    fn add_viscous(&mut self, joint: &str, more: f64) {
        let mut joints = self.structure.joints.iter_mut();
        let joint = joints.find(|known| known.name == joint);
        if let Some(
            JointKind::Turn {
                viscous_nm_s_rad: viscous,
                ..
            }
            | JointKind::Slide {
                viscous_n_s_m: viscous,
                ..
            },
        ) = joint.map(|joint| &mut joint.kind)
        {
            *viscous += more;
        }
    }
}

/// Control law, torque limit and damping of an actuator; `None` for an actuator of an unsupported kind.
fn law(actuator: &Actuator) -> Option<(ServoLaw, f64, f64)> {
    let gear = actuator.gear[0].abs();
    let gear = if gear == 0.0 { 1.0 } else { gear };
    let at_most = |range: Option<[f64; 2]>| {
        range
            .map(|[low, high]| low.abs().max(high.abs()))
            .filter(|most| *most > 0.0)
    };
    let force = at_most(actuator.force_range).map(|most| most * gear);
    let bounded = |most: Option<f64>| most.map_or(MOST, |most| most.clamp(1e-9, MOST));
    let direct = |factor: f64, viscous: f64| {
        let command = at_most(actuator.ctrl_range).map(|most| most * gear * factor);
        let most = match (command, force) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        Some((ServoLaw::Direct, bounded(most), viscous))
    };
    let position = |kp: f64, kv: f64| {
        let law = ServoLaw::Torque {
            stiffness_nm_rad: (kp * gear * gear).clamp(1e-9, 1e6),
            damping_nm_s_rad: (kv * gear * gear).clamp(0.0, 1e6),
        };
        Some((law, bounded(force), 0.0))
    };
    match actuator.kind {
        ActuatorKind::Motor => direct(1.0, 0.0),
        ActuatorKind::Position => position(actuator.kp.unwrap_or(1.0), actuator.kv.unwrap_or(0.0)),
        ActuatorKind::Velocity => {
            let kv = actuator.kv.unwrap_or(1.0);
            direct(kv, kv * gear * gear)
        }
        ActuatorKind::Damper => None,
        ActuatorKind::General => {
            let gain = actuator.gainprm.first().copied().unwrap_or(1.0);
            let bias = |k: usize| actuator.biasprm.get(k).copied().unwrap_or(0.0);
            let is_fixed = actuator
                .gain_type
                .as_deref()
                .is_none_or(|kind| kind == "fixed");
            let is_affine = actuator.bias_type.as_deref() == Some("affine");
            match (is_fixed, is_affine) {
                (true, true) if bias(1) < 0.0 => position(-bias(1), -bias(2)),
                (true, true) => direct(gain.abs(), -bias(2) * gear * gear),
                (true, false) => direct(gain.abs(), 0.0),
                (false, _) => None,
            }
        }
        ActuatorKind::IntVelocity | ActuatorKind::Other => None,
    }
}
