//! How somebody's files are to be read, guessed from what is in them: each guess with its evidence, and what stays open.
//!
//! Names of columns carry roles and units; the usual interval tells the unit of time; free fall tells the unit of length and which way
//! is up, for it is 9.81 m/s² everywhere; else the floor does, beside the size of the robot. Nothing here is done without a word.

mod column;
mod motion;

use std::path::{Path, PathBuf};

use super::axes::Axes;
use super::csv::Csv;
use super::format::Format as _;
use super::reading::{Crop, Reading};
use super::registry::{format_of, parse_all, read_bytes};
use super::{Recording, Trajectory, suspicion};
use realgap_core::error::{Advice, Error, Result};

use realgap_core::unit::{GRAVITY_M_S2, LengthUnit, TimeUnit, number};
use realgap_core::warning::Code;

/// How files are to be read, why, and what nobody can tell from the files alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InferredReading {
    /// What was said before, and what was guessed.
    pub reading: Reading,
    /// What was guessed, each with its evidence.
    pub clues: Vec<Evidence>,
    /// What somebody has to say.
    pub open: Vec<Ambiguity>,
    /// Whether the first recording falls freely somewhere.
    pub falls: bool,
}

/// A guess and its evidence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Evidence {
    /// What is taken to be so.
    pub what: String,
    /// What it was seen from.
    pub because: String,
}

/// What the files alone do not tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ambiguity {
    /// What is asked.
    pub ask: Question,
    /// What was seen of it.
    pub found: String,
}

/// What somebody has to say about files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Question {
    /// The unit of times.
    Time,
    /// The unit of lengths.
    Length,
    /// Which axis points up.
    Up,
    /// Whose rows are read, of several objects.
    Whose,
}

/// Rates that trackers have, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.9..=2500.0;
/// A robot that is recorded goes this many of its lengths, at least and at most.
const LENGTHS: std::ops::RangeInclusive<f64> = 0.15..=150.0;
/// Free fall is recognised within this share.
const FALL: f64 = 0.12;

impl InferredReading {
    /// How these files are to be read, as the first of them tells. What `known` says is not guessed; `body_m` is the size of the
    /// robot, metres.
    ///
    /// # Errors
    /// A file that cannot be read whatever is guessed: no column of times or positions, nothing but a header, another header than the
    /// first one's, mirrored axes.
    pub fn of(paths: &[PathBuf], known: &Reading, body_m: Option<f64>) -> Result<Self> {
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
            column::name(&text, &mut guess).map_err(|e| e.at_file(path))?;
        }
        let mut recording = guess.first(path, &bytes)?;
        if known.time.is_none() && guess.time(&recording.trajectory) {
            recording = guess.first(path, &bytes)?;
        }
        if guess.open.iter().any(|open| open.ask == Question::Whose) {
            return Ok(guess);
        }
        let fall = motion::free_fall(&recording.trajectory);
        guess.falls = fall.is_some();
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
        if let Some(found) = motion::mirrored(&all) {
            return Err(Error::invalid("the recording is mirrored")
                .at_file(path)
                .found(found)
                .allowed("right-handed axes: x forward, y to the left, z up")
                .hint("export it with right-handed axes, or change the sign of one axis in positions and orientations alike"));
        }
        guess.turned(&recording);
        guess.part(&recording);
        Ok(guess)
    }

    fn say(&mut self, what: impl Into<String>, because: impl Into<String>) {
        self.clues.push(Evidence {
            what: what.into(),
            because: because.into(),
        });
    }

    fn ask(&mut self, ask: Question, found: impl Into<String>) {
        self.open.push(Ambiguity {
            ask,
            found: found.into(),
        });
    }

    /// The first recording of a file, with what it takes to read it at all.
    fn first(&mut self, path: &Path, bytes: &[u8]) -> Result<Recording> {
        loop {
            let error = match parse_all(path, bytes.to_vec(), &self.reading) {
                Ok(mut all) if !all.is_empty() => {
                    let recording = all.swap_remove(0);
                    self.whose(&recording);
                    return Ok(recording);
                }
                Ok(_) => return Err(Error::invalid("no recording").at_file(path)),
                Err(error) => error,
            };
            let can = |advice: Advice| error.advice().contains(&advice);
            let where_ = error
                .line_column()
                .map(|(line, _)| format!("line {line}: "));
            let because = format!("{}{}", where_.unwrap_or_default(), error.message());
            if can(Advice::SkipLost) && self.reading.skip_lost.is_none() {
                self.reading.skip_lost = Some(true);
                self.say("samples that the tracker has lost are left out", because);
            } else if can(Advice::SortSamples) && self.reading.sort.is_none() {
                self.reading.sort = Some(true);
                self.say("samples are sorted by time", because);
            } else {
                return Err(error);
            }
        }
    }

    /// Asks whose rows are meant, where a path jumps between several.
    fn whose(&mut self, recording: &Recording) {
        let several = |w: &&realgap_core::Warning| w.code == Code::SeveralRobots;
        let asked = self.open.iter().any(|open| open.ask == Question::Whose);
        if let (Some(warning), false) = (recording.warnings.iter().find(several), asked) {
            self.ask(Question::Whose, warning.message.clone());
        }
    }

    /// The unit of time, from how far samples are apart; whether it is another than before.
    fn time(&mut self, trajectory: &Trajectory) -> bool {
        let now = self.reading.columns.get(super::Role::Time);
        let factor = now.and_then(|column| column.factor);
        let usual_s = suspicion::usual_interval_s(trajectory);
        // As the file has it.
        let usual = usual_s / factor.unwrap_or(1.0);
        let rate_hz = |unit: &TimeUnit| 1.0 / (usual * unit.seconds());
        if RATES_HZ.contains(&(1.0 / usual_s)) && (factor.is_some() || usual < 0.2) {
            self.say(
                format!("{:.4} samples a second", 1.0 / usual_s),
                format!("usually {usual_s:.6} s between two samples"),
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
                self.say(
                    format!("times are in {unit}"),
                    format!(
                        "samples are {} apart, which is {:.4} Hz",
                        number(usual),
                        rate_hz(unit)
                    ),
                );
                true
            }
            _ => {
                self.ask(
                    Question::Time,
                    format!("samples are {usual} apart in the file's own unit"),
                );
                false
            }
        }
    }

    /// The unit of length, from free fall or the robot's size; whether it is another than before.
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
        // As it was read.
        let now = named.unwrap_or_else(|| self.reading.length.unwrap_or_default().metres());
        let is_said = named.is_some() || self.reading.length.is_some() || column.is_none();
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
                let because = format!("in free flight it falls with {there:.2} m/s² then");
                self.say(format!("lengths are in {unit}"), because);
                return self.set_length(*unit, of(now));
            }
        }
        let Some(body_m) = body_m else {
            if !is_said {
                self.ask(
                    Question::Length,
                    "no name of a column says it, nothing falls freely, and no robot is known",
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
        let current = of(now).filter(|unit| is_said && likely.contains(unit));
        let seen = |unit: &LengthUnit| {
            format!("it goes {:.3} robot's lengths far in {unit}", lengths(unit))
        };
        match (current, likely.as_slice()) {
            (Some(unit), _) => {
                self.say(
                    format!("lengths are in {unit}"),
                    format!("so they are named, and {}", seen(&unit)),
                );
                false
            }
            (None, [unit]) if !is_said => {
                self.say(format!("lengths are in {unit}"), seen(unit));
                self.set_length(*unit, of(now))
            }
            _ => {
                let all: Vec<String> = LengthUnit::ALL.iter().map(seen).collect();
                self.ask(Question::Length, all.join(", "));
                false
            }
        }
    }

    /// Takes lengths in this unit; whether it is another than before.
    fn set_length(&mut self, unit: LengthUnit, now: Option<LengthUnit>) -> bool {
        if now == Some(unit) {
            return false;
        }
        column::without_length_units(&mut self.reading);
        self.reading.length = Some(unit);
        true
    }

    /// Which way is up, by free fall or by the floor; whether it is another than before.
    fn up(
        &mut self,
        trajectory: &Trajectory,
        fall: Option<motion::Fall>,
        body_m: Option<f64>,
    ) -> bool {
        let (up, because) = match fall {
            Some(fall) => (fall.up, "it falls the other way".to_owned()),
            None => {
                match body_m.and_then(|body_m| motion::above_floor(trajectory, body_m)) {
                    Some((up, level_m)) => (
                        up,
                        format!("it stays near {level_m:.3} m along it, as on a floor"),
                    ),
                    None => {
                        self.ask(Question::Up, "it never falls freely, and stays at no height of its size along one axis");
                        return false;
                    }
                }
            }
        };
        let (axes, name) = match up {
            motion::Up::Z => (None, "z"),
            motion::Up::Y => (Some(Axes::YUp), "y"),
            motion::Up::MinusZ => (Some(Axes::ZDown), "-z"),
            motion::Up::MinusY => (Some(Axes::Camera), "-y"),
            motion::Up::Other => {
                self.ask(
                    Question::Up,
                    format!("neither y nor z points up: {because}"),
                );
                return false;
            }
        };
        self.say(format!("{name} points up"), because);
        self.reading.axes = axes;
        axes.is_some()
    }

    /// The other order of quaternions, where a robot stays upright in it alone.
    fn turned(&mut self, recording: &Recording) {
        for warning in &recording.warnings {
            if warning.code == Code::QuaternionOrder && self.reading.quaternion.is_none() {
                let order = super::QuaternionOrder::ALL
                    .iter()
                    .find(|order| warning.message.contains(&format!("\"{}\"", order.name())));
                self.reading.quaternion = order.copied();
                let what = "quaternions are in the other order".to_owned();
                self.clues.push(Evidence {
                    what,
                    because: warning.message.clone(),
                });
            }
        }
    }

    /// The part in which it moves.
    fn part(&mut self, recording: &Recording) {
        if self.reading.crop.is_some() {
            return;
        }
        let times_s = recording.trajectory.times_s();
        if let Some(from_s) = suspicion::waits_until_s(&recording.trajectory) {
            let from_s = ((from_s - times_s[0]) * 100.0).floor() / 100.0;
            self.reading.crop = Some(Crop { from_s, to_s: None });
            self.say(
                format!("recordings begin at {from_s} s"),
                format!(
                    "nothing moves before, of {:.2} s",
                    recording.trajectory.duration_s()
                ),
            );
        }
        let hole = |w: &&realgap_core::Warning| w.code == Code::Hole;
        if let Some(warning) = recording.warnings.iter().find(hole) {
            self.say(
                "a hole is filled with a straight line",
                warning.message.clone(),
            );
        }
    }
}

/// Why the axes of these recordings of one robot of size `body_m` (metres) are hardly x forward, y to the left, z up, where nobody
/// said so: they fall along another axis than z, go up and down along z as over a floor while another axis stays at the robot's
/// height, or are mirrored.
pub fn odd_axes(recordings: &[Recording], body_m: f64) -> Option<String> {
    let unsaid: Vec<&Recording> = (recordings.iter())
        .filter(|recording| recording.reading.axes.is_none() && !recording.trajectory.is_planar())
        .collect();
    for recording in &unsaid {
        let motion = &recording.trajectory;
        let fall =
            motion::free_fall(motion).map(|fall| (fall.up, "it falls the other way".to_owned()));
        let (up, because) = match fall {
            Some(found) => found,
            None => match motion::above_floor(motion, body_m) {
                Some((up, level_m)) if motion::roams_along_z(motion, body_m) => {
                    (up, format!("it stays near {} m along it", number(level_m)))
                }
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
            "{}: {name} seems to point up ({because}): `axes: \"{}\"` reads it so",
            recording.name,
            axes.name()
        ));
    }
    let found = motion::mirrored(recordings)?;
    Some(format!(
        "{}: axes seem mirrored ({found}): export them right-handed, or change the sign of one axis in positions and orientations alike",
        recordings.first()?.name
    ))
}
