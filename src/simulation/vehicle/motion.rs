//! Epoch by epoch: drive, look, turn.

use std::time::Duration;

use nalgebra::{UnitQuaternion, Vector3};
use rand::RngExt as _;
use rand_distr::StandardNormal;

use super::Vehicle;
use super::drive::{Drive, EPOCH_S};
use super::sense::Eye;
use crate::error::Result;
use crate::random::{Generator, Numbered};
use crate::simulation::experiment::Experiment;
use crate::simulation::outcome::Outcome;
use crate::simulation::run::Run;
use crate::trajectory::Trajectory;

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Doing {
    /// Straight ahead.
    Forward,
    /// Decided, but still going straight until a time.
    Reacting { until_s: f64 },
    /// On by so much after a straight command.
    Coasting { left_m: f64 },
    /// Turning right by so much more.
    Turning { left_rad: f64 },
}

/// Where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pose {
    place_m: [f64; 2],
    heading_rad: f64,
}

impl Pose {
    fn at(&self, ahead_m: f64, left_m: f64) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        [
            self.place_m[0] + ahead_m * cos - left_m * sin,
            self.place_m[1] + ahead_m * sin + left_m * cos,
        ]
    }
}

/// Draws of the actuators; zeros where nothing is random.
struct Dice {
    rng: Option<Generator>,
    factor: f64,
}

impl Dice {
    fn normal(&mut self, sd: f64) -> f64 {
        let factor = self.factor;
        self.rng.as_mut().map_or(0.0, |rng| {
            factor * sd * rng.sample::<f64, _>(StandardNormal)
        })
    }
}

/// Runs a two-wheel robot.
///
/// # Errors
/// A start in a wall, a sensor whose parameters leave it without a spread.
pub(in crate::simulation) fn run(experiment: &Experiment, vehicle: &Vehicle) -> Result<Run> {
    let drive = experiment.drive.resolved();
    vehicle.sensor.check()?;
    let draw = experiment.perturbation.draw;
    let stream = |stream: Numbered| draw.map(|(seed, repeat)| stream.generator(seed, repeat));
    let mut dice = Dice {
        rng: stream(Numbered::Actuator),
        factor: drive.actuator_noise,
    };
    let eye = Eye::new(vehicle, drive, stream(Numbered::SensorReading));
    let [x, y, heading] = vehicle.arena.start.unwrap_or([0.0; 3]);
    let shift = experiment.perturbation.shift_world_m;
    // Where the tracked point starts is what is known.
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
    let start_s = drive.start_s + dice.normal_of(drive.start_sd_s);
    let (path, steps) = drive_along(
        experiment.duration_s,
        start_s,
        start,
        vehicle,
        &drive,
        dice,
        eye,
    );
    let motion = recorded(experiment, &drive, start_s, &path)?;
    Ok(Run {
        outcome: Outcome::Completed(motion),
        steps,
        settle_steps: 0,
        cpu: Duration::ZERO,
        servo_rms_rad: 0.0,
        warnings: Vec::new(),
    })
}

impl Dice {
    /// As [`Dice::normal`], of something that is no actuator.
    fn normal_of(&mut self, sd: f64) -> f64 {
        self.rng
            .as_mut()
            .map_or(0.0, |rng| sd * rng.sample::<f64, _>(StandardNormal))
    }
}

impl Dice {
    /// What follows a straight command.
    fn coast(&mut self, drive: &Drive) -> Doing {
        Doing::Coasting {
            left_m: (drive.coast_m + self.normal(drive.coast_sd_m)).max(0.0),
        }
    }
}

/// Poses at every epoch since it began to move.
fn drive_along(
    duration_s: f64,
    start_s: f64,
    start: Pose,
    vehicle: &Vehicle,
    drive: &Drive,
    mut dice: Dice,
    mut eye: Eye<'_>,
) -> (Vec<Pose>, u64) {
    let epochs = ((duration_s - start_s) / EPOCH_S).ceil().max(0.0) as usize;
    let mut pose = start;
    let mut path = Vec::with_capacity(epochs + 1);
    path.push(pose);
    let mut doing = Doing::Forward;
    pose.heading_rad += drive.drift_offset_rad + dice.normal(drive.drift_sd_rad);
    for epoch in 0..epochs {
        let time_s = EPOCH_S * epoch as f64;
        let mut ahead_m = drive.speed_m_s * EPOCH_S;
        match doing {
            Doing::Forward => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if eye.is_near(time_s, pose.place_m, pose.heading_rad) == Some(true) {
                    doing = if drive.reaction_s > 0.0 {
                        Doing::Reacting {
                            until_s: time_s + drive.reaction_s,
                        }
                    } else {
                        dice.coast(drive)
                    };
                }
            }
            Doing::Reacting { until_s } => {
                pose.heading_rad += drive.drift_rad_s * EPOCH_S;
                if time_s >= until_s - 1e-9 {
                    doing = dice.coast(drive);
                }
            }
            Doing::Coasting { left_m } => {
                ahead_m = ahead_m.min(left_m);
                doing = if left_m > ahead_m {
                    Doing::Coasting {
                        left_m: left_m - ahead_m,
                    }
                } else {
                    let turn_rad =
                        drive.turn_rate_rad_s * drive.turn_command_s + drive.turn_coast_rad;
                    Doing::Turning {
                        left_rad: (turn_rad + dice.normal(drive.turn_sd_rad)).max(0.0),
                    }
                };
            }
            Doing::Turning { left_rad } => {
                ahead_m = 0.0;
                let step_rad = (drive.turn_rate_rad_s * EPOCH_S).min(left_rad);
                pose.heading_rad -= step_rad;
                doing = if left_rad > step_rad {
                    Doing::Turning {
                        left_rad: left_rad - step_rad,
                    }
                } else {
                    eye.forget();
                    pose.heading_rad += drive.drift_offset_rad + dice.normal(drive.drift_sd_rad);
                    Doing::Forward
                };
            }
        }
        let next = Pose {
            place_m: pose.at(ahead_m, 0.0),
            ..pose
        };
        // It pushes nothing: where it would run into a wall, its wheels slip.
        if ahead_m > 0.0 && vehicle.arena.clearance_m(next.place_m) >= 0.0 {
            pose = next;
        }
        path.push(pose);
    }
    (path, epochs as u64)
}

/// What the pictures show, at the times that are asked for: straight lines between pictures.
fn recorded(
    experiment: &Experiment,
    drive: &Drive,
    start_s: f64,
    path: &[Pose],
) -> Result<Trajectory> {
    let seen_at = |time_s: f64| -> ([f64; 2], f64) {
        let moving_s = if time_s < drive.stale_s {
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
        let frame = (time_s / frame_s).floor();
        let share = time_s / frame_s - frame;
        let ((a, turn_a), (b, turn_b)) =
            (seen_at(frame * frame_s), seen_at((frame + 1.0) * frame_s));
        let mix = |a: f64, b: f64| a + share * (b - a);
        positions.push(Vector3::new(mix(a[0], b[0]), mix(a[1], b[1]), 0.0));
        orientations.push(UnitQuaternion::from_axis_angle(
            &Vector3::z_axis(),
            mix(turn_a, turn_b),
        ));
    }
    Trajectory::new(times_s, positions)?.with_orientations(orientations)
}
