//! Collects the topics of a log that hold poses, joints, commands and sensors, selects what is read, and converts it into a table.

use std::collections::{BTreeMap, HashMap};

use super::cdr::Cdr;
use super::chain;
use super::joined::Joined;
use super::message::{Column, Content, Frames, Quantity, Sample};
use super::pose_stream::Stream;
use super::series::{Role, Series};
use super::{foxglove, ros};
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{MAX_ROWS, excerpt};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::Code;

/// The first bytes of what zstd compressed.
const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// The largest number of streams that an error message lists.
const LISTED: usize = 12;

/// The topic of a message and the name of its type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Said<'a> {
    pub(super) topic: &'a str,
    pub(super) kind: &'a str,
}

/// All streams of a log.
pub(super) struct Log<'a> {
    reading: &'a Reading,
    streams: Vec<Stream>,
    places: HashMap<(String, Frames), usize>,
    series: Vec<Series>,
    /// The series of each topic.
    series_of: HashMap<String, Vec<usize>>,
    /// Topics that hold nothing that is read: the type and the number of their messages.
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
            series: Vec::new(),
            series_of: HashMap::new(),
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
            "cdr" => ros::kind(said.kind)
                .map(|kind| Cdr::new(data).and_then(|cdr| ros::content(kind, log_ns, cdr))),
            "ros1" => ros::kind(said.kind).map(|kind| ros::content(kind, log_ns, Cdr::ros1(data))),
            "json" => foxglove::KINDS
                .of(said.kind)
                .map(|kind| foxglove::content(kind, log_ns, data)),
            _ => None,
        };
        match done {
            None => self.other(said, encoding),
            // The error is reported only if this topic is read.
            Some(None) if self.is_wanted(said.topic) || self.is_stated_command(said.topic) => {
                let error = Error::invalid("a message cannot be decoded").field(said.topic);
                let found = format!("{} bytes of the type {}", data.len(), excerpt(said.kind));
                let error = error.found(found);
                self.broken.get_or_insert(match data.starts_with(ZSTD) {
                    true => error.hint("the messages are compressed one by one: `ros2 bag convert` writes them without compression"),
                    false => error,
                });
            }
            Some(None) => {}
            Some(Some(Content::Poses(all))) => {
                for (frames, sample) in all {
                    self.push(said, frames, sample);
                }
            }
            Some(Some(Content::Path(samples))) => self.replace(said, samples),
            Some(Some(Content::Row(row))) => {
                let series = self.series(said, &row.columns);
                series.count += 1;
                series.push(row);
                self.kept += 1;
            }
            Some(Some(Content::Plan(plan))) => {
                let columns = plan.joints.iter().cloned();
                let columns: Vec<Column> = columns
                    .map(|joint| Column::Joint(joint, Quantity::Angle))
                    .collect();
                let points = plan.points.len();
                let series = self.series(said, &columns);
                series.count += 1;
                series.push_plan(plan);
                self.kept += points;
            }
        }
        if self.kept > MAX_ROWS {
            return Err(Error::invalid("too many poses")
                .allowed(format!("at most {MAX_ROWS}"))
                .advise(Advice::Topic));
        }
        Ok(())
    }

    fn is_stated_command(&self, topic: &str) -> bool {
        let stated = self.reading.command_topic.as_deref();
        stated.is_some_and(|stated| same_topic(stated, topic))
    }

    /// The series of a topic with these columns.
    fn series(&mut self, said: Said<'_>, columns: &[Column]) -> &mut Series {
        let places = self.series_of.entry(said.topic.to_owned()).or_default();
        let mut known = places.iter().copied();
        let index = known.find(|index| self.series[*index].holds(columns));
        let index = index.unwrap_or_else(|| {
            let role = match ros::kind(said.kind) {
                Some(kind) if kind.is_command() => Role::Command,
                Some(ros::Kind::Joints | ros::Kind::Controller) => Role::State,
                _ => Role::Sensor,
            };
            self.series.push(Series {
                topic: said.topic.to_owned(),
                kind: said.kind.to_owned(),
                role,
                columns: columns.to_vec(),
                rows: Vec::new(),
                plans: Vec::new(),
                count: 0,
            });
            places.push(self.series.len() - 1);
            self.series.len() - 1
        });
        &mut self.series[index]
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
        let is_wanted = match (&frames, chain::wanted(self.reading)) {
            // Any transform may be on the way.
            (Some(_), Some(_)) => true,
            (frames, _) => {
                self.is_wanted(said.topic)
                    && child.is_none_or(|child| frames.as_ref().is_none_or(|(_, own)| own == child))
            }
        };
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

    /// The selected recording as a table with a header: one object's poses, or the joints of a topic, with the commands that belong to
    /// them.
    ///
    /// # Errors
    /// Nothing that can be read, or several recordings without a selection; the error lists them.
    pub(super) fn table(self) -> Result<Decoded> {
        if let Some((child, parent)) = chain::wanted(self.reading) {
            return self.chained(child, parent);
        }
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
        let joints: Vec<&Series> = match child {
            Some(_) => Vec::new(),
            None => self.states(),
        };
        match (found.as_slice(), joints.as_slice()) {
            ([stream], []) => match self.broken {
                Some(error) => Err(error),
                None => self.poses(stream),
            },
            ([], [joints]) => match self.broken {
                Some(error) => Err(error),
                None => self.joints(joints),
            },
            ([], []) => Err(match self.broken {
                Some(error) => error,
                None => self.nothing(is_chosen),
            }),
            (several, joints) => {
                let transforms = several.iter().all(|stream| stream.frames.is_some());
                let mut topics = several.iter().map(|stream| &stream.topic);
                let first = topics.next();
                let is_one_topic = topics.all(|topic| Some(topic) == first) && joints.is_empty();
                let field = match is_one_topic && transforms {
                    true => "child_frame",
                    false => "topic",
                };
                let message = match (joints.is_empty(), several.is_empty()) {
                    (true, _) => "the file holds the poses of several objects",
                    (false, true) => "the file holds the joints of several topics",
                    (false, false) => "the file holds joints, and poses of several objects",
                };
                let joints = joints.iter().map(|series| words_of(series));
                let all: Vec<String> = joints.chain(several.iter().map(|s| s.words())).collect();
                let has_frames = several.iter().any(|stream| stream.frames.is_some());
                Err(Error::invalid(message)
                    .field(field)
                    .found(list(all.into_iter()))
                    .allowed(match has_frames {
                        true => "one of them, or the pose of one frame in another that transforms connect with it: FRAME in OTHER",
                        false => "one of them",
                    })
                    .advise(Advice::Topic))
            }
        }
    }

    /// The topics of measured joints, each by its longest series: publishers of one topic may report different joints.
    fn states(&self) -> Vec<&Series> {
        let mut found: Vec<&Series> = Vec::new();
        let all = self.series.iter();
        for series in all.filter(|series| series.role == Role::State && series.has(Quantity::Angle))
        {
            let is_wanted = self.is_wanted(&series.topic) && !self.is_stated_command(&series.topic);
            if !is_wanted || series.count < 2 {
                continue;
            }
            match found.iter_mut().find(|known| known.topic == series.topic) {
                Some(known) if known.count >= series.count => {}
                Some(known) => *known = series,
                None => found.push(series),
            }
        }
        found
    }

    /// A topic of joints, with further joints of this topic, the commands of these joints, and the sensors of bodies.
    fn joints(&self, base: &Series) -> Result<Decoded> {
        let mut joined = Joined::of_joints(base)?;
        let others = || {
            let all = self.series.iter();
            all.filter(|series| !std::ptr::eq(*series, base))
        };
        for series in others().filter(|series| series.topic == base.topic) {
            joined.add_joints(series);
        }
        let joints: Vec<&str> = others()
            .filter(|series| series.topic == base.topic)
            .chain([base])
            .flat_map(Series::joints)
            .collect();
        let is_of_joints = |series: &Series| {
            let own = series.joints();
            !own.is_empty() && own.iter().all(|joint| joints.contains(joint))
        };
        let is_command = |series: &&Series| match &self.reading.command_topic {
            Some(topic) => same_topic(topic, &series.topic),
            None => {
                // Plans and references have the names of the joints; what else moves them has to be stated.
                let is_plan = series.role == Role::Command && is_of_joints(series);
                let is_reference = series.has(Quantity::Reference) && is_of_joints(series);
                series.topic != base.topic
                    && !base.has(Quantity::Reference)
                    && (is_plan || is_reference)
            }
        };
        let commands: Vec<&Series> = others().filter(is_command).collect();
        if commands.len() > 1 && self.reading.command_topic.is_none() {
            let all: Vec<String> = commands.iter().map(|series| words_of(series)).collect();
            return Err(Error::invalid("the file holds commands of several topics")
                .field("command_topic")
                .found(list(all.into_iter()))
                .allowed("one of them")
                .advise(Advice::CommandTopic));
        }
        self.must_be_there(&commands)?;
        for series in &commands {
            joined.add_commands(series, self.reading)?;
        }
        for series in others().filter(|series| series.role == Role::Sensor && series.count > 1) {
            joined.add_sensor(series);
        }
        let is_read = |topic: &str| {
            topic == base.topic || commands.iter().any(|series| series.topic == topic)
        };
        joined.not_read(&self.unread(&is_read));
        joined.table(None)
    }

    /// Poses of one object, with the stated commands.
    fn poses(&self, stream: &Stream) -> Result<Decoded> {
        let stated = self.series.iter();
        let commands: Vec<&Series> = stated
            .filter(|series| self.is_stated_command(&series.topic))
            .collect();
        self.must_be_there(&commands)?;
        let mut joined = Joined::at(stream.clock(), stream.times_ns());
        for series in &commands {
            joined.add_commands(series, self.reading)?;
        }
        let is_read = |topic: &str| commands.iter().any(|series| series.topic == topic);
        joined.not_read(&self.unread(&is_read));
        let (names, rows) = stream.rows()?;
        joined.table(Some((&names, &rows)))
    }

    /// Poses of one frame in another, over the transforms between them.
    fn chained(self, child: &str, parent: &str) -> Result<Decoded> {
        if let Some(error) = self.broken {
            return Err(error);
        }
        let stream = chain::poses(&self.streams, self.reading, child, parent)?;
        let way = chain::way_in_words(&self.streams, self.reading, (child, parent));
        let mut decoded = self.poses(&stream)?;
        if let Some(way) = way {
            decoded.warnings.push(Code::ReadAs.warning(format!(
                "the pose of {} in {} follows from {way}",
                excerpt(child),
                excerpt(parent)
            )));
        }
        Ok(decoded)
    }

    /// Refuses a topic of commands that the log does not have.
    fn must_be_there(&self, commands: &[&Series]) -> Result<()> {
        match &self.reading.command_topic {
            Some(topic) if commands.is_empty() => {
                let all: Vec<String> = self.series.iter().map(words_of).collect();
                Err(Error::invalid("there are no commands with this name")
                    .field("command_topic")
                    .found(match all.is_empty() {
                        true => format!("no commands, and no topic {}", excerpt(topic)),
                        false => list(all.into_iter()),
                    })
                    .advise(Advice::CommandTopic))
            }
            _ => Ok(()),
        }
    }

    /// Topics of commands and joints that are not read.
    fn unread(&self, is_read: &dyn Fn(&str) -> bool) -> Vec<String> {
        let all = self.series.iter();
        let left = all.filter(|series| series.role != Role::Sensor && !is_read(&series.topic));
        left.map(words_of).collect()
    }

    fn nothing(&self, is_chosen: bool) -> Error {
        let poses = self.streams.iter().map(Stream::words);
        let poses = poses.chain(self.series.iter().map(words_of));
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
            return Error::invalid("there are no poses or joints with this name")
                .field(match self.reading.topic {
                    Some(_) => "topic",
                    None => "child_frame",
                })
                .found(found)
                .advise(Advice::Topic);
        }
        let kinds: Vec<&str> = ros::KINDS.names().chain(foxglove::KINDS.names()).collect();
        Error::invalid("the file holds no poses that change, and no joints")
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

/// A series in the words of a list.
fn words_of(series: &Series) -> String {
    let joints = series.joints();
    let what = match joints.is_empty() {
        true => counted(series.columns.len(), "number"),
        false => counted(joints.len(), "joint"),
    };
    let (topic, kind) = (excerpt(&series.topic), excerpt(&series.kind));
    format!(
        "{topic} ({kind}, {what}, {})",
        counted(series.count, "message")
    )
}

/// True if messages of this type in this encoding are read.
pub(super) fn is_read(encoding: &str, kind: &str) -> bool {
    match encoding {
        "cdr" | "ros1" => ros::kind(kind).is_some(),
        "json" => foxglove::KINDS.of(kind).is_some(),
        _ => false,
    }
}

pub(super) fn same_topic(wanted: &str, topic: &str) -> bool {
    wanted.trim_start_matches('/') == topic.trim_start_matches('/')
}

/// Writes nanoseconds as seconds without rounding.
pub(super) fn push_seconds(text: &mut String, time_ns: i64) {
    let size = time_ns.unsigned_abs();
    let sign = if time_ns < 0 { "-" } else { "" };
    let (whole, rest) = (size / 1_000_000_000, size % 1_000_000_000);
    text.push_str(&format!("{sign}{whole}.{rest:09}"));
}
