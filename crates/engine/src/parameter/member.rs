//! Parameters of one thing or of a group: `module.NAME.quantity`, and every parameter of servos, hinges and joints as
//! `servo.NAME.quantity`, where `*` in the name stands for any letters.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex};

use super::{Parameter, hinge, joint, module, motor, servo};
use crate::{Experiment, HingeAdjustment};
use realgap_robot::morphology::Hinge;

/// In place of the name of a module or joint, in lists.
pub(super) const ANY: &str = "NAME";
/// Groups that have members by the name of a joint.
pub(super) const OF_JOINTS: [&str; 3] = ["servo", "hinge", "joint"];
/// Longest name of a thing.
const LONGEST: usize = 64;

/// Parameters of the groups [`OF_JOINTS`].
pub(super) fn of_joints() -> impl Iterator<Item = &'static Parameter> {
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
pub(super) fn of_robot(robot: &str, all: &'static Parameter) -> &'static Parameter {
    kept(format!("robot.{robot}.{}", all.name), all.subject, all)
}

/// The parameter that a name with a thing in it means: group `.` name of the thing `.` quantity.
pub(super) fn member(name: &str) -> Option<&'static Parameter> {
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

/// Whether a name has this form; nothing stands for every name.
pub(super) fn matches(form: &str, name: &str) -> bool {
    if form.is_empty() {
        return true;
    }
    let mut parts = form.split('*');
    let Some(mut rest) = name.strip_prefix(parts.next().unwrap_or_default()) else {
        return false;
    };
    let Some(last) = parts.next_back() else {
        return rest.is_empty();
    };
    for part in parts {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

/// What the chosen hinges have in common; `None` where they differ or none has it.
pub(super) fn shared(
    experiment: &Experiment,
    subject: &str,
    own: impl Fn(&Hinge, &HingeAdjustment) -> Option<f64>,
) -> Option<f64> {
    let hinges = experiment.assembly.hinges.iter().enumerate();
    let mut values = hinges
        .filter(|(_, hinge)| matches(subject, &hinge.name))
        .filter_map(|(index, hinge)| own(hinge, &experiment.hinge_adjustment(index)));
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

/// Changes what the robot's file states of the chosen hinges.
pub(super) fn change(experiment: &mut Experiment, subject: &str, to: impl Fn(&mut Hinge)) {
    let hinges = &mut std::sync::Arc::make_mut(&mut experiment.assembly).hinges;
    let chosen = hinges.iter_mut().filter(|h| matches(subject, &h.name));
    chosen.for_each(to);
}

/// Changes what a study says of the chosen hinges beside that.
pub(super) fn adjust(
    experiment: &mut Experiment,
    subject: &str,
    to: impl Fn(&mut HingeAdjustment),
) {
    let hinges = &experiment.assembly.hinges;
    let changes = &mut experiment.hinge_adjustments;
    changes.resize(hinges.len(), HingeAdjustment::default());
    for (hinge, change) in hinges.iter().zip(changes) {
        if matches(subject, &hinge.name) {
            to(change);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn a_star_stands_for_any_letters() {
        for (form, name, is) in [
            ("", "elbow", true),
            ("elbow", "elbow", true),
            ("elbow", "elbow_flex", false),
            ("shoulder_*", "shoulder_pan", true),
            ("*_flex", "wrist_flex", true),
            ("*_flex", "wrist_roll", false),
            ("a*b*c", "axxbyyc", true),
            ("a*b*c", "axxc", false),
            ("*", "anything", true),
            ("ab*ba", "aba", false),
        ] {
            assert_eq!(matches(form, name), is, "{form} {name}");
        }
    }
}
