//! Simulates a robot that logs scans in an arena: on a random walk, as in paper 001 for its sensorgraph, or along a given path, as
//! in the validation runs of paper 001.

use rand::RngExt;

use super::scan::{Scan, ScanLog};
use crate::arena::Arena;
use crate::graph::angle::wrapped;
use crate::range::{Beam, RangeModel, RangeSensor, ReadingUnit};
use realgap_core::error::{Error, Result};
use realgap_core::random::{Generator, Numbered, Once};
use realgap_core::range::Range;

/// A robot with a scanner. The defaults are the values of paper 001 where it gives them, except for the time between scans.
///
/// Paper 001 has a scan every 0.25 s. With that interval, 1400 scans would take 350 s, in which a robot at 0.5 m/s does not reach
/// every part of a field of 10 x 10 m.
#[derive(Debug, Clone, PartialEq)]
pub struct Logger {
    /// Number of beams; 360 in paper 001.
    pub beams: usize,
    /// Angle of view from the rightmost to the leftmost beam, degrees; 180 in paper 001.
    pub view_deg: f64,
    /// Time from one scan to the next, seconds.
    pub interval_s: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Rate of a turn, rad/s.
    pub turn_rate_rad_s: f64,
    /// Radius of the robot, metres.
    pub radius_m: f64,
    /// In a random walk, the robot turns if an obstacle ahead is nearer than this, metres.
    pub avoid_m: f64,
    /// In a random walk, the robot turns by a random angle after driving straight ahead for this time, seconds.
    pub turn_every_s: f64,
}

impl Default for Logger {
    fn default() -> Self {
        Self {
            beams: 360,
            view_deg: 180.0,
            interval_s: 1.0,
            speed_m_s: 0.5,
            turn_rate_rad_s: 1.5,
            radius_m: 0.3,
            avoid_m: 0.6,
            turn_every_s: 8.0,
        }
    }
}

/// Largest number of scans of a log, and largest number of readings.
const MOST_SCANS: usize = 100_000;
const MOST_READINGS: usize = 20_000_000;
/// Interval at which a random walk checks for obstacles ahead, seconds, and number of beams for this check.
const EPOCH_S: f64 = 0.1;
const LOOKS: usize = 9;
/// Half angle ahead of the robot in which a random walk avoids obstacles, radians.
const AHEAD_RAD: f64 = 0.6;
/// Ranges are written in whole millimetres.
const MILLIMETRES: f64 = 1e3;

/// Position and heading of the robot.
#[derive(Debug, Clone, Copy)]
struct Pose {
    place_m: [f64; 2],
    heading_rad: f64,
}

impl Pose {
    fn ahead(self, by_m: f64) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        [self.place_m[0] + by_m * cos, self.place_m[1] + by_m * sin]
    }
}

impl Logger {
    /// Logs `scans` scans on a random walk from the arena's start (its middle if it has no start). The robot drives straight ahead,
    /// turns away from near obstacles, and turns by a random angle from time to time.
    ///
    /// # Errors
    /// Numbers out of range, a start in a wall, a sensor whose readings are not lengths.
    pub fn walk(
        &self,
        arena: &Arena,
        sensor: &RangeModel,
        scans: usize,
        seed: u64,
    ) -> Result<ScanLog> {
        self.check(sensor, scans)?;
        let [width, depth] = arena.size_m;
        let [x, y, heading_rad] = arena.start.unwrap_or([0.5 * width, 0.5 * depth, 0.0]);
        arena.check_place([x, y], self.radius_m)?;
        let mut rng = Once::RandomWalk.generator(seed);
        let mut pose = Pose {
            place_m: [x, y],
            heading_rad,
        };
        let epochs = (self.interval_s / EPOCH_S).round().max(1.0) as usize;
        let epoch_s = self.interval_s / epochs as f64;
        let (mut left_rad, mut since_s) = (0.0_f64, 0.0);
        let mut log = self.empty_log();
        while log.scans.len() < scans {
            log.scans
                .push(self.scan(arena, sensor, pose, log.scans.len(), seed));
            for _ in 0..epochs {
                if left_rad == 0.0 {
                    since_s += epoch_s;
                    let next_m = pose.ahead(self.speed_m_s * epoch_s);
                    let (near_m, _) = free_distance_m(arena, pose, -AHEAD_RAD, AHEAD_RAD);
                    if near_m < self.avoid_m || arena.check_place(next_m, self.radius_m).is_err() {
                        left_rad = away(arena, pose, &mut rng);
                    } else if since_s >= self.turn_every_s {
                        left_rad = std::f64::consts::PI * (2.0 * rng.random::<f64>() - 1.0);
                    } else {
                        pose.place_m = next_m;
                    }
                }
                if left_rad != 0.0 {
                    let most = self.turn_rate_rad_s * epoch_s;
                    let step = left_rad.clamp(-most, most);
                    pose.heading_rad += step;
                    left_rad -= step;
                    since_s = 0.0;
                }
            }
        }
        Ok(log)
    }

    /// Logs scans along straight lines from point to point; the robot turns on the spot where two lines meet.
    ///
    /// # Errors
    /// The errors of [`Logger::walk`], fewer than two points, a path through a wall, more than 100 000 scans.
    pub fn follow(
        &self,
        arena: &Arena,
        sensor: &RangeModel,
        way_m: &[[f64; 2]],
        seed: u64,
    ) -> Result<ScanLog> {
        let direction = |pair: &[[f64; 2]]| {
            let [dx, dy] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            (libm::atan2(dy, dx), dx.hypot(dy))
        };
        let [first, second, ..] = way_m else {
            return Err(Error::invalid("a path needs two or more places")
                .field("way")
                .found(way_m.len()));
        };
        self.check(sensor, 1)?;
        let mut pose = Pose {
            place_m: *first,
            heading_rad: direction(&[*first, *second]).0,
        };
        let mut log = self.empty_log();
        let mut take = |pose: Pose| -> Result<()> {
            if arena.check_place(pose.place_m, self.radius_m).is_err() {
                let [x, y] = pose.place_m;
                return Err(
                    Error::invalid("the path leads through a wall, or out of the field")
                        .field("way")
                        .found(format!(
                            "({x:.3}, {y:.3}) m, {:.3} m from the nearest wall",
                            arena.clearance_m(pose.place_m)
                        ))
                        .allowed(format!("{} m or more from every wall", self.radius_m)),
                );
            }
            if log.scans.len() >= MOST_SCANS || (log.scans.len() + 1) * self.beams > MOST_READINGS {
                return Err(Error::invalid("the path is too long for one log")
                    .field("way")
                    .allowed(format!("at most {MOST_SCANS} scans")));
            }
            let index = log.scans.len();
            log.scans.push(self.scan(arena, sensor, pose, index, seed));
            Ok(())
        };
        for pair in way_m.windows(2) {
            let (towards, length_m) = direction(pair);
            let turn = wrapped(towards - pose.heading_rad);
            let steps = (turn.abs() / (self.turn_rate_rad_s * self.interval_s)).ceil() as usize;
            let from_rad = pose.heading_rad;
            for step in 1..=steps {
                pose.heading_rad = from_rad + turn * step as f64 / steps as f64;
                take(pose)?;
            }
            pose.heading_rad = towards;
            let steps = (length_m / (self.speed_m_s * self.interval_s)).ceil() as usize;
            for step in 0..steps {
                pose.place_m = pair[0];
                pose.place_m = pose.ahead(length_m * step as f64 / steps as f64);
                take(pose)?;
            }
        }
        Ok(log)
    }

    /// Checks the settings of the robot and its sensor for a log of `scans` scans.
    ///
    /// # Errors
    /// Numbers out of range, a sensor whose readings are not lengths.
    pub fn check(&self, sensor: &RangeModel, scans: usize) -> Result<()> {
        let (scans, beams) = (scans as f64, self.beams as f64);
        for (field, found, low, high, unit) in [
            ("beams", beams, 2.0, 100_000.0, ""),
            ("view", self.view_deg, 1.0, 360.0, "degrees"),
            ("interval", self.interval_s, 0.001, 1e3, "s"),
            ("speed", self.speed_m_s, 1e-3, 100.0, "m/s"),
            ("turn rate", self.turn_rate_rad_s, 1e-3, 1e3, "rad/s"),
            ("radius", self.radius_m, 0.0, 100.0, "m"),
            ("avoid", self.avoid_m, 0.0, 1e3, "m"),
            ("turn every", self.turn_every_s, 0.001, 1e6, "s"),
            ("samples", scans, 1.0, MOST_SCANS as f64, ""),
            (
                "samples x beams",
                scans * beams,
                1.0,
                MOST_READINGS as f64,
                "",
            ),
        ] {
            Range::within(low, high, unit).check(found, field)?;
        }
        match sensor.reading_unit {
            ReadingUnit::Length(_) => Ok(()),
            ReadingUnit::Own(_) => Err(Error::invalid(
                "a scanner needs a sensor whose readings are lengths",
            )
            .field("reading_unit")
            .found(format!(
                "a unit of its own, \"{}\"",
                sensor.reading_unit.symbol()
            ))
            .hint("take a model whose reading_unit is a Length, e.g. `laser`")),
        }
    }

    /// A log without scans, with the directions of the beams from right to left.
    fn empty_log(&self) -> ScanLog {
        let step_deg = self.view_deg / self.beams as f64;
        let degrees = |k: usize| -0.5 * self.view_deg + step_deg * k as f64;
        ScanLog {
            beams_rad: (0..self.beams)
                .map(|k| wrapped(degrees(k).to_radians()))
                .collect(),
            scans: Vec::new(),
        }
    }

    fn scan(
        &self,
        arena: &Arena,
        sensor: &RangeModel,
        pose: Pose,
        index: usize,
        seed: u64,
    ) -> Scan {
        let mut rng = Numbered::SensorReading.generator(seed, index as u64);
        let unit_m = match sensor.reading_unit {
            ReadingUnit::Length(unit) => unit.metres(),
            ReadingUnit::Own(_) => 1.0,
        };
        let (_, far_m) = sensor.range_m();
        let range = |beam_rad: f64| {
            let hit = arena.cast(pose.place_m, pose.heading_rad + beam_rad)?;
            let beam = Beam {
                distance_m: hit.distance_m,
                incidence_rad: hit.incidence_rad,
                offset_rad: 0.0,
            };
            // A reading is drawn for every hit, even if it is discarded below, so that the random numbers of the other beams do
            // not depend on it.
            let reading = sensor.draw(&beam, &mut rng)?;
            let range_m = (reading * unit_m * MILLIMETRES).round() / MILLIMETRES;
            (hit.distance_m <= far_m && range_m > 0.0).then_some(range_m)
        };
        Scan {
            time_s: self.interval_s * index as f64,
            position_world_m: pose.place_m,
            heading_rad: wrapped(pose.heading_rad),
            ranges_m: self.empty_log().beams_rad.into_iter().map(range).collect(),
        }
    }
}

/// Distance to the nearest obstacle between two directions from straight ahead, and the mean distance to obstacles there; metres.
fn free_distance_m(arena: &Arena, pose: Pose, from_rad: f64, to_rad: f64) -> (f64, f64) {
    let [width, depth] = arena.size_m;
    let beam = |k: usize| {
        let share = k as f64 / (LOOKS - 1) as f64;
        let direction = pose.heading_rad + from_rad + share * (to_rad - from_rad);
        arena
            .cast(pose.place_m, direction)
            .map_or(width + depth, |hit| hit.distance_m)
    };
    let seen: [f64; LOOKS] = std::array::from_fn(beam);
    let nearest = seen.iter().copied().fold(f64::INFINITY, f64::min);
    (nearest, seen.iter().sum::<f64>() / LOOKS as f64)
}

/// A turn of 60° to 180° to the side on which the mean distance to obstacles is larger.
fn away(arena: &Arena, pose: Pose, rng: &mut Generator) -> f64 {
    let free_m = |side: f64| free_distance_m(arena, pose, side * 0.1, side * 1.5).1;
    let angle = std::f64::consts::PI * (1.0 + 2.0 * rng.random::<f64>()) / 3.0;
    if free_m(1.0) >= free_m(-1.0) {
        angle
    } else {
        -angle
    }
}

impl ScanLog {
    /// The log that ideal beams would give at the same poses in an arena.
    #[must_use]
    pub(crate) fn cast_in(&self, arena: &Arena) -> Self {
        let scans = self.scans.iter().map(|scan| Scan {
            ranges_m: self
                .beams_rad
                .iter()
                .map(|beam| {
                    let hit = arena.cast(scan.position_world_m, scan.heading_rad + beam)?;
                    Some(hit.distance_m)
                })
                .collect(),
            ..scan.clone()
        });
        Self {
            beams_rad: self.beams_rad.clone(),
            scans: scans.collect(),
        }
    }

    /// The log as CSV, as [`ScanLog::read`] reads it.
    pub fn to_csv(&self) -> String {
        use std::fmt::Write as _;
        let mut text = String::from("t_s,x_m,y_m,heading_rad");
        for beam in &self.beams_rad {
            let degrees = (beam.to_degrees() * 1e6).round() / 1e6;
            let _ = write!(text, ",range_{degrees}_m");
        }
        text.push('\n');
        for scan in &self.scans {
            let [x, y] = scan.position_world_m;
            let _ = write!(text, "{},{x},{y},{}", scan.time_s, scan.heading_rad);
            for range in &scan.ranges_m {
                text.push(',');
                if let Some(range) = range {
                    let _ = write!(text, "{range}");
                }
            }
            text.push('\n');
        }
        text
    }
}
