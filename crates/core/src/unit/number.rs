//! Formats numbers for people: with three significant digits, in a unit that suits their size.

use super::Unit;

/// The unit in which a value is displayed: `value * factor` is shown with `symbol`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Factor from the stored unit to the displayed unit.
    pub factor: f64,
    /// The symbol, empty for a dimensionless quantity.
    pub symbol: &'static str,
}

impl DisplayUnit {
    /// The unit in which values of this `size` (in `unit`) are easy to read: 0.0123 m is shown as 1.23 cm.
    pub fn for_size(unit: Unit, size: f64) -> Self {
        let size = size.abs();
        let (factor, symbol) = match unit {
            Unit::Metre if size >= 1.0 => (1.0, "m"),
            Unit::Metre if size >= 0.01 => (100.0, "cm"),
            Unit::Metre if size >= 1e-4 || size == 0.0 => (1e3, "mm"),
            Unit::Metre => (1e6, "µm"),
            Unit::Second if size < 0.1 && size > 0.0 => (1e3, "ms"),
            Unit::Radian if size < 0.1 && size > 0.0 => (1e3, "mrad"),
            Unit::Degree => (1.0, "°"),
            Unit::NewtonMetre => (1.0, "N·m"),
            Unit::NewtonMetreSecondPerRadian => (1.0, "N·m·s/rad"),
            Unit::MetrePerSecondSquared => (1.0, "m/s²"),
            other => (1.0, other.symbol()),
        };
        Self { factor, symbol }
    }

    /// One unit for all of `values`, so that they can be compared at a glance: the unit that suits their median.
    pub fn for_values(unit: Unit, values: impl IntoIterator<Item = f64>) -> Self {
        let mut sizes: Vec<f64> = values
            .into_iter()
            .filter(|value| value.is_finite() && *value != 0.0)
            .map(f64::abs)
            .collect();
        sizes.sort_by(f64::total_cmp);
        Self::for_size(unit, sizes.get(sizes.len() / 2).copied().unwrap_or(0.0))
    }

    /// `value` (in the stored unit) with its symbol: `1.23 cm`.
    pub fn format(self, value: f64) -> String {
        let number = self.figure(value);
        match self.symbol {
            "" => number,
            "°" => format!("{number}°"),
            symbol => format!("{number} {symbol}"),
        }
    }

    /// As [`DisplayUnit::format`] without the symbol, for numbers next to another number that shows the symbol.
    pub fn figure(self, value: f64) -> String {
        number(value * self.factor)
    }

    /// The label followed by the unit in brackets, if it has a symbol: `discrepancy (cm)`.
    pub fn label(self, label: &str) -> String {
        match self.symbol {
            "" => label.to_string(),
            symbol => format!("{label} ({symbol})"),
        }
    }
}

/// A range of shares in percent with the fewest decimals (at most three) at which both ends differ; one number where they do not
/// differ at three decimals.
///
/// ```
/// use realgap_core::unit::percent_range;
/// assert_eq!(percent_range(0.15, 0.85), "15 to 85 %");
/// assert_eq!(percent_range(0.9998, 1.0), "99.98 to 100 %");
/// assert_eq!(percent_range(0.5, 0.5), "50 %");
/// ```
pub fn percent_range(low: f64, high: f64) -> String {
    range_in_percent([low, high], |text| text)
}

/// As [`percent_range`], of changes: both ends have a sign.
///
/// ```
/// use realgap_core::unit::percent_change_range;
/// assert_eq!(percent_change_range(-0.1512, -0.1511), "-15.12 to -15.11 %");
/// assert_eq!(percent_change_range(-0.02, 0.3), "-2 to +30 %");
/// ```
pub fn percent_change_range(low: f64, high: f64) -> String {
    range_in_percent([low, high], |text| {
        match text.starts_with('-') || text == "0" {
            true => text,
            false => format!("+{text}"),
        }
    })
}

fn range_in_percent(ends: [f64; 2], sign: impl Fn(String) -> String) -> String {
    let text = |share: f64, places: usize| {
        let text = decimals(100.0 * share, places);
        // An end that is a whole number needs no decimals.
        match text.split_once('.') {
            Some((whole, rest)) if rest.chars().all(|c| c == '0') => whole.to_owned(),
            _ => text,
        }
    };
    let pairs = (0..=3).map(|places| ends.map(|share| text(share, places)));
    let pairs: Vec<[String; 2]> = pairs.collect();
    let different = pairs.iter().find(|[low, high]| low != high);
    match different.unwrap_or(&pairs[0]).clone() {
        [low, high] if low != high => format!("{} to {} %", sign(low), sign(high)),
        [both, _] => format!("{} %", sign(both)),
    }
}

/// The value in a unit that suits its size, with the unit's symbol: `quantity(0.0123, Unit::Metre)` is `1.23 cm`.
///
/// ```
/// use realgap_core::unit::{Unit, quantity};
/// assert_eq!(quantity(0.0123, Unit::Metre), "1.23 cm");
/// assert_eq!(quantity(12.0, Unit::Degree), "12.0°");
/// assert_eq!(quantity(0.0042, Unit::Radian), "4.20 mrad");
/// assert_eq!(quantity(0.2, Unit::One), "0.200");
/// ```
pub fn quantity(value: f64, unit: Unit) -> String {
    DisplayUnit::for_size(unit, value).format(value)
}

/// The value with this number of decimals; a value that rounds to zero has no minus sign.
///
/// ```
/// use realgap_core::unit::decimals;
/// assert_eq!([decimals(-0.04, 1), decimals(-0.06, 1)], ["0.0", "-0.1"]);
/// ```
pub fn decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|b| matches!(b, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// The value with three significant digits; with an exponent only if it is very large or very small; `–` if it is not finite.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_string();
    }
    if value == 0.0 {
        return "0".to_string();
    }
    // The exponent is taken after rounding, because 9.996 is shown as 10.0.
    let scientific = format!("{value:.2e}");
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    if (-4..6).contains(&exponent) {
        format!("{value:.*}", (2 - exponent).max(0) as usize)
    } else {
        scientific
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (9.996, "10.0"),
            (123.4, "123"),
            (123_456.0, "123456"),
            (0.000_123_4, "0.000123"),
            (-0.5, "-0.500"),
            (1.0e-7, "1.00e-7"),
            (2.5e12, "2.50e12"),
            (f64::NAN, "–"),
            (f64::INFINITY, "–"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn lengths_are_shown_in_a_unit_that_suits_their_size() {
        for (value, text) in [
            (0.0, "0 mm"),
            (1.5, "1.50 m"),
            (0.0123, "1.23 cm"),
            (0.001_23, "1.23 mm"),
            (0.000_012_3, "12.3 µm"),
            (-0.0123, "-1.23 cm"),
        ] {
            assert_eq!(quantity(value, Unit::Metre), text);
        }
        assert_eq!(quantity(0.002, Unit::Second), "2.00 ms");
    }
}
