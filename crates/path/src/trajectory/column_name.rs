//! Interprets the name of a column: its words, and the unit that it states.

use super::column::Measure;
use realgap_core::unit::{AngleUnit, LengthUnit, TimeUnit};

/// The unit of a column, as its name or a row of units states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StatedUnit {
    /// A unit of a known size: its symbol, and its size in the SI unit.
    Known(&'static str, f64),
    /// Pixels, whose size in metres depends on the camera.
    Pixel,
}

/// The words of a name in lower case: the name is split at every character that is neither a letter nor a digit, and between a lower-case and
/// an upper-case letter. The micro and degree signs count as letters.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut was_small = false;
    for c in name.chars() {
        let is_letter = c.is_alphanumeric() || c == '\u{b0}';
        let ends = !is_letter || (was_small && c.is_uppercase());
        if ends && all.last().is_some_and(|word| !word.is_empty()) {
            all.push(String::new());
        }
        if is_letter && let Some(word) = all.last_mut() {
            word.extend(c.to_lowercase());
        }
        was_small = c.is_lowercase();
    }
    all.retain(|word| !word.is_empty());
    all
}

/// The unit of a quantity of this kind that a word in lower case names.
pub(super) fn unit_of_word(word: &str, measure: Measure) -> Option<StatedUnit> {
    let known = |symbol, size| Some(StatedUnit::Known(symbol, size));
    match measure {
        Measure::Time => TimeUnit::by_word(word).and_then(|u| known(u.symbol(), u.seconds())),
        Measure::Length if matches!(word, "px" | "pix" | "pixel" | "pixels") => {
            Some(StatedUnit::Pixel)
        }
        Measure::Length => LengthUnit::by_word(word).and_then(|u| known(u.symbol(), u.metres())),
        Measure::Angle => AngleUnit::by_word(word).and_then(|u| known(u.symbol(), u.radians())),
        _ => None,
    }
}

/// The unit at the end of a name, if it is one of a quantity of this kind: `x_mm`, `Time (ms)`, `vx_mm_s`, `wz_deg_s`. A name that is nothing
/// but a unit states none.
pub(super) fn unit_in_name(name: &str, measure: Measure) -> Option<StatedUnit> {
    let words = words(name);
    let mut before: &[String] = &words;
    let base = match measure {
        Measure::Velocity | Measure::AngularVelocity => {
            let (last, rest) = words.split_last()?;
            before = match (last.as_str(), rest.split_last()) {
                // vx_m_per_s
                ("s" | "sec", Some((per, rest))) if per == "per" => rest,
                ("s" | "sec", Some(_)) => rest,
                _ => return None,
            };
            match measure {
                Measure::Velocity => Measure::Length,
                _ => Measure::Angle,
            }
        }
        measure => measure,
    };
    let (last, rest) = before.split_last()?;
    if rest.is_empty() {
        return None;
    }
    unit_of_word(last, base)
}

/// The unit in a cell of a row of units: `mm`, `[m]`, `(deg)`, `m/s`.
pub(super) fn unit_in_row(cell: &str, measure: Measure) -> Option<StatedUnit> {
    let cell = cell.trim_matches(|c: char| "[]() ".contains(c));
    let (base, word) = match (measure, cell.strip_suffix("/s")) {
        (Measure::Velocity, Some(word)) => (Measure::Length, word),
        (Measure::AngularVelocity, Some(word)) => (Measure::Angle, word),
        (Measure::Velocity | Measure::AngularVelocity, None) => return None,
        (measure, _) => (measure, cell),
    };
    unit_of_word(&word.to_lowercase(), base)
}

/// True if a row below the names holds units: no numbers, nothing but units, and at least one.
pub(super) fn is_row_of_units<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let kinds = [
        Measure::Time,
        Measure::Length,
        Measure::Angle,
        Measure::Velocity,
        Measure::AngularVelocity,
    ];
    let mut units = 0;
    for cell in cells {
        let bare = cell.trim_matches(|c: char| "[]() ".contains(c));
        if kinds.iter().any(|kind| unit_in_row(cell, *kind).is_some()) {
            units += 1;
        } else if !["", "-", "none", "unitless", "1"].contains(&bare) {
            let is_compound = bare.contains('/') && !bare.contains(|c: char| c.is_ascii_digit());
            if !is_compound {
                return false;
            }
        }
    }
    units > 0
}

/// True if a column with this name counts samples.
pub(super) fn counts_samples(name: &str) -> bool {
    let counters = [
        "frame", "frames", "index", "idx", "sample", "samples", "step", "row", "seq", "number",
        "no", "count", "counter",
    ];
    let words = words(name);
    words
        .last()
        .is_some_and(|last| counters.contains(&last.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_at_the_end_of_names() {
        let of = |name, measure| match unit_in_name(name, measure) {
            Some(StatedUnit::Known(symbol, _)) => Some(symbol),
            Some(StatedUnit::Pixel) => Some("px"),
            None => None,
        };
        for (name, measure, unit) in [
            ("x_mm", Measure::Length, Some("mm")),
            ("X (inches)", Measure::Length, Some("in")),
            ("px_x_px", Measure::Length, Some("px")),
            ("pose.x", Measure::Length, None),
            ("m", Measure::Length, None),
            ("TimeUS", Measure::Time, Some("us")),
            ("time_boot_ms", Measure::Time, Some("ms")),
            ("Time [\u{b5}s]", Measure::Time, Some("us")),
            ("x_mm", Measure::Time, None),
            ("vx_mm_s", Measure::Velocity, Some("mm")),
            ("wz_deg_s", Measure::AngularVelocity, Some("deg")),
            ("yaw [\u{b0}]", Measure::Angle, Some("deg")),
        ] {
            assert_eq!(of(name, measure), unit, "{name}");
        }
    }

    #[test]
    fn a_row_of_units_holds_nothing_else() {
        let is = |row: &str| is_row_of_units(row.split(','));
        assert!(is("s,m,m,deg,m/s,") && is("[ms],[mm],[mm]") && is("ns,m,m,-,-"));
        assert!(!is("0,1,2") && !is("a,m,m") && !is(",,") && !is("nan,nan,nan"));
    }
}
