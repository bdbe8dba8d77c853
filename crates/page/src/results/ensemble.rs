//! What an ensemble leaves in a folder: `NAME.json`, `repeats.csv`, `ensemble.png` and `.svg`.

use std::path::Path;

use serde::Serialize;

use super::draft::{Draft, publish};
use super::kind::{Kind, file};
use super::table::{CsvTable, number};
use crate::plot::{Caption, EnsembleBand, EnsembleGroup, EnsemblePlot};
use crate::report::{ResultsPage, odds};
use realgap_core::error::{Error, Result};
use realgap_core::file::{versioned_json, write_atomic};
use realgap_lab::prediction::ensemble::{
    Behaviours, Ensemble, Envelope, Forecast, LEVELS, Motion, Repeat,
};
use realgap_lab::prediction::{Card, EnsembleReport};
use realgap_path::trajectory::Source;

/// The largest number of paths of one behaviour in a picture: more could not be distinguished.
const PATHS_DRAWN: usize = 120;

/// An ensemble with its forecast and recordings.
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
pub fn write_ensemble(folder: &Path, report: &EnsembleReport) -> Result<ResultsPage> {
    let results = report.cases.iter().map(|case| {
        let result = EnsembleResult {
            ensemble: &case.ensemble,
            summary: &case.forecast,
            real_paths_m: case.real_paths_m.clone(),
            real_label: report.source.reality_label(),
            title: format!("{}: repeats under noise", case.case),
        };
        (case.case.as_str(), result)
    });
    let results: Vec<_> = results.collect();
    make(folder)?;
    publish(folder, Kind::Ensemble, |draft| {
        write_report(draft.folder(), file::ENSEMBLE, report)?;
        draft.table(file::REPEATS, &repeats(&results))?;
        for (index, (_, result)) in results.iter().enumerate().take(PICTURES) {
            // The first picture always has the same name; further ones are numbered.
            let stem = match index {
                0 => "ensemble".to_owned(),
                _ => format!("ensemble_{index:03}"),
            };
            draw_repeats(draft, &stem, result)?;
        }
        ResultsPage::of_ensemble(report, draft.take_pictures())
    })
}

/// Writes a prediction card and the repeats behind it: `prediction.json`, `repeats.csv`, `prediction.png` and `.svg`.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_prediction(folder: &Path, card: &Card, ensemble: &Ensemble) -> Result<ResultsPage> {
    let result = EnsembleResult {
        ensemble,
        summary: &card.prediction,
        real_paths_m: Vec::new(),
        real_label: Source::Real.reality_label(),
        title: format!("{}: prediction", card.robot),
    };
    make(folder)?;
    publish(folder, Kind::Prediction, |draft| {
        write_report(draft.folder(), file::PREDICTION, card)?;
        draw_repeats(draft, "prediction", &result)?;
        draft.table(file::REPEATS, &repeats(&[(&card.robot, result)]))?;
        ResultsPage::of_prediction(card, draft.take_pictures())
    })
}

/// One row a repeat: the random draw and its outcome. `cases` are ensembles with a name each.
fn repeats(cases: &[(&str, EnsembleResult<'_>)]) -> CsvTable {
    let all = cases.iter().flat_map(|(name, case)| {
        let repeats = case.ensemble.repeats.iter();
        repeats.map(move |repeat| row(name, case, repeat))
    });
    let mut all = all.peekable();
    let columns = all.peek().cloned().unwrap_or_default();
    let columns: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let rows = all.map(|row| row.into_iter().map(|(_, value)| value).collect());
    CsvTable::new(&columns, rows)
}

fn row(case_name: &str, case: &EnsembleResult<'_>, repeat: &Repeat) -> Vec<(String, String)> {
    let motion = repeat.outcome.get();
    let status = match repeat.outcome.divergence() {
        None => "completed".to_owned(),
        Some(divergence) => format!("diverged {divergence}"),
    };
    let behaviours = &case.summary.behaviours;
    let behaviour = behaviours.of_repeat(repeat.number);
    let behaviour = behaviour.map_or("diverged", |index| behaviours.list[index].name.as_str());
    let [net_m, path_m, turned_rad] = [
        motion.map(|m| m.net_displacement_m()),
        motion.map(|m| m.path.path_length_m()),
        motion.map(|m| m.turned_rad),
    ]
    .map(number);
    let first = [
        ("case", case_name.to_owned()),
        ("repeat", repeat.number.to_string()),
        ("seed", case.ensemble.seed.to_string()),
        ("status", status),
        ("behaviour", behaviour.to_owned()),
        ("net_displacement_m", net_m),
        ("path_length_m", path_m),
        ("turned_rad", turned_rad),
    ];
    let mut row: Vec<_> = first.map(|(name, text)| (name.to_owned(), text)).into();
    let drawn = &repeat.perturbation;
    for (name, vector) in [
        ("shift_{}_m", &drawn.shift_world_m),
        ("turn_{}_rad", &drawn.turn_world_rad),
        ("velocity_{}_m_s", &drawn.velocity_world_m_s),
        ("spin_{}_rad_s", &drawn.spin_world_rad_s),
    ] {
        let along = ["x", "y", "z"].into_iter().zip(vector.iter());
        row.extend(along.map(|(axis, value)| (name.replace("{}", axis), value.to_string())));
    }
    for (name, values) in [
        ("servo_zero_rad", &drawn.servo_zero_rad),
        ("servo_gain_factor", &drawn.servo_gain_factor),
        ("servo_phase_rad", &drawn.servo_phase_rad),
        ("servo_latency_s", &drawn.servo_latency_s),
        ("mass_factor", &drawn.mass_factor),
        ("friction_factor", &drawn.friction_factor),
    ] {
        let each = values.iter().enumerate();
        row.extend(each.map(|(index, value)| (format!("{name}_{index}"), value.to_string())));
    }
    let friction = drawn.run_friction_factor.to_string();
    row.push(("run_friction_factor".to_owned(), friction));
    row
}

/// Draws an ensemble as `STEM.png` and `STEM.svg`; nothing where every repeat diverged.
///
/// # Errors
/// A full disk or an unwritable folder.
pub(super) fn draw_repeats(draft: &mut Draft, stem: &str, case: &EnsembleResult<'_>) -> Result<()> {
    let Some(envelope) = &case.summary.envelope else {
        return Ok(());
    };
    let summary = case.summary;
    // A sum of time steps has rounding errors in its last digits.
    let duration_s = (1e3 * summary.duration_s).round() / 1e3;
    let incomplete = if summary.complete { "" } else { "INCOMPLETE: " };
    let mut subtitle = format!(
        "{incomplete}{} of {} repeats of {} s, seed {}",
        summary.repeats, summary.repeats_asked, duration_s, summary.seed
    );
    if summary.diverged.count > 0 {
        subtitle += &format!(", {} diverged", summary.diverged.count);
    }
    let path_m = |motion: &Motion| motion.path.xy_m().to_vec();
    let mut plot = ensemble_plot(&summary.behaviours, Some(envelope));
    for (group, behaviour) in plot.groups.iter_mut().zip(&summary.behaviours.list) {
        let alike = case.ensemble.motions();
        let alike = alike.filter(|(repeat, _)| behaviour.repeats.contains(&repeat.number));
        group.paths_m = alike.take(PATHS_DRAWN).map(|(_, m)| path_m(m)).collect();
    }
    let widest = LEVELS.len() - 1;
    let plot = EnsemblePlot {
        caption: Caption::new(case.title.clone(), subtitle),
        noise_free_m: (case.ensemble.noise_free.get()).map_or(Vec::new(), path_m),
        real_m: case.real_paths_m.clone(),
        real_label: case.real_label.to_owned(),
        whole_paths: (summary.band.as_ref()).map(|band| extent(band, widest)),
        ..plot
    };
    draft.draw(stem, &plot)
}

/// The behaviours of an ensemble with a typical path of each, and the regions that hold its repeats over time.
pub(crate) fn ensemble_plot(behaviours: &Behaviours, envelope: Option<&Envelope>) -> EnsemblePlot {
    let groups = behaviours.list.iter().map(|behaviour| {
        let is_known = behaviour.representative.is_some();
        let typical = Some(&behaviour.path_xy_m).filter(|_| is_known);
        let share = odds(behaviour.probability).replacen('(', "(95 %: ", 1);
        EnsembleGroup {
            label: format!("{}: {share}", behaviour.name),
            paths_m: Vec::new(),
            representative_m: typical.cloned().unwrap_or_default(),
        }
    });
    let bands = envelope.iter().flat_map(|envelope| {
        let widest = LEVELS.len() - 1;
        (0..=widest).rev().map(|level| extent(envelope, level))
    });
    EnsemblePlot {
        caption: Caption::default(),
        groups: groups.collect(),
        noise_free_m: Vec::new(),
        real_m: Vec::new(),
        real_label: String::new(),
        times_s: envelope.map_or_else(Vec::new, |envelope| envelope.times_s.clone()),
        bands: bands.collect(),
        whole_paths: None,
    }
}

/// How far the regions of a level reach along x and along y.
fn extent(envelope: &Envelope, level: usize) -> EnsembleBand {
    let ends = |sign: f64| {
        let ends = envelope.regions.iter().map(|region| {
            let half_m = region.half_widths_m(level);
            [0, 1].map(|axis| region.centre_m[axis] + sign * half_m[axis])
        });
        ends.collect()
    };
    EnsembleBand {
        level: LEVELS[level],
        low_m: ends(-1.0),
        high_m: ends(1.0),
    }
}
