//! Decodes JSON messages of Foxglove that hold poses.

use serde::Deserialize;

use super::message::{Content, Frames, Kinds, Sample};

#[derive(Deserialize)]
struct Time {
    sec: i64,
    nsec: i64,
}

#[derive(Deserialize)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize)]
struct Turn {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Deserialize)]
struct Pose {
    position: Vector,
    orientation: Turn,
}

#[derive(Deserialize)]
struct PoseInFrame {
    timestamp: Time,
    pose: Pose,
}

#[derive(Deserialize)]
struct FrameTransform {
    timestamp: Time,
    parent_frame_id: String,
    child_frame_id: String,
    translation: Vector,
    rotation: Turn,
}

#[derive(Deserialize)]
struct FrameTransforms {
    transforms: Vec<FrameTransform>,
}

/// The kind of a message, by the name of its schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Pose,
    Transform,
    Transforms,
}

pub(super) const KINDS: Kinds<Kind> = Kinds(&[
    ("foxglove.PoseInFrame", Kind::Pose),
    ("foxglove.FrameTransform", Kind::Transform),
    ("foxglove.FrameTransforms", Kind::Transforms),
]);

fn sample(time: &Time, place: &Vector, turn: &Turn, log_ns: i64) -> Option<Sample> {
    let stamp_ns = time
        .sec
        .checked_mul(1_000_000_000)?
        .checked_add(time.nsec)?;
    Some(Sample {
        stamp_ns,
        log_ns,
        place_m: [place.x, place.y, place.z],
        turn_xyzw: [turn.x, turn.y, turn.z, turn.w],
        twist: None,
    })
}

fn transform(transform: FrameTransform, log_ns: i64) -> Option<(Frames, Sample)> {
    let place = &transform.translation;
    let sample = sample(&transform.timestamp, place, &transform.rotation, log_ns)?;
    let frames = (transform.parent_frame_id, transform.child_frame_id);
    Some((Some(frames), sample))
}

/// Decodes the poses of a message; `None` if the message does not match its schema.
pub(super) fn content(kind: Kind, log_ns: i64, data: &[u8]) -> Option<Content> {
    let all = match kind {
        Kind::Pose => {
            let PoseInFrame { timestamp, pose } = serde_json::from_slice(data).ok()?;
            let sample = sample(&timestamp, &pose.position, &pose.orientation, log_ns)?;
            vec![(None, sample)]
        }
        Kind::Transform => vec![transform(serde_json::from_slice(data).ok()?, log_ns)?],
        Kind::Transforms => {
            let message: FrameTransforms = serde_json::from_slice(data).ok()?;
            let all = message.transforms.into_iter();
            all.map(|one| transform(one, log_ns))
                .collect::<Option<_>>()?
        }
    };
    Some(Content::Poses(all))
}
