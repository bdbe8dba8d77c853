//! Which points of a study cannot be told apart from the best one.

use super::inference::Inference;
use super::setting::Setting;
use super::{LEVEL, Scores, Study};
use realgap_core::statistics::{mean_of_any, standard_deviation};

realgap_core::labelled_enum! {
    /// Where the uncertainty of the scores comes from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "snake_case")]
    UncertaintySource.label;
    /// Recordings that differ (two or more), and what the runs leave open.
    Recordings "recordings, equally valid settings, places between runs";
    /// What the runs leave open alone (one recording).
    Runs "equally valid settings, places between runs";
}

/// The set of points that fit as well as the best within the uncertainty of the scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Where it comes from.
    pub source: UncertaintySource,
    /// Confidence level, e.g. 0.95.
    pub level: f64,
    /// Standard deviation of the best point's score over recordings of the same run, in the metric's unit.
    pub best_score_sd: f64,
    /// Standard deviation of the best point's score over equally valid settings, in the metric's unit.
    pub simulation_sd: f64,
    /// Share of what parts scores that more runs would take away, 0 to 1.
    pub emulator_share: f64,
    /// One flag per point; the best itself is always in.
    pub indistinguishable: Vec<bool>,
    /// Places where nothing was simulated, spread evenly over what may be, and what is there.
    pub unvisited: Vec<Unvisited>,
}

/// A place where nothing was simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Unvisited {
    /// Parameter values.
    pub values: Vec<f64>,
    /// Whether it may be as good as the best.
    pub indistinguishable: bool,
}

impl Uncertainty {
    /// `visited` are positions of the points that the inference was asked about.
    pub(super) fn new(
        study: &Study,
        scores: &Scores,
        best: usize,
        (inference, visited): (&Inference, &[usize]),
    ) -> Self {
        let recordings = study.fitted_recordings();
        let grid = &study.definition().grid;
        let is_in = |implausibility: &f64| *implausibility <= inference.limit;
        let mut indistinguishable = vec![false; scores.points.len()];
        for (position, implausibility) in visited.iter().zip(&inference.visited) {
            indistinguishable[*position] = is_in(implausibility);
        }
        indistinguishable[best] = true;
        let places = inference.places.iter().zip(&inference.implausibility);
        let unvisited = places.map(|(place, implausibility)| Unvisited {
            values: grid.values_at(place),
            indistinguishable: is_in(implausibility),
        });
        let fitted = study.part_of(&scores.points[best].recordings, false);
        let runs = scores.runs_at(&scores.points[best].values);
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
            emulator_share: inference.emulator_share,
            indistinguishable,
            unvisited: unvisited.collect(),
        }
    }
}

/// Score of a point with the study's own settings; `None` where it has not been simulated with them.
pub(super) fn own_score(study: &Study, scores: &Scores, best: usize) -> Option<f64> {
    let settings = study.settings();
    let runs = scores.runs_at(&scores.points[best].values);
    let own = runs.filter(|run| settings.of_trial(run.index) == Setting::OWN);
    mean_of_any(own.filter_map(|run| run.score))
}
