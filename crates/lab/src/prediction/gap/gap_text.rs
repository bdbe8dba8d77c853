//! Floors and gaps in words.

use std::fmt;

use super::distance::GapAndRatio;
use super::estimate::Estimate;
use super::set::FloorReport;
use super::study::StudyGap;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::{Unit, counted, number, quantity};

/// `3.1 cm (2.0 to 4.4)`.
fn in_unit(estimate: &Estimate, unit: Unit) -> String {
    let value = quantity(estimate.value, unit);
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => {
            format!(
                "{value} ({} to {})",
                quantity(low, unit),
                quantity(high, unit)
            )
        }
        _ => value,
    }
}

impl fmt::Display for FloorReport {
    /// A row a set, a column a metric.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut columns = vec![("set", Side::Left), ("runs", Side::Right)];
        columns.extend(self.metrics.iter().map(|(name, _)| (*name, Side::Right)));
        let mut table = TextTable::new(columns);
        for set in &self.sets {
            let mut row = vec![set.set.clone(), set.floor.recordings.to_string()];
            for (index, (_, unit)) in self.metrics.iter().enumerate() {
                row.push(match set.floor.metrics.get(index) {
                    Some(floor) => in_unit(&floor.floor, *unit),
                    None => "-".to_owned(),
                });
            }
            table.push(row);
        }
        write!(
            f,
            "noise floor: mean distance between repeats (95 % interval over recordings)\n{}",
            table.render(false).trim_end()
        )?;
        let mut claims = self.claims.iter();
        claims.try_for_each(|claim| write!(f, "\n  {claim}"))
    }
}

impl fmt::Display for StudyGap {
    /// Noise floor, gap and ratio by metric, then displacement and confidence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("metric", Side::Left),
            ("noise floor", Side::Right),
            ("simulation", Side::Left),
            ("gap", Side::Right),
            ("gap ratio", Side::Right),
            ("energy ratio", Side::Right),
            ("drawn alike? p", Side::Right),
        ]);
        let said = |value: Option<f64>| value.map_or("-".to_owned(), number);
        for row in &self.metrics {
            let floor = row.floor.map_or("-".to_owned(), |f| in_unit(&f, row.unit));
            let mut push = |first: [&str; 3], side: &Option<GapAndRatio>, alike: [String; 2]| {
                let [name, floor, what] = first;
                let [energy_ratio, p] = alike;
                if let Some(side) = side {
                    table.push([
                        name.to_owned(),
                        floor.to_owned(),
                        what.to_owned(),
                        in_unit(&side.gap, row.unit),
                        side.ratio
                            .map_or("-".to_owned(), |ratio| in_unit(&ratio, Unit::One)),
                        energy_ratio,
                        p,
                    ]);
                }
            };
            let alike = [
                row.alike.and_then(|a| a.ratio),
                row.alike.map(|a| a.p_value),
            ]
            .map(said);
            let none = [None, None].map(said);
            push([row.metric, &floor, "without noise"], &row.ideal, none);
            push(["", "", "repeats, mean"], &row.repeats, alike);
        }
        write!(
            f,
            "{}: {} of {}, {} under noise each (95 % intervals over recordings)\n{}",
            self.study,
            counted(self.recordings, "recording"),
            counted(self.starts, "start"),
            counted(self.repeats, "repeat"),
            table.render(false).trim_end()
        )?;
        if let Some(fitness) = &self.displacement {
            write!(
                f,
                "\n  displacement: real {}, repeats {}; drawn alike? p = {} (Mann-Whitney), {} (Kolmogorov-Smirnov)",
                quantity(fitness.real_mean_m, Unit::Metre),
                quantity(fitness.simulated_mean_m, Unit::Metre),
                number(fitness.mann_whitney.p_value),
                number(fitness.kolmogorov_smirnov.p_value)
            )?;
        }
        let mut claims = self.claims.iter();
        claims.try_for_each(|claim| write!(f, "\n  {claim}"))
    }
}
