//! The joints of a recording, for people.

use realgap::statistics::ends_of;
use realgap::text::shown;
use realgap::trajectory::Trajectory;

use super::super::kit::*;
use super::SHOWN;

/// The largest number of joints that are listed.
const SHOWN_JOINTS: usize = 12;

/// Which joints a recording holds, and how far each turns, so that a column that was taken for a joint, or a wrong unit, is seen.
pub(super) fn shown_joints(motion: &Trajectory) -> Option<String> {
    let ranges: Vec<String> = (motion.joints().iter().take(SHOWN_JOINTS))
        .map(|joint| {
            let (low, high) = ends_of(joint.angles_rad.iter().copied());
            format!("{} {low:.3} to {high:.3} rad", shown(&joint.name, SHOWN))
        })
        .collect();
    let count = motion.joints().len();
    let more = match count.saturating_sub(ranges.len()) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (count > 0).then(|| format!("{}: {}{more}", counted(count, "joint"), ranges.join(", ")))
}
