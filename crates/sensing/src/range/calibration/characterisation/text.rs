//! Formats a characterisation as text for the terminal.

use std::fmt;

use super::{Candidate, Characterisation, DistanceReport, Value};
use crate::range::form::form_by_name;
use realgap_core::statistics::Proportion;
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::{Column, TextTable};
use realgap_core::unit::number;

/// Largest number of rows of the table of distances, because a log may have thousands of different distances.
const MOST_ROWS: usize = 60;

/// A number with five significant digits.
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

fn values(
    f: &mut fmt::Formatter<'_>,
    what: &str,
    form: &str,
    values: &[Value],
    level: f64,
) -> fmt::Result {
    let interval = format!("{:.0} % interval", 100.0 * level);
    let formula = form_by_name(form).map_or("", |form| form.formula());
    writeln!(f, "{what}: {form}, {formula}")?;
    let table = TextTable::of(
        values,
        &[
            ("  parameter", Left, &|v| format!("  {}", v.name)),
            ("value", Right, &|v| digits(v.value)),
            (&interval, Left, &|v| {
                format!("{} to {}", digits(v.low), digits(v.high))
            }),
            ("standard error", Right, &|v| number(v.standard_error)),
        ],
    );
    f.write_str(&table.render(false))
}

fn share(p: &Proportion, level: f64) -> String {
    format!(
        "{} of {} ({:.2} %, {:.0} % interval {:.2} to {:.2} %)",
        p.count,
        p.trials,
        100.0 * p.share,
        100.0 * level,
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
        let level = self.level;
        values(f, "mean", self.mean_form, &self.mean, level)?;
        values(f, "spread", self.spread_form, &self.spread, level)?;
        self.write_sessions(f)?;
        writeln!(f, "dropouts: {}", share(&self.dropouts, level))?;
        writeln!(f, "outliers: {}", share(&self.outliers, level))?;
        match self.lack_of_fit_p {
            Some(p) => writeln!(f, "lack of fit of the mean readings: p = {p:.3}")?,
            None if self.sessions.is_none() => {
                writeln!(f, "too few readings at each distance to test the form")?;
            }
            None => {}
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
    fn write_sessions(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(found) = &self.sessions else {
            return Ok(());
        };
        writeln!(
            f,
            "sessions: {}; standard deviations and intervals take the variation within and between sessions into account",
            found.sessions
        )?;
        let rows = [
            (
                "  between sessions, at all distances together",
                found.everywhere,
            ),
            (
                "  between sessions, at each distance separately",
                found.by_distance,
            ),
        ];
        let interval = format!("{:.0} % interval", 100.0 * self.level);
        let table = TextTable::of(
            &rows,
            &[
                ("  standard deviation", Left, &|(what, _)| {
                    (*what).to_owned()
                }),
                ("value", Right, &|(_, s)| digits(s.sd)),
                (&interval, Left, &|(_, s)| {
                    format!("{} to {}", digits(s.low), digits(s.high))
                }),
                ("", Left, &|(_, s)| {
                    let share = format!("{:.2} % of the reading", 100.0 * s.share);
                    if s.grows_with_reading {
                        share
                    } else {
                        String::new()
                    }
                }),
            ],
        );
        f.write_str(&table.render(false))?;
        writeln!(f, "prediction of the next session, {interval}s:")?;
        let table = TextTable::of(
            found.next.iter().take(MOST_ROWS),
            &[
                ("  distance", Right, &|n| n.distance.to_string()),
                ("mean", Right, &|n| digits(n.mean)),
                ("of its mean", Left, &|n| {
                    format!("{} to {}", digits(n.mean_low), digits(n.mean_high))
                }),
                ("of its readings", Left, &|n| {
                    format!("{} to {}", digits(n.reading_low), digits(n.reading_high))
                }),
            ],
        );
        f.write_str(&table.render(false))
    }

    fn write_candidates(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.candidates.is_empty() {
            return Ok(());
        }
        writeln!(
            f,
            "\nforms, by the log density of readings at left-out distances (cross-validation)"
        )?;
        let behind = |c: &Candidate| c.behind.unwrap_or(f64::INFINITY);
        let mut order = self.candidates.clone();
        order.sort_by(|a, b| behind(a).total_cmp(&behind(b)));
        let of = |v: Option<f64>| v.map_or("no fit".to_owned(), |v| format!("{v:.4}"));
        let table = TextTable::of(
            &order,
            &[
                ("  mean", Left, &|c| format!("  {}", c.mean)),
                ("spread", Left, &|c| c.spread.to_owned()),
                ("parameters", Right, &|c| c.parameters.to_string()),
                ("log density", Right, &|c| of(c.log_score)),
                ("below the best", Right, &|c| of(c.behind)),
                ("± standard error", Left, &|c| {
                    of(c.behind_error) + if c.is_chosen { "  chosen" } else { "" }
                }),
            ],
        );
        f.write_str(&table.render(false))
    }

    fn write_sample_size(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(size) = &self.sample_size else {
            return Ok(());
        };
        writeln!(
            f,
            "\nhow many readings are enough ({} at {}, bins of {}): the histogram changes by less than {:.1} % from {} readings on, with which the standard error of the spread is {:.1} %",
            size.readings,
            size.distance,
            number(size.bin),
            100.0 * size.tolerance,
            size.enough,
            100.0 * size.spread_error
        )?;
        let table = TextTable::of(
            &size.steps,
            &[
                ("  readings", Right, &|s| s.readings.to_string()),
                ("change", Right, &|s| format!("{:.1} %", 100.0 * s.change)),
            ],
        );
        f.write_str(&table.render(false))
    }

    fn write_distances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has_angles = self
            .distances
            .iter()
            .any(|d| d.incidence_deg != 0.0 || d.offset_deg != 0.0);
        let none = || "–".to_owned();
        let angles: [Column<'_, DistanceReport>; 2] = [
            ("incidence", Right, &|d| d.incidence_deg.to_string()),
            ("offset", Right, &|d| d.offset_deg.to_string()),
        ];
        let mut columns: Vec<Column<'_, DistanceReport>> =
            vec![("  distance", Right, &|d| d.distance.to_string())];
        columns.extend(angles.into_iter().filter(|_| has_angles));
        let session: Column<'_, DistanceReport> =
            ("session", Left, &|d| d.session.clone().unwrap_or_default());
        columns.extend(self.sessions.is_some().then_some(session));
        let numbers: [Column<'_, DistanceReport>; 8] = [
            ("readings", Right, &|d| d.readings.to_string()),
            ("mean", Right, &|d| d.mean.map_or_else(none, digits)),
            ("residual", Right, &|d| {
                d.residual.map_or_else(none, |r| format!("{r:+.3e}"))
            }),
            ("sd", Right, &|d| d.sd.map_or_else(none, digits)),
            ("sd / model", Right, &|d| {
                d.sd_ratio.map_or_else(none, |r| format!("{r:.3}"))
            }),
            ("normal p", Right, &|d| {
                d.normality_p.map_or_else(none, |p| format!("{p:.3}"))
            }),
            ("outliers", Right, &|d| d.outliers.to_string()),
            ("dropouts", Right, &|d| d.dropouts.to_string()),
        ];
        columns.extend(numbers);
        let peaks: Column<'_, DistanceReport> = ("peaks at", Left, &|d| {
            let peaks = d.peaks.iter();
            let words: Vec<String> = peaks
                .map(|p| format!("{} ({:.0} %)", digits(p.centre), 100.0 * p.share))
                .collect();
            words.join(", ")
        });
        let has_peaks = self.distances.iter().any(|d| !d.peaks.is_empty());
        columns.extend(has_peaks.then_some(peaks));
        let table = TextTable::of(self.distances.iter().take(MOST_ROWS), &columns);
        let text = table.render(false);
        f.write_str(text.trim_end())?;
        if self.distances.len() > MOST_ROWS {
            write!(f, "\n  and {} more", self.distances.len() - MOST_ROWS)?;
        }
        Ok(())
    }
}
