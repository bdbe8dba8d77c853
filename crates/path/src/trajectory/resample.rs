//! Resamples and interpolates trajectories: linearly in position and velocity, by slerp in orientation.

use nalgebra::{UnitQuaternion, Vector3};

use super::{JointTrack, Trajectory};
use realgap_core::error::{Error, Result};

/// Resamples a trajectory to `points` samples uniform in time; both ends are kept.
///
/// Positions and velocities are interpolated linearly, orientations by slerp along the shorter way
/// (paper 003, section 2.2, step 1, with 182 points).
///
/// # Errors
/// Fewer than 2 points, or so many points in so short a time that their times are equal.
pub fn resample(trajectory: &Trajectory, points: usize) -> Result<Trajectory> {
    if points < 2 {
        return Err(Error::invalid("too few points to resample to")
            .found(points)
            .allowed("at least 2 points"));
    }
    let (first_s, last_s) = ends_s(trajectory);
    let mut times_s = Vec::with_capacity(points);
    let mut places = Vec::with_capacity(points);
    let mut interpolator = Interpolator::new(trajectory);
    for index in 0..points {
        let since_start_s = uniform(trajectory.duration_s(), index, points);
        times_s.push(if index + 1 == points {
            last_s
        } else {
            first_s + since_start_s
        });
        places.push(interpolator.place(since_start_s));
    }
    at_places(trajectory, times_s, &places)
}

/// The trajectory at these places, with these times; signals are left out, because they are held and not interpolated.
pub(super) fn at_places(
    trajectory: &Trajectory,
    times_s: Vec<f64>,
    places: &[Place],
) -> Result<Trajectory> {
    let positions = places
        .iter()
        .map(|place| place.lerp(trajectory.positions_world_m()))
        .collect();
    let mut resampled = Trajectory::new(times_s, positions)?;
    if let Some(all) = trajectory.orientations_world_from_body() {
        resampled =
            resampled.with_orientations(places.iter().map(|place| place.slerp(all)).collect())?;
    }
    if let Some([linear, angular]) = trajectory.velocities() {
        resampled = resampled.with_velocities(
            places.iter().map(|place| place.lerp(linear)).collect(),
            places.iter().map(|place| place.lerp(angular)).collect(),
        )?;
    }
    let joints = trajectory.joints().iter();
    let joints = joints.map(|joint| joint.map(|all| places.iter().map(|p| p.mix(all)).collect()));
    resampled = resampled.with_joints(joints.collect())?;
    Ok(resampled.planar_like(trajectory))
}

fn ends_s(trajectory: &Trajectory) -> (f64, f64) {
    let times_s = trajectory.times_s();
    (times_s[0], times_s[times_s.len() - 1])
}

/// Time number `index` of `points` uniform ones from 0 to `duration_s`.
pub(super) fn uniform(duration_s: f64, index: usize, points: usize) -> f64 {
    if index + 1 == points {
        duration_s
    } else {
        duration_s / (points - 1) as f64 * index as f64
    }
}

/// The position of a time between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    before: usize,
    /// From 0 at `before` to 1 at the sample after it.
    fraction: f64,
}

impl Place {
    /// Interpolates linearly between two numbers.
    pub(super) fn mix(self, values: &[f64]) -> f64 {
        let (a, b) = (values[self.before], values[self.before + 1]);
        if self.fraction >= 1.0 {
            b
        } else {
            a + (b - a) * self.fraction
        }
    }

    /// The value that held at this time.
    pub(super) fn held(self, values: &[f64]) -> f64 {
        values[self.before + usize::from(self.fraction >= 1.0)]
    }

    pub(super) fn lerp(self, values: &[Vector3<f64>]) -> Vector3<f64> {
        let (a, b) = (values[self.before], values[self.before + 1]);
        // The result is exact at both samples, so that resampling at the same times changes no position.
        if self.fraction >= 1.0 {
            b
        } else {
            a + (b - a) * self.fraction
        }
    }

    pub(super) fn slerp(self, values: &[UnitQuaternion<f64>]) -> UnitQuaternion<f64> {
        let (a, b) = (values[self.before], values[self.before + 1]);
        if self.fraction <= 0.0 {
            a
        } else if self.fraction >= 1.0 {
            b
        } else {
            // For nearly equal orientations slerp is ill-conditioned; linear interpolation (nlerp) is accurate there.
            a.try_slerp(&b, self.fraction, 1e-9).unwrap_or_else(|| {
                let b = if a.coords.dot(&b.coords) < 0.0 {
                    UnitQuaternion::new_unchecked(-b.into_inner())
                } else {
                    b
                };
                a.nlerp(&b, self.fraction)
            })
        }
    }
}

/// Interpolates the poses of a trajectory at any times; it is fastest if the times increase.
#[derive(Debug, Clone)]
pub struct Interpolator<'a> {
    trajectory: &'a Trajectory,
    segment: usize,
}

impl<'a> Interpolator<'a> {
    /// An interpolator at the start of `trajectory`.
    pub fn new(trajectory: &'a Trajectory) -> Self {
        Self {
            trajectory,
            segment: 0,
        }
    }

    /// One of these numbers, one for each sample, at `since_start_s` seconds after the first sample, interpolated linearly.
    pub fn number(&mut self, values: &[f64], since_start_s: f64) -> f64 {
        self.place(since_start_s).mix(values)
    }

    /// Position (world, metres) at `since_start_s` seconds after the first sample; beyond the ends, the position of the end.
    pub fn position_world_m(&mut self, since_start_s: f64) -> Vector3<f64> {
        self.place(since_start_s)
            .lerp(self.trajectory.positions_world_m())
    }

    /// Orientation (world from body) at `since_start_s` seconds after the first sample, if recorded.
    pub fn orientation_world_from_body(
        &mut self,
        since_start_s: f64,
    ) -> Option<UnitQuaternion<f64>> {
        let all = self.trajectory.orientations_world_from_body()?;
        Some(self.place(since_start_s).slerp(all))
    }

    /// Angle of a joint of this trajectory at `since_start_s` seconds after the first sample, radians.
    pub(crate) fn joint_angle_rad(&mut self, joint: &JointTrack, since_start_s: f64) -> f64 {
        self.place(since_start_s).mix(&joint.angles_rad)
    }

    pub(super) fn place(&mut self, since_start_s: f64) -> Place {
        let times_s = self.trajectory.times_s();
        let at = |index: usize| times_s[index] - times_s[0];
        while self.segment > 0 && since_start_s < at(self.segment) {
            self.segment -= 1;
        }
        while self.segment + 2 < times_s.len() && since_start_s >= at(self.segment + 1) {
            self.segment += 1;
        }
        let (before, after) = (at(self.segment), at(self.segment + 1));
        Place {
            before: self.segment,
            fraction: ((since_start_s - before) / (after - before)).clamp(0.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Trajectory {
        Trajectory::new(
            vec![10.0, 11.0, 13.0],
            vec![
                Vector3::zeros(),
                Vector3::new(1.0, 0.0, 0.0),
                Vector3::new(1.0, 4.0, 2.0),
            ],
        )
        .unwrap()
    }

    #[test]
    fn points_lie_on_the_segments_and_both_ends_are_kept() {
        let four = resample(&corner(), 4).unwrap();
        assert_eq!(four.times_s(), [10.0, 11.0, 12.0, 13.0]);
        assert_eq!(four.positions_world_m()[2], Vector3::new(1.0, 2.0, 1.0));
        assert_eq!(four.positions_world_m()[3], Vector3::new(1.0, 4.0, 2.0));
        assert!(resample(&corner(), 1).is_err());
    }

    #[test]
    fn orientation_takes_the_shorter_way() {
        let turn = |angle: f64| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let negated = UnitQuaternion::new_unchecked(-turn(1.0).into_inner());
        let trajectory = Trajectory::new(vec![0.0, 1.0], vec![Vector3::zeros(); 2])
            .unwrap()
            .with_orientations(vec![turn(0.0), negated])
            .unwrap();
        let middle = resample(&trajectory, 3).unwrap();
        let q = middle.orientations_world_from_body().unwrap()[1];
        assert!(q.angle_to(&turn(0.5)) < 1e-12);
    }

    #[test]
    fn opposite_orientations_do_not_panic() {
        let flip = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let trajectory = Trajectory::new(vec![0.0, 1.0], vec![Vector3::zeros(); 2])
            .unwrap()
            .with_orientations(vec![UnitQuaternion::identity(), flip])
            .unwrap();
        let middle = resample(&trajectory, 3).unwrap();
        let q = middle.orientations_world_from_body().unwrap()[1];
        assert!((q.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn the_interpolator_can_go_back_in_time_and_keeps_the_ends() {
        let corner = corner();
        let mut at = Interpolator::new(&corner);
        assert_eq!(at.position_world_m(2.0).y, 2.0);
        assert_eq!(at.position_world_m(0.5).x, 0.5);
        assert_eq!(at.position_world_m(9.0).y, 4.0);
        assert_eq!(at.position_world_m(-9.0).x, 0.0);
    }
}
