//! Infers from the content of recorded files how to read them, with the evidence for every inference and the questions that remain.
//!
//! The names of columns give roles and units. The usual interval of samples gives the unit of time. Free fall gives the unit of length and
//! the axis that points up, because its acceleration is 9.81 m/s² everywhere; without free fall, the height above the floor and the size of
//! the robot are used. Every inference is reported.

mod column;
mod joint;
mod lacking;
pub(in crate::trajectory) mod motion;
mod question;
mod role;
mod unit;

use std::path::{Path, PathBuf};

pub use joint::JointReading;
pub use question::{Ambiguity, Candidate, Evidence, Question};

use super::axes::Axes;
use super::meta::read_meta_beside;
use super::mixed_robots::names_column;
use super::reading::{Crop, Reading};
use super::registry::{format_in, parse_all, read_bytes};
use super::time_order::InFile;
use super::{Recording, Trajectory, plausibility};
use realgap_core::error::{Advice, Error, Result};

use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};

/// How files are to be read, with the evidence, and the questions that the files alone do not answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InferredReading {
    /// The reading: the given settings, completed by the inferred ones.
    pub reading: Reading,
    /// The inferences, each with its reason.
    pub evidence: Vec<Evidence>,
    /// The questions that the user has to answer.
    pub ambiguities: Vec<Ambiguity>,
    /// The doubts about the first recording, as far as it could be read.
    pub doubts: Vec<Warning>,
    /// True if the first recording contains free fall.
    pub has_free_fall: bool,
}

/// Relative tolerance between the acceleration of free fall and gravity.
const FALL: f64 = 0.12;

/// The bytes of the first file, and its text if it is a table with named columns.
struct Content {
    bytes: Vec<u8>,
    text: Option<String>,
}

/// What is said of a standstill before the motion.
const BEGINS: &str = "recordings begin at";

impl InferredReading {
    /// Recordings are read from their beginning, or as far as `known` says, although they stand still at first.
    pub fn leave_crop(&mut self, known: &Reading) {
        self.reading.crop = known.crop;
        self.evidence.retain(|one| !one.finding.starts_with(BEGINS));
    }

    /// Infers how these files are to be read, mainly from the first file. Settings of `known` are kept; `body_m` is the size of the robot,
    /// metres.
    ///
    /// # Errors
    /// A file that cannot be read under any inference: no column of times or positions, no samples below the header, a header that
    /// differs from that of the first file, mirrored axes.
    pub fn infer(paths: &[PathBuf], known: &Reading, body_m: Option<f64>) -> Result<Self> {
        let Some(path) = paths.first() else {
            return Err(Error::usage("no recording is named").advise(Advice::Recordings));
        };
        let mut guess = Self {
            reading: known.clone(),
            ..Self::default()
        };
        let Some((file, recording)) = guess.read_first(path)? else {
            return Ok(guess);
        };
        let mut recording = recording;
        guess.doubt(&recording);
        if guess.has_question(&Question::Robot) || guess.has_question(&Question::Split) {
            return Ok(guess);
        }
        let fall = motion::free_fall(&recording.trajectory);
        guess.has_free_fall = fall.is_some();
        if guess.length(&file, &recording, fall, body_m)? {
            match guess.first(path, &file.bytes)? {
                Some(again) => recording = again,
                None => return Ok(guess),
            }
        }
        if known.axes.is_none()
            && !recording.trajectory.is_planar()
            && guess.up(&recording.trajectory, fall, body_m)
        {
            match guess.first(path, &file.bytes)? {
                Some(again) => recording = again,
                None => return Ok(guess),
            }
        }
        let mut all = vec![recording.clone()];
        for other in &paths[1..] {
            let bytes = read_bytes(other)?;
            match guess.first(other, &bytes)? {
                Some(other) => all.push(other),
                None => return Ok(guess),
            }
        }
        if let Some(mirrored) = motion::mirrored(&all) {
            if !mirrored.is_certain {
                guess.conclude(
                    "axes may be mirrored: it goes on as read",
                    format!("{}; change the sign of one axis in positions and orientations if this is so", mirrored.found),
                );
            } else {
                return Err(Error::invalid("the recording is mirrored")
                .at_file(path)
                .found(mirrored.found)
                .allowed("right-handed axes: x forward, y to the left, z up")
                .hint("export it with right-handed axes, or change the sign of one axis in both positions and orientations"));
            }
        }
        guess.quaternion_order(&recording);
        guess.crop(&recording);
        Ok(guess)
    }

    /// Infers what is needed to read one file at all, for a purpose that has no robot: columns, units, and lost or unsorted samples. Settings of
    /// `known` are kept. Neither a part is chosen, nor axes are turned.
    ///
    /// # Errors
    /// The errors of [`InferredReading::infer`], but for mirrored axes.
    pub fn of_file(path: &Path, known: &Reading) -> Result<Self> {
        let mut guess = Self {
            reading: known.clone(),
            ..Self::default()
        };
        if let Some((file, recording)) = guess.read_first(path)? {
            let fall = motion::free_fall(&recording.trajectory);
            guess.has_free_fall = fall.is_some();
            guess.length_without_robot(&file, &recording, fall)?;
        }
        Ok(guess)
    }

    /// As [`InferredReading::of_file`], where nobody can be asked: the first open question is an error that says how to answer it.
    ///
    /// # Errors
    /// An open question; the errors of [`InferredReading::of_file`].
    pub fn without_questions(path: &Path, known: &Reading) -> Result<Self> {
        let guess = Self::of_file(path, known)?;
        match guess.ambiguities.first() {
            Some(open) => Err(open.error().at_file(path)),
            None => Ok(guess),
        }
    }

    /// Reads the first recording of the first file with inferred columns and times; `None` if a question has to be answered first.
    fn read_first(&mut self, path: &Path) -> Result<Option<(Content, Recording)>> {
        let bytes = read_bytes(path)?;
        let format = format_in(path, &bytes)?;
        let mut file = Content { bytes, text: None };
        // The settings beside the file count as known.
        let meta = read_meta_beside(path)?.map(|meta| meta.reading);
        if let Some(meta) = &meta {
            self.reading = self.reading.clone().or(meta);
        }
        if format.is_table() {
            let text = format.decode(file.bytes.clone(), &self.reading);
            let text = text.map_err(|e| e.at_file(path))?.text;
            column::infer_columns(&text, self).map_err(|e| e.at_file(path))?;
            file.text = Some(text);
        }
        if self.has_question(&Question::Body) {
            return Ok(None);
        }
        let Some(mut recording) = self.first(path, &file.bytes)? else {
            return Ok(None);
        };
        if self.reading.time.is_none() && self.time(&file, &recording.trajectory)? {
            match self.first(path, &file.bytes)? {
                Some(again) => recording = again,
                None => return Ok(None),
            }
        }
        if !self.has_question(&Question::Split) && self.alternates(&recording.trajectory) {
            return Ok(None);
        }
        Ok(Some((file, recording)))
    }

    /// Asks whether the file is split, if its rows seem to alternate between bodies although times increase.
    fn alternates(&mut self, trajectory: &Trajectory) -> bool {
        if self.reading.split.is_some() || trajectory.is_of_joints() {
            return false;
        }
        let file = InFile {
            times_s: trajectory.times_s(),
            places: trajectory.positions_world_m(),
        };
        let Some(bodies) = file.hidden_bodies() else {
            return false;
        };
        self.ask(
            Question::Split,
            format!("the rows seem to alternate between {bodies} bodies: every row is over 10 times as near to the row {bodies} later as to the next one"),
        );
        true
    }

    fn conclude(&mut self, finding: impl Into<String>, reason: impl Into<String>) {
        self.evidence.push(Evidence {
            finding: finding.into(),
            reason: reason.into(),
        });
    }

    fn ask(&mut self, question: Question, found: impl Into<String>) {
        self.ambiguities.push(Ambiguity {
            question,
            found: found.into(),
            candidates: Vec::new(),
        });
    }

    fn has_question(&self, question: &Question) -> bool {
        let mut all = self.ambiguities.iter();
        all.any(|ambiguity| ambiguity.question == *question)
    }

    /// Reads the first recording of a file, and adds settings without which it cannot be read; `None` if a question has to be answered first.
    fn first(&mut self, path: &Path, bytes: &[u8]) -> Result<Option<Recording>> {
        loop {
            let error = match parse_all(path, bytes.to_vec(), &self.reading) {
                Ok(mut all) if !all.is_empty() => {
                    let recording = all.swap_remove(0);
                    self.several_robots(&recording);
                    return Ok(Some(recording));
                }
                Ok(_) => return Err(Error::invalid("the file holds no recording").at_file(path)),
                Err(error) => error,
            };
            let can = |advice: Advice| error.advice().contains(&advice);
            let where_ = error
                .line_column()
                .map(|(line, _)| format!("line {line}: "));
            let found = error.found_text().map(|found| format!(" ({found})"));
            let reason = format!(
                "{}{}{}",
                where_.unwrap_or_default(),
                error.message(),
                found.unwrap_or_default()
            );
            if can(Advice::SkipLost) && self.reading.skip_lost.is_none() {
                self.reading.skip_lost = Some(true);
                self.conclude("samples that the tracker has lost are left out", reason);
            } else if can(Advice::UnpaddedStamps) && self.reading.unpadded_stamps.is_none() {
                self.reading.unpadded_stamps = Some(true);
                self.conclude(
                    "digits behind the dot of times are whole nanoseconds without leading zeros",
                    format!(
                        "with them times increase throughout, and as decimals they do not: {reason}"
                    ),
                );
            } else if can(Advice::SortSamples) && self.reading.sort.is_none() {
                self.reading.sort = Some(true);
                self.conclude("samples are sorted by time", reason);
            } else if can(Advice::Split) && self.reading.split.is_none() {
                let hint = error.hint_text().unwrap_or_default();
                self.ask(Question::Split, format!("{reason}: {hint}"));
                return Ok(None);
            } else {
                return Err(error);
            }
        }
    }

    /// Asks which robot's rows are read, if the path jumps between several robots; without a column that tells them apart, asks whether
    /// the file is split.
    fn several_robots(&mut self, recording: &Recording) {
        let several = |w: &&Warning| w.code == Code::SeveralRobots;
        let Some(warning) = recording.warnings.iter().find(several) else {
            return;
        };
        let question = match names_column(warning) {
            true => Question::Robot,
            false if self.reading.split.is_none() => Question::Split,
            false => return,
        };
        if !self.has_question(&question) {
            self.ask(question, warning.message.clone());
        }
    }

    /// Keeps the doubts about the first recording, which a reader wants to know beside an open question.
    fn doubt(&mut self, recording: &Recording) {
        let is_doubt = |w: &&Warning| {
            !matches!(
                w.code,
                Code::ReadAs | Code::ColumnsIgnored | Code::SeveralRobots
            )
        };
        self.doubts = recording
            .warnings
            .iter()
            .filter(is_doubt)
            .cloned()
            .collect();
    }

    /// Infers the axis that points up from free fall or from the floor; true if the reading has changed.
    fn up(
        &mut self,
        trajectory: &Trajectory,
        fall: Option<motion::Fall>,
        body_m: Option<f64>,
    ) -> bool {
        if fall.is_none() && is_flat(trajectory) {
            self.conclude("z points up", "z is 0 throughout, as in flat odometry");
            return false;
        }
        let (up, reason) = match fall {
            Some(fall) => (fall.up, "it falls in the opposite direction".to_owned()),
            None => match body_m.and_then(|body_m| motion::above_floor(trajectory, body_m)) {
                Some((up, level_m)) => (
                    up,
                    format!("it stays near {level_m:.3} m on this axis, as on a floor"),
                ),
                None if self.reading.columns.is_empty() => {
                    self.conclude(
                        "z points up",
                        "columns have realgap's own names, whose z points up, and the motion does not say otherwise",
                    );
                    return false;
                }
                None => {
                    self.ask(Question::Up, "it never falls freely, and on no axis does it stay at a height of about its size");
                    return false;
                }
            },
        };
        let (axes, name) = match up {
            motion::Up::Z => (None, "z"),
            motion::Up::Y => (Some(Axes::YUp), "y"),
            motion::Up::MinusZ => (Some(Axes::ZDown), "-z"),
            motion::Up::MinusY => (Some(Axes::Camera), "-y"),
            motion::Up::Other => {
                self.ask(Question::Up, format!("neither y nor z points up: {reason}"));
                return false;
            }
        };
        self.conclude(format!("{name} points up"), reason);
        self.reading.axes = axes;
        axes.is_some()
    }

    /// Infers the other order of quaternions, if the robot stays upright in that order only.
    fn quaternion_order(&mut self, recording: &Recording) {
        for warning in &recording.warnings {
            if warning.code == Code::QuaternionOrder && self.reading.quaternion.is_none() {
                let order = super::QuaternionOrder::ALL
                    .iter()
                    .find(|order| warning.message.contains(&format!("\"{}\"", order.name())));
                self.reading.quaternion = order.copied();
                let finding = "quaternions are in the other order".to_owned();
                self.evidence.push(Evidence {
                    finding,
                    reason: warning.message.clone(),
                });
            }
        }
    }

    /// Infers a crop that leaves out a standstill at the start.
    fn crop(&mut self, recording: &Recording) {
        if self.reading.crop.is_some() {
            return;
        }
        let times_s = recording.trajectory.times_s();
        if let Some(from_s) = plausibility::waits_until_s(&recording.trajectory) {
            let from_s = ((from_s - times_s[0]) * 100.0).floor() / 100.0;
            self.reading.crop = Some(Crop { from_s, to_s: None });
            self.conclude(
                format!("{BEGINS} {from_s} s"),
                format!(
                    "the robot does not move before this time; the recording lasts {:.2} s",
                    recording.trajectory.duration_s()
                ),
            );
        }
        let hole = |w: &&Warning| w.code == Code::Hole;
        if let Some(warning) = recording.warnings.iter().find(hole) {
            self.conclude(
                "a gap without samples is filled with a straight line",
                warning.message.clone(),
            );
        }
    }
}

/// True if z is 0 throughout and x or y changes, as programs for robots on flat floors write it.
fn is_flat(trajectory: &Trajectory) -> bool {
    let places = trajectory.positions_world_m();
    places.iter().all(|place| place.z == 0.0)
        && places.iter().any(|place| place.xy() != places[0].xy())
}

/// A message if recordings without stated axes, of one robot of size `body_m` (metres), probably do not have x forward, y to the left and z
/// up: the robot falls along another axis than z, or moves along z while it stays at a constant height on another axis, or the axes are
/// mirrored.
pub fn odd_axes(recordings: &[Recording], body_m: f64) -> Option<String> {
    let unstated: Vec<&Recording> = (recordings.iter())
        .filter(|recording| recording.reading.axes.is_none() && !recording.trajectory.is_planar())
        .collect();
    for recording in &unstated {
        let motion = &recording.trajectory;
        let fall = motion::free_fall(motion)
            .map(|fall| (fall.up, "it falls in the opposite direction".to_owned()));
        let (up, reason) = match fall {
            Some(found) => found,
            None => match motion::above_floor(motion, body_m) {
                Some((up, level_m)) if motion::roams_along_z(motion, body_m) => (
                    up,
                    format!("it stays near {} m on this axis", number(level_m)),
                ),
                _ => continue,
            },
        };
        let Some((name, axes)) = up.setting() else {
            continue;
        };
        return Some(format!(
            "{}: {name} seems to point up ({reason}): `axes: \"{}\"` reads it with this axis up",
            recording.name,
            axes.name()
        ));
    }
    let found = motion::mirrored(recordings)?.found;
    Some(format!(
        "{}: axes seem mirrored ({found}): export them right-handed, or change the sign of one axis in both positions and orientations",
        recordings.first()?.name
    ))
}
