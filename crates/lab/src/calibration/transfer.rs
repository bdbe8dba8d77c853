//! Does what is tuned on some robots hold for another? The question of a study of many.

use serde::Serialize;

use super::fleet::Member;
use super::score::{PointScore, Scores};
use super::study::Study;
use realgap_core::statistics::mean;

/// What a floor that was tuned on the other robots does for each of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Transfer {
    /// The point that counts as untuned: that nearest to the defaults of the parameters.
    pub untuned: Vec<f64>,
    /// Mean misfit over the robots at that point, in the unit of the metric.
    pub untuned_misfit: f64,
    /// Mean misfit over the robots, each at the best point of the others: the held-out error.
    pub held_out_misfit: f64,
    /// Mean misfit over the robots, each at its own best point; the lowest of many points is partly luck.
    pub own_misfit: f64,
    /// Share of the untuned misfit that the others' point closes, over all robots; negative where it makes it larger.
    pub closed: f64,
    /// Share of the untuned misfit that each robot's own best point closes: no floor can close more.
    pub closable: f64,
    /// The robots, in the order of the study.
    pub robots: Vec<RobotMisfit>,
}

/// How far one robot of a study is from its recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotMisfit {
    /// Its name.
    pub robot: String,
    /// Recordings of it.
    pub recordings: usize,
    /// Misfit at the untuned point, in the unit of the metric.
    pub untuned: f64,
    /// Misfit at the shared answer, which has seen it.
    pub shared: f64,
    /// Misfit at the best point of all the others.
    pub held_out: f64,
    /// Values of the parameters at that point.
    pub without_it: Vec<f64>,
    /// Misfit at its own best point.
    pub own: f64,
    /// Share of the untuned misfit that the others' point closes.
    pub closed: f64,
}

impl Transfer {
    /// Of the points that a sweep or an optimizer has evaluated; `None` for a study of one robot, and where nothing has a score.
    pub(super) fn new(study: &Study, scores: &Scores) -> Option<Self> {
        let definition = study.definition();
        if definition.robots.len() < 2 {
            return None;
        }
        let shared = &scores.points[scores.best?];
        let points: Vec<&PointScore> = (scores.points.iter())
            .filter(|point| point.score.is_some())
            .collect();
        let untuned = nearest_to_defaults(study, &points)?;
        let weights = definition.weights();
        let misfit = |point: &PointScore, member: &Member| {
            let own = member.recordings.clone();
            let own = own.map(|recording| point.recordings[recording] / weights[recording]);
            mean(&own.collect::<Vec<f64>>())
        };
        let mut robots = Vec::new();
        for member in &definition.robots {
            let of_others = |point: &PointScore| {
                let all = point.recordings.iter().enumerate();
                let others = all.filter(|(index, _)| !member.recordings.contains(index));
                mean(&others.map(|(_, score)| *score).collect::<Vec<f64>>())
            };
            let lowest = |of: &dyn Fn(&PointScore) -> f64| {
                let all = points.iter().copied();
                all.min_by(|a, b| of(a).total_cmp(&of(b)))
            };
            let without_it = lowest(&of_others)?;
            let own = lowest(&|point| misfit(point, member))?;
            let (before, after) = (misfit(untuned, member), misfit(without_it, member));
            robots.push(RobotMisfit {
                robot: member.morphology.name().to_owned(),
                recordings: member.recordings.len(),
                untuned: before,
                shared: misfit(shared, member),
                held_out: after,
                without_it: without_it.values.clone(),
                own: misfit(own, member),
                closed: 1.0 - after / before,
            });
        }
        let over = |of: fn(&RobotMisfit) -> f64| mean(&robots.iter().map(of).collect::<Vec<_>>());
        let (before, after, own) = (over(|r| r.untuned), over(|r| r.held_out), over(|r| r.own));
        Some(Self {
            untuned: untuned.values.clone(),
            untuned_misfit: before,
            held_out_misfit: after,
            own_misfit: own,
            closed: 1.0 - after / before,
            closable: 1.0 - own / before,
            robots,
        })
    }
}

/// The point nearest to where nobody has tuned anything, along the ranges.
fn nearest_to_defaults<'a>(study: &Study, points: &[&'a PointScore]) -> Option<&'a PointScore> {
    let definition = study.definition();
    let ranges = definition.grid.ranges();
    let away = |point: &PointScore| -> f64 {
        let axes = definition.parameters.iter().zip(ranges).zip(&point.values);
        axes.map(|((parameter, range), value)| {
            let untuned = definition.untuned(parameter);
            let default = parameter.value(&untuned).unwrap_or(range.from);
            let default = default.clamp(range.from, range.to);
            (range.coordinate(*value) - range.coordinate(default)).powi(2)
        })
        .sum()
    };
    let points = points.iter().copied();
    points.min_by(|a, b| away(a).total_cmp(&away(b)))
}
