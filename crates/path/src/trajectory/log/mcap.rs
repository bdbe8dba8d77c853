//! The file format MCAP, which ROS 2 and Foxglove record.

use std::path::Path;

use serde_json::json;

use super::stream::{self, Log, Said};
use crate::trajectory::csv::Csv;
use crate::trajectory::format::{Decoded, Format, Parsed, Rendered, beyond_poses, not_written};
use crate::trajectory::relabel::relabelled;
use crate::trajectory::{Reading, Trajectory};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::file::{McapWriter, Topic, read_limited, read_mcap, read_thin_mcap, stamp};
use realgap_core::warning::Warning;

/// The files that ROS 2 and Foxglove record (<https://mcap.dev>).
///
/// It reads messages of ROS 2 encoded in CDR (`PoseStamped`, `PoseWithCovarianceStamped`, `Odometry`, `TransformStamped`, `TFMessage`,
/// `Path`; joints of `JointState` and `JointTrajectoryControllerState`; commands of `JointTrajectory`, `Float64MultiArray` and `Twist`; sensors
/// of `Imu` and `WrenchStamped`), those of ROS 1 in files that were converted, and messages of Foxglove in JSON (`PoseInFrame`, `FrameTransform`, `FrameTransforms`). If a file holds poses of several objects, the
/// reading's `topic` and `child_frame` select one. Times are those in the messages, or the times of recording if the messages have none.
/// The velocities of `Odometry` are in the body frame and are rotated into the world frame; velocities that are all 0 count as not
/// recorded, and so does an orientation that is 0 everywhere. Chunks may be compressed with zstd or lz4.
///
/// It writes `PoseInFrame` messages in JSON on the topic `/pose`, which cannot hold velocities, joints or the fact that z is unknown, and
/// whose times are whole nanoseconds from 0.
#[derive(Debug, Clone, Copy)]
pub struct Mcap;

/// Topic and frame of the written messages.
const TOPIC: &str = "/pose";
const FRAME: &str = "world";
/// Of files beyond this size, bytes, only the messages that may be read are taken into memory: most of such a file are pictures.
pub(super) const LARGE: u64 = 32_000_000;

/// The settings of `reading` that concern a log after its conversion into a table.
pub(super) fn applied(reading: &Reading) -> Reading {
    Reading {
        topic: reading.topic.clone(),
        command_topic: reading.command_topic.clone(),
        unitless: reading.unitless.clone(),
        child_frame: reading.child_frame.clone(),
        crop: reading.crop,
        sort: reading.sort,
        split: reading.split,
        skip_lost: reading.skip_lost,
        axes: reading.axes,
        floor_leans: reading.floor_leans,
        ..Reading::default()
    }
}

/// The settings of `reading` that rename columns of the table; lists are those of topics, which have names already.
pub(super) fn renamed(reading: &Reading) -> Reading {
    Reading {
        names: reading.names.clone(),
        wheels: reading.wheels.clone(),
        ..Reading::default()
    }
}

impl Format for Mcap {
    constant_methods! {
        name: &'static str = "mcap";
        doc: &'static str = "MCAP: poses, odometry, transforms, a path or joints among the messages of ROS or Foxglove";
        extensions: &'static [&'static str] = &["mcap"];
    }

    fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let is_large =
            std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() > LARGE);
        match is_large {
            true => read_thin_mcap(path, limit, &|channel| {
                stream::is_read(&channel.encoding, &channel.schema)
            }),
            false => read_limited(path, limit, "trajectory"),
        }
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let mut log = Log::new(reading);
        read_mcap(&bytes, &mut |message| {
            let channel = message.channel;
            let said = Said {
                topic: &channel.topic,
                kind: &channel.schema,
            };
            let log_ns = i64::try_from(message.log_time_ns).unwrap_or(0);
            log.message(said, &channel.encoding, log_ns, message.data)
        })?;
        let decoded = log.table()?;
        Ok(Decoded {
            text: relabelled(decoded.text, &renamed(reading))?,
            warnings: decoded.warnings,
        })
    }

    fn applied(&self, _text: &str, reading: &Reading) -> Reading {
        applied(reading)
    }

    fn is_table(&self) -> bool {
        true
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, &applied(reading))
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, &applied(reading))
    }

    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        let (times_ns, warnings) = whole_nanoseconds(trajectory);
        let mut lost = beyond_poses("MCAP files", trajectory);
        lost.extend(warnings);
        let mut file = McapWriter::new(vec![Topic::Pose(TOPIC.to_owned())]);
        for (time_ns, (_, p, q)) in times_ns.iter().zip(trajectory.poses()) {
            let message = json!({
                "timestamp": stamp(*time_ns),
                "frame_id": FRAME,
                "pose": {
                    "position": { "x": p.x, "y": p.y, "z": p.z },
                    "orientation": { "x": q.i, "y": q.j, "z": q.k, "w": q.w },
                },
            });
            file.message(0, *time_ns, &message);
        }
        Ok(Rendered {
            bytes: file.finish(),
            warnings: lost,
        })
    }
}

/// The times as whole nanoseconds from 0, and warnings about times that were changed by this.
pub(super) fn whole_nanoseconds(trajectory: &Trajectory) -> (Vec<u64>, Vec<Warning>) {
    let times_s = trajectory.times_s();
    let shift_s = (-times_s[0]).max(0.0);
    let times_ns: Vec<u64> = (times_s.iter())
        .map(|time_s| ((time_s + shift_s) * 1e9).round() as u64)
        .collect();
    let mut warnings = Vec::new();
    if shift_s > 0.0 {
        let what = "times before 0; all are moved until the first is 0";
        warnings.push(not_written("MCAP files", what));
    }
    let is_whole = |(time_ns, time_s): (&u64, &f64)| *time_ns as f64 * 1e-9 == *time_s + shift_s;
    if !times_ns.iter().zip(times_s).all(is_whole) {
        let what = "times finer than a nanosecond; they are rounded";
        warnings.push(not_written("MCAP files", what));
    }
    (times_ns, warnings)
}
