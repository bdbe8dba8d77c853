//! Decodes messages of ROS 2 that hold poses.

use super::cdr::Cdr;
use super::message::{Content, Frames, Kinds, Sample};

/// The kind of a message, by the name of its type, e.g. `geometry_msgs/msg/PoseStamped`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Pose,
    Odometry,
    Transform,
    Transforms,
    Path,
}

/// The names of message types in ROS 2.
pub(super) const KINDS: Kinds<Kind> = Kinds(&[
    ("geometry_msgs/msg/PoseStamped", Kind::Pose),
    // The covariance follows after the pose and is ignored.
    ("geometry_msgs/msg/PoseWithCovarianceStamped", Kind::Pose),
    ("nav_msgs/msg/Odometry", Kind::Odometry),
    ("geometry_msgs/msg/TransformStamped", Kind::Transform),
    ("tf2_msgs/msg/TFMessage", Kind::Transforms),
    ("nav_msgs/msg/Path", Kind::Path),
]);

/// Decodes a header: its time, nanoseconds, and its frame.
fn header(cdr: &mut Cdr<'_>) -> Option<(i64, String)> {
    let seconds = i64::from(cdr.i32()?);
    let stamp_ns = seconds * 1_000_000_000 + i64::from(cdr.u32()?);
    Some((stamp_ns, cdr.text()?))
}

fn pose(cdr: &mut Cdr<'_>, stamp_ns: i64, log_ns: i64) -> Option<Sample> {
    Some(Sample {
        stamp_ns,
        log_ns,
        place_m: cdr.numbers()?,
        turn_xyzw: cdr.numbers()?,
        twist: None,
    })
}

fn transform(cdr: &mut Cdr<'_>, log_ns: i64) -> Option<(Frames, Sample)> {
    let (stamp_ns, parent) = header(cdr)?;
    let child = cdr.text()?;
    Some((Some((parent, child)), pose(cdr, stamp_ns, log_ns)?))
}

/// Decodes the poses of a message; `None` if the message is incomplete.
pub(super) fn content(kind: Kind, log_ns: i64, data: &[u8]) -> Option<Content> {
    let mut cdr = Cdr::new(data)?;
    let all = match kind {
        Kind::Pose => {
            let (stamp_ns, _) = header(&mut cdr)?;
            vec![(None, pose(&mut cdr, stamp_ns, log_ns)?)]
        }
        Kind::Odometry => {
            let (stamp_ns, _) = header(&mut cdr)?;
            let _child = cdr.text()?;
            let mut sample = pose(&mut cdr, stamp_ns, log_ns)?;
            let _covariance: [f64; 36] = cdr.numbers()?;
            sample.twist = Some(cdr.numbers()?);
            vec![(None, sample)]
        }
        Kind::Transform => vec![transform(&mut cdr, log_ns)?],
        Kind::Transforms => (0..cdr.u32()?)
            .map(|_| transform(&mut cdr, log_ns))
            .collect::<Option<_>>()?,
        Kind::Path => {
            header(&mut cdr)?;
            let samples = (0..cdr.u32()?).map(|_| {
                let (stamp_ns, _) = header(&mut cdr)?;
                pose(&mut cdr, stamp_ns, log_ns)
            });
            return samples.collect::<Option<_>>().map(Content::Path);
        }
    };
    Some(Content::Poses(all))
}
