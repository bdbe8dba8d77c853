//! Parameters: named numbers of an experiment that can be set, swept and tuned.
//!
//! One registry, [`PARAMETERS`], holds name, unit, bounds, default, meaning, and how to read and
//! write the number. Adding a parameter is one entry in the file of its group.

mod assignment;
mod body;
mod command;
mod contact;
mod floor;
mod foreign;
mod gait;
mod hinge;
mod joint;
mod member;
mod module;
mod motor;
mod mount;
mod recording;
mod sensor;
mod servo;
mod solver;
mod track;
mod tyre;
mod vehicle;

pub use assignment::{Assignment, ParameterSet};
pub use foreign::{Declared, FOREIGN, foreign_parameter};

pub use realgap_core::quantity::Scale;

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex};

use crate::Experiment;
use member::{OF_JOINTS, OF_WHEELS};
use realgap_core::error::{Advice, Error, Result};
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
    /// Whether only whole numbers are allowed.
    pub whole: bool,
    /// Scale on which a search varies the parameter.
    pub scale: Scale,
    /// A small change of the value, which sensitivity studies use.
    pub nudge: Nudge,
    /// Meaning, in one sentence.
    pub doc: &'static str,
    /// Name of the module, region or step, or pattern of the joints that the parameter refers to, with `*` for any letters; empty if it
    /// refers to the whole experiment.
    pub subject: &'static str,
    get: fn(&Experiment, &str) -> Option<f64>,
    set: fn(&mut Experiment, &str, f64),
}

/// Defines a parameter that is not restricted to whole numbers and does not belong to a single module.
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

/// Defines a parameter that is a field of the experiment: name, unit, bounds, scale, small step, meaning, path of the field.
macro_rules! field {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $($field:ident).+) => {
        $crate::parameter::entry!(
            $name, $unit, $bounds, $scale, $nudge, $doc,
            |e, _| Some(e.$($field).+), |e, _, value| e.$($field).+ = value)
    };
}
use field;

/// Defines a parameter that selects an element of a list by its index: name, list, meaning, path of the field.
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
    /// A change by this fraction of the value.
    Share(f64),
    /// A change by this amount, in the parameter's unit.
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
    mount::PARAMETERS,
    track::PARAMETERS,
    tyre::PARAMETERS,
    command::PARAMETERS,
    gait::PARAMETERS,
    hinge::PARAMETERS,
    joint::PARAMETERS,
    recording::PARAMETERS,
    vehicle::PARAMETERS,
    sensor::CURVES,
    sensor::PARAMETERS,
];

/// Parameters of single modules, and of single regions and steps of the ground, with `NAME` in place of a name. Parameters of servos,
/// hinges and joints can also refer to selected joints: `servo.NAME.gain`, `servo.shoulder_*.gain`.
pub fn families() -> impl Iterator<Item = &'static Parameter> {
    module::FAMILY.iter().chain(floor::FAMILY)
}

/// Alternative names of parameters: alternative group and quantity, and the usual ones.
const ALSO: [[(&str, &str); 2]; 2] = [
    [("joint", "delay_s"), ("servo", "latency_s")],
    [("hinge", "dry_friction_nm"), ("hinge", "dry_nm")],
];

/// The usual name of a parameter, for an alternative name.
fn usual(name: &str) -> String {
    let (group, rest) = name.split_once('.').unwrap_or((name, ""));
    let (subject, quantity) = match rest.rsplit_once('.') {
        // An empty name of a module or joint is invalid; it does not stand for all of them.
        Some(("", _)) => return name.to_owned(),
        Some(parts) => parts,
        None => ("", rest),
    };
    // In a robot of bodies, a module is one body.
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

/// What a name refers to, where it begins with a robot or a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    /// One robot of several: `robot.NAME.servo.gain`.
    Robot(&'static str),
    /// The runs of some recordings: `run.NAME.floor.friction`, where `*` in the name stands for any letters.
    Run(&'static str),
}

/// Splits a name that begins with `robot.NAME.` or `run.NAME.` into its scope and the rest.
fn scoped(name: &str) -> Option<(&str, &str, bool)> {
    let (of_run, rest) = match name.strip_prefix("robot.") {
        Some(rest) => (false, rest),
        None => (true, name.strip_prefix("run.")?),
    };
    let (owner, rest) = rest.split_once('.')?;
    let is_name =
        |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-' || (of_run && c == '*');
    let is_owner = (1..=LONGEST_OWNER).contains(&owner.len()) && owner.chars().all(is_name);
    let is_nested = rest.starts_with("robot.") || rest.starts_with("run.");
    (is_owner && !is_nested).then_some((owner, rest, of_run))
}

/// Longest name of a robot or run before a parameter, in bytes.
const LONGEST_OWNER: usize = 128;

/// How a recording is called in the names of parameters of its run, `run.NAME.floor.friction`: other characters than ASCII letters,
/// digits and `-` become `_`.
///
/// ```
/// use realgap_simulation::parameter::run_name;
///
/// assert_eq!(run_name("tiles 2.1"), "tiles_2_1");
/// ```
pub fn run_name(recording: &str) -> String {
    let letters = recording.chars().map(|c| match c {
        c if c.is_ascii_alphanumeric() || c == '-' => c,
        _ => '_',
    });
    letters.take(LONGEST_OWNER).collect()
}

/// Longest name of a module or joint, in bytes.
const LONGEST: usize = 64;

/// Parameters of the groups [`OF_JOINTS`].
fn of_joints() -> impl Iterator<Item = &'static Parameter> {
    let groups = [
        servo::PARAMETERS,
        motor::PARAMETERS,
        hinge::PARAMETERS,
        joint::PARAMETERS,
        command::PARAMETERS,
    ];
    let all = groups.into_iter().flatten();
    all.filter(|parameter| OF_JOINTS.contains(&parameter.group()))
}

/// Parameters are compared and stored by reference, so each name gets one parameter that lives as long as the program.
static KNOWN: LazyLock<Mutex<BTreeMap<String, &'static Parameter>>> = LazyLock::new(Mutex::default);

/// The unique parameter of this name; it is created at the first use.
fn interned(name: String, subject: &str, family: &Parameter) -> &'static Parameter {
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

/// The parameter restricted to one robot of several, or to the runs of some recordings.
fn of_owner((owner, of_run): (&str, bool), all: &'static Parameter) -> &'static Parameter {
    let kind = if of_run { "run" } else { "robot" };
    interned(format!("{kind}.{owner}.{}", all.name), all.subject, all)
}

/// The parameter of a name with a module, a joint or a region: group `.` its name `.` quantity.
fn member(name: &str) -> Option<&'static Parameter> {
    let (group, rest) = name.split_once('.')?;
    let (subject, quantity) = rest.rsplit_once('.')?;
    let has_pattern = OF_JOINTS.contains(&group) || group == OF_WHEELS;
    let is_name =
        |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-' || (c == '*' && has_pattern);
    if subject.is_empty() || subject.len() > LONGEST || !subject.chars().all(is_name) {
        return None;
    }
    let family = match group {
        "module" => module::FAMILY.iter().find(|p| p.quantity() == quantity)?,
        "floor" => floor::FAMILY.iter().find(|p| p.quantity() == quantity)?,
        OF_WHEELS => tyre::PARAMETERS.iter().find(|p| p.quantity() == quantity)?,
        _ => of_joints().find(|p| p.group() == group && p.quantity() == quantity)?,
    };
    Some(interned(name.to_owned(), subject, family))
}

/// Looks a parameter up by name.
///
/// # Errors
/// An unknown name; the error lists the nearest known ones.
pub fn by_name(name: &str) -> Result<&'static Parameter> {
    let asked = name;
    if let Some((owner, rest, of_run)) = scoped(name) {
        return Ok(of_owner((owner, of_run), by_name(rest)?));
    }
    if let Some(own) = foreign::own_name(name) {
        return Ok(foreign_parameter(&Declared::unknown(own)));
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
    fn scope(&self) -> Option<Scope> {
        scoped(self.name).map(|(owner, _, of_run)| match of_run {
            true => Scope::Run(owner),
            false => Scope::Robot(owner),
        })
    }

    /// Name of the robot that the parameter refers to in a study of several robots; `None` if it refers to all of them.
    pub fn robot(&self) -> Option<&'static str> {
        match self.scope()? {
            Scope::Robot(name) => Some(name),
            Scope::Run(_) => None,
        }
    }

    /// Name of the run that the parameter refers to ([`run_name`]), with `*` for any letters; `None` if it refers to all runs.
    pub fn run(&self) -> Option<&'static str> {
        match self.scope()? {
            Scope::Run(name) => Some(name),
            Scope::Robot(_) => None,
        }
    }

    /// The name without a robot or run before it.
    fn unscoped(&self) -> &'static str {
        scoped(self.name).map_or(self.name, |(_, rest, _)| rest)
    }

    /// The same parameter of all robots and runs.
    pub fn of_all(&'static self) -> &'static Self {
        match self.scope() {
            None => self,
            Some(_) => by_name(self.unscoped()).unwrap_or(self),
        }
    }

    /// The same parameter of the runs of this name alone.
    ///
    /// # Errors
    /// A parameter that refers to a robot or a run already.
    pub fn of_run(&'static self, run: &str) -> Result<&'static Self> {
        match self.scope() {
            None => Ok(of_owner((run, true), self)),
            Some(_) => Err(Error::invalid(
                "a parameter of one robot or run cannot be another run's",
            )
            .field(self.name)
            .hint("name the parameter itself")),
        }
    }

    /// Whether the parameter refers to the robot of this experiment.
    fn is_about(&self, experiment: &Experiment) -> bool {
        let own = &experiment.assembly.name;
        self.robot().is_none_or(|robot| robot == own)
    }

    /// Whether the parameter refers to this run; an experiment that belongs to no run is about all of them.
    fn is_of_run(&self, run: Option<&str>) -> bool {
        match (self.run(), run) {
            (Some(form), Some(run)) => member::matches(form, run),
            _ => true,
        }
    }

    /// The group: the part of the name before the first dot, without the robot or run.
    fn group(&self) -> &'static str {
        let name = self.unscoped();
        name.split('.').next().unwrap_or(name)
    }

    /// The quantity: the part of the name after the last dot.
    fn quantity(&self) -> &'static str {
        self.name.rsplit('.').next().unwrap_or(self.name)
    }

    /// Whether the parameter sets this quantity of the servo of this joint: by its name, by a form with `*`, or of all joints.
    ///
    /// ```
    /// use realgap_simulation::parameter::by_name;
    ///
    /// let calves = by_name("servo.*_calf_joint.stiffness_nm_rad")?;
    /// assert!(calves.sets_servo("FL_calf_joint", "stiffness_nm_rad"));
    /// assert!(!calves.sets_servo("FL_hip_joint", "stiffness_nm_rad"));
    /// assert!(!calves.sets_servo("FL_calf_joint", "damping_nm_s_rad"));
    /// # Ok::<(), realgap_core::Error>(())
    /// ```
    pub fn sets_servo(&self, joint: &str, quantity: &str) -> bool {
        self.group() == "servo"
            && self.quantity() == quantity
            && member::matches(self.subject, joint)
    }

    /// Whether the parameter refers to selected modules or joints only, so that it overrides a parameter of all of them.
    pub(crate) fn is_precise(&self) -> bool {
        self.rank() > 0
    }

    /// Order in which assignments are applied, independent of their order in a file: first parameters of all joints, then of
    /// groups, then of single joints.
    fn rank(&self) -> usize {
        let specificity = match self.subject {
            "" => 0,
            form if form.contains('*') => 1,
            _ => 2,
        };
        // A parameter of one robot overrides a parameter of all robots, and one of a run what holds for several runs.
        match self.scope() {
            None => specificity,
            Some(Scope::Robot(_)) => specificity + 3,
            Some(Scope::Run(form)) if form.contains('*') => specificity + 6,
            Some(Scope::Run(_)) => specificity + 9,
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

    /// The value; `None` if the robot's file determines it (e.g. a limit that is not overridden).
    pub fn value(&self, experiment: &Experiment) -> Option<f64> {
        if !self.is_about(experiment) {
            return None;
        }
        (self.get)(experiment, self.subject)
    }

    /// Whether setting the parameter changes the experiment.
    fn has_effect_on(&self, experiment: &Experiment) -> bool {
        let [low, high] = [self.bounds.0, self.bounds.1].map(|value| {
            let mut changed = experiment.clone();
            self.put(&mut changed, value);
            changed
        });
        low != high
    }

    fn put(&self, experiment: &mut Experiment, value: f64) {
        if !self.is_about(experiment) || !self.is_of_run(experiment.run.as_deref()) {
            return;
        }
        (self.set)(experiment, self.subject, value);
    }

    /// The value if nothing is set; `None` if the robot's file determines it.
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
    fn the_error_of_an_unknown_name_lists_similar_names() {
        let error = by_name("floor.frictoin").unwrap_err().to_string();
        assert!(
            error.contains("floor.friction, floor.restitution"),
            "{error}"
        );
    }
}
