//! Collects the streams of poses in a log, selects one, and converts it into a table.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::message::{Content, Frames, Sample};
use super::{foxglove, ros};
use crate::trajectory::Reading;
use crate::trajectory::text::{MAX_ROWS, excerpt, push_number};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;

/// The largest number of streams that an error message lists.
const LISTED: usize = 12;

/// The topic of a message and the name of its type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Said<'a> {
    pub(super) topic: &'a str,
    pub(super) kind: &'a str,
}

/// The poses of one object: one topic, and one pair of frames for transforms.
#[derive(Debug, Clone, Default)]
struct Stream {
    topic: String,
    kind: String,
    frames: Frames,
    samples: Vec<Sample>,
    /// The number of poses in the log, including those that are not kept.
    count: usize,
    /// True if each message holds a whole path.
    is_path: bool,
}

/// All streams of a log.
pub(super) struct Log<'a> {
    reading: &'a Reading,
    streams: Vec<Stream>,
    places: HashMap<(String, Frames), usize>,
    /// Topics without poses: the type and the number of their messages.
    others: BTreeMap<String, (String, usize)>,
    kept: usize,
    broken: Option<Error>,
}

impl<'a> Log<'a> {
    pub(super) fn new(reading: &'a Reading) -> Self {
        Self {
            reading,
            streams: Vec::new(),
            places: HashMap::new(),
            others: BTreeMap::new(),
            kept: 0,
            broken: None,
        }
    }

    /// Adds one message of any type.
    ///
    /// # Errors
    /// More poses than [`MAX_ROWS`].
    pub(super) fn message(
        &mut self,
        said: Said<'_>,
        encoding: &str,
        log_ns: i64,
        data: &[u8],
    ) -> Result<()> {
        let done = match encoding {
            "cdr" => ros::KINDS
                .of(said.kind)
                .map(|kind| ros::content(kind, log_ns, data)),
            "json" => foxglove::KINDS
                .of(said.kind)
                .map(|kind| foxglove::content(kind, log_ns, data)),
            _ => None,
        };
        match done {
            None => self.other(said, encoding),
            // The error is reported only if this topic is read.
            Some(None) if self.is_wanted(said.topic) => {
                let error = Error::invalid("a message cannot be decoded").field(said.topic);
                let found = format!("{} bytes of the type {}", data.len(), excerpt(said.kind));
                self.broken.get_or_insert(error.found(found));
            }
            Some(None) => {}
            Some(Some(Content::Poses(all))) => {
                for (frames, sample) in all {
                    self.push(said, frames, sample);
                }
            }
            Some(Some(Content::Path(samples))) => self.replace(said, samples),
        }
        if self.kept > MAX_ROWS {
            return Err(Error::invalid("too many poses")
                .allowed(format!("at most {MAX_ROWS}"))
                .advise(Advice::Topic));
        }
        Ok(())
    }

    fn other(&mut self, said: Said<'_>, encoding: &str) {
        let kind = match encoding {
            "cdr" => said.kind.to_owned(),
            _ => format!("{} as {encoding}", said.kind),
        };
        let other = self.others.entry(said.topic.to_owned());
        other.or_insert((kind, 0)).1 += 1;
    }

    fn is_wanted(&self, topic: &str) -> bool {
        let wanted = self.reading.topic.as_deref();
        wanted.is_none_or(|wanted| same_topic(wanted, topic))
    }

    fn stream(&mut self, said: Said<'_>, frames: Frames) -> &mut Stream {
        let index = *self
            .places
            .entry((said.topic.to_owned(), frames))
            .or_insert_with_key(|(topic, frames)| {
                self.streams.push(Stream {
                    topic: topic.clone(),
                    kind: said.kind.to_owned(),
                    frames: frames.clone(),
                    ..Stream::default()
                });
                self.streams.len() - 1
            });
        &mut self.streams[index]
    }

    /// Adds one pose to its stream.
    fn push(&mut self, said: Said<'_>, frames: Frames, sample: Sample) {
        let child = self.reading.child_frame.as_deref();
        let is_wanted = self.is_wanted(said.topic)
            && child.is_none_or(|child| frames.as_ref().is_none_or(|(_, own)| own == child));
        let stream = self.stream(said, frames);
        stream.count += 1;
        if is_wanted {
            stream.samples.push(sample);
            self.kept += 1;
        }
    }

    /// Replaces the path of a topic, because each message holds the whole path up to its time.
    fn replace(&mut self, said: Said<'_>, samples: Vec<Sample>) {
        let is_wanted = self.is_wanted(said.topic);
        let stream = self.stream(said, None);
        stream.is_path = true;
        stream.count = samples.len();
        let before = stream.samples.len();
        if is_wanted {
            stream.samples = samples;
            let now = stream.samples.len();
            self.kept = self.kept - before + now;
        }
    }

    /// The selected stream of poses as a table with a header.
    ///
    /// # Errors
    /// No stream of poses, or several streams without a selection; the error lists the streams.
    pub(super) fn table(self) -> Result<String> {
        let child = self.reading.child_frame.as_deref();
        let is_chosen = self.reading.topic.is_some() || child.is_some();
        let fits = |stream: &&Stream| {
            let is_child = match (child, &stream.frames) {
                (Some(child), Some((_, own))) => child == own,
                (Some(_), None) => self.reading.topic.is_some(),
                (None, _) => true,
            };
            // A pose that occurs only once belongs to an object that does not move.
            is_child && self.is_wanted(&stream.topic) && (is_chosen || stream.count > 1)
        };
        let found: Vec<&Stream> = self.streams.iter().filter(fits).collect();
        match found.as_slice() {
            [stream] => match self.broken {
                Some(error) => Err(error),
                None => stream.table(),
            },
            [] => Err(match self.broken {
                Some(error) => error,
                None => self.nothing(is_chosen),
            }),
            several => {
                let transforms = several.iter().all(|stream| stream.frames.is_some());
                let is_one_topic = several.iter().all(|s| s.topic == several[0].topic);
                let field = match is_one_topic && transforms {
                    true => "child_frame",
                    false => "topic",
                };
                Err(
                    Error::invalid("the file holds the poses of several objects")
                        .field(field)
                        .found(list(several.iter().map(|stream| stream.words())))
                        .allowed("one of them")
                        .advise(Advice::Topic),
                )
            }
        }
    }

    fn nothing(&self, is_chosen: bool) -> Error {
        let poses = self.streams.iter().map(Stream::words);
        let others = self.others.iter();
        let others = others.map(|(topic, (kind, count))| {
            format!("{} ({}, {count})", excerpt(topic), excerpt(kind))
        });
        let all: Vec<String> = poses.chain(others).collect();
        let found = if all.is_empty() {
            "no messages".to_owned()
        } else {
            list(all.into_iter())
        };
        if is_chosen {
            return Error::invalid("there are no poses with this name")
                .field(match self.reading.topic {
                    Some(_) => "topic",
                    None => "child_frame",
                })
                .found(found)
                .advise(Advice::Topic);
        }
        let kinds: Vec<&str> = ros::KINDS.names().chain(foxglove::KINDS.names()).collect();
        Error::invalid("the file holds no poses that change")
            .found(found)
            .allowed(format!("messages of {}", kinds.join(", ")))
    }
}

fn list(words: impl ExactSizeIterator<Item = String>) -> String {
    let more = words.len().saturating_sub(LISTED);
    let mut listed: Vec<String> = words.take(LISTED).collect();
    if more > 0 {
        listed.push(format!("{more} more"));
    }
    listed.join("; ")
}

fn same_topic(wanted: &str, topic: &str) -> bool {
    wanted.trim_start_matches('/') == topic.trim_start_matches('/')
}

impl Stream {
    fn words(&self) -> String {
        let frames = match &self.frames {
            Some((parent, child)) => format!(" {} in {}", excerpt(child), excerpt(parent)),
            None => String::new(),
        };
        let (topic, kind) = (excerpt(&self.topic), excerpt(&self.kind));
        format!("{topic}{frames} ({kind}, {})", counted(self.count, "pose"))
    }

    fn table(&self) -> Result<String> {
        let all = &self.samples;
        let has_stamps = all.iter().any(|sample| sample.stamp_ns != 0);
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
        let mut text = String::from("t_s,x_m,y_m,z_m");
        if turns {
            text.push_str(",qw,qx,qy,qz");
        }
        if moves {
            text.push_str(",vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s");
        }
        text.push('\n');
        for sample in all {
            let time_ns = if has_stamps {
                sample.stamp_ns
            } else {
                sample.log_ns
            };
            push_seconds(&mut text, time_ns);
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
            text.push('\n');
        }
        Ok(text)
    }
}

/// Rotates the linear velocity of a twist from the body frame into the world frame; the angular velocity stays in the body frame.
fn world_speeds([w, x, y, z]: [f64; 4], twist: [f64; 6]) -> [f64; 6] {
    let [vx, vy, vz, wx, wy, wz] = twist;
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let linear = turn * Vector3::new(vx, vy, vz);
    [linear.x, linear.y, linear.z, wx, wy, wz]
}

/// Writes nanoseconds as seconds without rounding.
fn push_seconds(text: &mut String, time_ns: i64) {
    let size = time_ns.unsigned_abs();
    let sign = if time_ns < 0 { "-" } else { "" };
    let (whole, rest) = (size / 1_000_000_000, size % 1_000_000_000);
    text.push_str(&format!("{sign}{whole}.{rest:09}"));
}
