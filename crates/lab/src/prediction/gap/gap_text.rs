//! Floors and gaps in words.

use std::fmt;

use super::{Estimate, FloorReport, GapAndRatio, StudyGap};
use crate::claim::{evidence, verdict_lines};
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::{DisplayUnit, Unit, counted, number, quantity};

/// Writes for example `3.10 cm (2.02 to 4.41)`: all three numbers have the same unit, so that they are easy to compare.
fn in_unit(estimate: &Estimate, unit: Unit) -> String {
    let shown = DisplayUnit::for_size(unit, estimate.value);
    let value = shown.format(estimate.value);
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => {
            format!("{value} ({} to {})", shown.figure(low), shown.figure(high))
        }
        _ => value,
    }
}

impl fmt::Display for FloorReport {
    /// Writes a row for each set and metric.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("set", Side::Left),
            ("runs", Side::Right),
            ("metric", Side::Left),
            ("noise floor", Side::Left),
        ]);
        for set in &self.sets {
            let mut first = [set.set.clone(), set.floor.recordings.to_string()];
            for (index, (metric, unit)) in self.metrics.iter().enumerate() {
                let floor = set.floor.metrics.get(index);
                let floor = floor.map_or("-".to_owned(), |floor| in_unit(&floor.floor, *unit));
                let [set, runs] = std::mem::take(&mut first);
                table.push([set, runs, (*metric).to_owned(), floor]);
            }
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
    /// Writes the verdict, noise floor, gap and ratio by metric, then displacement and confidence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("metric", Side::Left),
            ("distance", Side::Left),
            ("gap ratio", Side::Left),
            ("energy ratio", Side::Right),
            ("same distribution? p", Side::Right),
        ]);
        let said = |value: Option<f64>| value.map_or("-".to_owned(), number);
        for row in &self.metrics {
            table.push([row.metric]);
            if let Some(floor) = row.floor {
                table.push(["  noise floor".to_owned(), in_unit(&floor, row.unit)]);
            }
            let mut push = |what: &str, side: &Option<GapAndRatio>, alike: [String; 2]| {
                if let Some(side) = side {
                    let ratio = side.ratio.map(|ratio| in_unit(&ratio, Unit::One));
                    let [energy_ratio, p] = alike;
                    table.push([
                        format!("  {what}"),
                        in_unit(&side.gap, row.unit),
                        ratio.unwrap_or("-".to_owned()),
                        energy_ratio,
                        p,
                    ]);
                }
            };
            let alike = [
                row.alike.and_then(|a| a.ratio),
                row.alike.map(|a| a.p_value),
            ];
            push("without noise", &row.ideal, [None, None].map(said));
            push("repeats", &row.repeats, alike.map(said));
        }
        f.write_str(&verdict_lines(&self.claims))?;
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
                "\n  displacement: real {}, repeats {}; same distribution? p = {} (Mann-Whitney), {} (Kolmogorov-Smirnov)",
                quantity(fitness.real_mean_m, Unit::Metre),
                quantity(fitness.simulated_mean_m, Unit::Metre),
                number(fitness.mann_whitney.p_value),
                number(fitness.kolmogorov_smirnov.p_value)
            )?;
        }
        evidence(&self.claims).try_for_each(|claim| write!(f, "\n  {claim}"))
    }
}
