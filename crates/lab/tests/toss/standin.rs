//! Simulated tosses, recorded as a real tracker would record them: with noise, a wrong length scale and late velocities.
#![allow(dead_code, reason = "not every test uses all of it")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use realgap_path::trajectory::{Reading, Recording, State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Sampling, Start, run};

pub const RATE_HZ: f64 = 148.0;

pub fn cube() -> Experiment {
    let path = crate::common::project().join("morphologies/cube.ron");
    Experiment::new(Morphology::read(path).unwrap().assemble())
}

/// The errors that the tracker adds to the truth.
pub struct Tracker {
    pub length_scale: f64,
    pub noise_m: f64,
    pub noise_rad: f64,
}

pub const EXACT: Tracker = Tracker {
    length_scale: 1.0,
    noise_m: 0.0,
    noise_rad: 0.0,
};

/// A toss: the true state at the first recorded sample, and the tracker's recording.
pub struct Toss {
    pub truth: State,
    pub recording: Recording,
}

pub fn tosses(robot: &Experiment, tracker: &Tracker, count: u64) -> Vec<Toss> {
    (0..count).map(|seed| toss(robot, tracker, seed)).collect()
}

fn toss(robot: &Experiment, tracker: &Tracker, seed: u64) -> Toss {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = |sd: f64| Vector3::from_fn(|_, _| sd * normal(&mut rng));
    // The throw is one sample earlier than the recording, so that the first recorded velocity can be a backward difference.
    let thrown = State {
        position_world_m: Vector3::new(0.0, 0.0, 0.28),
        orientation_world_from_body: UnitQuaternion::from_scaled_axis(draw(1.5)),
        velocity_world_m_s: draw(0.5),
        angular_velocity_body_rad_s: draw(6.0),
    };
    let times: Vec<f64> = (0..90).map(|k| f64::from(k) / RATE_HZ).collect();
    let mut experiment = robot.clone();
    experiment.start = Start::State(thrown);
    experiment.solver.timestep_s = 0.5 / RATE_HZ;
    experiment.duration_s = times[times.len() - 1];
    experiment.sampling = Sampling::Times(Arc::from(times.clone()));
    let truth = run(&experiment).unwrap().outcome.completed().unwrap();
    let positions: Vec<_> = truth
        .positions_world_m()
        .iter()
        .map(|p| (p + draw(tracker.noise_m)) * tracker.length_scale)
        .collect();
    let orientations: Vec<_> = truth
        .orientations_world_from_body()
        .unwrap()
        .iter()
        .map(|q| UnitQuaternion::from_scaled_axis(draw(tracker.noise_rad)) * q)
        .collect();
    let late: Vec<_> = positions
        .windows(2)
        .map(|w| (w[1] - w[0]) * RATE_HZ)
        .collect();
    let rates = truth.angular_velocities_body_rad_s().unwrap()[1..].to_vec();
    let state = State {
        position_world_m: truth.positions_world_m()[1],
        orientation_world_from_body: truth.orientations_world_from_body().unwrap()[1],
        velocity_world_m_s: truth.velocities_world_m_s().unwrap()[1],
        angular_velocity_body_rad_s: rates[0],
    };
    let trajectory = Trajectory::new(times[1..].to_vec(), positions[1..].to_vec())
        .unwrap()
        .with_orientations(orientations[1..].to_vec())
        .unwrap()
        .with_velocities(late, rates)
        .unwrap();
    Toss {
        truth: state,
        recording: Recording {
            name: format!("toss_{seed:02}"),
            path: PathBuf::from(format!("toss_{seed:02}.csv")),
            trajectory,
            log: None,
            bodies: Vec::new(),
            meta: None,
            reading: Reading::default(),
            warnings: Vec::new(),
        },
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Writes tosses into a folder and returns the glob that finds them.
pub fn write(folder: &Path, tosses: &[Toss]) -> String {
    for toss in tosses {
        let path = folder.join(&toss.recording.path);
        realgap_path::trajectory::write(path, &toss.recording.trajectory).unwrap();
    }
    folder.join("toss_*.csv").to_string_lossy().into_owned()
}

/// The shipped study of the tosses.
pub fn study() -> PathBuf {
    crate::common::project().join("sweeps/cube_toss_fit.ron")
}
