//! Regions of the floor that a study sets or varies although no run of it touches them.

use std::collections::BTreeSet;

use super::{Case, Definition};
use realgap_core::warning::{Code, Warning};
use realgap_simulation::run;

/// The largest number of runs that are simulated before the regions count as untouched.
const MOST_RUNS: usize = 30;

/// Warnings about regions of the floor whose parameters the study sets or varies, and which no run touches. The runs are simulated
/// with the values that the study starts from until all regions were touched; of many runs, some evenly chosen ones.
pub(super) fn regions(definition: &Definition, cases: &[Case]) -> Vec<Warning> {
    let set = definition.set.iter().map(|value| value.parameter);
    let named: BTreeSet<&str> = set
        .chain(definition.parameters.iter().copied())
        .map(|parameter| parameter.of_all())
        .filter(|parameter| parameter.name.starts_with("floor."))
        .map(|parameter| parameter.subject)
        .filter(|subject| !subject.is_empty())
        .collect();
    let is_asked = |warning: &Warning| {
        warning.code == Code::RegionUntouched
            && (named.iter()).any(|name| warning.message.contains(&format!("`{name}`")))
    };
    let mut untouched: Option<Vec<Warning>> = None;
    let every = cases.len().div_ceil(MOST_RUNS).max(1);
    for case in cases.iter().step_by(every) {
        let experiment = &case.experiment;
        let may_touch = !named.is_empty() && experiment.has_engine();
        if !may_touch || experiment.ground.regions.is_empty() {
            continue;
        }
        // A run that fails is reported where it is scored.
        let Ok(run) = run(experiment) else { continue };
        if !run.outcome.is_completed() {
            continue;
        }
        let own = run.warnings.into_iter().filter(is_asked);
        untouched = Some(match untouched {
            None => own.collect(),
            Some(before) => own.filter(|warning| before.contains(warning)).collect(),
        });
        if untouched.as_ref().is_some_and(Vec::is_empty) {
            break;
        }
    }
    untouched.unwrap_or_default()
}
