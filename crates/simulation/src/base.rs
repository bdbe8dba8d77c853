//! A base that is led: the root of a robot follows a recorded pose, as the legs of a robot on a stand that shakes or is carried about.
//!
//! Between samples the pose is a cubic with the slopes of a parabola through three neighbours (Catmull and Rom 1974), for the orientation of
//! its rotation vector, so that velocities are continuous: from straight lines the joints would get a blow at every sample.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::experiment::Experiment;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::Trajectory;

/// The recorded pose of the tracked body over time, in recorded lengths.
#[derive(Debug, Clone, PartialEq)]
pub struct LedBase {
    /// Times since the first sample, seconds.
    times_s: Vec<f64>,
    places_world_m: Vec<Vector3<f64>>,
    turns_world_from_body: Vec<UnitQuaternion<f64>>,
    velocities_world_m_s: Vec<Vector3<f64>>,
    turn_rates_world_rad_s: Vec<Vector3<f64>>,
}

/// Slopes at all samples, from the steps between them and the changes over them: those of a parabola through a sample and its neighbours.
fn slopes(steps_s: &[f64], changes: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let rate = |k: usize| changes[k] / steps_s[k];
    let last = steps_s.len();
    // The parabola through the first three samples, at the first of them; the last likewise.
    let end = |near: usize, far: usize| {
        let share = steps_s[near] / (steps_s[near] + steps_s[far]);
        rate(near) + (rate(near) - rate(far)) * share
    };
    (0..=last)
        .map(|k| match k {
            _ if last == 1 => rate(0),
            0 => end(0, 1),
            k if k == last => end(last - 1, last - 2),
            k => {
                let whole = steps_s[k - 1] + steps_s[k];
                rate(k - 1) * (steps_s[k] / whole) + rate(k) * (steps_s[k - 1] / whole)
            }
        })
        .collect()
}

/// The value of a cubic from 0 at share 0 to `change` at share 1, with these derivatives by the share at both ends.
fn cubic(share: f64, change: Vector3<f64>, ends: [Vector3<f64>; 2]) -> Vector3<f64> {
    let (s2, s3) = (share.powi(2), share.powi(3));
    change * (3.0 * s2 - 2.0 * s3) + ends[0] * (s3 - 2.0 * s2 + share) + ends[1] * (s3 - s2)
}

/// The rate of a rotation vector `turn` whose rotation has this angular velocity, to second order in the vector.
fn vector_rate(turn: &Vector3<f64>, rate: Vector3<f64>) -> Vector3<f64> {
    rate - turn.cross(&rate) * 0.5 + turn.cross(&turn.cross(&rate)) / 12.0
}

impl LedBase {
    /// The poses of a recording, from its first sample on.
    ///
    /// # Errors
    /// A recording without orientations.
    pub fn new(recorded: &Trajectory) -> Result<Self> {
        let Some(turns) = recorded.orientations_world_from_body() else {
            return Err(
                Error::invalid("a base cannot be led along a path without orientations")
                    .found("positions only")
                    .allowed("columns x_m, y_m, z_m, qw, qx, qy, qz of the base beside its joints"),
            );
        };
        let times_s: Vec<f64> = recorded
            .times_s()
            .iter()
            .map(|t| t - recorded.times_s()[0])
            .collect();
        let steps_s: Vec<f64> = times_s.windows(2).map(|w| w[1] - w[0]).collect();
        let places = recorded.positions_world_m();
        let moved: Vec<Vector3<f64>> = places.windows(2).map(|w| w[1] - w[0]).collect();
        let turned: Vec<Vector3<f64>> = turns
            .windows(2)
            .map(|w| (w[1] * w[0].inverse()).scaled_axis())
            .collect();
        Ok(Self {
            velocities_world_m_s: slopes(&steps_s, &moved),
            turn_rates_world_rad_s: slopes(&steps_s, &turned),
            places_world_m: places.to_vec(),
            turns_world_from_body: turns.to_vec(),
            times_s,
        })
    }

    /// Pose of the tracked body; before the first sample and after the last, that of this sample.
    fn world_from_track(&self, since_start_s: f64) -> Isometry3<f64> {
        let last = self.times_s.len() - 1;
        let t_s = since_start_s.clamp(0.0, self.times_s[last]);
        let k = self
            .times_s
            .partition_point(|known| *known <= t_s)
            .clamp(1, last)
            - 1;
        let step_s = self.times_s[k + 1] - self.times_s[k];
        let share = (t_s - self.times_s[k]) / step_s;
        let places = &self.places_world_m;
        let velocities = &self.velocities_world_m_s;
        let moved_m = cubic(
            share,
            places[k + 1] - places[k],
            [velocities[k] * step_s, velocities[k + 1] * step_s],
        );
        let turns = &self.turns_world_from_body;
        let rates = &self.turn_rates_world_rad_s;
        let turn = (turns[k + 1] * turns[k].inverse()).scaled_axis();
        let turned = cubic(
            share,
            turn,
            [rates[k] * step_s, vector_rate(&turn, rates[k + 1] * step_s)],
        );
        Isometry3::from_parts(
            (places[k] + moved_m).into(),
            UnitQuaternion::from_scaled_axis(turned) * turns[k],
        )
    }

    /// Pose of the robot's frame, true lengths.
    pub(super) fn world_from_robot(
        &self,
        experiment: &Experiment,
        since_start_s: f64,
    ) -> Isometry3<f64> {
        let mut world_from_track = self.world_from_track(since_start_s);
        world_from_track.translation.vector /= experiment.recording_length_scale;
        world_from_track * experiment.assembly.robot_from_track.inverse()
    }

    /// Velocity of the robot's frame at the start, in true lengths: of its origin, and angular, world frame.
    pub(super) fn start_velocity(&self, experiment: &Experiment) -> (Vector3<f64>, Vector3<f64>) {
        let track_m_s = self.velocities_world_m_s[0] / experiment.recording_length_scale;
        let rate_rad_s = self.turn_rates_world_rad_s[0];
        let from_track = self.turns_world_from_body[0]
            * experiment
                .assembly
                .robot_from_track
                .inverse()
                .translation
                .vector;
        (track_m_s + rate_rad_s.cross(&from_track), rate_rad_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poses of a steady motion, at uneven times.
    fn recorded(
        place_m: impl Fn(f64) -> Vector3<f64>,
        turn: impl Fn(f64) -> UnitQuaternion<f64>,
    ) -> LedBase {
        let times_s: Vec<f64> = (0..40)
            .map(|k| 0.05 * f64::from(k) + 0.01 * f64::from(k % 3))
            .collect();
        let places = times_s.iter().map(|t| place_m(*t)).collect();
        let turns = times_s.iter().map(|t| turn(*t)).collect();
        let motion = Trajectory::new(times_s, places).unwrap();
        LedBase::new(&motion.with_orientations(turns).unwrap()).unwrap()
    }

    #[test]
    fn a_parabola_and_a_steady_turn_are_followed_exactly_between_samples() {
        let place_m = |t: f64| Vector3::new(1.0 + 2.0 * t, -0.5 * t * t, 0.3 * t * t - t);
        let rate = Vector3::new(0.3, -1.2, 0.8);
        let at = UnitQuaternion::from_euler_angles(0.4, 0.2, -1.0);
        let turn = |t: f64| UnitQuaternion::from_scaled_axis(rate * t) * at;
        let base = recorded(place_m, turn);
        for k in 0..190 {
            let t = 0.01 * f64::from(k);
            let pose = base.world_from_track(t);
            assert!((pose.translation.vector - place_m(t)).norm() < 1e-12, "{t}");
            assert!(pose.rotation.angle_to(&turn(t)) < 1e-7, "{t}");
        }
        assert!((base.velocities_world_m_s[0] - Vector3::new(2.0, 0.0, -1.0)).norm() < 1e-12);
        assert!((base.turn_rates_world_rad_s[0] - rate).norm() < 1e-9);
    }

    #[test]
    fn the_velocity_between_samples_has_no_jumps() {
        let place_m = |t: f64| Vector3::new((3.0 * t).sin(), 0.0, 0.0);
        let turn = |t: f64| {
            UnitQuaternion::from_scaled_axis(Vector3::z() * (2.0 * t).sin())
                * UnitQuaternion::from_scaled_axis(Vector3::x() * (3.0 * t).cos())
        };
        let base = recorded(place_m, turn);
        let h = 1e-5;
        for k in 1..39 {
            let at_s = base.times_s[k];
            let [before, here, after] =
                [at_s - h, at_s, at_s + h].map(|t| base.world_from_track(t));
            let v = [
                (here.translation.vector - before.translation.vector) / h,
                (after.translation.vector - here.translation.vector) / h,
            ];
            assert!((v[1] - v[0]).norm() < 3e-3, "{at_s}: {v:?}");
            let w = [
                (here.rotation * before.rotation.inverse()).scaled_axis() / h,
                (after.rotation * here.rotation.inverse()).scaled_axis() / h,
            ];
            assert!((w[1] - w[0]).norm() < 1e-2, "{at_s}: {w:?}");
        }
    }
}
