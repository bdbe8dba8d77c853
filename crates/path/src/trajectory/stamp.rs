//! Reads times of all notations: numbers in any unit, stamps in two columns, ISO 8601, and times of day.

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// A time as a cell states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stamp {
    /// Seconds, for a date since 1970.
    Absolute(f64),
    /// Seconds since midnight of an unknown day.
    OfDay(f64),
}

/// The time of day that the last sample had, and the days that have passed since the first.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Calendar {
    last_s: f64,
    days: u32,
}

impl Calendar {
    /// Seconds without the step back at midnight: a time of day more than half a day before the last belongs to the next day.
    pub(super) fn seconds(&mut self, stamp: Stamp) -> f64 {
        match stamp {
            Stamp::Absolute(seconds) => seconds,
            Stamp::OfDay(seconds) => {
                if seconds < self.last_s - 0.5 * DAY_S {
                    self.days += 1;
                }
                self.last_s = seconds;
                f64::from(self.days) * DAY_S + seconds
            }
        }
    }
}

/// A whole number of units, of which `1/factor` make a second, in seconds: whole seconds and the rest are divided separately, because stamps
/// since 1970 in nanoseconds have more digits than a number of 64 bits holds. `None` if the text is not a whole number, or the unit is
/// no such part of a second.
pub(super) fn whole_units(text: &str, factor: f64) -> Option<f64> {
    let per_s = (1.0 / factor).round();
    if !(1.0..=1e9).contains(&per_s) || (per_s * factor - 1.0).abs() > 1e-12 {
        return None;
    }
    let (count, per_s) = (text.parse::<i64>().ok()?, per_s as i64);
    let rest = count.rem_euclid(per_s) as f64 / per_s as f64;
    Some(count.div_euclid(per_s) as f64 + rest)
}

/// Seconds and the nanoseconds behind the dot, if both are whole numbers.
pub(super) fn seconds_dot_nanoseconds(text: &str) -> Option<(i64, u32)> {
    let (whole, rest) = text.split_once('.')?;
    let is_digits = !rest.is_empty() && rest.len() <= 9 && rest.bytes().all(|b| b.is_ascii_digit());
    match is_digits {
        true => Some((whole.parse().ok()?, rest.parse().ok()?)),
        false => None,
    }
}

/// A date with its time (`2024-03-01T12:00:00.123Z`, also with a space and with an offset, `1.3.2024 12:00:00`, `2024-03-01-12-00-00`), or a
/// time of day (`12:00:00.5`, `12:00:00:500000`, `1:00:00 PM`). Of dates with slashes and the year at their end only the time of day is
/// taken, because nothing says whether the day or the month stands first.
pub(super) fn stamp(text: &str) -> Option<Stamp> {
    let text = text.trim();
    if !text.is_ascii() {
        return None;
    }
    if let Some(colons) = with_colons(text) {
        return stamp(&colons);
    }
    // Every other notation has a colon; most cells that are not numbers end here.
    if !text.contains(':') {
        return None;
    }
    if let Some((date, clock)) = text.split_once([' ', '_']) {
        let (date, clock) = (date.trim_end_matches(','), clock.trim());
        if date.split('/').count() == 3 && date.len() <= 10 && date.find('/') < Some(3) {
            date.split('/')
                .try_for_each(|part| number(part).map(|_| ()))?;
            return time_of_day(clock).map(Stamp::OfDay);
        }
        if date.split('.').count() == 3 {
            let mut parts = date.split('.').map(number);
            let (day, month, year) = (parts.next()??, parts.next()??, parts.next()??);
            let day_s = days_since_1970(year, month, day).filter(|_| year >= 1970)?;
            let (whole, fraction) = (time_of_day(clock)?.trunc(), fraction(clock)?);
            return Some(Stamp::Absolute((day_s * 86_400) as f64 + whole + fraction));
        }
    }
    let bytes = text.as_bytes();
    let is_date = bytes.len() > 11
        && matches!(bytes[4], b'-' | b'/')
        && bytes[7] == bytes[4]
        && matches!(bytes[10], b'T' | b't' | b' ' | b'_');
    if !is_date {
        return time_of_day(text).map(Stamp::OfDay);
    }
    let day_s = days_since_1970(
        number(&text[..4])?,
        number(&text[5..7])?,
        number(&text[8..10])?,
    )?;
    let (clock, offset_s) = zone(text[11..].trim())?;
    let of_day_s = time_of_day(clock)?;
    // Whole seconds are added first, so that the fraction is rounded once.
    let whole = day_s * 86_400 - offset_s;
    let (seconds, fraction) = (of_day_s.trunc(), fraction(clock)?);
    Some(Stamp::Absolute(whole as f64 + seconds + fraction))
}

/// `2024-03-01-12-00-00.5`, as many programs name files, with the usual signs between its parts.
fn with_colons(text: &str) -> Option<String> {
    let bytes = text.as_bytes();
    let is_dash = |at: usize| bytes.get(at) == Some(&b'-');
    let has_dashes = [4, 7, 10, 13, 16].into_iter().all(is_dash) && !text.contains(':');
    has_dashes.then(|| format!("{}T{}", &text[..10], text[11..].replace('-', ":")))
}

/// True for `12:00:00:07`: the last part may count frames of a film, or hundredths of a second.
pub(super) fn is_time_code(text: &str) -> bool {
    let parts: Vec<&str> = text.trim().split([':', ';']).collect();
    parts.len() == 4 && parts[3].len() < 3 && parts.iter().all(|part| number(part).is_some())
}

fn number(digits: &str) -> Option<i64> {
    let is_digits = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    is_digits.then(|| digits.parse().ok()).flatten()
}

/// The digits behind the decimal point or comma, or behind a third colon, as a part of a second.
fn fraction(clock: &str) -> Option<f64> {
    match point(half_of_day(clock).0) {
        (_, None) => Some(0.0),
        (_, Some(digits)) => format!("0.{digits}").parse().ok(),
    }
}

/// The whole seconds of a time, and the digits that follow them. Behind a third colon, three, six or nine digits are a part of a second.
fn point(clock: &str) -> (&str, Option<&str>) {
    if let Some(at) = clock.find(['.', ',']) {
        return (&clock[..at], Some(&clock[at + 1..]));
    }
    let third = clock.match_indices(':').nth(2);
    match third.map(|(at, _)| (&clock[..at], &clock[at + 1..])) {
        Some((whole, digits)) if matches!(digits.len(), 3 | 6 | 9) => (whole, Some(digits)),
        _ => (clock, None),
    }
}

/// A time without AM or PM, and whether it is of the afternoon; `None` for the 24 hours of a day.
fn half_of_day(clock: &str) -> (&str, Option<bool>) {
    let lower = |end: usize| clock.get(end..).map(str::to_ascii_lowercase);
    let end = clock.len().saturating_sub(2);
    match lower(end).as_deref() {
        Some("am") => (clock[..end].trim_end(), Some(false)),
        Some("pm") => (clock[..end].trim_end(), Some(true)),
        _ => (clock, None),
    }
}

/// `HH:MM`, `HH:MM:SS`, `HH:MM:SS.f` or `HH:MM:SS:fff` in seconds since midnight, also with AM or PM.
fn time_of_day(clock: &str) -> Option<f64> {
    let (clock, afternoon) = half_of_day(clock);
    let (whole, rest) = point(clock);
    if let Some(rest) = rest {
        number(rest)?;
    }
    let mut parts = whole.split(':').map(number);
    let (hour, minute) = (parts.next()??, parts.next()??);
    let second = parts.next().unwrap_or(Some(0))?;
    let hour = match afternoon {
        Some(_) if !(1..=12).contains(&hour) => return None,
        Some(is_after) => hour % 12 + if is_after { 12 } else { 0 },
        None => hour,
    };
    // A leap second is the 61st of its minute.
    let is_sound = hour < 24 && minute < 60 && second <= 60 && parts.next().is_none();
    is_sound
        .then(|| (hour * 3600 + minute * 60 + second) as f64)
        .and_then(|seconds| Some(seconds + fraction(clock)?))
}

/// The clock's part of a text, and the offset of its zone from UTC in seconds.
fn zone(text: &str) -> Option<(&str, i64)> {
    if let Some(clock) = text.strip_suffix(['Z', 'z']) {
        return Some((clock.trim(), 0));
    }
    let Some(at) = text.rfind(['+', '-']) else {
        return Some((text, 0));
    };
    let sign = if text[at..].starts_with('-') { -1 } else { 1 };
    let digits = text[at + 1..].replace(':', "");
    let (hours, minutes) = match digits.len() {
        2 => (number(&digits)?, 0),
        4 => (number(&digits[..2])?, number(&digits[2..])?),
        _ => return None,
    };
    Some((text[..at].trim(), sign * (hours * 3600 + minutes * 60)))
}

/// The days from 1970-01-01 to a day of the Gregorian calendar (Hinnant, "chrono-compatible low-level date algorithms").
fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // Years begin in March, so that the leap day is the last one of its year.
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    Some(era * 146_097 + day_of_era - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_all_notations_are_seconds_since_1970() {
        let noon = 1_709_294_400.0;
        for (text, seconds) in [
            ("2024-03-01T12:00:00Z", noon),
            ("2024-03-01 12:00:00", noon),
            ("2024/03/01 12:00:00.25", noon + 0.25),
            ("2024-03-01T12:00:00,5Z", noon + 0.5),
            ("2024-03-01T14:00:00+02:00", noon),
            ("2024-03-01T07:30-0430", noon),
            ("1969-12-31T23:59:59Z", -1.0),
            ("2000-02-29T00:00:00Z", 951_782_400.0),
            ("01.03.2024 12:00:00,250", noon + 0.25),
            ("1.3.2024, 12:00", noon),
            ("2024-03-01-12-00-00.5", noon + 0.5),
            ("2024-03-01 12:00:00:250000", noon + 0.25),
        ] {
            assert_eq!(stamp(text), Some(Stamp::Absolute(seconds)), "{text}");
        }
        for text in [
            "",
            ":",
            "12",
            "2024-13-01T00:00:00Z",
            "2024-03-01T25:00:00Z",
            "2024-03-01T12:00:00+2",
            "1:2:3:4",
            "10:15:20:24",
            "13:00:00 PM",
            "31.02 12:00:00",
            "a/b/2024 12:00:00",
            "2024-03-01-12-00",
            "12:0a:00",
            "2024-03-01T12:00:00.Z",
            "2024-03-01T::",
            "\u{e9}:::::::::::",
        ] {
            assert_eq!(stamp(text), None, "{text}");
        }
    }

    #[test]
    fn times_of_day_of_all_notations_are_seconds_since_midnight() {
        let noon = 43_200.0;
        for (text, seconds) in [
            ("12:00:00:500", noon + 0.5),
            ("12:00:00:000001", noon + 1e-6),
            ("12:00:00,5", noon + 0.5),
            ("12:00:00.5 PM", noon + 0.5),
            ("12:00 am", 0.0),
            ("1:00:00PM", noon + 3600.0),
            ("3/1/2024 12:00:00.5", noon + 0.5),
            ("03/01/2024 1:00:00 PM", noon + 3600.0),
        ] {
            assert_eq!(stamp(text), Some(Stamp::OfDay(seconds)), "{text}");
        }
        assert!(is_time_code("10:15:20:24") && is_time_code("01:00:00;12"));
        assert!(!is_time_code("10:15:20:240") && !is_time_code("10:15:20"));
    }

    #[test]
    fn the_day_after_midnight_goes_on() {
        let mut calendar = Calendar::default();
        let all = [
            "23:59:59.5",
            "00:00:00.5",
            "12:00:00",
            "23:59:59",
            "0:00:01",
        ];
        let seconds = all.map(|text| calendar.seconds(stamp(text).unwrap()));
        assert_eq!(
            seconds,
            [86_399.5, 86_400.5, 129_600.0, 172_799.0, 172_801.0]
        );
    }

    #[test]
    fn nanoseconds_since_1970_are_rounded_once() {
        for text in ["1700000000123456789", "1700000000000000001", "-1500000000"] {
            let ns: i128 = text.parse().unwrap();
            let decimal = format!(
                "{}{}.{:09}",
                if ns < 0 { "-" } else { "" },
                ns.abs() / 1_000_000_000,
                ns.abs() % 1_000_000_000
            );
            let exact: f64 = decimal.parse().unwrap();
            assert_eq!(whole_units(text, 1e-9), Some(exact), "{text}");
        }
        assert_eq!(whole_units("2500", 1e-3), Some(2.5));
        assert_eq!(whole_units("2.5", 1e-3), None);
        assert_eq!(seconds_dot_nanoseconds("12.5"), Some((12, 5)));
        assert_eq!(seconds_dot_nanoseconds("12.1234567890"), None);
    }
}
