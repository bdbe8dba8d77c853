//! Logs of poses and scans, read from CSV with one column for each beam or from CARMEN's text format.

use std::path::Path;

use nalgebra::Vector3;

use crate::graph::angle::wrapped;
use realgap_core::error::{Error, Result};
use realgap_core::file::{LogTable, read_log_text};
use realgap_core::statistics::median;
use realgap_core::unit::LengthUnit;
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::{self, Interpolator};

/// One scan with the pose at which it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Time, seconds.
    pub time_s: f64,
    /// Position in the world, metres.
    pub position_world_m: [f64; 2],
    /// Heading, radians, counter-clockwise from +x of the world.
    pub heading_rad: f64,
    /// One range for each beam, metres; `None` if the beam did not return.
    pub ranges_m: Vec<Option<f64>>,
}

/// Scans along a path, in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanLog {
    /// Direction of each beam, radians, counter-clockwise from straight ahead, in (−π, π].
    pub beams_rad: Vec<f64>,
    /// The scans.
    pub scans: Vec<Scan>,
}

const HINT: &str = "a log of scans has the columns t_s, x_m, y_m, heading_rad and a range for every beam, range_000_m, range_002_m … in degrees \
     counter-clockwise from straight ahead; or it is a CARMEN log with FLASER lines";

impl ScanLog {
    /// Reads a log in CSV, or in CARMEN's format if the first lines are in that format.
    ///
    /// # Errors
    /// A missing file, missing columns, poses that are not numbers, negative ranges, decreasing times, no scans.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(path, &read_log_text(path)?)
    }

    /// Parses a log from a text; errors name it by `path`.
    ///
    /// # Errors
    /// As [`ScanLog::read`].
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let path = path.as_ref();
        let is_carmen = text.lines().take(200).any(|line| {
            ["FLASER ", "ODOM ", "PARAM ", "# CARMEN"]
                .iter()
                .any(|start| line.starts_with(start))
        });
        let log = if is_carmen {
            carmen(path, text)?
        } else {
            csv(path, text, true)?
        };
        log.checked(path)
    }

    /// Reads a CSV log of scans whose poses are in a trajectory file (TUM text or CSV) with the same clock. Scans outside of the
    /// times of the trajectory are left out, with a warning.
    ///
    /// # Errors
    /// As [`ScanLog::read`]; a trajectory without orientations; no scan within its times.
    pub fn read_with_poses(
        path: impl AsRef<Path>,
        poses: impl AsRef<Path>,
    ) -> Result<(Self, Option<Warning>)> {
        let (path, poses) = (path.as_ref(), poses.as_ref());
        let motion = trajectory::read(poses, LengthUnit::Metre)?.trajectory;
        if motion.orientations_world_from_body().is_none() {
            return Err(Error::invalid("poses of a scanner need orientations")
                .at_file(poses)
                .hint("columns qw, qx, qy, qz, or TUM text"));
        }
        let mut log = csv(path, &read_log_text(path)?, false)?;
        let times_s = motion.times_s();
        let (first_s, last_s) = (times_s[0], times_s[times_s.len() - 1]);
        let all = log.scans.len();
        let ends_s = log
            .scans
            .first()
            .zip(log.scans.last())
            .map(|(a, b)| (a.time_s, b.time_s));
        log.scans
            .retain(|scan| (first_s..=last_s).contains(&scan.time_s));
        let mut along = Interpolator::new(&motion);
        for scan in &mut log.scans {
            let since_s = scan.time_s - first_s;
            let at = along.position_world_m(since_s);
            let turn = along.orientation_world_from_body(since_s);
            scan.position_world_m = [at.x, at.y];
            scan.heading_rad = turn.map_or(0.0, |turn| {
                let ahead = turn * Vector3::x();
                libm::atan2(ahead.y, ahead.x)
            });
        }
        if let (Some((from, to)), true) = (ends_s, log.scans.is_empty()) {
            return Err(Error::invalid("no scan lies within the times of the poses")
                .at_file(path)
                .field("t_s")
                .found(format!("{from} to {to} s"))
                .allowed(format!("{first_s} to {last_s} s"))
                .hint("both files must have the same clock"));
        }
        let warning = (log.scans.len() < all).then(|| {
            Code::ScansWithoutPose.warning(format!(
                "{} of {all} scans lie outside of the times of the poses and are left out",
                all - log.scans.len()
            ))
        });
        Ok((log.checked(path)?, warning))
    }

    fn checked(self, path: &Path) -> Result<Self> {
        if self.scans.is_empty() {
            return Err(Error::invalid("the log has no scans")
                .at_file(path)
                .hint(HINT));
        }
        Ok(self)
    }

    /// The scans between two shares (0 to 1) of the log: a part of the path.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let count = self.scans.len();
        let at = |share: f64| ((share * count as f64).round() as usize).min(count);
        self.with_scans(self.scans[at(from)..at(to)].to_vec())
    }

    fn with_scans(&self, scans: Vec<Scan>) -> Self {
        Self {
            beams_rad: self.beams_rad.clone(),
            scans,
        }
    }

    /// A log of the scans for which `keep` is true.
    pub(super) fn kept(&self, keep: &[bool]) -> Self {
        let scans = self.scans.iter().zip(keep).filter(|(_, keep)| **keep);
        self.with_scans(scans.map(|(scan, _)| scan.clone()).collect())
    }

    /// The same scans, each with the pose of `lag_s` before it. Poses between those of the log are interpolated linearly; before the
    /// first and after the last scan the pose is constant.
    pub fn with_lag(&self, lag_s: f64) -> Self {
        let pose_at = |time_s: f64| {
            let after = self.scans.partition_point(|scan| scan.time_s <= time_s);
            let a = &self.scans[after.saturating_sub(1)];
            let b = &self.scans[after.min(self.scans.len() - 1)];
            let share = if b.time_s > a.time_s {
                (time_s - a.time_s) / (b.time_s - a.time_s)
            } else {
                0.0
            };
            let along = |axis: usize| {
                let (from, to) = (a.position_world_m[axis], b.position_world_m[axis]);
                from + share * (to - from)
            };
            let turn = wrapped(b.heading_rad - a.heading_rad);
            ([along(0), along(1)], wrapped(a.heading_rad + share * turn))
        };
        let scans = self.scans.iter().map(|scan| {
            let (position_world_m, heading_rad) = pose_at(scan.time_s - lag_s);
            Scan {
                position_world_m,
                heading_rad,
                ..scan.clone()
            }
        });
        self.with_scans(scans.collect())
    }

    /// Whether the beams cover all directions, with gaps below 0.5 rad.
    pub fn is_all_round(&self) -> bool {
        let mut beams = self.beams_rad.clone();
        beams.sort_by(f64::total_cmp);
        let widest = beams.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        let across = beams
            .first()
            .zip(beams.last())
            .map_or(f64::MAX, |(a, b)| a + std::f64::consts::TAU - b);
        widest.max(across) < 0.5
    }

    /// Median range of a scan's beams in a segment of width `width_rad` about a direction relative to straight ahead; `None` if no
    /// beam of the segment returned. The lower edge belongs to the segment, the upper edge does not.
    pub fn median_m(&self, scan: &Scan, centre_rad: f64, width_rad: f64) -> Option<f64> {
        let ranges: Vec<f64> = self
            .beams_rad
            .iter()
            .zip(&scan.ranges_m)
            .filter(|(beam, _)| {
                let off = wrapped(*beam - centre_rad);
                off >= -0.5 * width_rad - 1e-9 && off < 0.5 * width_rad - 1e-9
            })
            .filter_map(|(_, range)| *range)
            .collect();
        (!ranges.is_empty()).then(|| median(&ranges))
    }
}

fn csv(path: &Path, text: &str, has_poses: bool) -> Result<ScanLog> {
    let table = LogTable::parse(path, text)?;
    let time = table.require("t_s", HINT)?;
    let pose = if has_poses {
        let [x, y, heading] = ["x_m", "y_m", "heading_rad"].map(|name| table.require(name, HINT));
        Some((x?, y?, heading?))
    } else {
        None
    };
    let beams: Vec<(usize, f64)> = table
        .header()
        .iter()
        .enumerate()
        .filter_map(|(column, name)| {
            let degrees = name
                .strip_prefix("range_")?
                .strip_suffix("_m")?
                .parse::<f64>()
                .ok()?;
            Some((column, wrapped(degrees.to_radians())))
        })
        .collect();
    if beams.is_empty() {
        return Err(Error::invalid("the log has no ranges")
            .at_file(path)
            .at_line(1, 1)
            .hint(HINT));
    }
    let mut scans: Vec<Scan> = Vec::with_capacity(table.row_count());
    for row in 0..table.row_count() {
        let time_s = table.number(row, time)?;
        if scans.last().is_some_and(|last| last.time_s > time_s) {
            let error = Error::invalid("times must not decrease")
                .field("t_s")
                .found(time_s);
            return Err(table.at(row, error));
        }
        let range = |&(column, _): &(usize, f64)| -> Result<Option<f64>> {
            let range = table.optional(row, column)?;
            match range {
                Some(range) if range < 0.0 => {
                    let error = Error::invalid("a range cannot be negative")
                        .field(&table.header()[column])
                        .found(range)
                        .allowed("0 or more; an empty cell if the beam did not return");
                    Err(table.at(row, error))
                }
                // Scanners report 0 if a beam does not return.
                range => Ok(range.filter(|r| *r > 0.0)),
            }
        };
        let (position_world_m, heading_rad) = match pose {
            Some((x, y, heading)) => (
                [table.number(row, x)?, table.number(row, y)?],
                wrapped(table.number(row, heading)?),
            ),
            None => ([0.0; 2], 0.0),
        };
        scans.push(Scan {
            time_s,
            position_world_m,
            heading_rad,
            ranges_m: beams.iter().map(range).collect::<Result<_>>()?,
        });
    }
    Ok(ScanLog {
        beams_rad: beams.iter().map(|(_, angle)| *angle).collect(),
        scans,
    })
}

/// In a CARMEN log, ranges from this value on mean that the beam did not return, metres.
const CARMEN_NOTHING_M: f64 = 80.0;

/// `FLASER n r_1 … r_n x y θ odom_x odom_y odom_θ time host time`: a front laser over 180°, with its pose.
fn carmen(path: &Path, text: &str) -> Result<ScanLog> {
    let mut beams_rad: Vec<f64> = Vec::new();
    let mut scans = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let Some(rest) = line.strip_prefix("FLASER ") else {
            continue;
        };
        let wrong = |what: &str| {
            Error::invalid(what.to_owned())
                .at_file(path)
                .at_line(index + 1, 1)
        };
        let words: Vec<&str> = rest.split_whitespace().collect();
        let count: usize = words
            .first()
            .and_then(|word| word.parse().ok())
            .filter(|n| (2..=100_000).contains(n))
            .ok_or_else(|| wrong("a FLASER line begins with its number of beams"))?;
        let numbers: Vec<f64> = words[1..]
            .iter()
            .take(count + 7)
            .filter_map(|word| word.parse().ok())
            .filter(|v: &f64| v.is_finite())
            .collect();
        if numbers.len() < count + 7 {
            return Err(wrong(
                "a FLASER line ends too early or contains a word that is not a number",
            )
            .allowed("n, n ranges, x y θ, odometry x y θ, a time"));
        }
        if beams_rad.is_empty() {
            // Beams are listed from right to left. With 180 or 360 beams, the outermost beams are half a step inside of ±90°; with
            // 181 or 361 beams, they are at ±90°.
            let step = if count % 2 == 1 {
                180.0 / (count - 1) as f64
            } else {
                180.0 / count as f64
            };
            let half = if count % 2 == 1 { 0.0 } else { 0.5 * step };
            beams_rad = (0..count)
                .map(|k| (-90.0 + half + step * k as f64).to_radians())
                .collect();
        } else if beams_rad.len() != count {
            return Err(wrong("scans of one log must have the same number of beams")
                .found(count)
                .allowed(beams_rad.len()));
        }
        let (ranges, pose) = numbers.split_at(count);
        scans.push(Scan {
            time_s: pose[6],
            position_world_m: [pose[0], pose[1]],
            heading_rad: wrapped(pose[2]),
            ranges_m: ranges
                .iter()
                .map(|r| (*r > 0.0 && *r < CARMEN_NOTHING_M).then_some(*r))
                .collect(),
        });
    }
    Ok(ScanLog { beams_rad, scans })
}
