//! What a parameter axis needs: its name and unit, its values, and the cells around them.

use super::scale::{Scale, Tick};
use realgap_core::unit::{DisplayUnit, Unit};
use realgap_core::{Error, Result};

/// Up to this many values each get a tick of their own.
const VALUES_WITH_OWN_TICK: usize = 8;

/// Name and unit of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSpec {
    /// The name, e.g. `friction`.
    pub label: String,
    /// The unit in which the values are given and shown.
    pub unit: Unit,
    /// Whether values are counts: no tick stands between whole numbers.
    pub whole: bool,
}

impl AxisSpec {
    /// A name and a unit.
    pub fn new(label: impl Into<String>, unit: Unit) -> Self {
        Self {
            label: label.into(),
            unit,
            whole: false,
        }
    }

    /// The same axis, of a count.
    #[must_use]
    pub fn whole(mut self) -> Self {
        self.whole = true;
        self
    }

    /// `friction`, `mass (kg)`.
    pub(in crate::plot) fn title(&self) -> String {
        self.display_unit().label(&self.label)
    }

    /// `friction 0.25`, `mass 0.37 kg`.
    pub(in crate::plot) fn at(&self, value: f64) -> String {
        let compact = compact(value);
        match self.display_unit().symbol {
            "" => format!("{} {compact}", self.label),
            symbol => format!("{} {compact} {symbol}", self.label),
        }
    }

    /// Parameters keep their unit, because users compare the axis with the values that they typed.
    fn display_unit(&self) -> DisplayUnit {
        DisplayUnit::for_size(self.unit, f64::INFINITY)
    }
}

/// A known true value of both axes (of one: `y` is ignored), marked in the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Value on the horizontal axis.
    pub x: f64,
    /// Value on the vertical axis of a heat map.
    pub y: f64,
    /// The text of the legend, e.g. `hidden value of the stand-in`.
    pub label: String,
}

/// Refuses values that are not finite and strictly increasing.
pub(in crate::plot) fn check_values(what: &str, values: &[f64]) -> Result<()> {
    if values.is_empty() {
        return Err(Error::invalid("a plot needs at least one value on each axis").field(what));
    }
    if let Some(value) = values.iter().find(|v| !v.is_finite() || v.abs() > 1e100) {
        return Err(Error::invalid("the values of an axis must be finite")
            .field(what)
            .found(value));
    }
    if let Some(pair) = values.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(Error::invalid("the values of an axis must increase")
            .field(what)
            .found(format!("{} followed by {}", pair[0], pair[1])));
    }
    Ok(())
}

/// The error for a chart without data.
pub(in crate::plot) fn nothing(what: &str, allowed: &str) -> Error {
    let error = Error::invalid("there is nothing to draw");
    error.field(what).allowed(allowed)
}

/// Refuses a list whose length is not that of the grid.
pub(in crate::plot) fn check_length(what: &str, found: usize, allowed: usize) -> Result<()> {
    if found == allowed {
        return Ok(());
    }
    Err(Error::invalid("a plot needs one entry for each point")
        .field(what)
        .found(found)
        .allowed(allowed))
}

/// The edges of the cells around `values`: half-way between neighbours, mirrored at both ends.
pub(in crate::plot) fn edges(values: &[f64]) -> Vec<f64> {
    match values {
        [] => vec![0.0, 1.0],
        [only] => {
            let scale = Scale::linear(*only, *only);
            vec![scale.low, scale.high]
        }
        [first, second, ..] => {
            let count = values.len();
            let (last, before) = (values[count - 1], values[count - 2]);
            let mut edges = vec![first - (second - first) / 2.0];
            let pairs = values.windows(2);
            edges.extend(pairs.map(|pair| pair[0] + (pair[1] - pair[0]) / 2.0));
            edges.push(last + (last - before) / 2.0);
            edges
        }
    }
}

/// Ticks on `scale`: at the values themselves where they are few, at round numbers otherwise.
pub(in crate::plot) fn ticks(
    spec: &AxisSpec,
    values: &[f64],
    scale: &Scale,
    count: usize,
) -> Vec<Tick> {
    let is_whole = |value: f64| !spec.whole || (value - value.round()).abs() < 1e-9;
    if values.len() > VALUES_WITH_OWN_TICK || !values.iter().all(|value| is_whole(*value)) {
        return round_ticks(spec, scale, count);
    }
    let label = |value| compact(value).replace('-', "−");
    let own = values.iter().map(|&value| (value, label(value)));
    own.map(|(value, label)| Tick { value, label }).collect()
}

/// Ticks at round numbers, and at whole ones only where the axis counts something.
pub(in crate::plot) fn round_ticks(spec: &AxisSpec, scale: &Scale, count: usize) -> Vec<Tick> {
    let mut ticks = scale.ticks(count);
    if spec.whole {
        ticks.retain(|tick| (tick.value - tick.value.round()).abs() < 1e-9);
        for tick in &mut ticks {
            tick.label = compact(tick.value.round()).replace('-', "−");
        }
    }
    ticks
}

/// `value` with at most four significant digits and no trailing zeros.
pub(in crate::plot) fn compact(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}
