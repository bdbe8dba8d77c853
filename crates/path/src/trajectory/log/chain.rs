//! The pose of one frame in another, over the transforms between them.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::message::Sample;
use super::pose_stream::Stream;
use super::stream::same_topic;
use crate::trajectory::Reading;
use crate::trajectory::text::excerpt;
use realgap_core::error::{Advice, Error, Result};

/// Between the two frames in a reading's `child_frame`: `base_link in map`.
const IN: &str = " in ";
/// The end of the topics whose transforms hold always.
const STATIC: &str = "tf_static";

/// The frame, and the one in which its pose is wanted, where the reading names both.
pub(super) fn wanted(reading: &Reading) -> Option<(&str, &str)> {
    let (child, parent) = reading.child_frame.as_deref()?.split_once(IN)?;
    Some((child.trim(), parent.trim()))
}

/// Poses with their times, nanoseconds.
type Track = Vec<(i64, Isometry3<f64>)>;

/// One transform on the way, `is_up` if it leads from the frame to its parent.
struct Step<'a> {
    stream: &'a Stream,
    is_up: bool,
}

/// The poses of `child` in `parent`, at the times of the transform on the way that has the most.
///
/// # Errors
/// A frame that no transform names, frames that are not connected, transforms without a time in common.
pub(super) fn poses(
    streams: &[Stream],
    reading: &Reading,
    child: &str,
    parent: &str,
) -> Result<Stream> {
    let steps = way(streams, reading, child, parent)?;
    if let [
        Step {
            stream,
            is_up: true,
        },
    ] = steps.as_slice()
        && !is_static(stream)
    {
        return Ok((*stream).clone());
    }
    let moving = steps.iter().filter(|step| !is_static(step.stream));
    let base = moving.max_by_key(|step| step.stream.samples.len());
    let Some(base) = base else {
        return Err(Error::invalid("nothing moves between these frames")
            .field("child_frame")
            .found(format!("static transforms from {parent} to {child}"))
            .advise(Advice::Topic));
    };
    let has_stamps = steps
        .iter()
        .filter(|step| !is_static(step.stream))
        .all(|step| {
            step.stream
                .samples
                .iter()
                .any(|sample| sample.stamp_ns != 0)
        });
    let time = |sample: &Sample| match has_stamps {
        true => sample.stamp_ns,
        false => sample.log_ns,
    };
    let sorted = |stream: &Stream| {
        let mut all: Track = stream
            .samples
            .iter()
            .map(|sample| (time(sample), isometry(sample)))
            .collect();
        all.sort_by_key(|(time_ns, _)| *time_ns);
        all
    };
    let tracks: Vec<Track> = steps.iter().map(|step| sorted(step.stream)).collect();
    let at = |time_ns: i64| {
        let mut pose = Isometry3::identity();
        for (step, track) in steps.iter().zip(&tracks) {
            let own = match is_static(step.stream) {
                true => track.first()?.1,
                false => between(track, time_ns)?,
            };
            // From the child upwards: each transform stands before what is known so far.
            pose = if step.is_up {
                own * pose
            } else {
                own.inverse() * pose
            };
        }
        Some(pose)
    };
    let samples: Vec<Sample> = base
        .stream
        .samples
        .iter()
        .filter_map(|sample| {
            let pose = at(time(sample))?;
            let (p, q) = (pose.translation.vector, pose.rotation.coords);
            Some(Sample {
                place_m: [p.x, p.y, p.z],
                turn_xyzw: [q.x, q.y, q.z, q.w],
                twist: None,
                ..*sample
            })
        })
        .collect();
    if samples.is_empty() {
        return Err(
            Error::invalid("the transforms between these frames have no time in common")
                .field("child_frame")
                .found(words(&steps))
                .advise(Advice::Topic),
        );
    }
    Ok(Stream {
        topic: base.stream.topic.clone(),
        kind: base.stream.kind.clone(),
        frames: Some((parent.to_owned(), child.to_owned())),
        count: samples.len(),
        samples,
        is_path: false,
    })
}

/// The transforms on the way, in words.
pub(super) fn way_in_words(
    streams: &[Stream],
    reading: &Reading,
    (child, parent): (&str, &str),
) -> Option<String> {
    let steps = way(streams, reading, child, parent).ok()?;
    (steps.len() > 1).then(|| words(&steps))
}

fn words(steps: &[Step<'_>]) -> String {
    let all: Vec<String> = steps.iter().map(|step| step.stream.words()).collect();
    all.join("; ")
}

/// Transforms of static topics, and those that a log states once.
fn is_static(stream: &Stream) -> bool {
    stream.topic.ends_with(STATIC) || stream.samples.len() == 1
}

fn isometry(sample: &Sample) -> Isometry3<f64> {
    let [x, y, z, w] = sample.turn_xyzw;
    // A rotation that is not stated is none.
    let turn = match [x, y, z, w] == [0.0; 4] {
        true => UnitQuaternion::identity(),
        false => UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
    };
    Isometry3::from_parts(Translation3::from(Vector3::from(sample.place_m)), turn)
}

/// The pose at a time on the shortest way between its neighbours; `None` before the first and behind the last.
fn between(track: &[(i64, Isometry3<f64>)], time_ns: i64) -> Option<Isometry3<f64>> {
    let next = track.partition_point(|(own, _)| *own <= time_ns);
    let (from_ns, from) = track.get(next.checked_sub(1)?)?;
    if *from_ns == time_ns {
        return Some(*from);
    }
    let (to_ns, to) = track.get(next)?;
    let share = (time_ns - from_ns) as f64 / (to_ns - from_ns) as f64;
    let turn = from.rotation.try_slerp(&to.rotation, share, 1e-9);
    let place = from.translation.vector.lerp(&to.translation.vector, share);
    Some(Isometry3::from_parts(
        Translation3::from(place),
        turn.unwrap_or(from.rotation),
    ))
}

/// The shortest way from `child` to `parent`.
fn way<'a>(
    streams: &'a [Stream],
    reading: &Reading,
    child: &str,
    parent: &str,
) -> Result<Vec<Step<'a>>> {
    // Of two topics with the same transform, the stated one, else that with more poses.
    let mut edges: BTreeMap<(&str, &str), &Stream> = BTreeMap::new();
    let rank = |stream: &Stream| {
        let stated = reading.topic.as_deref();
        let is_stated = stated.is_some_and(|stated| same_topic(stated, &stream.topic));
        (is_stated, stream.samples.len())
    };
    for stream in streams {
        if let Some((parent, child)) = &stream.frames
            && !stream.samples.is_empty()
        {
            let edge = edges.entry((parent, child)).or_insert(stream);
            if rank(stream) > rank(edge) {
                *edge = stream;
            }
        }
    }
    let mut came: BTreeMap<&str, (&str, bool, &Stream)> = BTreeMap::new();
    let mut open = VecDeque::from([child]);
    while let Some(frame) = open.pop_front() {
        if frame == parent {
            break;
        }
        for ((above, below), stream) in &edges {
            let next = match (*below == frame, *above == frame) {
                (true, _) => (*above, true),
                (_, true) => (*below, false),
                _ => continue,
            };
            if next.0 != child && !came.contains_key(next.0) {
                came.insert(next.0, (frame, next.1, stream));
                open.push_back(next.0);
            }
        }
    }
    let mut steps = Vec::new();
    let mut frame = parent;
    while frame != child {
        let Some((before, is_up, stream)) = came.get(frame) else {
            let mut all: Vec<String> = edges
                .keys()
                .map(|(parent, child)| format!("{}{IN}{}", excerpt(child), excerpt(parent)))
                .collect();
            all.truncate(20);
            return Err(
                Error::invalid("no transforms lead from one frame to the other")
                    .field("child_frame")
                    .found(format!("{}{IN}{}", excerpt(child), excerpt(parent)))
                    .allowed(match all.is_empty() {
                        true => "a log with transforms".to_owned(),
                        false => format!("frames that these connect: {}", all.join(", ")),
                    })
                    .advise(Advice::Topic),
            );
        };
        steps.push(Step {
            stream,
            is_up: *is_up,
        });
        frame = before;
    }
    steps.reverse();
    Ok(steps)
}
