//! Runs an experiment and keeps the state of the robot at every step, for the checks to measure.

use nalgebra::{UnitQuaternion, Vector3};

use realgap_core::error::Result;
use realgap_path::trajectory::State;
use realgap_simulation::{Experiment, Push, Snapshot, Start, watch};

/// Height of a floor that is so far down that no body reaches it, metres.
pub(super) const ABYSS_M: f64 = -10.0;

/// The state at every step of a run, including the start.
#[derive(Debug)]
pub(super) struct SimulationLog(Vec<Snapshot>);

impl SimulationLog {
    /// Runs the experiment; `None` if the simulation diverges.
    pub fn record(experiment: &Experiment, pushes: &[Push]) -> Result<Option<Self>> {
        let mut snapshots = Vec::new();
        let run = watch(experiment, pushes, &mut |snapshot| {
            snapshots.push(snapshot.clone());
        })?;
        Ok((run.outcome.is_completed() && !snapshots.is_empty()).then_some(Self(snapshots)))
    }

    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Snapshot> {
        self.0.iter()
    }

    pub fn pairs(&self) -> impl Iterator<Item = (&Snapshot, &Snapshot)> {
        self.0.windows(2).map(|pair| (&pair[0], &pair[1]))
    }

    pub fn first(&self) -> &Snapshot {
        &self.0[0]
    }

    pub fn last(&self) -> &Snapshot {
        &self.0[self.0.len() - 1]
    }

    /// The first snapshot at or after `time_s`, or the last.
    pub fn at(&self, time_s: f64) -> &Snapshot {
        let index = self.0.partition_point(|s| s.time_s < time_s - 1e-9);
        &self.0[index.min(self.0.len() - 1)]
    }

    pub fn since(&self, time_s: f64) -> impl Iterator<Item = &Snapshot> {
        self.0.iter().filter(move |s| s.time_s >= time_s - 1e-9)
    }
}

/// A value measured on the states of a run; not a number if the run diverged or the measured event did not occur.
pub(super) fn measure(
    film: Option<&SimulationLog>,
    look: impl Fn(&SimulationLog) -> Option<f64>,
) -> f64 {
    film.and_then(look).unwrap_or(f64::NAN)
}

/// Centre of mass of the whole robot, metres.
pub(super) fn centre_world_m(snapshot: &Snapshot) -> Vector3<f64> {
    let mass_kg: f64 = snapshot.parts.iter().map(|p| p.mass_kg).sum();
    snapshot
        .parts
        .iter()
        .map(|p| p.centre_world_m * p.mass_kg)
        .sum::<Vector3<f64>>()
        / mass_kg
}

/// The largest of the numbers, or NaN if any of them is NaN.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| {
        if a.is_nan() || b.is_nan() {
            f64::NAN
        } else {
            a.max(b)
        }
    })
}

/// The value that is farthest from `expected`, or NaN if any value is NaN.
pub(super) fn worst(values: impl IntoIterator<Item = f64>, expected: f64) -> f64 {
    let far = |v: f64| (v - expected).abs();
    values.into_iter().fold(expected, |a: f64, b| {
        if a.is_nan() || b.is_nan() {
            f64::NAN
        } else if far(b) > far(a) {
            b
        } else {
            a
        }
    })
}

/// A start at rest.
pub(super) fn at_rest(position_world_m: Vector3<f64>, turn: UnitQuaternion<f64>) -> Start {
    moving(position_world_m, turn, Vector3::zeros(), Vector3::zeros())
}

/// A start in motion.
pub(super) fn moving(
    position_world_m: Vector3<f64>,
    orientation_world_from_body: UnitQuaternion<f64>,
    velocity_world_m_s: Vector3<f64>,
    angular_velocity_body_rad_s: Vector3<f64>,
) -> Start {
    Start::State(State {
        position_world_m,
        orientation_world_from_body,
        velocity_world_m_s,
        angular_velocity_body_rad_s,
    })
}

/// The experiment without gravity, its floor out of reach.
pub(super) fn weightless(mut experiment: Experiment) -> Experiment {
    experiment.gravity_m_s2 = 0.0;
    experiment.floor.height_m = ABYSS_M;
    experiment
}
