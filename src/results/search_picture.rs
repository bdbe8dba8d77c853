//! Pictures of a search: fitness over the robots, the archive, the best robots, their paths.

use std::path::Path;

use super::ensemble::{EnsembleResult, draw_repeats};
use super::search::elites;
use crate::error::Result;
use crate::plot::portrait::portrait;
use crate::plot::{
    AxisSpec, Gallery, HeatMap, LinePlot, ScoreScale, Series, SeriesKind, draw_gallery,
    draw_heat_map, draw_lines, number,
};
use crate::search::{Finalist, Hunt, Judged, Plan, descriptor_named};
use crate::statistics::mean;
use crate::unit::{Unit, counted};

pub(super) fn draw(
    folder: &Path,
    hunt: &Hunt,
    robots: &[Judged],
    finalists: &[Finalist],
) -> Result<()> {
    if let Some(plot) = fitness(hunt, robots) {
        for extension in ["png", "svg"] {
            draw_lines(&plot, folder.join(format!("fitness.{extension}")))?;
        }
    }
    if let Some(map) = archive(hunt, robots)? {
        for extension in ["png", "svg"] {
            draw_heat_map(&map, folder.join(format!("archive.{extension}")))?;
        }
    }
    if finalists.is_empty() {
        return Ok(());
    }
    for extension in ["png", "svg"] {
        draw_gallery(
            &gallery(hunt, finalists),
            folder.join(format!("gallery.{extension}")),
        )?;
    }
    let best = &finalists[0];
    let result = EnsembleResult {
        ensemble: &best.ensemble,
        summary: &best.prediction,
        reality: None,
        real_paths_m: Vec::new(),
        real_label: "reality",
        title: format!("{}: what the best robot will do", best.robot.name()),
    };
    draw_repeats(folder, "paths", &result)
}

/// Fitness of every robot, mean of every generation, best so far; nothing where every robot failed.
fn fitness(hunt: &Hunt, robots: &[Judged]) -> Option<LinePlot> {
    let mut dots = Vec::new();
    let mut best: Vec<(f64, f64)> = Vec::new();
    let mut means = Vec::new();
    let last = robots.last()?.index;
    for generation in 0..=hunt.plan.generation_of(last) {
        let here = robots
            .iter()
            .filter(|robot| hunt.plan.generation_of(robot.index) == generation);
        let values: Vec<f64> = here.filter_map(|robot| robot.fitness).collect();
        let x = generation as f64;
        dots.extend(values.iter().map(|value| (x, *value)));
        let so_far = best.last().map(|(_, best)| *best).into_iter();
        let so_far = so_far.chain(values.iter().copied()).reduce(f64::max);
        best.extend(so_far.map(|so_far| (x, so_far)));
        if !values.is_empty() {
            means.push((x, mean(&values)));
        }
    }
    if dots.is_empty() {
        return None;
    }
    let failed = robots
        .iter()
        .filter(|robot| robot.failure.is_some())
        .count();
    let series = |label: &str, points, kind, colour| Series {
        label: label.to_owned(),
        points,
        kind,
        colour,
    };
    let incomplete = if robots.len() < hunt.plan.budget() {
        "INCOMPLETE: "
    } else {
        ""
    };
    Some(LinePlot {
        title: format!("{}: fitness over {}", hunt.name, hunt.plan.name()),
        subtitle: format!(
            "{incomplete}{}, {} each of {} s, {failed} failed and are not shown, seed {}",
            counted(robots.len(), "robot"),
            counted(hunt.repeats, "repeat"),
            hunt.duration_s,
            hunt.seed
        ),
        x: AxisSpec::new(generation_label(hunt), Unit::One),
        y_label: hunt.objective.label(),
        y_unit: hunt.objective.measure.unit(),
        scale: ScoreScale::Linear,
        y_range: None,
        series: vec![
            series("a robot", dots, SeriesKind::Dots, 4),
            series("mean of those that walked", means, SeriesKind::Line, 1),
            series("best so far", best, SeriesKind::Line, 0),
        ],
    })
}

fn generation_label(hunt: &Hunt) -> &'static str {
    match &hunt.plan {
        Plan::Evolution(_) => "generation",
        Plan::Grid(_) => "tens of robots",
        Plan::MapElites(_) | Plan::CmaEs(_) => "batch",
    }
}

/// The best fitness over the first two axes, whatever the others; nothing for one axis.
fn archive(hunt: &Hunt, robots: &[Judged]) -> Result<Option<HeatMap>> {
    let Plan::MapElites(plan) = &hunt.plan else {
        return Ok(None);
    };
    let [x, y, ..] = plan.axes.as_slice() else {
        return Ok(None);
    };
    let elites = elites(hunt, robots)?;
    let mut scores: Vec<Option<f64>> = vec![None; x.cells * y.cells];
    let mut best: Option<((usize, usize), f64)> = None;
    for (along, elite) in &elites {
        let Some(fitness) = robots[*elite].fitness else {
            continue;
        };
        let cell = &mut scores[along[1] * x.cells + along[0]];
        *cell = Some(cell.map_or(fitness, |held| held.max(fitness)));
        if best.is_none_or(|(_, held)| fitness > held) {
            best = Some(((along[0], along[1]), fitness));
        }
    }
    if elites.is_empty() {
        return Ok(None);
    }
    let centres = |axis: &crate::search::Axis| -> Vec<f64> {
        let width = (axis.to - axis.from) / axis.cells as f64;
        (0..axis.cells)
            .map(|cell| axis.from + (cell as f64 + 0.5) * width)
            .collect()
    };
    let spec = |axis: &crate::search::Axis| -> Result<AxisSpec> {
        let descriptor = descriptor_named(&axis.name)?;
        let unit = descriptor.unit.symbol();
        let label = axis.name.strip_suffix(&format!("_{unit}"));
        let label = label.unwrap_or(&axis.name).replace('_', " ");
        Ok(AxisSpec::new(label, descriptor.unit))
    };
    Ok(Some(HeatMap {
        title: format!("{}: the best robot of every kind", hunt.name),
        subtitle: format!(
            "{} in {} of {} cells, {} simulated, seed {}",
            counted(elites.len(), "elite"),
            scores.iter().flatten().count(),
            scores.len(),
            counted(robots.len(), "robot"),
            hunt.seed
        ),
        x: spec(x)?,
        y: spec(y)?,
        x_values: centres(x),
        y_values: centres(y),
        scores,
        missing: "no robot".to_owned(),
        score_label: hunt.objective.label(),
        score_unit: hunt.objective.measure.unit(),
        scale: ScoreScale::Linear,
        best: best.map(|(cell, _)| cell),
        indistinguishable: Vec::new(),
        truth: None,
    }))
}

fn gallery(hunt: &Hunt, finalists: &[Finalist]) -> Gallery {
    let robots = finalists
        .iter()
        .enumerate()
        .map(|(index, finalist)| {
            let far = finalist.prediction.displacement_m.map_or(
                "every repeat diverged".to_owned(),
                |d| {
                    let [q05, q50, q95] = [d.q05, d.q50, d.q95].map(|m| number(100.0 * m));
                    format!("{q50} cm (90 %: {q05} to {q95} cm)")
                },
            );
            let success = finalist.success.as_ref().map_or(String::new(), |s| {
                format!(", P(success) {:.0} %", 100.0 * s.probability.share)
            });
            let survives = if finalist.survives() {
                ""
            } else {
                ", does NOT survive reruns"
            };
            let mut drawn = portrait(&finalist.robot, format!("{far}{success}{survives}"));
            drawn.title = format!("{}. {}", index + 1, finalist.robot.name());
            drawn
        })
        .collect();
    Gallery {
        title: format!("{}: the best robots", hunt.name),
        subtitle: format!(
            "{} of {}, {}, in {} s; at zero servo angles",
            hunt.plan.name(),
            counted(hunt.plan.budget(), "robot"),
            hunt.objective.label(),
            hunt.duration_s
        ),
        columns: finalists.len().min(4),
        robots,
    }
}
