//! The comparison in words.

use std::fmt;

use super::alignment::RelativeTo;
use super::comparison::{Answer, ExtractorReport, Mean, Verdict, VisionReport};
use super::views::PictureSource;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::counted;

fn shown(value: f64, unit: &str) -> String {
    if unit.is_empty() {
        format!("{value:.3}")
    } else {
        format!("{value:.2} {unit}")
    }
}

fn mean(mean: Option<Mean>, unit: &str) -> String {
    match mean {
        None => "-".to_owned(),
        Some(Mean {
            value,
            interval: None,
            ..
        }) => shown(value, unit),
        Some(Mean {
            value,
            interval: Some((low, high)),
            ..
        }) => format!(
            "{} ({} to {})",
            shown(value, unit),
            shown(low, ""),
            shown(high, "")
        ),
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let answer = match self.answer {
            Answer::Nearer => "yes",
            Answer::Farther => "no",
            Answer::Open => "cannot be told",
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
    let mut table = TextTable::new([
        ("error", Side::Left),
        ("simulated", Side::Right),
        ("real", Side::Right),
        ("badly lit", Side::Right),
    ]);
    let measures: Vec<_> = report.extractors.iter().map(|e| e.error_measure).collect();
    for e in &report.extractors {
        let Some(measure) = e.error_measure else {
            continue;
        };
        // Two may measure the same.
        let alike = measures.iter().filter(|m| **m == e.error_measure).count();
        table.push([
            match alike {
                1 => measure.name.to_owned(),
                _ => format!("{}: {}", e.extractor, measure.name),
            },
            mean(e.simulated_error, measure.unit),
            mean(e.real_error, measure.unit),
            mean(e.badly_lit_error, measure.unit),
        ]);
    }
    table
}

fn distances(report: &VisionReport) -> TextTable {
    let mut table = TextTable::new([
        ("distance", Side::Left),
        ("simulated to real", Side::Right),
        ("badly lit to real", Side::Right),
        ("noise floor", Side::Right),
        ("gap ratio", Side::Right),
    ]);
    for e in &report.extractors {
        let unit = e.distance_measure.unit;
        table.push([
            format!("{}: {}", e.extractor, e.distance_measure.name),
            mean(e.gap, unit),
            mean(e.badly_lit, unit),
            mean(e.floor, unit),
            e.gap_ratio.map_or("-".to_owned(), |r| format!("{r:.2}")),
        ]);
    }
    table
}

impl fmt::Display for ExtractorReport {
    /// View by view.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("view", Side::Left),
            ("error: simulated", Side::Right),
            ("real", Side::Right),
            ("badly lit", Side::Right),
            ("distance: sim.-real", Side::Right),
            ("bad-real", Side::Right),
            ("real-real", Side::Right),
        ]);
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |v| shown(v, ""));
        for v in &self.views {
            table.push([
                v.view.clone(),
                cell(v.simulated_error),
                cell(v.real_error),
                cell(v.badly_lit_error),
                cell(v.simulated_real),
                cell(v.badly_lit_real),
                cell(v.floor),
            ]);
        }
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
        let real = match self.real {
            PictureSource::StandIn => "stand-ins in place of real pictures",
            _ => "real pictures",
        };
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
                    "distances after each picture is turned and shifted to where the other's known places are",
                RelativeTo::View => "distances as the pictures are: where each camera stood counts",
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
