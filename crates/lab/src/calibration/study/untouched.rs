//! Regions of the floor that a study sets or varies although no run of it touches them.

use std::collections::BTreeSet;

use super::{Case, Definition};
use realgap_core::warning::Warning;
use realgap_simulation::{region_untouched, run};

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
    let Some(first) = cases.first().filter(|_| !named.is_empty()) else {
        return Vec::new();
    };
    let regions = first.experiment.ground.regions.iter();
    let asked = regions.filter(|region| named.contains(region.name.as_str()));
    let mut untouched: Vec<Warning> = asked.map(|r| region_untouched(&r.name)).collect();
    let mut has_run = false;
    let every = cases.len().div_ceil(MOST_RUNS).max(1);
    for case in cases.iter().step_by(every) {
        let experiment = &case.experiment;
        if untouched.is_empty() {
            break;
        }
        if !experiment.has_engine() {
            continue;
        }
        // A run that fails is reported where it is scored.
        let Ok(run) = run(experiment) else { continue };
        if run.outcome.is_completed() {
            has_run = true;
            untouched.retain(|warning| run.warnings.contains(warning));
        }
    }
    match has_run {
        true => untouched,
        false => Vec::new(),
    }
}
