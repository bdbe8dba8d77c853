//! Recordings and simulations in the plane of the first two principal components, and the basis for other studies.

use std::path::Path;

use super::cell::is_alike;
use crate::plot::{Caption, Cloud, plane};
use crate::results::draft::Draft;
use crate::results::ensemble::write_report;
use crate::results::kind::file;
use realgap_core::error::Result;
use realgap_lab::calibration::{Answer, PointScore, Study};
use realgap_path::comparison::Basis;
use realgap_path::trajectory::Prepared;

/// The basis of the scores as `basis.json`, where the metric has one: `--basis` takes it in another study.
pub(in crate::results) fn write_basis(folder: &Path, answer: &Answer) -> Result<()> {
    match &answer.scores.basis {
        Some(basis) => write_report(folder, file::BASIS, basis),
        None => Ok(()),
    }
}

/// Every run and every recording as a dot, where there are two components.
pub(super) fn draw(
    draft: &mut Draft,
    study: &Study,
    answer: &Answer,
    subtitle: &str,
) -> Result<()> {
    let real = study.real_paths();
    let runs = answer.scores.runs.iter();
    let runs = runs.filter(|run| run.score.is_some() && !run.path_xy_m.is_empty());
    let runs = runs.map(|run| Ok((run, Prepared::from_xy_m(run.path_xy_m.clone())?)));
    let runs: Vec<(&PointScore, Prepared)> = runs.collect::<Result<_>>()?;
    let simulated = runs.iter().map(|(_, path)| path);
    let all = real.iter().copied().chain(simulated);
    let Some(basis) = Basis::plane(answer.scores.basis.as_ref(), all)? else {
        return Ok(());
    };
    let points = &answer.scores.points;
    let is_at = |run: &PointScore, place: usize| points[place].values == run.values;
    let is_in = |run: &PointScore| {
        let mut marked = (0..points.len()).filter(|point| is_alike(answer, *point));
        marked.any(|place| is_at(run, place))
    };
    let (mut others, mut alike, mut best) = (Vec::new(), Vec::new(), Vec::new());
    for (run, path) in &runs {
        let is_best = answer.scores.best.is_some_and(|best| is_at(run, best));
        let group = match (is_best, is_in(run)) {
            (true, _) => &mut best,
            (false, true) => &mut alike,
            (false, false) => &mut others,
        };
        group.push(basis.in_plane_m(path));
    }
    let definition = study.definition();
    let reality = real.iter().map(|path| basis.in_plane_m(path)).collect();
    let cloud = |label: &str, colour: usize, points_m: Vec<(f64, f64)>| Cloud {
        label: label.to_owned(),
        colour,
        points_m,
    };
    let name = &definition.name;
    let title = format!("{name}: paths in the first two principal components");
    let plot = plane(
        Caption::new(title, subtitle),
        basis.plane_shares(),
        vec![
            cloud("simulated", 4, others),
            cloud("simulated, in the confidence set", 2, alike),
            cloud("simulated, best values", 0, best),
            cloud(definition.source().reality_label(), 1, reality),
        ],
    );
    draft.draw("components", &plot)
}
