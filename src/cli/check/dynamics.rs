//! The dynamics of a robot at some coordinates of its joints, for comparisons with other programs.

use realgap::robot::morphology::Assembly;

use super::report;

/// Coordinates spread over what the joints allow, or half a turn: the k-th of them, by multiples of the golden ratio.
fn coordinates(assembly: &Assembly, k: usize) -> Vec<f64> {
    let hinges = assembly.hinges.iter().enumerate();
    hinges
        .map(|(index, hinge)| {
            let (low, high) = hinge.bearing.limits_rad.unwrap_or((-1.5, 1.5));
            let (low, high) = (low.max(-3.0), high.min(3.0));
            let share = (((k + 1) * (index + 1)) as f64 * 0.618_033_988_749_895).fract();
            low + share * (high - low)
        })
        .collect()
}

pub(super) fn states(assembly: &Assembly, count: usize) -> Option<report::States> {
    (count > 0).then(|| report::States {
        bodies: assembly.module_names.clone(),
        joints: assembly
            .hinges
            .iter()
            .map(|hinge| hinge.name.clone())
            .collect(),
        states: (0..count)
            .map(|k| assembly.dynamics(&coordinates(assembly, k)))
            .collect(),
    })
}
