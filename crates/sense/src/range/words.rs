//! A characterisation in words.

use std::fmt;

use super::characterisation::{Characterisation, Value};
use super::form::form_by_name;
use realgap_core::statistics::Proportion;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::number;

/// Most rows of the table of distances; a log of thousands of different distances has its own file.
const MOST_ROWS: usize = 60;

/// Five significant digits.
fn digits(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let before = if value == 0.0 {
        0
    } else {
        value.abs().log10().floor() as i32
    };
    format!("{value:.*}", (4 - before).clamp(0, 8) as usize)
}

fn values(f: &mut fmt::Formatter<'_>, what: &str, form: &str, values: &[Value]) -> fmt::Result {
    let formula = form_by_name(form).map_or("", |form| form.formula());
    writeln!(f, "{what}: {form}, {formula}")?;
    let mut table = TextTable::new([
        ("  parameter", Side::Left),
        ("value", Side::Right),
        ("95 % interval", Side::Left),
        ("standard error", Side::Right),
    ]);
    for v in values {
        table.push([
            format!("  {}", v.name),
            digits(v.value),
            format!("{} to {}", digits(v.low), digits(v.high)),
            number(v.standard_error),
        ]);
    }
    f.write_str(&table.render(false))
}

fn share(p: &Proportion) -> String {
    format!(
        "{} of {} ({:.2} %, 95 % interval {:.2} to {:.2} %)",
        p.count,
        p.trials,
        100.0 * p.share,
        100.0 * p.low,
        100.0 * p.high
    )
}

impl fmt::Display for Characterisation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let length = self.model.distance_unit.symbol();
        let reading = match self.model.reading_unit.symbol() {
            "" => "the sensor's own unit".to_owned(),
            symbol => symbol.to_owned(),
        };
        writeln!(
            f,
            "{} readings at {} to {} {length}, in {reading}",
            self.dropouts.trials, self.model.range.0, self.model.range.1
        )?;
        writeln!(f)?;
        values(f, "mean", self.mean_form, &self.mean)?;
        values(f, "spread", self.spread_form, &self.spread)?;
        writeln!(f, "never came: {}", share(&self.dropouts))?;
        writeln!(f, "nonsense:   {}", share(&self.outliers))?;
        match self.lack_of_fit_p {
            Some(p) => writeln!(
                f,
                "misses the mean readings by chance alone with p = {p:.3}"
            )?,
            None => writeln!(f, "too few readings a distance to test the form")?,
        }
        if self.normality.tested > 0 {
            writeln!(
                f,
                "normal: rejected at {} of {} distances at 5 % (smallest p, adjusted: {:.3})",
                self.normality.rejected, self.normality.tested, self.normality.adjusted_p
            )?;
        }
        self.write_candidates(f)?;
        self.write_sample_size(f)?;
        writeln!(f)?;
        self.write_distances(f)
    }
}

impl Characterisation {
    fn write_candidates(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.candidates.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "\nforms, by the log density of readings at distances that were left out"
        )?;
        let mut table = TextTable::new([
            ("  mean", Side::Left),
            ("spread", Side::Left),
            ("parameters", Side::Right),
            ("a reading", Side::Right),
            ("behind", Side::Right),
            ("± standard error", Side::Left),
        ]);
        let mut order: Vec<_> = self.candidates.iter().collect();
        order.sort_by(|a, b| {
            let behind = |c: &super::Candidate| c.behind.unwrap_or(f64::INFINITY);
            behind(a).total_cmp(&behind(b))
        });
        for c in order {
            let of = |v: Option<f64>| v.map_or("cannot be".to_owned(), |v| format!("{v:.4}"));
            table.push([
                format!("  {}", c.mean),
                c.spread.to_owned(),
                c.parameters.to_string(),
                of(c.log_score),
                of(c.behind),
                of(c.behind_error) + if c.is_chosen { "  chosen" } else { "" },
            ]);
        }
        f.write_str(&table.render(false))
    }

    fn write_sample_size(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(size) = &self.sample_size else {
            return Ok(());
        };
        writeln!(
            f,
            "\nhow many readings are enough ({} at {}, bins of {}): the histogram changes by less than {:.1} % from {} readings on, which know the spread to {:.1} %",
            size.readings,
            size.distance,
            number(size.bin),
            100.0 * size.tolerance,
            size.enough,
            100.0 * size.spread_error
        )?;
        let mut table =
            TextTable::new([("  readings", Side::Right), ("in another bin", Side::Right)]);
        for step in &size.steps {
            table.push([
                step.readings.to_string(),
                format!("{:.1} %", 100.0 * step.change),
            ]);
        }
        f.write_str(&table.render(false))
    }

    fn write_distances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has_angles = self
            .distances
            .iter()
            .any(|d| d.incidence_deg != 0.0 || d.offset_deg != 0.0);
        let mut columns = vec![("  distance", Side::Right)];
        if has_angles {
            columns.extend([("incidence", Side::Right), ("offset", Side::Right)]);
        }
        for name in [
            "readings",
            "mean",
            "off the model",
            "sd",
            "sd / model",
            "normal p",
            "nonsense",
            "never came",
        ] {
            columns.push((name, Side::Right));
        }
        let mut table = TextTable::new(columns);
        for d in self.distances.iter().take(MOST_ROWS) {
            let of = |v: Option<f64>| v.map_or("–".to_owned(), digits);
            let mut cells = vec![d.distance.to_string()];
            if has_angles {
                cells.extend([d.incidence_deg.to_string(), d.offset_deg.to_string()]);
            }
            cells.extend([
                d.readings.to_string(),
                of(d.mean),
                d.residual.map_or("–".to_owned(), |r| format!("{r:+.3e}")),
                of(d.sd),
                d.sd_ratio.map_or("–".to_owned(), |r| format!("{r:.3}")),
                d.normality_p.map_or("–".to_owned(), |p| format!("{p:.3}")),
                d.outliers.to_string(),
                d.dropouts.to_string(),
            ]);
            table.push(cells);
        }
        let text = table.render(false);
        f.write_str(text.trim_end())?;
        if self.distances.len() > MOST_ROWS {
            write!(f, "\n  and {} more", self.distances.len() - MOST_ROWS)?;
        }
        Ok(())
    }
}
