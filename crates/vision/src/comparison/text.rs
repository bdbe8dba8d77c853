//! Formats the report of a comparison of pictures as text for the terminal.

use std::fmt;

use super::super::alignment::RelativeTo;
use super::super::extractor::Measure;
use super::{Answer, ExtractorReport, Mean, PairedComparison, VisionReport};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::unit::counted;

fn shown(value: f64, unit: &str) -> String {
    if unit.is_empty() {
        format!("{value:.3}")
    } else {
        format!("{value:.2} {unit}")
    }
}

fn mean(mean: Option<Mean>, unit: &str) -> String {
    let Some(Mean {
        value, interval, ..
    }) = mean
    else {
        return "-".to_owned();
    };
    let value = shown(value, unit);
    match interval {
        None => value,
        Some((low, high)) => format!("{value} ({} to {})", shown(low, ""), shown(high, "")),
    }
}

impl fmt::Display for PairedComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let answer = match self.answer {
            Answer::Nearer => "yes",
            Answer::Farther => "no",
            Answer::Open => "undecided",
        };
        write!(f, "{answer}: nearer in {} of {}", self.nearer, self.views)?;
        if self.equal > 0 {
            write!(f, ", equal in {}", self.equal)?;
        }
        write!(
            f,
            " (p = {:.3}, effect {:+.2})",
            self.test.p_value, self.test.effect
        )
    }
}

fn errors(report: &VisionReport) -> TextTable {
    let measured: Vec<(&ExtractorReport, Measure)> = report
        .extractors
        .iter()
        .filter_map(|e| Some((e, e.error_measure?)))
        .collect();
    // Two extractors may report the same quantity; then the name of the extractor is added.
    let is_shared = |measure: Measure| measured.iter().filter(|m| m.1 == measure).count() > 1;
    TextTable::of(
        &measured,
        &[
            ("error", Left, &|(e, m)| match is_shared(*m) {
                true => format!("{}: {}", e.extractor, m.name),
                false => m.name.to_owned(),
            }),
            ("simulated", Right, &|(e, m)| {
                mean(e.simulated_error, m.unit)
            }),
            ("real", Right, &|(e, m)| mean(e.real_error, m.unit)),
            ("badly lit", Right, &|(e, m)| {
                mean(e.badly_lit_error, m.unit)
            }),
        ],
    )
}

fn distances(report: &VisionReport) -> TextTable {
    let of = |e: &ExtractorReport, value: Option<Mean>| mean(value, e.distance_measure.unit);
    TextTable::of(
        &report.extractors,
        &[
            ("distance", Left, &|e| {
                format!("{}: {}", e.extractor, e.distance_measure.name)
            }),
            ("simulated to real", Right, &|e| of(e, e.gap)),
            ("badly lit to real", Right, &|e| of(e, e.badly_lit)),
            ("noise floor", Right, &|e| of(e, e.floor)),
            ("gap ratio", Right, &|e| {
                e.gap_ratio.map_or("-".to_owned(), |r| format!("{r:.2}"))
            }),
        ],
    )
}

impl fmt::Display for ExtractorReport {
    /// A table with one row for each view.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |v| shown(v, ""));
        let table = TextTable::of(
            &self.views,
            &[
                ("view", Left, &|v| v.view.clone()),
                ("error: simulated", Right, &|v| cell(v.simulated_error)),
                ("real", Right, &|v| cell(v.real_error)),
                ("badly lit", Right, &|v| cell(v.badly_lit_error)),
                ("distance: sim.-real", Right, &|v| cell(v.simulated_real)),
                ("bad-real", Right, &|v| cell(v.badly_lit_real)),
                ("real-real", Right, &|v| cell(v.floor)),
            ],
        );
        write!(
            f,
            "{} (figure {})\n{}",
            self.extractor,
            self.figure,
            table.render(false)
        )
    }
}

impl fmt::Display for VisionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let real = self.real.words();
        writeln!(
            f,
            "{} of simulated and {real}; means over views with 90 % intervals",
            counted(self.views.len(), "view")
        )?;
        if self.extractors.iter().any(|e| e.error_measure.is_some()) {
            writeln!(f, "\n{}", errors(self).render(false))?;
        }
        writeln!(f, "\n{}", distances(self).render(false))?;
        writeln!(
            f,
            "{}",
            match self.relative_to {
                RelativeTo::Own =>
                    "distances after the pictures are aligned by the positions that are known in both",
                RelativeTo::View =>
                    "distances without alignment of the pictures; they include the displacement of cameras",
            }
        )?;
        for e in &self.extractors {
            if let Some(program) = &e.program {
                writeln!(f, "{} is the installed program {program}", e.extractor)?;
            }
        }
        let answered: Vec<_> = self
            .extractors
            .iter()
            .filter_map(|e| Some((e.extractor, e.verdict?)))
            .collect();
        if !answered.is_empty() {
            writeln!(
                f,
                "\nIs a simulated picture nearer to a well lit real one than a badly lit real one is?"
            )?;
            for (extractor, verdict) in answered {
                writeln!(f, "  {extractor}: {verdict}")?;
            }
        }
        Ok(())
    }
}
