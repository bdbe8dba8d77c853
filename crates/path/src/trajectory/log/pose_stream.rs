//! The poses of one object in a log, and their columns in a table.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::message::{Frames, Sample};
use super::series::Clock;
use crate::trajectory::text::{excerpt, push_number};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;

/// The poses of one object: one topic, and one pair of frames for transforms.
#[derive(Debug, Clone, Default)]
pub(super) struct Stream {
    pub(super) topic: String,
    pub(super) kind: String,
    pub(super) frames: Frames,
    pub(super) samples: Vec<Sample>,
    /// The number of poses in the log, including those that are not kept.
    pub(super) count: usize,
    /// True if each message holds a whole path.
    pub(super) is_path: bool,
}

impl Stream {
    pub(super) fn words(&self) -> String {
        let frames = match &self.frames {
            Some((parent, child)) => format!(" {} in {}", excerpt(child), excerpt(parent)),
            None => String::new(),
        };
        let (topic, kind) = (excerpt(&self.topic), excerpt(&self.kind));
        format!("{topic}{frames} ({kind}, {})", counted(self.count, "pose"))
    }

    fn has_stamps(&self) -> bool {
        self.samples.iter().any(|sample| sample.stamp_ns != 0)
    }

    /// The times of the poses, nanoseconds.
    pub(super) fn times_ns(&self) -> Vec<i64> {
        let has_stamps = self.has_stamps();
        let time = |sample: &Sample| match has_stamps {
            true => sample.stamp_ns,
            false => sample.log_ns,
        };
        self.samples.iter().map(time).collect()
    }

    pub(super) fn clock(&self) -> Clock {
        let stamps = self.samples.iter();
        Clock::of(stamps.map(|sample| (sample.stamp_ns, sample.log_ns)))
    }

    /// The names of the columns beside the time, and the cells of each row, both with a separator before each.
    pub(super) fn rows(&self) -> Result<(String, Vec<String>)> {
        let all = &self.samples;
        if self.is_path && all.len() > 1 && all.windows(2).all(|w| w[0].stamp_ns == w[1].stamp_ns) {
            return Err(
                Error::invalid("the poses of this path have no times of their own")
                    .field(&self.topic)
                    .hint("record the topic from which this path is made"),
            );
        }
        let turns = all.iter().any(|sample| sample.turn_xyzw != [0.0; 4]);
        // Programs without velocities leave these numbers at 0.
        let moves = turns && all.iter().all(|sample| sample.twist.is_some());
        let moves = moves && all.iter().any(|sample| sample.twist != Some([0.0; 6]));
        let mut names = String::from(",x_m,y_m,z_m");
        if turns {
            names.push_str(",qw,qx,qy,qz");
        }
        if moves {
            names.push_str(",vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s");
        }
        let row = |sample: &Sample| {
            let mut text = String::new();
            let [x, y, z, w] = sample.turn_xyzw;
            let turn = [w, x, y, z];
            let speeds = sample.twist.map(|twist| world_speeds(turn, twist));
            let numbers = sample.place_m.into_iter();
            let numbers = numbers.chain(turn.into_iter().filter(|_| turns));
            let speeds = speeds.into_iter().flatten().filter(|_| moves);
            for value in numbers.chain(speeds) {
                text.push(',');
                push_number(&mut text, value);
            }
            text
        };
        Ok((names, all.iter().map(row).collect()))
    }
}

/// Rotates the linear velocity of a twist from the body frame into the world frame; the angular velocity stays in the body frame.
fn world_speeds([w, x, y, z]: [f64; 4], twist: [f64; 6]) -> [f64; 6] {
    let [vx, vy, vz, wx, wy, wz] = twist;
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let linear = turn * Vector3::new(vx, vy, vz);
    [linear.x, linear.y, linear.z, wx, wy, wz]
}
