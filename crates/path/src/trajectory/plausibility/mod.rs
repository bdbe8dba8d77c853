//! Doubts: checks of a recording for common faults, each with a warning that says where, what was seen, and the remedy.
//!
//! A new doubt is one new file and one line in [`DOUBTS`]. Every doubt looks at the motion alone, so it holds for all formats.

mod coarse_encoder;
mod degrees;
mod exchanged;
mod flipped;
mod frozen;
mod interleaved;
mod lost_packets;
mod normalised;
mod obedience;
mod quaternion_order;
mod saturated;
mod scale;
mod series;
mod spike;
mod stale;
mod standstill;
mod switched_off;
mod timing;
mod upright;
mod wrapped;
mod zeros;

use super::reading::{QuaternionOrder, Reading};
use super::{Trajectory, clock};
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};

pub(super) use standstill::waits_until_s;

/// What a doubt looks at.
struct Seen<'a> {
    trajectory: &'a Trajectory,
    /// The time from which times in messages count: the start of the recording before it was cropped.
    origin_s: f64,
    /// The usual time between samples, seconds.
    interval_s: f64,
    /// The order in which quaternions were read.
    read_as: QuaternionOrder,
    /// Whether the directions of the axes are stated.
    has_axes: bool,
}

impl Seen<'_> {
    /// The time of a sample, as it is written in a message.
    fn at(&self, sample: usize) -> String {
        format!(
            "{} s",
            number(self.trajectory.times_s()[sample] - self.origin_s)
        )
    }
}

/// A check: the message about what it finds, `None` if there is no doubt.
type Doubt = fn(&Seen<'_>) -> Option<String>;

/// Every doubt about a single recording, with its code.
const DOUBTS: &[(Code, Doubt)] = &[
    (Code::UnlikelyTime, timing::unlikely_interval),
    (Code::Hole, timing::hole),
    (Code::Standstill, standstill::doubt),
    (Code::QuaternionOrder, quaternion_order::doubt),
    (Code::StaleSamples, stale::doubt),
    (Code::UnsynchronisedClocks, |seen| {
        clock::clock_fault(seen.trajectory, seen.interval_s)
    }),
    (Code::Spike, spike::doubt),
    (Code::LostAsZero, zeros::of_positions),
    (Code::JointDropout, zeros::of_joints),
    (Code::FrozenTracker, frozen::doubt),
    (Code::WrappedAngle, wrapped::doubt),
    (Code::ExchangedJoints, exchanged::doubt),
    (Code::FlippedSign, flipped::doubt),
    (Code::DegreesAsRadians, degrees::doubt),
    (Code::NormalisedAngles, normalised::doubt),
    (Code::SeveralRobots, interleaved::doubt),
    (Code::ChangedUnit, scale::doubt),
    (Code::CoarseEncoder, coarse_encoder::doubt),
    (Code::LostPackets, lost_packets::doubt),
    (Code::SaturatedCommands, saturated::doubt),
    (Code::SwitchedOff, switched_off::doubt),
    (Code::UnknownAxes, upright::doubt),
];

/// The doubts about paths that also hold for bodies beside the tracked one.
const OF_PATHS: [Code; 5] = [
    Code::Spike,
    Code::LostAsZero,
    Code::FrozenTracker,
    Code::SeveralRobots,
    Code::ChangedUnit,
];

/// Warnings about faults of this recording, whose quaternions were read in the order `read_as`.
pub(super) fn warnings(
    name: &str,
    trajectory: &Trajectory,
    reading: &Reading,
    read_as: QuaternionOrder,
) -> Vec<Warning> {
    // Times in messages count from the start of the whole recording, also if it was cropped.
    let cropped_s = reading.crop.map_or(0.0, |crop| crop.from_s);
    let seen = Seen {
        trajectory,
        origin_s: trajectory.times_s()[0] - cropped_s,
        interval_s: usual_interval_s(trajectory),
        read_as,
        has_axes: reading.axes.is_some(),
    };
    let found = DOUBTS
        .iter()
        .filter_map(|(code, doubt)| Some(code.warning(format!("{name}: {}", doubt(&seen)?))));
    found.collect()
}

/// Warnings about faults of the path of another body in a recording; its times are those of the tracked body.
pub(super) fn path_warnings(name: &str, path: &Trajectory, reading: &Reading) -> Vec<Warning> {
    // The order of quaternions is judged by the tracked body.
    let mut all = warnings(name, path, reading, QuaternionOrder::Wxyz);
    all.retain(|warning| OF_PATHS.contains(&warning.code));
    all
}

/// The usual time between samples, seconds.
pub(super) fn usual_interval_s(trajectory: &Trajectory) -> f64 {
    let times_s = trajectory.times_s();
    let mut intervals_s: Vec<f64> = times_s.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = intervals_s.len() / 2;
    *intervals_s.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The end of a message that names one of several places: how many more there are.
fn and_more(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        count => format!(" (and {} more)", count - 1),
    }
}
