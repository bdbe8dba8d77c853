//! Durations of options: seconds, with or without a unit.

/// Units of a duration, with their seconds; longer names come before their beginnings.
const UNITS: [(&str, f64); 5] = [
    ("ms", 1e-3),
    ("min", 60.0),
    ("s", 1.0),
    ("h", 3600.0),
    ("d", 86_400.0),
];

/// Seconds of a text such as `10`, `10s`, `500 ms`, `2min`, `1h`. clap prints the message itself.
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let trimmed = text.trim();
    let at = trimmed
        .find(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E'))
        .unwrap_or(trimmed.len());
    let (value, unit) = trimmed.split_at(at);
    let seconds = match unit {
        "" => Some(1.0),
        unit => UNITS.iter().find(|known| known.0 == unit).map(|u| u.1),
    };
    let value = value.trim().parse::<f64>().ok();
    let both = value.zip(seconds).map(|(value, seconds)| value * seconds);
    both.filter(|s| s.is_finite()).ok_or_else(|| {
        "a duration is a number of seconds, or has a unit: 10, 10s, 500ms, 2min, 1h, 1d".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_may_have_a_unit() {
        let cases = [
            ("10", 10.0),
            ("10s", 10.0),
            ("1e-3", 1e-3),
            ("-2.5", -2.5),
            ("500 ms", 0.5),
            ("2min", 120.0),
            ("1.5h", 5400.0),
            ("1d", 86_400.0),
        ];
        for (text, seconds) in cases {
            assert_eq!(parse_seconds(text), Ok(seconds), "{text}");
        }
        for text in ["", "s", "10 parsecs", "1:30", "NaN", "inf"] {
            let error = parse_seconds(text).unwrap_err();
            assert!(error.contains("10s"), "{text}: {error}");
        }
    }
}
