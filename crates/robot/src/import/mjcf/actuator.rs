//! Conversion of MJCF actuators, as MuJoCo compiles them, into servos.

use std::collections::BTreeMap;

use super::super::note::Notes;
use super::element::Element;
use super::robot::Robot;
use crate::morphology::body::{Driver, JointKind};
use crate::morphology::{CommandScale, Servo, ServoLaw};
use realgap_core::error::Result;

/// Torque limit of an actuator for which the file states none, N m.
const MOST: f64 = 1e4;
/// Largest stiffness and damping of a servo.
const STIFFEST: f64 = 1e6;

/// The numbers of an actuator: force = gain · command + bias₀ + bias₁ · length + bias₂ · speed, with the length `gear · coordinate`.
#[derive(Debug, Clone)]
pub(super) struct Actuator {
    pub name: String,
    pub joint: Option<String>,
    pub gear: f64,
    pub gain: [f64; 3],
    pub bias: [f64; 3],
    pub gain_kind: String,
    pub bias_kind: String,
    pub dynamics: String,
    pub time_s: f64,
    pub inherit: f64,
    pub command_range: Option<[f64; 2]>,
    pub force_range: Option<[f64; 2]>,
    pub damping: f64,
    pub armature: f64,
    pub delay_s: f64,
    /// Properties that have no counterpart here.
    pub unknown: Vec<String>,
}

impl Actuator {
    /// Compiles the actuators of the default classes and the actuator itself, each of which changes what those before it state.
    pub fn of(chain: &[Element], autolimits: bool) -> Result<Option<Self>> {
        let Some(last) = chain.last() else {
            return Ok(None);
        };
        let mut all = Self {
            name: last.get("name").unwrap_or("without a name").to_owned(),
            joint: None,
            gear: 1.0,
            gain: [1.0, 0.0, 0.0],
            bias: [0.0; 3],
            gain_kind: "fixed".to_owned(),
            bias_kind: "none".to_owned(),
            dynamics: "none".to_owned(),
            time_s: 1.0,
            inherit: 0.0,
            command_range: None,
            force_range: None,
            damping: 0.0,
            armature: 0.0,
            delay_s: 0.0,
            unknown: Vec::new(),
        };
        let mut limited = Element::default();
        for given in chain {
            for name in ["ctrllimited", "forcelimited"] {
                if let Some(value) = given.get(name) {
                    limited.attributes.insert(name.to_owned(), value.to_owned());
                }
            }
            all.command_range = given.numbers::<2>("ctrlrange")?.or(all.command_range);
            all.force_range = given.numbers::<2>("forcerange")?.or(all.force_range);
            all.gear = given.number("gear", all.gear)?;
            all.damping = given.number("damping", all.damping)?;
            all.armature = given.number("armature", all.armature)?;
            all.delay_s = given.number("delay", all.delay_s)?;
            let joint = given.get("joint").or(given.get("jointinparent"));
            all.joint = joint.map(str::to_owned).or(all.joint);
            all.apply(given)?;
        }
        all.command_range = (all.command_range)
            .filter(|range| limited.is_limited("ctrllimited", Some(*range), autolimits));
        all.force_range = (all.force_range)
            .filter(|range| limited.is_limited("forcelimited", Some(*range), autolimits));
        if last
            .list("damping")?
            .iter()
            .skip(1)
            .any(|more| *more != 0.0)
        {
            all.unknown
                .push("damping that grows with the speed (polynomial)".to_owned());
        }
        Ok(Some(all))
    }

    /// Applies the attributes that depend on the kind of actuator.
    fn apply(&mut self, given: &Element) -> Result<()> {
        let over = |to: &mut [f64; 3], list: Vec<f64>| {
            to.iter_mut().zip(&list).for_each(|(to, from)| *to = *from);
        };
        let set = |to: &mut String, value: &str| value.clone_into(to);
        match given.tag.as_str() {
            "general" => {
                for (name, to) in [
                    ("gaintype", &mut self.gain_kind),
                    ("biastype", &mut self.bias_kind),
                    ("dyntype", &mut self.dynamics),
                ] {
                    if let Some(kind) = given.get(name) {
                        set(to, kind);
                    }
                }
                over(&mut self.gain, given.list("gainprm")?);
                over(&mut self.bias, given.list("biasprm")?);
                self.time_s = given.number("dynprm", self.time_s)?;
                self.inherit = given.number("inheritrange", self.inherit)?;
            }
            "motor" => {
                self.gain[0] = 1.0;
                set(&mut self.dynamics, "none");
                set(&mut self.gain_kind, "fixed");
                set(&mut self.bias_kind, "none");
            }
            "position" | "intvelocity" | "pid" => {
                let kp = given.number("kp", self.gain[0])?;
                (self.gain[0], self.bias[1]) = (kp, -kp);
                if given.get("kv").is_some() {
                    self.bias[2] = -given.number("kv", 0.0)?;
                }
                // A positive number in this place is a ratio of damping until the inertia is known.
                self.bias[2] = given.number("dampratio", self.bias[2])?;
                if given.get("timeconst").is_some() {
                    self.time_s = given.number("timeconst", 0.0)?;
                    let kind = if self.time_s > 0.0 {
                        "filterexact"
                    } else {
                        "none"
                    };
                    set(&mut self.dynamics, kind);
                }
                self.inherit = given.number("inheritrange", self.inherit)?;
                set(&mut self.gain_kind, "fixed");
                set(&mut self.bias_kind, "affine");
                if given.tag == "intvelocity" {
                    set(&mut self.dynamics, "integrator");
                }
                if given.tag == "pid" {
                    set(&mut self.dynamics, "pid");
                }
            }
            "velocity" => {
                let kv = given.number("kv", self.gain[0])?;
                (self.gain[0], self.bias) = (kv, [0.0, 0.0, -kv]);
                set(&mut self.dynamics, "none");
                set(&mut self.gain_kind, "fixed");
                set(&mut self.bias_kind, "affine");
            }
            other => set(&mut self.gain_kind, other),
        }
        Ok(())
    }

    /// Why the actuator has no counterpart here; `None` if it has one.
    fn refusal(&self) -> Option<String> {
        if self.gain_kind != "fixed" {
            return Some(format!("its gain is of the kind `{}`", self.gain_kind));
        }
        if !["none", "affine"].contains(&self.bias_kind.as_str()) {
            return Some(format!("its bias is of the kind `{}`", self.bias_kind));
        }
        if !["none", "filter", "filterexact"].contains(&self.dynamics.as_str()) {
            return Some(format!("its activation is of the kind `{}`", self.dynamics));
        }
        if self.gear == 0.0 {
            return Some("its gear is 0".to_owned());
        }
        if self.bias_kind == "affine" && self.bias[1] > 0.0 {
            return Some("its force grows with the coordinate".to_owned());
        }
        None
    }
}

/// What an actuator does to its joint.
struct Effect {
    law: ServoLaw,
    /// Damping that no force limit bounds.
    viscous: f64,
    command: CommandScale,
    /// Lower and upper force at the joint.
    force: Option<[f64; 2]>,
}

impl Robot<'_> {
    /// Adds the actuators to the robot.
    pub(super) fn actuators(&mut self, notes: &mut Notes) -> Result<()> {
        let (mut motors, mut unlimited) = (0, 0);
        let mut scaled: Vec<String> = Vec::new();
        let mut lagging: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for actuator in self.drives.clone() {
            let name = &actuator.name;
            let known = actuator
                .joint
                .as_ref()
                .and_then(|joint| self.joint_names.get(joint));
            let Some((joint, place)) = known.cloned() else {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`, which drives no joint with one degree of freedom"),
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
            if let Some(why) = actuator.refusal() {
                notes.left_out(
                    None,
                    format!("the actuator `{name}`: {why}"),
                    "state its servo in `actuators`",
                );
                continue;
            }
            for unknown in &actuator.unknown {
                notes.left_out(
                    None,
                    format!("of the actuator `{name}`: {unknown}"),
                    "measure what it changes",
                );
            }
            if actuator.dynamics != "none" {
                let what = format!("{} of {} s", actuator.dynamics, actuator.time_s);
                lagging.entry(what).or_default().push(joint.clone());
            }
            let mut effect = self.effect(&actuator, &joint, place, notes);
            if actuator.dynamics != "none" {
                effect.command.lag_s = actuator.time_s.clamp(0.0, CommandScale::LONGEST_LAG_S);
            }
            motors += usize::from(effect.law == ServoLaw::Direct);
            unlimited += usize::from(effect.force.is_none());
            let max_torque_nm = match effect.force {
                None => MOST,
                Some([low, high]) => {
                    let most = low.abs().max(high.abs());
                    if (low + high).abs() > 1e-9 * most {
                        notes.changed(
                            None,
                            format!("the force of `{name}` at joint `{joint}` is limited to {most} in both directions; the file has {low} to {high}"),
                            "the limits of a servo are symmetric: state the smaller one if it binds",
                        );
                    }
                    if most > MOST {
                        notes.changed(
                            None,
                            format!("the force limit {most} of `{name}` is reduced to {MOST}"),
                            "state the limit of its motor",
                        );
                    }
                    most.clamp(1e-9, MOST)
                }
            };
            self.add_viscous(&joint, effect.viscous);
            let command = (!effect.command.is_none()).then_some(effect.command);
            if let Some(command) = command.filter(|c| c.factor != 1.0 || c.offset != 0.0) {
                scaled.push(format!(
                    "`{joint}` {} · command + {}",
                    command.factor, command.offset
                ));
            }
            self.structure.actuators.push(Driver {
                joint,
                servo: Servo {
                    law: effect.law,
                    max_torque_nm,
                    max_speed_rad_s: f64::INFINITY,
                    delay_s: actuator.delay_s.clamp(0.0, 10.0),
                    torque_constant_nm_a: None,
                },
                gait: None,
                follows: None,
                command,
            });
        }
        if motors > 0 {
            notes.assumed(None, format!("{motors} motors take torques as commands, but no command is stated: they exert no torque"), "state a gait in `actuators`; its offset and amplitude are then torques");
        }
        if unlimited > 0 {
            notes.assumed(
                None,
                format!("{unlimited} actuators have no force limit: {MOST} N m or N is used"),
                "state forcerange or actuatorfrcrange",
            );
        }
        if !scaled.is_empty() {
            notes.changed(
                None,
                format!(
                    "recorded commands are those of MuJoCo's `ctrl`; at the joint they become: {}",
                    scaled.join(", ")
                ),
                "remove `command` of these actuators for recordings in radians and newton metres",
            );
        }
        for (what, joints) in lagging {
            notes.changed(
                None,
                format!(
                    "the activation ({what}) of the actuators of {} is a lag of recorded commands, which begins at the first command; MuJoCo's begins at 0",
                    joints.join(", ")
                ),
                "no action is needed for recordings that begin at rest",
            );
        }
        Ok(())
    }

    /// The law of an actuator, in the coordinate of its joint.
    fn effect(
        &self,
        actuator: &Actuator,
        joint: &str,
        (body, index): (usize, usize),
        notes: &mut Notes,
    ) -> Effect {
        let name = &actuator.name;
        let given = &self.model.bodies[body].joints[index];
        let gear = actuator.gear;
        let gain = actuator.gain[0];
        let bias = match actuator.bias_kind.as_str() {
            "affine" => actuator.bias,
            _ => [0.0; 3],
        };
        let mut damping = -bias[2];
        if bias[2] > 0.0
            && gain == -bias[1]
            && let Some(inertia) = self.inertia.free(body, index)
        {
            let reflected = inertia / (gear * gear);
            damping = 2.0 * bias[2] * (gain * reflected).sqrt();
        }
        damping *= gear * gear;
        if damping < 0.0 {
            notes.left_out(
                None,
                format!("the negative damping {damping} of the actuator `{name}`"),
                "a servo takes energy out: state a damping of 0 or more",
            );
            damping = 0.0;
        }
        let stiffness = -bias[1] * gear * gear;
        let mut force = actuator.force_range.map(|[low, high]| {
            let (a, b) = (low * gear, high * gear);
            [a.min(b), a.max(b)]
        });
        if let Some([low, high]) = given.force_range {
            force = Some(force.map_or([low, high], |[a, b]| [a.max(low), b.min(high)]));
        }
        let mut range = actuator.command_range;
        if let (None, Some([low, high])) = (range, given.range)
            && actuator.inherit > 0.0
        {
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * actuator.inherit);
            range = Some([middle - half, middle + half]);
        }
        let command = |factor: f64, offset: f64| CommandScale {
            factor,
            offset,
            range: range.map(|[low, high]| (low, high)),
            ..CommandScale::default()
        };
        if stiffness > 0.0 {
            if stiffness > STIFFEST || damping > STIFFEST {
                notes.changed(None, format!("stiffness {stiffness} and damping {damping} of the servo at `{joint}` are reduced to at most {STIFFEST}"), "state those of the real servo");
            }
            return Effect {
                law: ServoLaw::Torque {
                    stiffness_nm_rad: stiffness.clamp(1e-9, STIFFEST),
                    damping_nm_s_rad: damping.min(STIFFEST),
                },
                viscous: 0.0,
                command: command(
                    gain * gear / stiffness,
                    bias[0] * gear / stiffness - given.reference,
                ),
                force,
            };
        }
        // An actuator `velocity`: torque = damping · (command − speed).
        if damping > 0.0 && gain == -bias[2] && gear != 0.0 {
            if damping > STIFFEST {
                notes.changed(None, format!("the gain {damping} of the speed servo at `{joint}` is reduced to {STIFFEST}"), "state that of the real servo");
            }
            return Effect {
                law: ServoLaw::Torque {
                    stiffness_nm_rad: 0.0,
                    damping_nm_s_rad: damping.min(STIFFEST),
                },
                viscous: 0.0,
                command: command(gain * gear / damping, bias[0] * gear / damping),
                force,
            };
        }
        if damping > 0.0 && force.is_some() {
            notes.changed(None, format!("the damping of the actuator `{name}` is a damping of the joint `{joint}`: the force limit does not bound it"), "a servo of the law Torque bounds both");
        }
        let (factor, offset) = (gain * gear, bias[0] * gear);
        if let Some([low, high]) = range {
            let ends = [factor * low + offset, factor * high + offset];
            let most = ends[0].abs().max(ends[1].abs());
            let bound = force.map_or([-most, most], |[a, b]| [a.max(-most), b.min(most)]);
            force = Some(bound).filter(|_| most > 0.0).or(force);
            // The torque limit alone bounds a symmetric range.
            if (ends[0] + ends[1]).abs() <= 1e-12 * most && factor == 1.0 && offset == 0.0 {
                range = None;
            }
        }
        Effect {
            law: ServoLaw::Direct,
            viscous: damping,
            command: CommandScale {
                factor,
                offset,
                range: range.map(|[low, high]| (low, high)),
                ..CommandScale::default()
            },
            force,
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
