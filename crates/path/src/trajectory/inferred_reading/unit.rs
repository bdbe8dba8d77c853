//! Infers the units of times and lengths.

use super::super::column::Measure;
use super::super::{Recording, Role, Trajectory, plausibility};
use super::{Candidate, Content, FALL, InferredReading, Question, column, motion};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, LengthUnit, TimeUnit, number};

/// Plausible sampling rates of trackers, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.9..=2500.0;
/// The longest interval between samples that is plausible in seconds if nothing states the unit, in the file's own unit.
const SHORT: f64 = 0.2;
/// Plausible distances that a recorded robot moves, in body lengths.
const LENGTHS: std::ops::RangeInclusive<f64> = 0.15..=150.0;
/// The fastest plausible robot, body lengths per second: a longer way is plausible if it took as long.
const FAST_1_S: f64 = 5.0;
/// Stamps between these seconds since 1970 (1990 and 2100) are dates; other times count from the start of something.
const DATES_S: std::ops::Range<f64> = 631_152_000.0..4_102_444_800.0;
/// Sampling rates with which the size of times is believed to be that of a date, Hz.
const DATED_RATES_HZ: std::ops::RangeInclusive<f64> = 1e-3..=1e5;
/// Plausible largest speeds of robots if no robot is known, m/s.
const SPEEDS_M_S: std::ops::RangeInclusive<f64> = 2e-3..=30.0;

impl InferredReading {
    /// Infers the unit of time from the size of dates or from the interval between samples; true if the reading has changed.
    pub(super) fn time(&mut self, file: &Content, trajectory: &Trajectory) -> Result<bool> {
        let now = self.reading.columns.get(Role::Time);
        let factor = now.and_then(|column| column.factor);
        let usual_s = plausibility::usual_interval_s(trajectory);
        // The interval in the file's own unit.
        let usual = usual_s / factor.unwrap_or(1.0);
        let rate_hz = |unit: &TimeUnit| 1.0 / (usual * unit.seconds());
        let rate = |rate_hz: f64| format!("the sampling rate is {rate_hz:.4} Hz");
        let has_dates = file.text.as_deref();
        let has_dates = has_dates.is_some_and(|text| column::has_dates(text, &self.reading));
        let is_counted = self.reading.rate_hz.is_some();
        if has_dates || is_counted {
            let reason = match has_dates {
                true => "times are dates or times of day",
                false => "the rate is stated",
            };
            self.conclude(rate(1.0 / usual_s), reason);
            return Ok(false);
        }
        let first = trajectory.times_s()[0] / factor.unwrap_or(1.0);
        let is_date = |unit: &&TimeUnit| {
            DATES_S.contains(&(first * unit.seconds())) && DATED_RATES_HZ.contains(&rate_hz(unit))
        };
        if factor.is_none()
            && let Some(unit) = TimeUnit::ALL.iter().find(is_date)
        {
            let reason = format!("{first} {unit} since 1970 are a date of our time");
            self.conclude(format!("times are in {unit}"), reason);
            return match unit {
                TimeUnit::Second => Ok(false),
                unit => self.set_time(file, *unit).map(|()| true),
            };
        }
        let is_named = file.text.as_deref();
        let is_named = is_named.is_some_and(|text| column::names_time_unit(text, &self.reading));
        let is_stated = factor.is_some() || is_named;
        if RATES_HZ.contains(&(1.0 / usual_s)) && (is_stated || usual < SHORT) {
            let reason = format!("the usual interval between two samples is {usual_s:.6} s");
            self.conclude(rate(1.0 / usual_s), reason);
            return Ok(false);
        }
        let likely: Vec<TimeUnit> = TimeUnit::ALL
            .iter()
            .copied()
            .filter(|unit| RATES_HZ.contains(&rate_hz(unit)))
            .collect();
        match likely.as_slice() {
            [unit] if factor.is_none() => {
                self.conclude(
                    format!("times are in {unit}"),
                    format!(
                        "the interval between samples is {}, so the sampling rate is {:.4} Hz",
                        number(usual),
                        rate_hz(unit)
                    ),
                );
                self.set_time(file, *unit).map(|()| true)
            }
            _ => {
                self.ask(
                    Question::Time,
                    format!("the interval between samples is {usual} in the file's own unit"),
                );
                Ok(false)
            }
        }
    }

    fn set_time(&mut self, file: &Content, unit: TimeUnit) -> Result<()> {
        self.reading.time = Some(unit);
        match &file.text {
            Some(text) => column::restate(text, &mut self.reading, Measure::Time, unit.symbol()),
            None => Ok(()),
        }
    }

    /// The size of the unit with which lengths were read, in metres, and true if the file or the user states it.
    fn length_now(&self, file: &Content) -> (f64, bool) {
        let stated = file.text.as_deref();
        let stated = stated.and_then(|text| column::stated_length_m(text, &self.reading));
        let usual = self.reading.factor(Measure::Length);
        let is_given = self.reading.length.is_some() || self.reading.scale.is_some();
        // Formats without names of columns define their unit.
        let is_stated = stated.is_some() || is_given || file.text.is_none();
        (stated.unwrap_or(usual), is_stated)
    }

    /// Infers the unit of length from free fall; `None` if nothing falls with the acceleration of gravity.
    fn length_by_fall(
        &mut self,
        file: &Content,
        fall: Option<motion::Fall>,
        now: f64,
    ) -> Result<Option<bool>> {
        let Some(fall) = fall else {
            return Ok(None);
        };
        let there = |unit: &LengthUnit| fall.size_m_s2 * unit.metres() / now;
        let fits = |unit: &&LengthUnit| (there(unit) / GRAVITY_M_S2 - 1.0).abs() < FALL;
        // The unit as it is read comes first, because an inch and a foot are near to other units.
        let current = column::unit_of_size(now);
        let current = current.filter(|unit| fits(&unit));
        let Some(unit) = current.or_else(|| LengthUnit::METRIC.iter().find(fits).copied()) else {
            return Ok(None);
        };
        let reason = format!(
            "with this unit, its acceleration in free flight is {:.2} m/s²",
            there(&unit)
        );
        self.conclude(format!("lengths are in {unit}"), reason);
        self.set_length(file, unit, now).map(Some)
    }

    /// Infers the unit of length from free fall or from the robot's size; true if the reading has changed.
    pub(super) fn length(
        &mut self,
        file: &Content,
        recording: &Recording,
        fall: Option<motion::Fall>,
        body_m: Option<f64>,
    ) -> Result<bool> {
        let motion = &recording.trajectory;
        if motion.is_of_joints() {
            return Ok(false);
        }
        let is_given = self.reading.length.is_some() || self.reading.scale.is_some();
        let (now, is_stated) = self.length_now(file);
        if is_given {
            let doubt = body_m.map(|body_m| {
                let lengths = motion::reach_m(motion) / body_m;
                let doubt = match LENGTHS.contains(&lengths) {
                    true => "",
                    false => ", which is doubtful",
                };
                format!("; so it moves {} body lengths{doubt}", number(lengths))
            });
            let by = match is_named_otherwise(file, self, now) {
                true => "the names of the columns state this, not the unit that was given",
                false => "this is stated",
            };
            self.conclude(
                format!("lengths are in units of {now} m"),
                format!("{by}{}", doubt.unwrap_or_default()),
            );
            return Ok(false);
        }
        if let Some(changed) = self.length_by_fall(file, fall, now)? {
            return Ok(changed);
        }
        let Some(body_m) = body_m else {
            if !is_stated {
                self.ask(
                    Question::Length,
                    "no column name states the unit, the recording contains no free fall, and no robot is given",
                );
            }
            return Ok(false);
        };
        let reach = motion::reach_m(motion) / now;
        let lengths = |metres: f64| reach * metres / body_m;
        let likely: Vec<LengthUnit> = LengthUnit::METRIC
            .iter()
            .copied()
            .filter(|unit| LENGTHS.contains(&lengths(unit.metres())))
            .collect();
        let distance = |name: String, metres: f64| {
            format!("in {name} it moves {:.3} body lengths", lengths(metres))
        };
        let is_slow = lengths(now) <= FAST_1_S * motion.duration_s();
        let is_plausible =
            *LENGTHS.start() <= lengths(now) && (lengths(now) <= *LENGTHS.end() || is_slow);
        if is_stated && is_plausible {
            let name = match column::unit_of_size(now) {
                Some(unit) => unit.to_string(),
                None => format!("units of {now} m"),
            };
            self.conclude(
                format!("lengths are in {name}"),
                format!("the file says so, and {}", distance(name, now)),
            );
            return Ok(false);
        }
        match likely.as_slice() {
            [unit] if !is_stated => {
                let reason = distance(unit.to_string(), unit.metres());
                self.conclude(format!("lengths are in {unit}"), reason);
                self.set_length(file, *unit, now)
            }
            _ => {
                let all = LengthUnit::METRIC.iter();
                let all: Vec<String> = all.map(|u| distance(u.to_string(), u.metres())).collect();
                self.ask(Question::Length, all.join(", "));
                if let (true, Some(text)) = (is_stated, &file.text) {
                    self.offer_mappings(text)?;
                }
                Ok(false)
            }
        }
    }

    /// Adds to the last question how the columns are mapped for each unit, because their names state one that may be wrong.
    fn offer_mappings(&mut self, text: &str) -> Result<()> {
        let mut candidates = Vec::new();
        for unit in LengthUnit::METRIC {
            let mut reading = self.reading.clone();
            column::restate(text, &mut reading, Measure::Length, unit.symbol())?;
            candidates.push(Candidate {
                name: unit.symbol().to_owned(),
                columns: reading.columns,
            });
        }
        if let Some(open) = self.ambiguities.last_mut() {
            open.candidates = candidates;
        }
        Ok(())
    }

    /// Takes lengths of an unstated unit for metres, if the speeds are those of robots; asks otherwise.
    pub(super) fn length_without_robot(
        &mut self,
        file: &Content,
        recording: &Recording,
        fall: Option<motion::Fall>,
    ) -> Result<()> {
        let motion = &recording.trajectory;
        let (now, is_stated) = self.length_now(file);
        if is_stated || motion.is_of_joints() || self.length_by_fall(file, fall, now)?.is_some() {
            return Ok(());
        }
        let speed_m_s = usual_speed_m_s(motion);
        if speed_m_s == 0.0 || SPEEDS_M_S.contains(&speed_m_s) {
            self.set_length(file, LengthUnit::Metre, f64::NAN)?;
            self.conclude(
                "lengths are taken for metres",
                format!(
                    "nothing states their unit, and a speed of {} m/s suits a robot",
                    number(speed_m_s)
                ),
            );
            return Ok(());
        }
        self.ask(
            Question::Length,
            format!(
                "nothing states the unit, and in metres the speed is {} m/s",
                number(speed_m_s)
            ),
        );
        Ok(())
    }

    /// Sets the unit of length; true if it differs from the unit of size `now`.
    fn set_length(&mut self, file: &Content, unit: LengthUnit, now: f64) -> Result<bool> {
        if (unit.metres() / now - 1.0).abs() < 1e-9 {
            return Ok(false);
        }
        self.reading.length = Some(unit);
        self.reading.scale = None;
        if let Some(text) = &file.text {
            column::restate(text, &mut self.reading, Measure::Length, unit.symbol())?;
        }
        Ok(true)
    }
}

/// True if the file states another unit than the reading.
fn is_named_otherwise(file: &Content, guess: &InferredReading, now: f64) -> bool {
    let given = guess.reading.factor(Measure::Length);
    file.text.is_some() && (now / given - 1.0).abs() > 1e-9
}

/// The speed that nine tenths of the intervals do not exceed, m/s.
fn usual_speed_m_s(motion: &Trajectory) -> f64 {
    let (times_s, places) = (motion.times_s(), motion.positions_world_m());
    let mut all: Vec<f64> = (1..places.len())
        .map(|k| (places[k] - places[k - 1]).norm() / (times_s[k] - times_s[k - 1]))
        .collect();
    all.sort_by(f64::total_cmp);
    all[all.len() * 9 / 10]
}
