//! Assignments of values to parameters: from `--set name=value`, from a file, or from a grid.

use std::fmt;

use super::foreign::FOREIGN;
use super::member::{OF_JOINTS, OF_WHEELS, matches};
use super::motor::is_of_motor;
use super::{Parameter, by_name};
use crate::{Experiment, SceneMotion};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::median;
use realgap_core::warning::{Code, Warning};

/// Quantities of the floor that act only where something touches it.
const OF_TOUCH: [&str; 4] = ["friction", "restitution", "rolling_m", "torsional_m"];

/// Names with commas between them.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// One parameter with a checked value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assignment {
    /// The parameter.
    pub parameter: &'static Parameter,
    /// Its value, in the parameter's unit, within its bounds.
    pub value: f64,
}

impl Assignment {
    /// A checked assignment.
    ///
    /// # Errors
    /// An unknown name or a value out of bounds.
    pub fn new(name: &str, value: f64) -> Result<Self> {
        let parameter = by_name(name)?;
        parameter.check(value)?;
        Ok(Self { parameter, value })
    }
}

impl std::str::FromStr for Assignment {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let shape = || {
            Error::usage("not an assignment")
                .found(format!("\"{text}\""))
                .allowed("name=value, e.g. floor.friction=0.4")
        };
        let (name, value) = text.split_once('=').ok_or_else(shape)?;
        let value = value.trim();
        let value = value.parse().map_err(|_| match value.replace(',', ".") {
            number if number != value && number.parse::<f64>().is_ok() => {
                Error::usage("a comma within a number")
                    .field(name.trim())
                    .found(value)
                    .allowed(number)
            }
            _ => shape(),
        })?;
        Self::new(name.trim(), value)
    }
}

impl fmt::Display for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.parameter.name, self.value)
    }
}

/// Values for some parameters, in order; a later value for the same parameter replaces the earlier.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterSet(Vec<Assignment>);

impl ParameterSet {
    /// An empty set, which changes nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// The set with one more assignment.
    #[must_use]
    pub fn with(mut self, assignment: Assignment) -> Self {
        match self
            .0
            .iter_mut()
            .find(|known| known.parameter == assignment.parameter)
        {
            Some(known) => known.value = assignment.value,
            None => self.0.push(assignment),
        }
        self
    }

    /// The set with all of `other`'s assignments after its own.
    #[must_use]
    pub fn with_all(self, other: &Self) -> Self {
        other
            .0
            .iter()
            .fold(self, |set, assignment| set.with(*assignment))
    }

    /// The assignments, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Assignment> {
        self.0.iter()
    }

    /// The value of a parameter, if the set contains one.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.0
            .iter()
            .find(|a| a.parameter.name == name)
            .map(|a| a.value)
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Warnings about assignments that have no effect, because the robot has no such part.
    pub fn without_effect(&self, experiment: &Experiment) -> Vec<Warning> {
        let robot = &experiment.assembly;
        let has_servos = robot.hinges.iter().any(|hinge| hinge.actuator.is_some());
        let has_motors = robot.hinges.iter().any(|hinge| {
            hinge
                .actuator
                .is_some_and(|a| a.servo.law.motor().is_some())
        });
        let has_stated = robot.hinges.iter().any(|hinge| hinge.is_stated);
        let has_pusher = experiment
            .scene
            .iter()
            .any(|body| matches!(body.motion, SceneMotion::Driven { .. }));
        let why = |a: &Assignment| -> Option<String> {
            let subject = a.parameter.subject;
            let names = || robot.hinges.iter().map(|hinge| hinge.name.as_str());
            if !a.parameter.is_about(experiment) {
                return Some(format!("the robot is `{}`", robot.name));
            }
            if !a.parameter.is_of_run(experiment.run.as_deref()) {
                // It is another run's; whether there is such a run, the study checks.
                return None;
            }
            match a.parameter.group() {
                group
                    if OF_JOINTS.contains(&group)
                        && !subject.is_empty()
                        && !names().any(|n| matches(subject, n)) =>
                {
                    let names: Vec<&str> = names().collect();
                    Some(format!(
                        "the robot has no joint `{subject}`, only {}",
                        names.join(", ")
                    ))
                }
                FOREIGN if experiment.simulator.is_built_in() => {
                    Some("the study names no simulator of its own".to_owned())
                }
                "servo" | "gait" | "command" if !has_servos => {
                    Some("the robot has no servos".to_owned())
                }
                "servo"
                    if !has_motors
                        && is_of_motor(a.parameter)
                        && !a.parameter.has_effect_on(experiment) =>
                {
                    Some("no servo of the robot is a motor behind a gear".to_owned())
                }
                "hinge" if !has_stated => Some("the robot's file states no hinges".to_owned()),
                "vehicle" if experiment.vehicle.is_none() => {
                    Some("the robot is not a vehicle".to_owned())
                }
                "vehicle" if a.parameter.value(experiment).is_none() => {
                    Some("the sensor's model has no such quantity".to_owned())
                }
                "contact" if !experiment.contact.is_on && a.parameter.name != "contact.on" => {
                    Some("contacts are off".to_owned())
                }
                "floor" if !subject.is_empty() && a.parameter.value(experiment).is_none() => {
                    let ground = &experiment.ground;
                    let regions = ground.regions.iter().map(|region| region.name.as_str());
                    let steps = ground.steps.iter().map(|step| step.name.as_str());
                    let (regions, steps) = (listed(regions), listed(steps));
                    Some(match a.parameter.quantity() {
                        "restitution" => {
                            format!("the floor has no region `{subject}`, only {regions}")
                        }
                        "height_m" => format!("the floor has no step `{subject}`, only {steps}"),
                        _ => format!(
                            "the floor has neither a region nor a step `{subject}`, only the regions {regions} and the steps {steps}"
                        ),
                    })
                }
                "floor"
                    if a.parameter.quantity() == "heights_scale"
                        && experiment.ground.heights.is_none() =>
                {
                    Some("the ground has no height field".to_owned())
                }
                "floor"
                    if !experiment.contact.is_on && OF_TOUCH.contains(&a.parameter.quantity()) =>
                {
                    Some("contacts are off".to_owned())
                }
                "floor"
                    if experiment.vehicle.is_some()
                        && ["rolling_m", "torsional_m"].contains(&a.parameter.quantity()) =>
                {
                    Some("a two-wheel robot moves without contacts".to_owned())
                }
                OF_WHEELS if !a.parameter.has_effect_on(experiment) => {
                    Some("no shape of these bodies is a tyre".to_owned())
                }
                OF_WHEELS if !experiment.contact.is_on => Some("contacts are off".to_owned()),
                "mount" if robot.world_from_mount.is_none() => {
                    Some("the robot moves freely".to_owned())
                }
                "pusher" if !has_pusher => Some("the scene has no driven body".to_owned()),
                "servo" | "hinge" if !a.parameter.has_effect_on(experiment) => {
                    Some("none of these joints has this quantity".to_owned())
                }
                "module" if !robot.module_names.iter().any(|name| name == subject) => {
                    Some(format!("the robot has no module `{subject}`"))
                }
                _ => None,
            }
        };
        let idle = self.0.iter().filter_map(|a| Some((a, why(a)?)));
        idle.map(|(a, why)| {
            Code::NoEffect.warning(format!("{} has no effect: {why}", a.parameter.name))
        })
        .collect()
    }

    /// The assignments that refer to selected joints only.
    #[must_use]
    pub fn precise(&self) -> Self {
        let precise = self.0.iter().filter(|a| a.parameter.is_precise());
        Self(precise.copied().collect())
    }

    /// For every parameter of single runs that has no value for this run, the median of its values for other runs: what was found of
    /// some runs is the best that is known of a further one, and one run that was set up differently hardly moves their median.
    fn of_other_runs(&self, run: Option<&str>) -> Vec<Assignment> {
        let of_runs = || self.0.iter().filter(|a| a.parameter.run().is_some());
        let is_of_one = |a: &Assignment| a.parameter.run().is_some_and(|name| !name.contains('*'));
        let is_known = |name: &str| {
            let mut own = of_runs().filter(|a| a.parameter.unscoped() == name);
            run.is_some() && own.any(|a| a.parameter.is_of_run(run))
        };
        let mut medians: Vec<Assignment> = Vec::new();
        for (place, first) in self.0.iter().enumerate().filter(|(_, a)| is_of_one(a)) {
            let name = first.parameter.unscoped();
            let is_same = |a: &&Assignment| is_of_one(a) && a.parameter.unscoped() == name;
            if self.0[..place].iter().any(|a| is_same(&a)) || is_known(name) {
                continue;
            }
            let known: Vec<f64> = self.0.iter().filter(is_same).map(|a| a.value).collect();
            medians.push(Assignment {
                parameter: first.parameter.of_all(),
                value: median(&known),
            });
        }
        medians
    }

    /// A new experiment with every assignment applied. If two assignments refer to one joint, the more specific one holds,
    /// otherwise the later one. Parameters of runs (`run.NAME.floor.friction`) hold for the run of the experiment; a run without a value
    /// of its own has the median of the others.
    pub fn apply(&self, experiment: &Experiment) -> Experiment {
        let mut changed = experiment.clone();
        let run = experiment.run.as_deref();
        let of_this = self
            .0
            .iter()
            .filter(|a| a.parameter.run().is_none() || run.is_some());
        let mut assignments: Vec<Assignment> = of_this.copied().collect();
        if self.0.iter().any(|a| a.parameter.run().is_some()) {
            assignments.extend(self.of_other_runs(run));
        }
        assignments.sort_by_key(|a| a.parameter.rank());
        for assignment in &assignments {
            assignment.parameter.put(&mut changed, assignment.value);
        }
        changed
    }
}

impl FromIterator<Assignment> for ParameterSet {
    fn from_iter<T: IntoIterator<Item = Assignment>>(assignments: T) -> Self {
        assignments.into_iter().fold(Self::new(), Self::with)
    }
}

impl fmt::Display for ParameterSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, assignment) in self.0.iter().enumerate() {
            write!(f, "{}{assignment}", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}
