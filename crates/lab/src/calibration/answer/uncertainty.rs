//! The confidence set of a study: the points that fit as well as the best point within the uncertainty of the scores.

use crate::calibration::numerics::setting::Setting;
use crate::calibration::{Scores, Study};
use realgap_core::statistics::{mean_of_any, standard_deviation};
use realgap_inference::{HistoryMatching, LEVEL, PosteriorDraws, Unvisited};

/// Of the draws of a fit by least squares, one in so many is kept as a point beside those that were simulated.
const EVERY_DRAW: usize = 2;

realgap_core::labelled_enum! {
    /// Where the uncertainty of the scores comes from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "snake_case")]
    UncertaintySource.label;
    /// Differences between recordings (two or more), and the uncertainty that the runs leave.
    Recordings "recordings, equally valid settings, points between runs";
    /// The uncertainty that the runs leave alone (one recording).
    Runs "equally valid settings, points between runs";
}

/// The confidence set: the points that fit as well as the best point within the uncertainty of the scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// The sources of the uncertainty.
    pub source: UncertaintySource,
    /// Confidence level, e.g. 0.95.
    pub level: f64,
    /// Standard deviation of the best point's score over recordings of the same run, in the metric's unit.
    pub best_score_sd: f64,
    /// Standard deviation of the best point's score over equally valid settings, in the metric's unit.
    pub simulation_sd: f64,
    /// Share of the variance between points and the best point that more runs would remove, 0 to 1.
    pub emulator_share: f64,
    /// Whether each simulated point belongs to the set; the best point always does.
    pub indistinguishable: Vec<bool>,
    /// Whether the best point belongs to the set by what the emulator says of it, too.
    pub holds_best: bool,
    /// Whether each point of the grid belongs to the set, where an optimizer chose points beside it: of two parameters, otherwise
    /// empty.
    pub cells: Vec<bool>,
    /// Points that were not simulated, spread evenly over the part of the search space that is not implausible.
    pub unvisited: Vec<Unvisited>,
}

impl Uncertainty {
    /// `visited` are the positions of the simulated points whose implausibility was computed; that of cells may follow.
    pub(in crate::calibration) fn new(
        study: &Study,
        scores: &Scores,
        best: usize,
        (matching, visited): (&HistoryMatching, &[usize]),
    ) -> Self {
        let recordings = study.fitted_recordings();
        let mut indistinguishable = vec![false; scores.points.len()];
        for (position, is_in) in visited.iter().zip(matching.visited_in_set()) {
            indistinguishable[*position] = is_in;
        }
        let cells = matching.visited_in_set().skip(visited.len()).collect();
        let holds_best = std::mem::replace(&mut indistinguishable[best], true);
        let fitted = study.part_of(&scores.points[best].recordings, false);
        let runs = scores.runs_of_mean(&study.settings(), best).into_iter();
        let over_settings: Vec<f64> = runs.filter_map(|run| run.score).collect();
        let simulation_sd = standard_deviation(&over_settings);
        let (source, best_score_sd) = match recordings {
            0 | 1 => (UncertaintySource::Runs, simulation_sd),
            n => (
                UncertaintySource::Recordings,
                standard_deviation(&fitted) / (n as f64).sqrt(),
            ),
        };
        Self {
            source,
            level: LEVEL,
            best_score_sd,
            simulation_sd,
            emulator_share: matching.emulator_share(),
            indistinguishable,
            holds_best,
            cells,
            unvisited: matching.unvisited(&study.definition().grid),
        }
    }

    /// The set of a fit by least squares: whether each simulated point belongs to it, and some draws of the posterior beside them.
    pub(in crate::calibration) fn of_draws(
        study: &Study,
        scores: &Scores,
        (best, mut indistinguishable): (usize, Vec<bool>),
        draws: &PosteriorDraws,
    ) -> Self {
        indistinguishable[best] = true;
        let fitted = study.part_of(&scores.points[best].recordings, false);
        let (source, best_score_sd) = match fitted.len() {
            0 | 1 => (UncertaintySource::Runs, 0.0),
            n => (
                UncertaintySource::Recordings,
                standard_deviation(&fitted) / (n as f64).sqrt(),
            ),
        };
        let level = LEVEL;
        let axes = 0..study.definition().grid.ranges().len();
        let parts: Vec<_> = axes.map(|axis| draws.intervals(axis, level)).collect();
        let in_set = |values: &Vec<f64>| {
            let mut axes = values.iter().zip(&parts);
            axes.all(|(value, parts)| {
                parts
                    .iter()
                    .any(|(low, high)| (*low..=*high).contains(value))
            })
        };
        let some = draws.rows().iter().step_by(EVERY_DRAW);
        Self {
            source,
            level,
            best_score_sd,
            simulation_sd: 0.0,
            emulator_share: 0.0,
            indistinguishable,
            holds_best: true,
            cells: Vec::new(),
            unvisited: some
                .map(|values| Unvisited {
                    values: values.clone(),
                    indistinguishable: in_set(values),
                })
                .collect(),
        }
    }

    /// Values of parameter number `axis` in the confidence set: of simulated points and of others.
    pub(in crate::calibration) fn values_in_set<'a>(
        &'a self,
        scores: &'a Scores,
        axis: usize,
    ) -> impl Iterator<Item = f64> + 'a {
        let points = scores.points.iter().zip(&self.indistinguishable);
        let visited = points.map(|(point, is_in)| (&point.values, *is_in));
        let unvisited = self.unvisited.iter();
        let unvisited = unvisited.map(|point| (&point.values, point.indistinguishable));
        let all = visited.chain(unvisited).filter(|(_, is_in)| *is_in);
        all.map(move |(values, _)| values[axis])
    }
}

/// Score of a point with the study's own settings; `None` where it has not been simulated with them, or where the recordings speak
/// against the study's own engine.
pub(in crate::calibration) fn own_score(
    study: &Study,
    scores: &Scores,
    best: usize,
) -> Option<f64> {
    let settings = study.settings();
    let runs = scores.runs_of_mean(&settings, best).into_iter();
    let own = runs.filter(|run| settings.of_trial(run.index) == Setting::OWN);
    mean_of_any(own.filter_map(|run| run.score))
}
