//! The noise of repeats: what the study states, or else a careful noise that fits the recordings.
//!
//! Without stated noise nobody knows how repeats of the real robot differ, and a model must not be rejected for a guess. So the
//! camera's error is measured from the high frequencies of the recordings, and the errors of a careful repeat (start, servo
//! zeros) are made smaller or larger until simulated repeats are as far from each other as the recordings are.

use crate::calibration::goodness_of_fit::imitation::MeasurementNoise;
use crate::calibration::goodness_of_fit::visible_noise::VisibleNoise;
use crate::calibration::study::Study;
use crate::prediction::ensemble::{mean_distance_m, repeat};
use realgap_core::error::Result;
use realgap_core::statistics::{least_by, median};
use realgap_path::trajectory::{Interpolator, Prepared, Trajectory};
use realgap_simulation::{Camera, Distribution, Experiment, Noise};

/// Factors of the careful errors that are tried.
const FACTORS: [f64; 5] = [0.03, 0.1, 0.3, 1.0, 3.0];
/// Most repeats of each.
const REPEATS: usize = 5;
/// Numbers of these repeats, so that no other repeat has the same random numbers.
const FIRST: u64 = 1 << 32;

/// The noise by which repeats of `experiment`, a run near the recordings `real`, differ.
///
/// # Errors
/// Experiments that cannot be simulated.
pub(super) fn noise_of_repeats(
    study: &Study,
    real: &[&Prepared],
    experiment: &Experiment,
) -> Result<Noise> {
    if let Some(stated) = study.definition().noise {
        return Ok(stated);
    }
    let careful = Noise {
        camera: camera(study, experiment)?,
        ..Noise::careful_repeat()
    };
    let floor_m = mean_distance_m(real);
    let mut known: Vec<(f64, f64)> = Vec::new();
    for factor in FACTORS {
        let noise = careful.scaled(factor);
        let numbers = (0..real.len().min(REPEATS)).map(|number| FIRST + number as u64);
        let paths = numbers.map(|number| {
            let run = repeat(experiment, &noise, study.definition().seed, number)?;
            let motion = run.outcome.get();
            motion.map(|motion| study.prepared(motion)).transpose()
        });
        let paths: Vec<Prepared> = paths.filter_map(Result::transpose).collect::<Result<_>>()?;
        if paths.len() > 1 {
            known.push((factor, mean_distance_m(&paths.iter().collect::<Vec<_>>())));
        }
    }
    let off = |(_, distance_m): &(f64, f64)| libm::log(distance_m / floor_m).abs();
    let best = least_by(known, off);
    Ok(careful.scaled(best.map_or(1.0, |(factor, _)| factor)))
}

/// The camera that the recordings show; where the motion hides its errors, they are at most the recordings' high frequencies.
fn camera(study: &Study, experiment: &Experiment) -> Result<Camera> {
    let recorded = study.cases()[0].targets.iter();
    let recorded = recorded.map(|target| target.in_true_lengths(experiment.recording_length_scale));
    let recorded: Vec<Trajectory> = recorded
        .map(|target| Ok(target?.into_owned().motion))
        .collect::<Result<_>>()?;
    let run = realgap_simulation::run(experiment)?.outcome.completed();
    let at_times = |real: &Trajectory| run.as_ref().and_then(|run| sampled(run, real).ok());
    let runs: Vec<Option<Trajectory>> = recorded.iter().map(at_times).collect();
    let pairs = recorded.iter().zip(&runs);
    let pairs: Vec<_> = pairs
        .filter_map(|(real, run)| Some((real, run.as_ref()?)))
        .collect();
    let visible = MeasurementNoise::visible(&pairs, false);
    let bounds_m = recorded.iter().map(|real| {
        let axis = |axis: usize| -> Option<f64> {
            let values: Vec<f64> = real.positions_world_m().iter().map(|p| p[axis]).collect();
            VisibleNoise::at_most(real.times_s(), &values)
        };
        Some(axis(0)?.max(axis(1)?))
    });
    let bounds_m: Vec<f64> = bounds_m.flatten().collect();
    // Where the recordings have too few samples to tell the errors of their camera, a careful one is assumed.
    let careful = Camera::careful();
    let careful_m = careful.position_m.size();
    let most_m = match bounds_m.is_empty() {
        true => careful_m,
        false => median(&bounds_m).min(careful_m),
    };
    let position_m = if visible.plane_m > 0.0 {
        visible.plane_m
    } else {
        most_m
    };
    // Errors about three axes make one error about a random axis.
    let angle_rad = match visible.turn_rad > 0.0 {
        true => visible.turn_rad * 3.0_f64.sqrt(),
        false => careful.angle_rad.size() * (position_m / careful_m).min(1.0),
    };
    Ok(Camera {
        position_m: Distribution::Normal(position_m),
        angle_rad: Distribution::Normal(angle_rad),
        time_s: Distribution::default(),
    })
}

/// The run at the times of a recording.
fn sampled(run: &Trajectory, real: &Trajectory) -> Result<Trajectory> {
    let start_s = real.times_s()[0];
    let times_s: Vec<f64> = real.times_s().iter().map(|t| t - start_s).collect();
    let mut at = Interpolator::new(run);
    let places = times_s.iter().map(|t| at.position_world_m(*t)).collect();
    let turns = times_s.iter().map(|t| at.orientation_world_from_body(*t));
    let turns: Option<Vec<_>> = turns.collect();
    let sampled = Trajectory::new(times_s.clone(), places)?;
    match turns {
        Some(turns) => sampled.with_orientations(turns),
        None => Ok(sampled),
    }
}
