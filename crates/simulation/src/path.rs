//! Sampling of a run: interpolation between steps, and collection of samples into a trajectory.

use nalgebra::{UnitQuaternion, Vector3};

use super::experiment::JointState;
use realgap_core::error::Result;
use realgap_path::trajectory::{JointTrack, Signal, State, Trajectory};

/// Interpolates the state between two steps; exactly the end states for shares of 0 and 1.
pub(super) fn between(
    before: &(State, Vec<JointState>),
    after: &(State, Vec<JointState>),
    share: f64,
) -> (State, Vec<JointState>) {
    if share <= 0.0 {
        return before.clone();
    }
    if share >= 1.0 {
        return after.clone();
    }
    let lerp = |a: f64, b: f64| a + share * (b - a);
    let joints = before.1.iter().zip(&after.1).map(|(a, b)| JointState {
        angle_rad: lerp(a.angle_rad, b.angle_rad),
        speed_rad_s: lerp(a.speed_rad_s, b.speed_rad_s),
    });
    (between_states(&before.0, &after.0, share), joints.collect())
}

fn between_states(before: &State, after: &State, share: f64) -> State {
    let orientation = |a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>| {
        a.try_slerp(b, share, 1e-12).unwrap_or(*b)
    };
    State {
        position_world_m: before.position_world_m.lerp(&after.position_world_m, share),
        orientation_world_from_body: orientation(
            &before.orientation_world_from_body,
            &after.orientation_world_from_body,
        ),
        velocity_world_m_s: before
            .velocity_world_m_s
            .lerp(&after.velocity_world_m_s, share),
        angular_velocity_body_rad_s: before
            .angular_velocity_body_rad_s
            .lerp(&after.angular_velocity_body_rad_s, share),
    }
}

/// The samples of a run, from which a trajectory is built.
#[derive(Default)]
pub(super) struct Path {
    times_s: Vec<f64>,
    positions: Vec<Vector3<f64>>,
    orientations: Vec<UnitQuaternion<f64>>,
    linear: Vec<Vector3<f64>>,
    angular: Vec<Vector3<f64>>,
    /// Names of the recorded joints.
    pub joint_names: Vec<String>,
    /// Joints of every sample, one sample after the other.
    joints: Vec<JointState>,
    /// Columns of the recorded instruments.
    pub instrument_names: Vec<String>,
    /// Readings of the instruments of every sample, one sample after the other; NaN before the first step.
    readings: Vec<f64>,
}

impl Path {
    /// A path without samples.
    pub fn with_capacity(samples: usize) -> Self {
        Self {
            times_s: Vec::with_capacity(samples),
            positions: Vec::with_capacity(samples),
            orientations: Vec::with_capacity(samples),
            linear: Vec::with_capacity(samples),
            angular: Vec::with_capacity(samples),
            joint_names: Vec::new(),
            joints: Vec::new(),
            instrument_names: Vec::new(),
            readings: Vec::new(),
        }
    }

    /// Appends a sample.
    pub fn push(&mut self, t_s: f64, (state, joints): &(State, Vec<JointState>), readings: &[f64]) {
        self.readings.extend(readings);
        self.joints.extend(joints);
        self.times_s.push(t_s);
        self.positions.push(state.position_world_m);
        self.orientations.push(state.orientation_world_from_body);
        self.linear.push(state.velocity_world_m_s);
        self.angular.push(state.angular_velocity_body_rad_s);
    }

    /// The trajectory of all samples.
    ///
    /// # Errors
    /// Times or values that make no trajectory.
    pub fn finish(self) -> Result<Trajectory> {
        let count = self.joint_names.len();
        let tracks = self
            .joint_names
            .into_iter()
            .enumerate()
            .map(|(index, name)| {
                let own = self.joints.iter().skip(index).step_by(count);
                JointTrack {
                    name,
                    angles_rad: own.clone().map(|joint| joint.angle_rad).collect(),
                    speeds_rad_s: Some(own.map(|joint| joint.speed_rad_s).collect()),
                }
            });
        let tracks = tracks.collect();
        let columns = self.instrument_names.len();
        let signals = self.instrument_names.into_iter().enumerate();
        let signals = signals.map(|(index, name)| {
            let own = self.readings.iter().skip(index).step_by(columns);
            let mut values: Vec<f64> = own.copied().collect();
            // Before the first step nothing was measured; the first measured value stands there.
            let first = values.iter().position(|value| !value.is_nan());
            let first = first.unwrap_or(values.len());
            let value = values.get(first).copied().unwrap_or(0.0);
            values[..first].fill(value);
            Signal { name, values }
        });
        let signals = signals.collect();
        Trajectory::new(self.times_s, self.positions)?
            .with_orientations(self.orientations)?
            .with_velocities(self.linear, self.angular)?
            .with_joints(tracks)?
            .with_signals(signals)
    }
}
