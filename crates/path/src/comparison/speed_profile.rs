//! How fast a body moves and turns over time, on a common grid: quantities that do not depend on the frame of the poses.

use crate::trajectory::{Interpolator, Trajectory};

/// Speeds over one window of time at the moments of a grid.
#[derive(Debug, Clone)]
pub(super) struct SpeedProfile {
    /// Number of the first moment on the grid; moment k is the time k · step.
    pub(super) first: i64,
    /// Speed of the position at every moment, m/s.
    pub(super) linear_m_s: Vec<f64>,
    /// Speed of turning at every moment, rad/s, if there are orientations.
    pub(super) angular_rad_s: Option<Vec<f64>>,
}

impl SpeedProfile {
    /// The speeds over a window of `window_s` at all multiples of `step_s` that have a whole window inside of the trajectory, whose
    /// first sample counts as the time `start_s`.
    pub(super) fn new(trajectory: &Trajectory, start_s: f64, step_s: f64, window_s: f64) -> Self {
        let half_s = 0.5 * window_s;
        let first = ((start_s + half_s) / step_s).ceil() as i64;
        let last = ((start_s + trajectory.duration_s() - half_s) / step_s).floor() as i64;
        let count = usize::try_from(last - first + 1).unwrap_or(0);
        let (mut behind, mut ahead) =
            (Interpolator::new(trajectory), Interpolator::new(trajectory));
        let mut linear_m_s = Vec::with_capacity(count);
        let mut angular_rad_s = Vec::with_capacity(count);
        for k in 0..count {
            let since_s = (first + k as i64) as f64 * step_s - start_s;
            let (from_s, to_s) = (since_s - half_s, since_s + half_s);
            let way_m = ahead.position_world_m(to_s) - behind.position_world_m(from_s);
            linear_m_s.push(way_m.norm() / window_s);
            let turns = (
                behind.orientation_world_from_body(from_s),
                ahead.orientation_world_from_body(to_s),
            );
            if let (Some(from), Some(to)) = turns {
                angular_rad_s.push(from.angle_to(&to) / window_s);
            }
        }
        Self {
            first,
            linear_m_s,
            angular_rad_s: trajectory
                .orientations_world_from_body()
                .map(|_| angular_rad_s),
        }
    }

    /// The pairs of profiles of the same quantity.
    pub(super) fn channels<'a>(&'a self, other: &'a Self) -> Vec<(&'a [f64], &'a [f64])> {
        let angular = self
            .angular_rad_s
            .as_deref()
            .zip(other.angular_rad_s.as_deref());
        std::iter::once((self.linear_m_s.as_slice(), other.linear_m_s.as_slice()))
            .chain(angular)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn steady_motion_has_constant_speeds_on_multiples_of_the_step() {
        let times_s: Vec<f64> = (0..101).map(|i| 7.03 + 0.1 * f64::from(i)).collect();
        let positions = times_s.iter().map(|t| Vector3::new(0.0, 2.0 * t, 0.0));
        let turns = times_s
            .iter()
            .map(|t| UnitQuaternion::from_euler_angles(0.5 * t, 0.0, 0.0));
        let turns = turns.collect();
        let steady = Trajectory::new(times_s.clone(), positions.collect())
            .and_then(|path| path.with_orientations(turns))
            .unwrap();
        let profile = SpeedProfile::new(&steady, 7.03, 0.5, 0.2);
        assert_eq!(profile.first, 15);
        assert_eq!(profile.linear_m_s.len(), 19);
        let angular = profile.angular_rad_s.as_ref().unwrap();
        for (linear, angular) in profile.linear_m_s.iter().zip(angular) {
            assert!((linear - 2.0).abs() < 1e-9 && (angular - 0.5).abs() < 1e-9);
        }
    }
}
