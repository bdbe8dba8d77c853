//! What a results folder of a sweep or a tuning says about its parameters, for use elsewhere: in a robot's file, in another
//! program that randomises its model, on a card for people.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::folder::check_seal;
use crate::results::kind::file;
use realgap_core::error::{Error, Result};
use realgap_core::file::{read_limited, versioned_json};
use realgap_core::statistics::{mean, quantile, standard_deviation};
use realgap_core::unit::counted;
use realgap_lab::calibration::{Best, Fitted, Validation};
use realgap_lab::claim::VERDICT;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::read_posterior;
use realgap_simulation::parameter::{Assignment, ParameterSet};

/// Largest report that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// Level of the intervals, in percent.
const PERCENT: &str = "90 %";

/// The values that a sweep or a tuning found, with what it says about them.
#[derive(Debug)]
pub struct FittedStudy {
    summary: Summary,
    values: ParameterSet,
    draws: Vec<ParameterSet>,
}

/// The fields of `summary.json` that are used here.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Summary {
    study: Option<String>,
    description: String,
    complete: bool,
    recordings: usize,
    metric: String,
    unit: Option<String>,
    best: Option<Best>,
    verdicts: Vec<Row>,
    claims: Vec<Claim>,
    validation: Option<Validation>,
    provenance: BTreeMap<String, String>,
}

/// The fields of a verdict that are used here.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Row {
    parameter: String,
    unit: String,
    interval: Option<(f64, f64)>,
    intervals: Vec<(f64, f64)>,
    identified: bool,
}

/// What is left possible, for a program that draws models: `--ranges`.
#[derive(Debug, Serialize)]
struct Ranges<'a> {
    /// Name of the study.
    study: &'a str,
    /// Each parameter alone. A box of these ranges holds combinations that the recordings reject: draw from `draws` instead.
    parameters: Vec<Range<'a>>,
    /// Names of the columns of `draws`.
    columns: Vec<&'a str>,
    /// Draws of all parameters together, equally likely.
    draws: Vec<Vec<f64>>,
    /// Scores of the fitted recordings and of those that were held out, where some were, with the share of samples held out that lie
    /// within the bands of their predictions.
    held_out: Option<&'a Validation>,
}

/// One parameter alone.
#[derive(Debug, Serialize)]
struct Range<'a> {
    name: &'a str,
    unit: &'a str,
    best: Option<f64>,
    mean: f64,
    sd: f64,
    q05: f64,
    q50: f64,
    q95: f64,
}

impl FittedStudy {
    /// Reads a folder that a sweep or a tuning has written.
    ///
    /// # Errors
    /// Another folder; files that are not what was written there; an answer without a best point.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(file::SUMMARY);
        let other = |error: Error| {
            error
                .at_file(folder)
                .hint("name a folder that sweep or tune has written to its end")
        };
        if !path.is_file() {
            return Err(other(Error::invalid("no fitted parameters here")));
        }
        check_seal(folder)?;
        let bytes = read_limited(&path, MOST_BYTES, "report")?;
        let summary: Summary = serde_json::from_slice(&bytes)
            .map_err(|e| Error::invalid(format!("not a report: {e}")).at_file(&path))?;
        if summary.study.is_none() || summary.best.is_none() {
            return Err(other(Error::invalid("no fitted parameters here")));
        }
        let best = folder.join(file::BEST);
        let draws = match folder.join(file::INDISTINGUISHABLE).is_file() {
            true => read_posterior(folder)?,
            false => Vec::new(),
        };
        Ok(Self {
            values: Fitted::read(&[best])?.values,
            draws,
            summary,
        })
    }

    /// The best values, with those that the study fixes.
    pub fn values(&self) -> &ParameterSet {
        &self.values
    }

    /// Name of the study.
    pub fn study(&self) -> &str {
        self.summary.study.as_deref().unwrap_or_default()
    }

    /// Draws of the posterior; none where the study has no intervals.
    pub fn draws(&self) -> &[ParameterSet] {
        &self.draws
    }

    fn verdict(&self, name: &str) -> Option<&Row> {
        let mut all = self.summary.verdicts.iter();
        all.find(|row| row.parameter == name)
    }

    /// The sentence about a value that stands beside it in another file: name, value, interval, study.
    pub fn remark(&self, value: &Assignment) -> String {
        let name = value.parameter.name;
        let unit = self.unit_of(name);
        let sure = match self.verdict(name) {
            None => "fixed in".to_owned(),
            Some(row) => match (interval_text(row), row.identified) {
                (None, _) => "no interval,".to_owned(),
                (Some(text), true) => format!("{PERCENT} interval {text},"),
                (Some(text), false) => format!("not determined, {PERCENT} interval {text},"),
            },
        };
        let value = rounded(value.value);
        format!(
            "realgap: {name} = {value}{unit}, {sure} study {}",
            self.study()
        )
    }

    /// The unit of a parameter behind a number, with a blank before it.
    fn unit_of(&self, name: &str) -> String {
        let own = self.verdict(name).map(|row| row.unit.clone());
        let known = || realgap_simulation::parameter::by_name(name).ok();
        let unit = own.or_else(|| known().map(|p| p.unit.label().to_owned()));
        match unit.as_deref() {
            None | Some("" | "1") => String::new(),
            Some(unit) => format!(" {unit}"),
        }
    }

    /// The draws with their marginal ranges, as JSON.
    ///
    /// # Errors
    /// A study without draws.
    pub fn ranges_json(&self) -> Result<String> {
        let columns = self.columns()?;
        let parameters = columns.iter().map(|name| {
            let values: Vec<f64> = self
                .draws
                .iter()
                .filter_map(|set| set.value(name))
                .collect();
            Range {
                name,
                unit: self.verdict(name).map_or("", |row| &row.unit),
                best: self.values.value(name),
                mean: mean(&values),
                sd: standard_deviation(&values),
                q05: quantile(&values, 0.05),
                q50: quantile(&values, 0.5),
                q95: quantile(&values, 0.95),
            }
        });
        versioned_json(&Ranges {
            study: self.study(),
            parameters: parameters.collect(),
            draws: self.rows(&columns),
            columns: columns.clone(),
            held_out: self.summary.validation.as_ref(),
        })
    }

    /// The draws as CSV: a column a parameter, a row a draw.
    ///
    /// # Errors
    /// A study without draws.
    pub fn ranges_csv(&self) -> Result<String> {
        let columns = self.columns()?;
        let mut text = columns.join(",") + "\n";
        for row in self.rows(&columns) {
            let row: Vec<String> = row.iter().map(f64::to_string).collect();
            text += &(row.join(",") + "\n");
        }
        Ok(text)
    }

    /// The parameters that draws have.
    fn columns(&self) -> Result<Vec<&str>> {
        let Some(first) = self.draws.first() else {
            return Err(Error::invalid("the study has no posterior draws")
                .hint("run the sweep or tuning to its end, with enough points for intervals"));
        };
        Ok(first.iter().map(|value| value.parameter.name).collect())
    }

    fn rows(&self, columns: &[&str]) -> Vec<Vec<f64>> {
        let row = |set: &ParameterSet| -> Vec<f64> {
            let values = columns.iter().map(|name| set.value(name));
            values.map(|value| value.unwrap_or(f64::NAN)).collect()
        };
        self.draws.iter().map(row).collect()
    }

    /// The parameters on one page for people, as Markdown.
    pub fn card(&self) -> String {
        let summary = &self.summary;
        let mut card = format!("# Fitted parameters: {}\n", plain(self.study()));
        if !summary.description.is_empty() {
            let _ = write!(card, "\n{}\n", plain(&summary.description));
        }
        if !summary.complete {
            card += "\n**The run was interrupted: these are not its final values.**\n";
        }
        card += "\n## Verdict\n\n";
        for (label, about) in VERDICT {
            for claim in summary.claims.iter().filter(|claim| claim.about == about) {
                let _ = writeln!(card, "- {label}: {}", plain(&claim.text));
            }
        }
        card += "\n## Values\n\n";
        let _ = writeln!(
            card,
            "| parameter | value | {PERCENT} interval | determined |"
        );
        card += "|---|---:|---|---|\n";
        for value in self.values.iter() {
            let name = value.parameter.name;
            let (sure, is_determined) = match self.verdict(name) {
                None => ("fixed by the study".to_owned(), ""),
                Some(row) => (
                    interval_text(row).unwrap_or_else(|| "none".to_owned()),
                    if row.identified { "yes" } else { "no" },
                ),
            };
            let (number, unit) = (rounded(value.value), self.unit_of(name));
            let _ = writeln!(
                card,
                "| `{name}` | {number}{unit} | {sure} | {is_determined} |"
            );
        }
        let unit = match summary.unit.as_deref() {
            None | Some("1") => "",
            Some(unit) => unit,
        };
        card += "\n## Error\n\n";
        if let Some(best) = &summary.best {
            let score = rounded(best.score);
            let of = counted(summary.recordings, "recording");
            let _ = writeln!(card, "- {} of {of}: {score} {unit}", summary.metric);
        }
        match &summary.validation {
            None => card += "- on recordings that were not fitted: not measured\n",
            Some(held) => {
                let _ = writeln!(
                    card,
                    "- on recordings that were not fitted ({}): {} {unit}, where the fitted ones have {} {unit}",
                    plain(&held.split),
                    rounded(held.held_out_score),
                    rounded(held.fit_score),
                );
                if let Some(bands) = &held.bands {
                    let _ = writeln!(card, "- {}", bands.sentence());
                }
            }
        }
        card += "\n## Data and versions\n\n";
        let shown = |key: &str| {
            let kept = [
                "realgap",
                "engine",
                "morphology sha256",
                "metric",
                "seed",
                "split",
            ];
            kept.contains(&key) || key.starts_with("recording ") || key == "unit of the recordings"
        };
        for (key, value) in summary.provenance.iter().filter(|(key, _)| shown(key)) {
            let _ = writeln!(card, "- {}: {}", plain(key), plain(value));
        }
        card += "\n## How to cite\n\n";
        let version = summary.provenance.get("realgap").map_or("", String::as_str);
        let _ = writeln!(
            card,
            "The realgap authors: realgap {version}, *how far is a simulated robot from the real one, what closes the gap, and how sure may we be?* Study \"{}\", {} recordings; cite the sources of the recordings, too.",
            plain(self.study()),
            summary.recordings
        );
        card
    }

    /// What the recordings say about all parameters, in one sentence; empty where the study has no verdict.
    pub fn said(&self) -> &str {
        let mut claims = self.summary.claims.iter();
        let all = claims.find(|claim| claim.about == About::Parameters);
        all.map_or("", |claim| claim.text.as_str())
    }
}

/// The interval of a verdict, or its parts.
fn interval_text(row: &Row) -> Option<String> {
    let parts = row.interval.iter().chain(&row.intervals);
    let parts: Vec<String> = parts
        .map(|(low, high)| format!("{} to {}", rounded(*low), rounded(*high)))
        .collect();
    (!parts.is_empty()).then(|| parts.join(" or "))
}

/// A number with five significant digits.
fn rounded(value: f64) -> String {
    let short: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    short.to_string()
}

/// A text of a file without characters that Markdown or a terminal would read as something else.
fn plain(text: &str) -> String {
    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    realgap_core::text::escaped(&one_line)
        .replace('|', "\\|")
        .replace('<', "&lt;")
}
