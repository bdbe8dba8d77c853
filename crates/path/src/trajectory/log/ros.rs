//! Messages of ROS 2 that hold poses.

use super::cdr::Cdr;
use super::stream::{Frames, Kinds, Log, Said, Sample};

/// What a message says, by the name of its type; the last part of `geometry_msgs/msg/PoseStamped`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Pose,
    Odometry,
    Transform,
    Transforms,
    Path,
}

/// Types of messages, as ROS 2 calls them.
pub(super) const KINDS: Kinds<Kind> = Kinds(&[
    ("geometry_msgs/msg/PoseStamped", Kind::Pose),
    // The covariance stands behind.
    ("geometry_msgs/msg/PoseWithCovarianceStamped", Kind::Pose),
    ("nav_msgs/msg/Odometry", Kind::Odometry),
    ("geometry_msgs/msg/TransformStamped", Kind::Transform),
    ("tf2_msgs/msg/TFMessage", Kind::Transforms),
    ("nav_msgs/msg/Path", Kind::Path),
]);

/// Time and frame.
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

/// Adds what a message says to the log; `None` where it is not whole.
pub(super) fn push(
    log: &mut Log<'_>,
    said: Said<'_>,
    kind: Kind,
    log_ns: i64,
    data: &[u8],
) -> Option<()> {
    let mut cdr = Cdr::new(data)?;
    match kind {
        Kind::Pose => {
            let (stamp_ns, _) = header(&mut cdr)?;
            log.push(said, None, pose(&mut cdr, stamp_ns, log_ns)?);
        }
        Kind::Odometry => {
            let (stamp_ns, _) = header(&mut cdr)?;
            let _child = cdr.text()?;
            let mut sample = pose(&mut cdr, stamp_ns, log_ns)?;
            let _covariance: [f64; 36] = cdr.numbers()?;
            sample.twist = Some(cdr.numbers()?);
            log.push(said, None, sample);
        }
        Kind::Transform => {
            let (frames, sample) = transform(&mut cdr, log_ns)?;
            log.push(said, frames, sample);
        }
        Kind::Transforms => {
            for _ in 0..cdr.u32()? {
                let (frames, sample) = transform(&mut cdr, log_ns)?;
                log.push(said, frames, sample);
            }
        }
        Kind::Path => {
            header(&mut cdr)?;
            let mut samples = Vec::new();
            for _ in 0..cdr.u32()? {
                let (stamp_ns, _) = header(&mut cdr)?;
                samples.push(pose(&mut cdr, stamp_ns, log_ns)?);
            }
            log.replace(said, samples);
        }
    }
    Some(())
}
