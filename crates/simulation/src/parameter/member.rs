//! Parameters of single modules and joints: `module.NAME.quantity`, and every parameter of servos, hinges and joints as
//! `servo.NAME.quantity`, and those of tyres as `tyre.NAME.quantity`, where `*` in the name stands for any letters.

use crate::{Experiment, HingeAdjustment};
use realgap_core::text::fits;
use realgap_robot::morphology::Hinge;

/// Placeholder for the name of a module or joint in lists.
pub(super) const ANY: &str = "NAME";
/// Groups whose parameters may name a joint.
pub(super) const OF_JOINTS: [&str; 4] = ["servo", "hinge", "joint", "command"];
/// The group whose parameters may name bodies that have tyres.
pub(super) const OF_WHEELS: &str = "tyre";

/// Whether a name matches this pattern; an empty pattern matches every name.
pub(super) fn matches(form: &str, name: &str) -> bool {
    form.is_empty() || fits(form, name)
}

/// The common value of the selected hinges; `None` if the values differ or no hinge has one.
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

/// Changes values of the robot's file for the selected hinges.
pub(super) fn change(experiment: &mut Experiment, subject: &str, to: impl Fn(&mut Hinge)) {
    let hinges = &mut std::sync::Arc::make_mut(&mut experiment.assembly).hinges;
    let chosen = hinges.iter_mut().filter(|h| matches(subject, &h.name));
    chosen.for_each(to);
}

/// Changes the study's adjustments of the selected hinges.
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
