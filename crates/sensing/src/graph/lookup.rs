//! Predicts a scan by looking up the nearest pose of the log, without polynomials.

use super::angle::wrapped;
use super::model::{LoggedPose, NOTHING, Sensorgraph};

/// Metres that a radian of heading counts as in the distance between poses.
const METRES_PER_RADIAN: f64 = 1.0;

/// A range of a [`LoggedPose`]; `None` if no beam returned.
fn returned(range_m: f64) -> Option<f64> {
    (range_m != NOTHING).then_some(range_m)
}

impl Sensorgraph {
    fn nearest(
        &self,
        [x, y]: [f64; 2],
        heading_rad: f64,
        metres_per_radian: f64,
    ) -> Option<&LoggedPose> {
        let off = |pose: &LoggedPose| {
            let turn = metres_per_radian * wrapped(pose.pose.2 - heading_rad);
            (pose.pose.0 - x).powi(2) + (pose.pose.1 - y).powi(2) + turn * turn
        };
        self.log.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// The logged pose nearest to this one.
    pub(super) fn nearest_pose(
        &self,
        position_world_m: [f64; 2],
        heading_rad: f64,
    ) -> Option<&LoggedPose> {
        self.nearest(position_world_m, heading_rad, METRES_PER_RADIAN)
    }

    /// The logged pose at the nearest position, whatever its heading.
    pub(super) fn nearest_place(&self, position_world_m: [f64; 2]) -> Option<&LoggedPose> {
        self.nearest(position_world_m, 0.0, 0.0)
    }

    /// The range of a segment at a logged pose, metres; `None` if no beam of the segment returned.
    pub(super) fn read_at(&self, pose: &LoggedPose, segment: usize) -> Option<f64> {
        returned(*pose.segments_m.get(segment)?)
    }

    /// The range that a segment would have had at a logged position with another heading, metres.
    pub(super) fn turned_at(
        &self,
        place: &LoggedPose,
        heading_rad: f64,
        segment: usize,
    ) -> Option<f64> {
        let (before, share) = self.between(heading_rad, segment);
        let at = |k: usize| returned(*place.directions_m.get(k % self.headings)?);
        let (low, high) = (at(before)?, at(before + 1)?);
        Some(low + share * (high - low))
    }
}
