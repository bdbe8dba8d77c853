//! The log itself as a model: what was read nearest to a pose.

use super::angle::wrapped;
use super::model::{LoggedPose, NOTHING, Sensorgraph};

/// Metres that a radian of heading counts as, for what the nearest pose is.
const METRES_PER_RADIAN: f64 = 1.0;

/// A number of a [`LoggedPose`], where something came back.
fn something(range_m: f64) -> Option<f64> {
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

    /// The logged pose at the nearest place, whatever its heading.
    pub(super) fn nearest_place(&self, position_world_m: [f64; 2]) -> Option<&LoggedPose> {
        self.nearest(position_world_m, 0.0, 0.0)
    }

    /// What a segment read at a logged pose, metres.
    pub(super) fn read_at(&self, pose: &LoggedPose, segment: usize) -> Option<f64> {
        something(*pose.segments_m.get(segment)?)
    }

    /// What a segment would have read at a logged place with another heading, metres.
    pub(super) fn turned_at(
        &self,
        place: &LoggedPose,
        heading_rad: f64,
        segment: usize,
    ) -> Option<f64> {
        let (before, share) = self.between(heading_rad, segment);
        let at = |k: usize| something(*place.directions_m.get(k % self.headings)?);
        let (low, high) = (at(before)?, at(before + 1)?);
        Some(low + share * (high - low))
    }
}
