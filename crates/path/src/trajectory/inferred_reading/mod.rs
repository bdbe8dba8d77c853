//! Infers from the content of recorded files how to read them, with the evidence for every inference and the questions that remain.
//!
//! The names of columns give roles and units. The usual interval of samples gives the unit of time. Free fall gives the unit of length and
//! the axis that points up, because its acceleration is 9.81 m/s² everywhere; without free fall, the height above the floor and the size of
//! the robot are used. Every inference is reported.

mod column;
mod motion;

use std::path::{Path, PathBuf};

use super::axes::Axes;
use super::csv::Csv;
use super::format::Format as _;
use super::reading::{Crop, Reading};
use super::registry::{format_of, parse_all, read_bytes};
use super::{Recording, Trajectory, plausibility};
use realgap_core::error::{Advice, Error, Result};

use realgap_core::unit::{GRAVITY_M_S2, LengthUnit, TimeUnit, number};
use realgap_core::warning::Code;

/// How files are to be read, with the evidence, and the questions that the files alone do not answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InferredReading {
    /// The reading: the given settings, completed by the inferred ones.
    pub reading: Reading,
    /// The inferences, each with its reason.
    pub evidence: Vec<Evidence>,
    /// The questions that the user has to answer.
    pub ambiguities: Vec<Ambiguity>,
    /// True if the first recording contains free fall.
    pub has_free_fall: bool,
}

/// An inference and its reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Evidence {
    /// The inference, e.g. `lengths are in millimetres`.
    pub finding: String,
    /// The observation from which it follows.
    pub reason: String,
}

/// A question that the files alone do not answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ambiguity {
    /// The question.
    pub question: Question,
    /// What was found in the files about it.
    pub found: String,
}

/// A question about files that the user has to answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Question {
    /// In which unit are times?
    Time,
    /// In which unit are lengths?
    Length,
    /// Which axis points up?
    Up,
    /// The rows of which robot are read, if a file holds several?
    Robot,
}

/// Plausible sampling rates of trackers, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.9..=2500.0;
/// Plausible distances that a recorded robot moves, in body lengths.
const LENGTHS: std::ops::RangeInclusive<f64> = 0.15..=150.0;
/// Relative tolerance between the acceleration of free fall and gravity.
const FALL: f64 = 0.12;

impl InferredReading {
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
        let format = format_of(path)?;
        let bytes = read_bytes(path)?;
        if format.name() == Csv.name() {
            let text = format.decode(bytes.clone(), known);
            let text = text.map_err(|e| e.at_file(path))?;
            column::infer_columns(&text, &mut guess).map_err(|e| e.at_file(path))?;
        }
        let mut recording = guess.first(path, &bytes)?;
        if known.time.is_none() && guess.time(&recording.trajectory) {
            recording = guess.first(path, &bytes)?;
        }
        if guess.has_question(&Question::Robot) {
            return Ok(guess);
        }
        let fall = motion::free_fall(&recording.trajectory);
        guess.has_free_fall = fall.is_some();
        if guess.length(&recording, fall, body_m) {
            recording = guess.first(path, &bytes)?;
        }
        if known.axes.is_none()
            && !recording.trajectory.is_planar()
            && guess.up(&recording.trajectory, fall, body_m)
        {
            recording = guess.first(path, &bytes)?;
        }
        let mut all = vec![recording.clone()];
        for other in &paths[1..] {
            let bytes = read_bytes(other)?;
            all.push(guess.first(other, &bytes)?);
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
        });
    }

    fn has_question(&self, question: &Question) -> bool {
        let mut all = self.ambiguities.iter();
        all.any(|ambiguity| ambiguity.question == *question)
    }

    /// Reads the first recording of a file, and adds settings without which it cannot be read.
    fn first(&mut self, path: &Path, bytes: &[u8]) -> Result<Recording> {
        loop {
            let error = match parse_all(path, bytes.to_vec(), &self.reading) {
                Ok(mut all) if !all.is_empty() => {
                    let recording = all.swap_remove(0);
                    self.several_robots(&recording);
                    return Ok(recording);
                }
                Ok(_) => return Err(Error::invalid("the file holds no recording").at_file(path)),
                Err(error) => error,
            };
            let can = |advice: Advice| error.advice().contains(&advice);
            let where_ = error
                .line_column()
                .map(|(line, _)| format!("line {line}: "));
            let reason = format!("{}{}", where_.unwrap_or_default(), error.message());
            if can(Advice::SkipLost) && self.reading.skip_lost.is_none() {
                self.reading.skip_lost = Some(true);
                self.conclude("samples that the tracker has lost are left out", reason);
            } else if can(Advice::SortSamples) && self.reading.sort.is_none() {
                self.reading.sort = Some(true);
                self.conclude("samples are sorted by time", reason);
            } else {
                return Err(error);
            }
        }
    }

    /// Asks which robot's rows are read, if the path jumps between several robots.
    fn several_robots(&mut self, recording: &Recording) {
        let several = |w: &&realgap_core::Warning| w.code == Code::SeveralRobots;
        let asked = self.has_question(&Question::Robot);
        if let (Some(warning), false) = (recording.warnings.iter().find(several), asked) {
            self.ask(Question::Robot, warning.message.clone());
        }
    }

    /// Infers the unit of time from the interval between samples; true if the reading has changed.
    fn time(&mut self, trajectory: &Trajectory) -> bool {
        let now = self.reading.columns.get(super::Role::Time);
        let factor = now.and_then(|column| column.factor);
        let usual_s = plausibility::usual_interval_s(trajectory);
        // The interval in the file's own unit.
        let usual = usual_s / factor.unwrap_or(1.0);
        let rate_hz = |unit: &TimeUnit| 1.0 / (usual * unit.seconds());
        if RATES_HZ.contains(&(1.0 / usual_s)) && (factor.is_some() || usual < 0.2) {
            self.conclude(
                format!("the sampling rate is {:.4} Hz", 1.0 / usual_s),
                format!("the usual interval between two samples is {usual_s:.6} s"),
            );
            return false;
        }
        let likely: Vec<TimeUnit> = TimeUnit::ALL
            .iter()
            .copied()
            .filter(|unit| RATES_HZ.contains(&rate_hz(unit)))
            .collect();
        match likely.as_slice() {
            [unit] if factor.is_none() => {
                self.reading.time = Some(*unit);
                self.conclude(
                    format!("times are in {unit}"),
                    format!(
                        "the interval between samples is {}, so the sampling rate is {:.4} Hz",
                        number(usual),
                        rate_hz(unit)
                    ),
                );
                true
            }
            _ => {
                self.ask(
                    Question::Time,
                    format!("the interval between samples is {usual} in the file's own unit"),
                );
                false
            }
        }
    }

    /// Infers the unit of length from free fall or from the robot's size; true if the reading has changed.
    fn length(
        &mut self,
        recording: &Recording,
        fall: Option<motion::Fall>,
        body_m: Option<f64>,
    ) -> bool {
        if recording.trajectory.is_of_joints() {
            return false;
        }
        let column = self.reading.columns.get(super::Role::X);
        let named = column.and_then(|column| column.factor);
        // The unit with which the lengths were read, in metres.
        let now = named.unwrap_or_else(|| self.reading.length.unwrap_or_default().metres());
        let is_stated = named.is_some() || self.reading.length.is_some() || column.is_none();
        let of = |metres: f64| {
            let mut all = LengthUnit::ALL.iter().copied();
            all.find(|unit| (unit.metres() / metres - 1.0).abs() < 1e-6)
        };
        if let Some(fall) = fall {
            let size = fall.size_m_s2;
            let fits = |unit: &&LengthUnit| {
                let there = size * unit.metres() / now;
                (there / GRAVITY_M_S2 - 1.0).abs() < FALL
            };
            if let Some(unit) = LengthUnit::ALL.iter().find(fits) {
                let there = size * unit.metres() / now;
                let reason =
                    format!("with this unit, its acceleration in free flight is {there:.2} m/s²");
                self.conclude(format!("lengths are in {unit}"), reason);
                return self.set_length(*unit, of(now));
            }
        }
        let Some(body_m) = body_m else {
            if !is_stated {
                self.ask(
                    Question::Length,
                    "no column name states the unit, the recording contains no free fall, and no robot is given",
                );
            }
            return false;
        };
        let reach = motion::reach_m(&recording.trajectory) / now;
        let lengths = |unit: &LengthUnit| reach * unit.metres() / body_m;
        let likely: Vec<LengthUnit> = LengthUnit::ALL
            .iter()
            .copied()
            .filter(|unit| LENGTHS.contains(&lengths(unit)))
            .collect();
        let current = of(now).filter(|unit| is_stated && likely.contains(unit));
        let distance =
            |unit: &LengthUnit| format!("in {unit} it moves {:.3} body lengths", lengths(unit));
        match (current, likely.as_slice()) {
            (Some(unit), _) => {
                self.conclude(
                    format!("lengths are in {unit}"),
                    format!("the names of the columns say so, and {}", distance(&unit)),
                );
                false
            }
            (None, [unit]) if !is_stated => {
                self.conclude(format!("lengths are in {unit}"), distance(unit));
                self.set_length(*unit, of(now))
            }
            _ => {
                let all: Vec<String> = LengthUnit::ALL.iter().map(distance).collect();
                self.ask(Question::Length, all.join(", "));
                false
            }
        }
    }

    /// Sets the unit of length; true if it differs from the unit `now`.
    fn set_length(&mut self, unit: LengthUnit, now: Option<LengthUnit>) -> bool {
        if now == Some(unit) {
            return false;
        }
        column::without_length_units(&mut self.reading);
        self.reading.length = Some(unit);
        true
    }

    /// Infers the axis that points up from free fall or from the floor; true if the reading has changed.
    fn up(
        &mut self,
        trajectory: &Trajectory,
        fall: Option<motion::Fall>,
        body_m: Option<f64>,
    ) -> bool {
        let (up, reason) = match fall {
            Some(fall) => (fall.up, "it falls in the opposite direction".to_owned()),
            None => match body_m.and_then(|body_m| motion::above_floor(trajectory, body_m)) {
                Some((up, level_m)) => (
                    up,
                    format!("it stays near {level_m:.3} m on this axis, as on a floor"),
                ),
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
                format!("recordings begin at {from_s} s"),
                format!(
                    "the robot does not move before this time; the recording lasts {:.2} s",
                    recording.trajectory.duration_s()
                ),
            );
        }
        let hole = |w: &&realgap_core::Warning| w.code == Code::Hole;
        if let Some(warning) = recording.warnings.iter().find(hole) {
            self.conclude(
                "a gap without samples is filled with a straight line",
                warning.message.clone(),
            );
        }
    }
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
        let (name, axes) = match up {
            motion::Up::Y => ("y", Axes::YUp),
            motion::Up::MinusZ => ("-z", Axes::ZDown),
            motion::Up::MinusY => ("-y", Axes::Camera),
            motion::Up::Z | motion::Up::Other => continue,
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
