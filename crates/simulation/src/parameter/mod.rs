//! Named numbers of an experiment that may be set, swept and tuned.
//!
//! One registry, [`PARAMETERS`], holds name, unit, bounds, default, meaning, and how to read and
//! write the number. Adding a parameter is one entry in the file of its group.

mod assignment;
mod body;
mod contact;
mod floor;
mod gait;
mod hinge;
mod joint;
mod member;
mod module;
mod motor;
mod recording;
mod sensor;
mod servo;
mod solver;
mod vehicle;

pub use assignment::{Assignment, ParameterSet};

pub use realgap_core::quantity::Scale;

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex};

use crate::Experiment;
use member::OF_JOINTS;
use realgap_core::error::{Advice, Result};
use realgap_core::file::unknown_name;
use realgap_core::quantity::Quantity;
use realgap_core::unit::Unit;
use realgap_robot::morphology::Assembly;

/// A named number of an experiment.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name, `group.quantity_unit`.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: Unit,
    /// Smallest and largest allowed value, both allowed.
    pub bounds: (f64, f64),
    /// True where only whole numbers make sense.
    pub whole: bool,
    /// How a search walks along it.
    pub scale: Scale,
    /// A change of the size that a user would call small: what a sensitivity study tries.
    pub nudge: Nudge,
    /// What it means, one sentence.
    pub doc: &'static str,
    /// The module or the joints that it is about, `*` for any letters; empty where it is about the whole experiment.
    pub subject: &'static str,
    get: fn(&Experiment, &str) -> Option<f64>,
    set: fn(&mut Experiment, &str, f64),
}

/// A row of a table: a number that is no count and of no module of its own.
macro_rules! entry {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $get:expr, $set:expr) => {
        $crate::parameter::Parameter {
            name: $name,
            unit: realgap_core::unit::Unit::$unit,
            bounds: $bounds,
            whole: false,
            scale: $crate::parameter::Scale::$scale,
            nudge: $nudge,
            doc: $doc,
            subject: "",
            get: $get,
            set: $set,
        }
    };
}
use entry;

/// A parameter that is a field of the experiment: name, unit, bounds, scale, small step, meaning, way to the field.
macro_rules! field {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $($field:ident).+) => {
        $crate::parameter::entry!(
            $name, $unit, $bounds, $scale, $nudge, $doc,
            |e, _| Some(e.$($field).+), |e, _, value| e.$($field).+ = value)
    };
}
use field;

/// A parameter that chooses one of a list by its place there: name, list, meaning, way to the field.
macro_rules! choice {
    ($name:literal, $list:expr, $doc:literal, $($field:ident).+) => {
        $crate::parameter::Parameter {
            whole: true,
            ..$crate::parameter::entry!(
                $name, One, (0.0, ($list.len() - 1) as f64), Linear, Nudge::Absolute(1.0), $doc,
                |e, _| $list.iter().position(|one| *one == e.$($field).+).map(|place| place as f64),
                |e, _, value| {
                    if let Some(one) = $list.get(value as usize) {
                        e.$($field).+ = *one;
                    }
                })
        }
    };
}
use choice;

/// A small change of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nudge {
    /// This share of the value.
    Share(f64),
    /// This much, in the parameter's unit.
    Absolute(f64),
}

impl From<&Parameter> for Quantity {
    fn from(parameter: &Parameter) -> Self {
        Self {
            name: parameter.name,
            unit: parameter.unit,
            bounds: parameter.bounds,
            whole: parameter.whole,
            scale: parameter.scale,
        }
    }
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Every parameter, by group.
pub fn all() -> impl Iterator<Item = &'static Parameter> {
    PARAMETERS.iter().flat_map(|group| group.iter())
}

/// The registry: one slice per group.
pub static PARAMETERS: &[&[Parameter]] = &[
    floor::PARAMETERS,
    contact::PARAMETERS,
    solver::PARAMETERS,
    body::PARAMETERS,
    servo::PARAMETERS,
    motor::PARAMETERS,
    gait::PARAMETERS,
    hinge::PARAMETERS,
    joint::PARAMETERS,
    recording::PARAMETERS,
    vehicle::PARAMETERS,
    sensor::CURVES,
    sensor::PARAMETERS,
];

/// Parameters of single modules, with `NAME` in place of a module's name. Those of servos, hinges and joints can be of chosen ones,
/// too: `servo.NAME.gain`, `servo.shoulder_*.gain`.
pub fn families() -> impl Iterator<Item = &'static Parameter> {
    module::FAMILY.iter()
}

/// Other names of parameters: group and quantity, and those that are usual here.
const ALSO: [[(&str, &str); 2]; 2] = [
    [("joint", "delay_s"), ("servo", "latency_s")],
    [("hinge", "dry_friction_nm"), ("hinge", "dry_nm")],
];

/// The usual name of a parameter that goes by another.
fn usual(name: &str) -> String {
    let (group, rest) = name.split_once('.').unwrap_or((name, ""));
    let (subject, quantity) = match rest.rsplit_once('.') {
        // A thing without a name is no parameter of all things.
        Some(("", _)) => return name.to_owned(),
        Some(parts) => parts,
        None => ("", rest),
    };
    // A module of a robot of bodies is one body.
    let group = match group {
        "body" if !subject.is_empty() => "module",
        group => group,
    };
    let also = ALSO.iter().find(|[other, _]| *other == (group, quantity));
    let (group, quantity) = also.map_or((group, quantity), |[_, usual]| *usual);
    [group, subject, quantity]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(".")
}

/// The robot and the rest of a name that is about one robot of many: `robot.NAME.servo.gain`.
fn scoped(name: &str) -> Option<(&str, &str)> {
    let (robot, rest) = name.strip_prefix("robot.")?.split_once('.')?;
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let is_robot = (1..=LONGEST).contains(&robot.len()) && robot.chars().all(is_name);
    (is_robot && !rest.starts_with("robot.")).then_some((robot, rest))
}

/// Longest name of a thing.
const LONGEST: usize = 64;

/// Parameters of the groups [`OF_JOINTS`].
fn of_joints() -> impl Iterator<Item = &'static Parameter> {
    let groups = [
        servo::PARAMETERS,
        motor::PARAMETERS,
        hinge::PARAMETERS,
        joint::PARAMETERS,
    ];
    let all = groups.into_iter().flatten();
    all.filter(|parameter| OF_JOINTS.contains(&parameter.group()))
}

/// Parameters are compared and stored by reference, so each name has one for as long as the program runs.
static KNOWN: LazyLock<Mutex<BTreeMap<String, &'static Parameter>>> = LazyLock::new(Mutex::default);

/// The one parameter of this name.
fn kept(name: String, subject: &str, family: &Parameter) -> &'static Parameter {
    let mut known = KNOWN
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    known.entry(name).or_insert_with_key(|name| {
        Box::leak(Box::new(Parameter {
            name: Box::leak(name.clone().into_boxed_str()),
            subject: Box::leak(subject.to_owned().into_boxed_str()),
            ..*family
        }))
    })
}

/// A parameter for one robot of many.
fn of_robot(robot: &str, all: &'static Parameter) -> &'static Parameter {
    kept(format!("robot.{robot}.{}", all.name), all.subject, all)
}

/// The parameter that a name with a thing in it means: group `.` name of the thing `.` quantity.
fn member(name: &str) -> Option<&'static Parameter> {
    let (group, rest) = name.split_once('.')?;
    let (subject, quantity) = rest.rsplit_once('.')?;
    let is_of_joint = OF_JOINTS.contains(&group);
    let is_name =
        |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-' || (c == '*' && is_of_joint);
    if subject.is_empty() || subject.len() > LONGEST || !subject.chars().all(is_name) {
        return None;
    }
    let family = match group {
        "module" => module::FAMILY.iter().find(|p| p.quantity() == quantity)?,
        _ => of_joints().find(|p| p.group() == group && p.quantity() == quantity)?,
    };
    Some(kept(name.to_owned(), subject, family))
}

/// Looks a parameter up by name.
///
/// # Errors
/// An unknown name; the error lists the nearest known ones.
pub fn by_name(name: &str) -> Result<&'static Parameter> {
    let asked = name;
    if let Some((robot, rest)) = scoped(name) {
        return Ok(of_robot(robot, by_name(rest)?));
    }
    let name = usual(name);
    let name = name.as_str();
    if let Some(known) = all().find(|parameter| parameter.name == name) {
        return Ok(known);
    }
    if let Some(member) = member(name) {
        return Ok(member);
    }
    let group = name.split('.').next().unwrap_or(name);
    let mut near: Vec<&str> = all()
        .chain(families())
        .map(|p| p.name)
        .filter(|known| known.starts_with(group))
        .collect();
    if near.is_empty() {
        near = all().map(|p| p.name).collect();
    }
    Err(unknown_name("parameter", asked, near).advise(Advice::ListParameters))
}

impl Parameter {
    /// The robot of a study of many that it is about; nothing where it is about all of them.
    pub fn robot(&self) -> Option<&'static str> {
        scoped(self.name).map(|(robot, _)| robot)
    }

    /// Whether it is about the robot of this experiment.
    fn is_about(&self, experiment: &Experiment) -> bool {
        let own = &experiment.assembly.name;
        self.robot().is_none_or(|robot| robot == own)
    }

    /// What stands before the first dot of its name, the robot that it is about left out.
    fn group(&self) -> &'static str {
        let name = scoped(self.name).map_or(self.name, |(_, rest)| rest);
        name.split('.').next().unwrap_or(name)
    }

    /// What stands after the last dot of its name.
    fn quantity(&self) -> &'static str {
        self.name.rsplit('.').next().unwrap_or(self.name)
    }

    /// Whether it is about chosen joints only, so that it overrules one that is about all of them.
    pub fn is_precise(&self) -> bool {
        self.rank() > 0
    }

    /// What is set later, whatever stands first in a file: one joint after a group, a group after all.
    fn rank(&self) -> usize {
        let thing = match self.subject {
            "" => 0,
            form if form.contains('*') => 1,
            _ => 2,
        };
        // What is about one robot overrules what is about all of them.
        if self.robot().is_some() {
            thing + 3
        } else {
            thing
        }
    }

    /// Checks that `value` is allowed.
    ///
    /// # Errors
    /// A value out of bounds, not finite, or not whole where it must be.
    pub fn check(&self, value: f64) -> Result<()> {
        Quantity::from(self).check(value)
    }

    /// A new experiment with this parameter set to `value`.
    ///
    /// # Errors
    /// As [`Parameter::check`].
    pub fn apply(&self, experiment: &Experiment, value: f64) -> Result<Experiment> {
        self.check(value)?;
        let mut changed = experiment.clone();
        self.put(&mut changed, value);
        Ok(changed)
    }

    /// The value; `None` where the robot's own file decides (a limit that is not overridden).
    pub fn value(&self, experiment: &Experiment) -> Option<f64> {
        if !self.is_about(experiment) {
            return None;
        }
        (self.get)(experiment, self.subject)
    }

    /// Whether setting it changes anything.
    fn is_felt_by(&self, experiment: &Experiment) -> bool {
        let [low, high] = [self.bounds.0, self.bounds.1].map(|value| {
            let mut changed = experiment.clone();
            self.put(&mut changed, value);
            changed
        });
        low != high
    }

    fn put(&self, experiment: &mut Experiment, value: f64) {
        if !self.is_about(experiment) {
            return;
        }
        (self.set)(experiment, self.subject, value);
    }

    /// The value where nothing is set; `None` where the robot's file decides.
    pub fn default_value(&self) -> Option<f64> {
        (self.get)(&Experiment::new(Assembly::empty()), self.subject)
    }

    /// `value` made a little smaller and a little larger (see [`Nudge`]); `None` at a bound.
    pub fn nudged(&self, value: f64) -> [Option<f64>; 2] {
        let step = match self.nudge {
            Nudge::Share(share) => share * value.abs(),
            Nudge::Absolute(step) => step,
        };
        [-step, step].map(|step| {
            let moved = value + step;
            (step != 0.0 && self.check(moved).is_ok()).then_some(moved)
        })
    }

    /// Name and unit for an axis or table: `floor.friction` or `floor.height_m (m)`.
    pub fn label(&self) -> String {
        Quantity::from(self).label()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_bounds_are_ordered() {
        let mut seen = std::collections::BTreeSet::new();
        for parameter in all() {
            assert!(
                seen.insert(parameter.name),
                "{} stands twice",
                parameter.name
            );
            assert!(
                parameter.bounds.0 < parameter.bounds.1,
                "{}",
                parameter.name
            );
            assert!(
                !parameter.doc.is_empty() && parameter.doc.ends_with('.'),
                "{}",
                parameter.name
            );
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_its_neighbours() {
        let error = by_name("floor.frictoin").unwrap_err().to_string();
        assert!(
            error.contains("floor.friction, floor.restitution"),
            "{error}"
        );
    }
}
