//! Pictures of a search: fitness over the robots, the archive, the best robots, their paths.

use super::table::History;
use crate::plot::{
    AxisSpec, Caption, Gallery, HeatMap, LinePlot, ScoreScale, Series, SeriesKind, number,
};
use crate::report::odds;
use crate::results::draft::Draft;
use crate::results::ensemble::{EnsembleResult, draw_repeats};
use crate::results::portrait::{GAIT_S, portrait};
use realgap_core::error::Result;
use realgap_core::statistics::mean;
use realgap_core::unit::{Unit, counted};
use realgap_lab::search::{Archive, Finalist, Search, SearchResults, descriptor_named};

/// Draws all pictures for which there are data.
pub(super) fn draw(
    draft: &mut Draft,
    search: &Search,
    results: &SearchResults,
    history: &History,
    elites: Option<&Archive>,
    finalists: &[Finalist],
) -> Result<()> {
    if let Some(plot) = fitness(search, results, history) {
        draft.draw("fitness", &plot)?;
    }
    let elites = elites.map(|elites| archive(search, results, elites));
    if let Some(map) = elites.transpose()?.flatten() {
        draft.draw("archive", &map)?;
    }
    if !finalists.is_empty() {
        draft.draw("gallery", &gallery(search, finalists))?;
    }
    let Some(best) = finalists.first() else {
        return Ok(());
    };
    let does = match best.finals.survives {
        true => "what the best robot will do",
        false => "what the best robot does with these settings, but NOT with others",
    };
    let result = EnsembleResult {
        ensemble: &best.ensemble,
        summary: best.prediction(),
        real_paths_m: Vec::new(),
        real_label: "reality",
        title: format!("{}: {does}", best.robot.name()),
    };
    draw_repeats(draft, "paths", &result)
}

/// Fitness of every robot with the caption of its picture; nothing where every robot failed.
fn fitness(search: &Search, results: &SearchResults, history: &History) -> Option<LinePlot> {
    let strategy = search.strategy();
    let unit = search.objective().measure.unit();
    let plot = fitness_chart(history, strategy.batch_name(), unit)?;
    let robots = results.robots.iter();
    let failed = robots.filter(|robot| robot.failure().is_some()).count();
    let is_whole = results.robots.len() >= strategy.budget();
    let incomplete = if is_whole { "" } else { "INCOMPLETE: " };
    let title = format!("{}: fitness over {}", search.name(), strategy.name());
    let subtitle = format!(
        "{incomplete}{}, {} each of {} s, {failed} failed and are not shown, seed {}",
        counted(results.robots.len(), "robot"),
        counted(search.repeats(), "repeat"),
        search.duration_s(),
        search.seed()
    );
    Some(LinePlot {
        caption: Caption::new(title, subtitle),
        ..plot
    })
}

/// Fitness of every robot over the batches that the strategy proposed; over the numbers of the robots where there was one
/// batch. Nothing where every robot failed.
pub(crate) fn fitness_chart(history: &History, batch_name: &str, unit: Unit) -> Option<LinePlot> {
    let mut batches: Vec<&str> = history.0.iter().map(|row| row.batch.as_str()).collect();
    batches.dedup();
    let one_batch = batches.len() < 2;
    let mut dots = Vec::new();
    let mut best: Vec<(f64, f64)> = Vec::new();
    let mut means = Vec::new();
    for (number, batch) in batches.iter().enumerate() {
        let at = batch.parse().unwrap_or(number as f64);
        let mut values = Vec::new();
        let here = history.0.iter().enumerate();
        let here = here.filter(|(_, row)| row.batch == **batch);
        for (robot, value) in here.filter_map(|(robot, row)| Some((robot, row.fitness?))) {
            values.push(value);
            let so_far = best.last().map_or(value, |(_, held)| held.max(value));
            let x = if one_batch { robot as f64 } else { at };
            dots.push((x, value));
            match best.last_mut() {
                Some(last) if last.0 == x => last.1 = so_far,
                _ => best.push((x, so_far)),
            }
        }
        if !one_batch && !values.is_empty() {
            means.push((at, mean(&values)));
        }
    }
    if dots.is_empty() {
        return None;
    }
    let series = [
        ("a robot", dots, SeriesKind::Dots, 4),
        ("mean of those that walked", means, SeriesKind::Line, 1),
        ("best so far", best, SeriesKind::Steps, 0),
    ];
    let series = series.map(|(label, points, kind, n)| Series::new(label, kind, points).colour(n));
    let series = series.into_iter().filter(|s| !s.points.is_empty());
    Some(LinePlot::new(
        Caption::default(),
        AxisSpec::new(if one_batch { "robot" } else { batch_name }, Unit::One).whole(),
        ("fitness", unit),
        series.collect(),
    ))
}

/// The best fitness over the first two axes of the archive, whatever the values on the others; nothing for one axis.
fn archive(search: &Search, results: &SearchResults, archive: &Archive) -> Result<Option<HeatMap>> {
    let [x, y, ..] = archive.axes() else {
        return Ok(None);
    };
    let elites = archive.elites();
    let mut scores: Vec<Option<f64>> = vec![None; x.cells * y.cells];
    let mut best: Option<((usize, usize), f64)> = None;
    for (along, elite) in &elites {
        let Some(fitness) = results.robots[*elite].fitness() else {
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
    let centres = |axis: &realgap_lab::search::Axis| -> Vec<f64> {
        let width = (axis.to - axis.from) / axis.cells as f64;
        let is_count = descriptor_named(&axis.name).is_ok_and(|d| d.is_count);
        let centre = |cell: usize| match is_count && (width - 1.0).abs() < 1e-9 {
            // Where every cell holds one count, its centre is that count, because no robot has 1.5 modules.
            true => (axis.from + cell as f64 * width).ceil(),
            false => axis.from + (cell as f64 + 0.5) * width,
        };
        (0..axis.cells).map(centre).collect()
    };
    let spec = |axis: &realgap_lab::search::Axis| -> Result<AxisSpec> {
        let descriptor = descriptor_named(&axis.name)?;
        let unit = descriptor.unit.symbol();
        let label = axis.name.strip_suffix(&format!("_{unit}"));
        let label = label.unwrap_or(&axis.name).replace('_', " ");
        let mut spec = AxisSpec::new(label, descriptor.unit);
        spec.whole = descriptor.is_count;
        Ok(spec)
    };
    let objective = search.objective();
    Ok(Some(HeatMap {
        missing: "no robot".to_owned(),
        scale: ScoreScale::Linear,
        best: best.map(|(cell, _)| cell),
        larger_is_better: true,
        caption: Caption::new(
            // The label is `fitness`: the full name of the objective would not fit beside the colour bar, and its unit would be cut.
            format!("{}: the best robot of every kind", search.name()),
            format!(
                "{} in {} of {} cells, {} simulated, seed {}",
                counted(elites.len(), "elite"),
                scores.iter().flatten().count(),
                scores.len(),
                counted(results.robots.len(), "robot"),
                search.seed()
            ),
        ),
        ..HeatMap::new(
            Caption::default(),
            [(spec(x)?, centres(x)), (spec(y)?, centres(y))],
            scores,
            ("fitness", objective.measure.unit()),
        )
    }))
}

fn gallery(search: &Search, finalists: &[Finalist]) -> Gallery {
    let robots = finalists.iter().enumerate().map(|(index, finalist)| {
        let far = finalist.prediction().displacement_m.map(|d| {
            let [q05, q50, q95] = [d.q05, d.q50, d.q95].map(|m| number(100.0 * m));
            format!("{q50} cm (90 %: {q05} to {q95} cm)")
        });
        let far = far.unwrap_or_else(|| "every repeat diverged".to_owned());
        let success = finalist.success().map(|s| {
            let least_cm = number(100.0 * s.least_displacement_m);
            let share = odds(s.probability).replacen('(', "(95 %: ", 1);
            format!(", P(over {least_cm} cm) {share}")
        });
        let success = success.unwrap_or_default();
        let survives = match finalist.finals.survives {
            true => "",
            false => ", does NOT survive reruns",
        };
        let mut drawn = portrait(&finalist.robot, format!("{far}{success}{survives}"));
        drawn.title = format!("{}. {}", index + 1, finalist.robot.name());
        drawn
    });
    let remark = match finalists.iter().any(|finalist| finalist.finals.survives) {
        true => "",
        false => "; none of them walks the same with other settings",
    };
    Gallery {
        gait_s: GAIT_S,
        caption: Caption::new(
            format!("{}: the best robots{remark}", search.name()),
            format!(
                "{} of {}, {}, in {} s; at zero servo angles",
                search.strategy().name(),
                counted(search.strategy().budget(), "robot"),
                search.objective().label(),
                search.duration_s()
            ),
        ),
        columns: finalists.len().min(4),
        robots: robots.collect(),
    }
}
