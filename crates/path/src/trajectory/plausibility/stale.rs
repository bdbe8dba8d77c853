//! The doubt about samples that repeat old joint angles.

use super::Seen;
use crate::trajectory::clock;

/// The share of samples that may repeat the previous joint angles although the commands change, because joints may stick.
const STALE: f64 = 0.1;

/// A message about samples that repeat all joint angles of the previous sample although their commands have changed.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let trajectory = seen.trajectory;
    let joints = clock::commanded_joints(trajectory);
    let differs = |angles: &[f64], k: usize| angles[k] != angles[k - 1];
    let has_new_command = |k: &usize| joints.iter().any(|(_, c)| differs(&c.angles_rad, *k));
    let repeats = |k: &usize| !joints.iter().any(|(j, _)| differs(&j.angles_rad, *k));
    let moved: Vec<usize> = (1..trajectory.len()).filter(has_new_command).collect();
    let repeated = moved.iter().filter(|k| repeats(k)).count();
    let share = repeated as f64 / moved.len().max(1) as f64;
    (share > STALE).then(|| {
        format!(
            "{:.0} % of the samples whose commands differ from the previous sample repeat all its angles: they were read too late, and are compared unchanged",
            100.0 * share
        )
    })
}
