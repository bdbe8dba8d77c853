//! One draw of the noise for another engine: the robot's file, and what that file cannot say.

use std::collections::BTreeMap;

use serde::Serialize;

use super::format_named;
use super::robot::Robot;
use crate::{Experiment, Start};
use realgap_core::Result;
use realgap_robot::morphology::{CommandScale, ServoLaw};

/// A robot with the deviations of one repeat, for MuJoCo: masses, servo zeros, phases and gains stand in its file.
///
/// ```
/// use realgap_simulation::export::DrawnRobot;
/// use realgap_simulation::{Experiment, Noise};
/// use realgap_robot::morphology::Morphology;
///
/// let robot = Morphology::read("../../morphologies/tripod.ron")?;
/// let experiment = Experiment::new(robot.assemble());
/// assert_eq!(DrawnRobot::cannot_say(&experiment), None);
/// let drawn = Noise::careful_start().perturb(&experiment, 1, 0);
/// let drawn = DrawnRobot::new(robot.name(), &drawn)?;
/// assert!(drawn.shift_world_m[0] != 0.0 && drawn.mjcf.starts_with("<?xml"));
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DrawnRobot {
    /// Shift of the start, world frame, metres.
    pub shift_world_m: [f64; 3],
    /// Rotation of the start, world frame, rotation vector, radians.
    pub turn_world_rad: [f64; 3],
    /// Age of the command that every servo acts on, seconds, by the servo's name in `mjcf`.
    pub servo_latency_s: BTreeMap<String, f64>,
    /// Friction of every box with the floor, by the box's name in `mjcf`.
    pub friction: BTreeMap<String, f64>,
    /// The robot with this draw's masses, servo zeros, phases and gains.
    pub mjcf: String,
}

impl DrawnRobot {
    /// The robot of an experiment with the deviations that it has.
    ///
    /// # Errors
    /// None: the format MJCF exists.
    pub fn new(name: &str, experiment: &Experiment) -> Result<Self> {
        let drawn = &experiment.perturbation;
        let robot = Robot::named(name, experiment);
        let solids = robot.assembly.parts.iter().flat_map(|part| &part.solids);
        let friction = solids.map(|solid| {
            let factor = drawn.friction_factor_of(solid.module, solid.role);
            (robot.solid_name(solid), experiment.floor.friction * factor)
        });
        let hinges = robot.assembly.hinges.iter().enumerate();
        let latency = hinges.filter_map(|(index, hinge)| {
            let own_s = hinge.actuator.as_ref()?.servo.delay_s;
            let added_s = experiment.hinge_adjustment(index).latency_s + drawn.latency_s_of(index);
            Some((hinge.name.clone(), added_s + own_s))
        });
        Ok(Self {
            shift_world_m: drawn.shift_world_m.into(),
            turn_world_rad: drawn.turn_world_rad.into(),
            servo_latency_s: latency.collect(),
            friction: friction.collect(),
            mjcf: format_named("mjcf")?.render(&robot).text,
        })
    }

    /// What a run of this experiment depends on that the other engine would not be told; `None` where it is told everything but
    /// the restitution and the numerical settings.
    pub fn cannot_say(experiment: &Experiment) -> Option<&'static str> {
        let assembly = &experiment.assembly;
        let adjusted = experiment.hinge_adjustments.iter();
        let mut adjusted = adjusted.map(|a| [a.backlash_rad, a.offset_rad, a.zero_rad]);
        let driven = || assembly.hinges.iter().filter_map(|h| h.actuator.as_ref());
        let is_scaled =
            |scale: &CommandScale| !scale.is_linear() || scale.factor != 1.0 || scale.offset != 0.0;
        let reasons = [
            (!experiment.has_engine(), "it is not simulated by an engine"),
            (
                experiment.start != Start::Settled,
                "the run starts from a recorded state",
            ),
            (
                !experiment.start_joints.is_empty(),
                "the joints start from recorded angles",
            ),
            (
                !experiment.commands.is_empty(),
                "the servos follow recorded commands",
            ),
            (
                experiment.controller.is_some(),
                "the robot has a controller",
            ),
            (
                !experiment.scene.is_empty(),
                "there are other bodies in the scene",
            ),
            (
                !experiment.ground.regions.is_empty(),
                "regions of the floor have friction of their own",
            ),
            (
                experiment.ground.heights.is_some(),
                "a height field is in place of the floor",
            ),
            (
                experiment.base.is_some() || assembly.world_from_mount.is_some(),
                "the robot is held",
            ),
            (!experiment.contact.is_on, "nothing touches the robot"),
            (assembly.is_compliant(), "its bearings give"),
            (assembly.has_tyres(), "it has tyres"),
            (
                experiment.has_turning_friction(),
                "it has rolling or torsional friction",
            ),
            (
                adjusted.any(|values| values != [0.0; 3]),
                "its joints have backlash, offsets or zeros",
            ),
            (
                driven().any(|a| {
                    matches!(a.servo.law, ServoLaw::Direct | ServoLaw::Throttle)
                        || a.servo.law.follows_speeds()
                        || is_scaled(&a.command)
                }),
                "its servos do not follow angles",
            ),
            (driven().next().is_none(), "nothing drives it"),
        ];
        reasons
            .into_iter()
            .find_map(|(holds, why)| holds.then_some(why))
    }
}
