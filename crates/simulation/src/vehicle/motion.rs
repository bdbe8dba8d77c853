//! Simulation of a run of two-wheel robots in epochs, and the recording of the first robot by a camera.

use std::time::Duration;

use nalgebra::{UnitQuaternion, Vector3};

use super::Vehicle;
use super::drive::{Drive, EPOCH_S};
use super::robot::{ActuatorNoise, Pose, Robot};
use super::sense::VehicleSensor;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::run::Run;
use realgap_core::error::Result;
use realgap_core::random::Numbered;
use realgap_path::trajectory::Trajectory;

/// Runs a two-wheel robot.
///
/// # Errors
/// A start in a wall, a sensor whose parameters leave it without a spread.
pub(crate) fn run(experiment: &Experiment, vehicle: &Vehicle) -> Result<Run> {
    let drive = experiment.drive.resolved();
    vehicle.sensor.check()?;
    let draw = experiment.perturbation.draw;
    // Every robot has its own random streams, so that the first draws the same numbers as without the others.
    let parts = |index: u64| {
        let stream = |stream: Numbered| {
            draw.map(|(seed, repeat)| stream.generator(seed, repeat + (index << 40)))
        };
        let noise = ActuatorNoise {
            rng: stream(Numbered::Actuator),
            factor: drive.actuator_noise,
        };
        let streams = [Numbered::SensorReading, Numbered::FalseAlarm].map(stream);
        (noise, VehicleSensor::new(vehicle, drive, streams))
    };
    let (mut noise, sensor) = parts(0);
    let [x, y, heading] = vehicle.arena.start.unwrap_or([0.0; 3]);
    let shift = experiment.perturbation.shift_world_m;
    // The known start is that of the tracked point.
    let heading_rad = heading + experiment.perturbation.turn_world_rad.z;
    let tag = Pose {
        place_m: [x + shift.x, y + shift.y],
        heading_rad,
    };
    let start = Pose {
        place_m: tag.at(-drive.tag_ahead_m, -drive.tag_left_m),
        heading_rad,
    };
    vehicle.arena.check_place(start.place_m, 0.0)?;
    let start_s = drive.start_s + noise.normal_of(drive.start_sd_s);
    // If there are no late runs, no number is drawn here, so that the following draws stay the same.
    let is_late = drive.late_share > 0.0 && noise.happens(drive.late_share);
    let start_s = start_s + if is_late { drive.late_s } else { 0.0 };
    let taken_s = match drive.frame_sd_s > 0.0 {
        true => noise.normal_of(drive.frame_sd_s),
        false => 0.0,
    };
    let mut robots = vec![Robot::new(vehicle, &drive, start, noise, sensor)];
    for (index, [x, y, heading_rad]) in (1_u64..).zip(&vehicle.others) {
        let (noise, sensor) = parts(index);
        let start = Pose {
            place_m: [*x, *y],
            heading_rad: *heading_rad,
        };
        robots.push(Robot::new(vehicle, &drive, start, noise, sensor));
    }
    let epochs = ((experiment.duration_s - start_s) / EPOCH_S)
        .ceil()
        .max(0.0) as usize;
    let path = drive_along(epochs, vehicle, &drive, robots);
    let motion = recorded(experiment, &drive, (start_s, taken_s), &path)?;
    Ok(Run {
        outcome: Outcome::Completed(motion),
        steps: epochs as u64,
        settle_steps: 0,
        cpu: Duration::ZERO,
        servo_rms_rad: 0.0,
        energy: None,
        warnings: Vec::new(),
    })
}

/// Poses of the first robot at every epoch since the robots began to move.
fn drive_along(
    epochs: usize,
    vehicle: &Vehicle,
    drive: &Drive,
    mut robots: Vec<Robot<'_>>,
) -> Vec<Pose> {
    for epoch in 0..epochs {
        let time_s = EPOCH_S * epoch as f64;
        // All robots detect the positions of the others before this epoch, so that their order does not matter.
        let places_m: Vec<[f64; 2]> = robots.iter().map(Robot::place_m).collect();
        for (index, robot) in robots.iter_mut().enumerate() {
            let others = places_m.iter().enumerate().filter(|(k, _)| *k != index);
            let others_m: Vec<[f64; 2]> = others.map(|(_, place)| *place).collect();
            robot.step(vehicle, drive, time_s, &others_m);
        }
    }
    robots.swap_remove(0).path
}

/// The recorded trajectory at the sample times: linear interpolation between pictures, which are all shifted by the same time.
fn recorded(
    experiment: &Experiment,
    drive: &Drive,
    (start_s, taken_s): (f64, f64),
    path: &[Pose],
) -> Result<Trajectory> {
    let seen_at = |time_s: f64| -> ([f64; 2], f64) {
        let moving_s = if time_s - taken_s < drive.stale_s {
            0.0
        } else {
            (time_s - start_s).max(0.0)
        };
        let place = moving_s / EPOCH_S;
        let below = (place.floor() as usize).min(path.len() - 1);
        let above = (below + 1).min(path.len() - 1);
        let share = (place - below as f64).clamp(0.0, 1.0);
        let [a, b] = [below, above].map(|k| path[k].at(drive.tag_ahead_m, drive.tag_left_m));
        let mix = |a: f64, b: f64| a + share * (b - a);
        (
            [mix(a[0], b[0]), mix(a[1], b[1])],
            mix(path[below].heading_rad, path[above].heading_rad),
        )
    };
    let times_s = experiment.sample_times_s();
    let frame_s = 1.0 / drive.frame_rate_hz;
    let mut positions = Vec::with_capacity(times_s.len());
    let mut orientations = Vec::with_capacity(times_s.len());
    for time_s in &times_s {
        let place = (time_s - taken_s) / frame_s;
        let (frame, share) = (place.floor(), place - place.floor());
        let picture = |number: f64| seen_at(taken_s + number * frame_s);
        let ((a, turn_a), (b, turn_b)) = (picture(frame), picture(frame + 1.0));
        let mix = |a: f64, b: f64| a + share * (b - a);
        positions.push(Vector3::new(mix(a[0], b[0]), mix(a[1], b[1]), 0.0));
        orientations.push(UnitQuaternion::from_axis_angle(
            &Vector3::z_axis(),
            mix(turn_a, turn_b),
        ));
    }
    Trajectory::new(times_s, positions)?.with_orientations(orientations)
}
