//! Which points of a study cannot be told apart from the best one.

use nalgebra::DVector;

use super::posterior::BestDraws;
use super::refinement::scored_runs;
use super::score::Scores;
use super::setting::Setting;
use super::study::Study;
use super::surface::Surface;
use realgap_core::error::Result;
use realgap_core::random::Once;
use realgap_core::statistics::{mean, smaller_resamples, standard_deviation};
use realgap_optimize::space_filling;

/// Where the uncertainty of the scores comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UncertaintySource {
    /// Resampling the recordings (two or more), and what the runs leave open.
    Bootstrap,
    /// What the runs leave open alone (one recording).
    Runs,
}

impl UncertaintySource {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Bootstrap => "recordings drawn again, equally valid settings",
            Self::Runs => "equally valid settings",
        }
    }
}

/// The set of points that fit as well as the best within the uncertainty of the scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Where it comes from.
    pub source: UncertaintySource,
    /// Confidence level, e.g. 0.95.
    pub level: f64,
    /// Standard deviation of the best point's score when reality is sampled again, in the metric's unit.
    pub best_score_sd: f64,
    /// Standard deviation of the best point's score over equally valid settings, in the metric's unit.
    pub simulation_sd: f64,
    /// One flag per point; the best itself is always in.
    pub indistinguishable: Vec<bool>,
    /// Places where nothing was simulated, and what is there.
    pub unvisited: Vec<Unvisited>,
}

/// A place where nothing was simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Unvisited {
    /// Parameter values.
    pub values: Vec<f64>,
    /// The score that the runs around it suggest.
    pub score: f64,
    /// Whether it may be as good as the best.
    pub indistinguishable: bool,
}

/// Confidence level of the indistinguishable set.
pub const LEVEL: f64 = 0.95;
/// Realities drawn.
const DRAWS: usize = 1000;
/// Points and places that the surface is known at, at most; worse points than these are told apart by their own scores.
const NODES: usize = 900;
/// Places where nothing was simulated, where the grid has more.
const PLACES: usize = 300;

/// The score at every point and place, and everything that follows from it.
pub(super) struct Known {
    surface: Surface,
    /// Position in the scores' points of each node that is one.
    points: Vec<usize>,
    /// Values at the nodes behind these.
    places: Vec<Vec<f64>>,
}

impl Known {
    /// `None` where there are too few scores.
    ///
    /// # Errors
    /// As [`Surface::new`].
    pub fn new(study: &Study, scores: &Scores) -> Result<Option<Self>> {
        let mut points = scores.ranked();
        points.truncate(NODES - PLACES);
        let places = places(study, scores);
        let nodes: Vec<Vec<f64>> = points
            .iter()
            .map(|position| &scores.points[*position].values)
            .chain(&places)
            .map(|values| study.definition().grid.place_of(values))
            .collect();
        let surface = Surface::new(&scored_runs(study, scores), &nodes)?;
        Ok(surface.map(|surface| Self {
            surface,
            points,
            places,
        }))
    }

    /// Position of the best point among those that were simulated.
    pub fn best(&self) -> Option<usize> {
        let node = self.surface.lowest(0..self.points.len())?;
        Some(self.points[node])
    }

    /// What another reality might have shown: the set and where its best lies.
    pub fn judge(&self, study: &Study, scores: &Scores, best: usize) -> (Uncertainty, BestDraws) {
        let definition = study.definition();
        let recordings = study.fitted_recordings();
        let resamples = smaller_resamples(recordings, DRAWS, definition.seed);
        let mut rng = Once::BestPoint.generator(definition.seed);
        let realities: Vec<DVector<f64>> = (0..DRAWS)
            .map(|draw| self.surface.draw_reality(resamples.get(draw), &mut rng))
            .collect();
        let best_node = self.points.iter().position(|point| *point == best);
        let as_good: Vec<bool> = (0..self.points.len() + self.places.len())
            .map(|node| {
                let wins = best_node.map_or(0, |best| {
                    realities.iter().filter(|r| r[node] <= r[best]).count()
                });
                wins as f64 > (1.0 - LEVEL) * DRAWS as f64
            })
            .collect();
        let mut indistinguishable = vec![false; scores.points.len()];
        for (node, position) in self.points.iter().enumerate() {
            indistinguishable[*position] = as_good[node];
        }
        indistinguishable[best] = true;
        let unvisited = self.places.iter().enumerate().map(|(index, values)| {
            let node = self.points.len() + index;
            Unvisited {
                values: values.clone(),
                score: self.surface.mean(node),
                indistinguishable: as_good[node],
            }
        });
        let values = self
            .points
            .iter()
            .map(|position| &scores.points[*position].values);
        let values: Vec<&Vec<f64>> = values.chain(&self.places).collect();
        let draws = realities.iter().map(|r| values[r.imin()].as_slice());
        let draws = BestDraws::new(&definition.grid, draws, definition.seed);
        let fitted = study.part_of(&scores.points[best].recordings, false);
        let over_settings: Vec<f64> = scores
            .runs_at(&scores.points[best].values)
            .filter_map(|run| run.score)
            .collect();
        let uncertainty = Uncertainty {
            source: if recordings < 2 {
                UncertaintySource::Runs
            } else {
                UncertaintySource::Bootstrap
            },
            level: LEVEL,
            best_score_sd: match recordings {
                0 | 1 => standard_deviation(&over_settings),
                n => standard_deviation(&fitted) / (n as f64).sqrt(),
            },
            simulation_sd: standard_deviation(&over_settings),
            indistinguishable,
            unvisited: unvisited.collect(),
        };
        (uncertainty, draws)
    }

    /// Score at a point as its neighbours and all its runs have it.
    pub fn mean(&self, position: usize) -> Option<f64> {
        let node = self.points.iter().position(|point| *point == position)?;
        Some(self.surface.mean(node))
    }
}

/// Values where nothing was simulated: points of the grid, or where these are too many, places spread over it.
fn places(study: &Study, scores: &Scores) -> Vec<Vec<f64>> {
    let grid = &study.definition().grid;
    let visited = |values: &Vec<f64>| scores.points.iter().any(|point| point.values == *values);
    if grid.len() <= scores.points.len() {
        return Vec::new();
    }
    if grid.len() <= PLACES {
        let all = (0..grid.len()).map(|index| grid.values(index));
        return all.filter(|values| !visited(values)).collect();
    }
    let seed = study.definition().seed.wrapping_add(1);
    space_filling(grid.ranges().len(), 0, PLACES, seed)
        .iter()
        .map(|place| grid.values_at(place))
        .collect()
}

/// Score of a point with the study's own settings; `None` where it has not been simulated with them.
pub(super) fn own_score(study: &Study, scores: &Scores, best: usize) -> Option<f64> {
    let settings = study.settings();
    let runs = scores.runs_at(&scores.points[best].values);
    let own: Vec<f64> = runs
        .filter(|run| settings.of_trial(run.index) == Setting::OWN)
        .filter_map(|run| run.score)
        .collect();
    (!own.is_empty()).then(|| mean(&own))
}
