//! The doubt about two joints whose measured (or commanded) columns have changed places.

use super::Seen;
use super::obedience::{DELAY_S, Obedience};

/// Exchanged columns leave less than this share of the error that the columns leave as they are, …
const CLEARER: f64 = 0.4;
/// … and as they are, the columns leave more than this share of the variance of their commands, …
const POOR: f64 = 0.25;
/// … and each of the two joints gains.
const EACH: f64 = 0.8;

/// A message about the two joints that gain most if they change places.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let all = Obedience::of(seen)?;
    let misfit = |angle: usize, command: usize| {
        all.misfit(all.joints[angle].0, all.joints[command].1, 1.0, DELAY_S)
    };
    let count = all.joints.len();
    let own: Vec<f64> = (0..count).map(|joint| misfit(joint, joint)).collect();
    let variances: Vec<f64> = all
        .joints
        .iter()
        .map(|(_, command)| all.variance(command).unwrap_or(0.0))
        .collect();
    let mut best: Option<(f64, usize, usize)> = None;
    for one in 0..count {
        for other in one + 1..count {
            let (as_read, told) = (own[one] + own[other], variances[one] + variances[other]);
            if told == 0.0 || as_read <= POOR * told {
                continue;
            }
            let [a, b] = [misfit(one, other), misfit(other, one)];
            let share = (a + b) / as_read;
            let gains = a < EACH * own[one] && b < EACH * own[other];
            if gains && share < CLEARER && best.is_none_or(|(least, ..)| share < least) {
                best = Some((share, one, other));
            }
        }
    }
    let (share, one, other) = best?;
    let [one, other] = [one, other].map(|joint| &all.joints[joint].0.name);
    Some(format!(
        "`{one}` follows the commands of `{other}`, and `{other}` those of `{one}`: exchanged, their columns leave {:.0} % of the error; exchange the names of the two measured columns, or of the two commanded ones",
        100.0 * share
    ))
}
