//! What an ensemble leaves in a folder: `NAME.json`, `repeats.csv`, `ensemble.png` and `.svg`.

use std::path::Path;

use serde::Serialize;

use super::draft::publish;
use super::kind::Kind;
use crate::plot::{Caption, EnsembleBand, EnsembleGroup, EnsemblePlot, both, draw_ensemble};
use realgap_core::error::{Error, Result};
use realgap_core::file::{versioned_json, write_atomic};
use realgap_core::text::cell;
use realgap_lab::prediction::ensemble::{Behaviours, Ensemble, Envelope, Forecast, LEVELS};
use realgap_lab::prediction::{Card, EnsembleReport};
use realgap_path::trajectory::Source;

/// More paths of one behaviour than this are not told apart in a picture.
const PATHS_DRAWN: usize = 120;

/// An ensemble with what is said about it.
#[derive(Debug)]
pub(super) struct EnsembleResult<'a> {
    /// The repeats.
    pub ensemble: &'a Ensemble,
    /// What they have in common.
    pub summary: &'a Forecast,
    /// Prepared paths of the recordings, true lengths, metres.
    pub real_paths_m: Vec<Vec<[f64; 2]>>,
    /// What the recordings are called, e.g. `stand-in for reality`.
    pub real_label: &'a str,
    /// Title of the picture.
    pub title: String,
}

/// Makes the folder and writes `report` as JSON under `name`.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_report(folder: &Path, name: &str, report: &impl Serialize) -> Result<()> {
    make(folder)?;
    let json = versioned_json(report)?;
    write_atomic(folder.join(name), format!("{json}\n").as_bytes())
}

pub(super) fn make(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, &e))
}

/// At most so many starts are drawn.
const PICTURES: usize = 12;

/// Writes what an ensemble report holds: `ensemble.json`, `repeats.csv`, and a picture for each of the first starts.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_ensemble(folder: &Path, report: &EnsembleReport) -> Result<()> {
    let results: Vec<(&str, EnsembleResult<'_>)> = report
        .cases
        .iter()
        .map(|case| {
            let result = EnsembleResult {
                ensemble: &case.ensemble,
                summary: &case.forecast,
                real_paths_m: case.real_paths_m.clone(),
                real_label: report.source.reality_label(),
                title: format!("{}: repeats under noise", case.case),
            };
            (case.case.as_str(), result)
        })
        .collect();
    make(folder)?;
    publish(folder, Kind::Ensemble, |draft| {
        write_report(draft, "ensemble.json", report)?;
        write_repeats(draft, &results)?;
        for (index, (_, result)) in results.iter().enumerate().take(PICTURES) {
            // The first has the name that is always there; more than one are numbered.
            let stem = match index {
                0 => "ensemble".to_owned(),
                _ => format!("ensemble_{index:03}"),
            };
            draw_repeats(draft, &stem, result)?;
        }
        Ok(())
    })
}

/// Writes a prediction card and the repeats behind it: `prediction.json`, `repeats.csv`, `prediction.png` and `.svg`.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_prediction(folder: &Path, card: &Card, repeats: &Ensemble) -> Result<()> {
    let result = EnsembleResult {
        ensemble: repeats,
        summary: &card.prediction,
        real_paths_m: Vec::new(),
        real_label: Source::Real.reality_label(),
        title: format!("{}: what it will do", card.robot),
    };
    make(folder)?;
    publish(folder, Kind::Prediction, |draft| {
        write_report(draft, "prediction.json", card)?;
        draw_repeats(draft, "prediction", &result)?;
        write_repeats(draft, &[(&card.robot, result)])
    })
}

/// Writes one row a repeat: what was drawn and what came of it. `cases` are ensembles with a name each.
///
/// # Errors
/// A full disk or an unwritable folder.
fn write_repeats(folder: &Path, cases: &[(&str, EnsembleResult<'_>)]) -> Result<()> {
    let path = folder.join("repeats.csv");
    let csv_error = |e: csv::Error| Error::invalid(format!("cannot write {}: {e}", path.display()));
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (index, (name, case)) in cases.iter().enumerate() {
        for repeat in &case.ensemble.repeats {
            let row = row(name, case, repeat);
            if index == 0 && Some(repeat.number) == case.ensemble.repeats.first().map(|r| r.number)
            {
                writer
                    .write_record(row.iter().map(|(column, _)| column))
                    .map_err(csv_error)?;
            }
            writer
                .write_record(row.iter().map(|(_, value)| cell(value).into_owned()))
                .map_err(csv_error)?;
        }
    }
    let bytes = writer
        .into_inner()
        .map_err(|e| Error::invalid(format!("cannot write {}: {e}", path.display())))?;
    write_atomic(&path, &bytes)
}

fn row(
    case_name: &str,
    case: &EnsembleResult<'_>,
    repeat: &realgap_lab::prediction::ensemble::Repeat,
) -> Vec<(String, String)> {
    let mut row = Vec::new();
    let mut push = |column: String, value: String| row.push((column, value));
    push("case".to_owned(), case_name.to_owned());
    push("repeat".to_owned(), repeat.number.to_string());
    push("seed".to_owned(), case.ensemble.seed.to_string());
    let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    let motion = repeat.outcome.get();
    let status = match repeat.outcome.divergence() {
        None => "completed".to_owned(),
        Some(divergence) => format!("diverged {divergence}"),
    };
    push("status".to_owned(), status);
    push(
        "behaviour".to_owned(),
        behaviour(&case.summary.behaviours, repeat.number),
    );
    push(
        "net_displacement_m".to_owned(),
        number(motion.map(|m| m.net_displacement_m())),
    );
    push(
        "path_length_m".to_owned(),
        number(motion.map(|m| m.path.path_length_m())),
    );
    push(
        "turned_rad".to_owned(),
        number(motion.map(|m| m.turned_rad)),
    );
    let drawn = &repeat.perturbation;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        push(
            format!("shift_{name}_m"),
            drawn.shift_world_m[axis].to_string(),
        );
    }
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        push(
            format!("turn_{name}_rad"),
            drawn.turn_world_rad[axis].to_string(),
        );
    }
    for (name, vector) in [
        ("velocity_{}_m_s", &drawn.velocity_world_m_s),
        ("spin_{}_rad_s", &drawn.spin_world_rad_s),
    ] {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            push(name.replace("{}", letter), vector[axis].to_string());
        }
    }
    for (name, values) in [
        ("servo_zero_rad", &drawn.servo_zero_rad),
        ("servo_gain_factor", &drawn.servo_gain_factor),
        ("servo_phase_rad", &drawn.servo_phase_rad),
        ("servo_latency_s", &drawn.servo_latency_s),
        ("mass_factor", &drawn.mass_factor),
        ("friction_factor", &drawn.friction_factor),
    ] {
        for (index, value) in values.iter().enumerate() {
            push(format!("{name}_{index}"), value.to_string());
        }
    }
    push(
        "run_friction_factor".to_owned(),
        drawn.run_friction_factor.to_string(),
    );
    row
}

fn behaviour(behaviours: &Behaviours, number: u64) -> String {
    behaviours
        .of_repeat(number)
        .map_or("diverged".to_owned(), |index| {
            behaviours.list[index].name.clone()
        })
}

/// Draws an ensemble as `STEM.png` and `STEM.svg`; nothing where every repeat diverged.
///
/// # Errors
/// A full disk or an unwritable folder.
pub(super) fn draw_repeats(folder: &Path, stem: &str, case: &EnsembleResult<'_>) -> Result<()> {
    let Some(envelope) = &case.summary.envelope else {
        return Ok(());
    };
    let summary = case.summary;
    let incomplete = if summary.complete { "" } else { "INCOMPLETE: " };
    let mut subtitle = format!(
        "{incomplete}{} of {} repeats of {} s, seed {}",
        summary.repeats, summary.repeats_asked, summary.duration_s, summary.seed
    );
    if summary.diverged.count > 0 {
        subtitle += &format!(", {} diverged", summary.diverged.count);
    }
    let groups = summary
        .behaviours
        .list
        .iter()
        .map(|behaviour| EnsembleGroup {
            label: format!(
                "{}: {:.0} %",
                behaviour.name,
                100.0 * behaviour.probability.share
            ),
            paths_m: case
                .ensemble
                .motions()
                .filter(|(repeat, _)| behaviour.repeats.contains(&repeat.number))
                .take(PATHS_DRAWN)
                .map(|(_, motion)| motion.path.xy_m().to_vec())
                .collect(),
            representative_m: behaviour
                .representative
                .map_or(Vec::new(), |_| behaviour.path_xy_m.clone()),
        })
        .collect();
    let widest = LEVELS.len() - 1;
    let bands = (0..=widest).rev().map(|level| extent(envelope, level));
    let plot = EnsemblePlot {
        caption: Caption::new(case.title.clone(), subtitle),
        groups,
        noise_free_m: case
            .ensemble
            .noise_free
            .get()
            .map_or(Vec::new(), |motion| motion.path.xy_m().to_vec()),
        real_m: case.real_paths_m.clone(),
        real_label: case.real_label.to_owned(),
        times_s: envelope.times_s.clone(),
        bands: bands.collect(),
        whole_paths: (summary.band.as_ref()).map(|band| extent(band, widest)),
    };
    both(folder, stem, |path| draw_ensemble(&plot, path))
}

/// How far the regions of a level reach along x and along y.
fn extent(envelope: &Envelope, level: usize) -> EnsembleBand {
    let ends = |sign: f64| {
        let regions = envelope.regions.iter();
        regions
            .map(|region| {
                let half_m = region.half_widths_m(level);
                [0, 1].map(|axis| region.centre_m[axis] + sign * half_m[axis])
            })
            .collect()
    };
    EnsembleBand {
        level: LEVELS[level],
        low_m: ends(-1.0),
        high_m: ends(1.0),
    }
}
