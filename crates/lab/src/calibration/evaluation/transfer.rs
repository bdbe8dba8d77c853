//! Transfer: whether a floor that is tuned on some robots of a study also holds for the others.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::calibration::{Member, PointScore, Scores, Study};
use realgap_core::statistics::{least_by, mean_of};

/// How well parameters that were tuned on the other robots fit each robot.
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
    /// How the robots' own parameters were treated at the point of the others.
    pub own_parameters: OwnParameters,
    /// The robots, in the order of the study.
    pub robots: Vec<RobotMisfit>,
}

/// How parameters of one robot alone (`robot.NAME.PARAMETER`) are treated where that robot is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OwnParameters {
    /// There are no such parameters.
    None,
    /// They are fitted again to the robot's own recordings, among the points that have the others' shared values.
    Refitted,
    /// They keep their values at the others' point, because no two evaluated points differ in them alone.
    AsTheyCame,
}

impl OwnParameters {
    /// A remark for readers behind the number that it is about; empty where there are no such parameters.
    pub fn remark(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Refitted => "; with the others' floor, robots' own parameters are fitted again",
            Self::AsTheyCame => {
                "; robots' own parameters were NOT fitted again with the others' floor: no two points differ in them alone"
            }
        }
    }
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
    /// Misfit at the best point of all the others, its own parameters fitted again where the points allow it.
    pub held_out: f64,
    /// Values of the parameters at that point.
    pub without_it: Vec<f64>,
    /// Points among which its own parameters were fitted again; 1 where they were not.
    pub refitted_among: usize,
    /// Misfit at its own best point.
    pub own: f64,
    /// Share of the untuned misfit that the others' point closes.
    pub closed: f64,
}

impl Transfer {
    /// Transfer over the points that a sweep or an optimizer has evaluated; `None` for a study of one robot, and where no point
    /// has a score.
    pub(in crate::calibration) fn new(study: &Study, scores: &Scores) -> Option<Self> {
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
            mean_of(own)
        };
        let mut robots = Vec::new();
        for member in &definition.robots {
            let of_others = |point: &PointScore| {
                let all = point.recordings.iter().enumerate();
                let others = all.filter(|(index, _)| !member.recordings.contains(index));
                mean_of(others.map(|(_, score)| *score))
            };
            let own_misfit = |point: &PointScore| misfit(point, member);
            let family = best_family(families(study, &points, member), &of_others)?;
            let without_it = lowest_of(&family, &own_misfit)?;
            let own = lowest_of(&points, &own_misfit)?;
            let (before, after) = (misfit(untuned, member), misfit(without_it, member));
            robots.push(RobotMisfit {
                robot: member.morphology.name().to_owned(),
                recordings: member.recordings.len(),
                untuned: before,
                shared: misfit(shared, member),
                held_out: after,
                without_it: without_it.values.clone(),
                refitted_among: family.len(),
                own: misfit(own, member),
                closed: 1.0 - after / before,
            });
        }
        let over = |of: fn(&RobotMisfit) -> f64| mean_of(robots.iter().map(of));
        let (before, after, own) = (over(|r| r.untuned), over(|r| r.held_out), over(|r| r.own));
        Some(Self {
            untuned: untuned.values.clone(),
            untuned_misfit: before,
            held_out_misfit: after,
            own_misfit: own,
            closed: 1.0 - after / before,
            closable: 1.0 - own / before,
            own_parameters: own_parameters(study, &robots),
            robots,
        })
    }
}

/// Whether each parameter of the study, in order, belongs to this robot alone.
fn is_own(study: &Study, member: &Member) -> Vec<bool> {
    let parameters = study.definition().parameters.iter();
    let name = member.morphology.name();
    parameters
        .map(|parameter| parameter.robot() == Some(name))
        .collect()
}

/// Groups of points that differ only in the robot's own parameters. Where a group has several points, groups of one are left out:
/// points of waves lie between the points of a grid and differ in all parameters.
fn families<'a>(
    study: &Study,
    points: &[&'a PointScore],
    member: &Member,
) -> Vec<Vec<&'a PointScore>> {
    let is_own = is_own(study, member);
    let mut numbers = BTreeMap::new();
    let mut families: Vec<Vec<&PointScore>> = Vec::new();
    for point in points.iter().copied() {
        let shared = point.values.iter().zip(&is_own).filter(|(_, own)| !**own);
        let shared: Vec<u64> = shared.map(|(value, _)| value.to_bits()).collect();
        let number = *numbers.entry(shared).or_insert(families.len());
        match families.get_mut(number) {
            Some(family) => family.push(point),
            None => families.push(vec![point]),
        }
    }
    if families.iter().any(|family| family.len() > 1) {
        families.retain(|family| family.len() > 1);
    }
    families
}

/// The group whose shared values fit the others best on average, because the robot's own parameters do not affect the others.
fn best_family<'a>(
    families: Vec<Vec<&'a PointScore>>,
    of_others: &dyn Fn(&PointScore) -> f64,
) -> Option<Vec<&'a PointScore>> {
    least_by(families, |family| {
        mean_of(family.iter().map(|point| of_others(point)))
    })
}

fn lowest_of<'a>(
    points: &[&'a PointScore],
    of: &dyn Fn(&PointScore) -> f64,
) -> Option<&'a PointScore> {
    least_by(points.iter().copied(), |point| of(point))
}

/// `Refitted` where every robot with parameters of its own was fitted again.
fn own_parameters(study: &Study, robots: &[RobotMisfit]) -> OwnParameters {
    let members = study.definition().robots.iter().zip(robots);
    let with_own = members.filter(|(member, _)| is_own(study, member).contains(&true));
    let refitted: Vec<bool> = with_own
        .map(|(_, robot)| robot.refitted_among > 1)
        .collect();
    match refitted.as_slice() {
        [] => OwnParameters::None,
        all if all.iter().all(|refitted| *refitted) => OwnParameters::Refitted,
        _ => OwnParameters::AsTheyCame,
    }
}

/// The point nearest to the default values, along the ranges.
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
    lowest_of(points, &away)
}
