//! Which points are simulated again: those that may be the best.

use super::score::Scores;
use super::setting::Setting;
use super::study::Study;
use super::surface::{ScoredRun, Surface};
use realgap_core::error::Result;
use realgap_core::random::Numbered;

/// Rounds of a sweep after its grid; every round knows what the one before has found.
pub(super) const ROUNDS: usize = 2;
/// Runs of one round: a share of the grid's points, within bounds.
const SHARE: usize = 4;
const LEAST: usize = 16;
const MOST: usize = 500;

/// Runs of one round on a grid of so many points; none where there is one setting only.
pub(super) fn runs_a_round(study: &Study) -> usize {
    let points = study.definition().grid.len();
    match study.settings().count {
        1 => 0,
        _ => (points / SHARE).clamp(LEAST.min(points), MOST),
    }
}

impl Study {
    /// Simulations of a sweep, each of all cases: the grid, the points that are simulated again, and the settings of the best;
    /// `usize::MAX` where nobody could count them.
    pub fn sweep_runs(&self) -> usize {
        let settings = self.settings().count;
        let again = ROUNDS * runs_a_round(self) + settings - 1;
        self.definition().grid.len().saturating_add(again)
    }

    /// What one of them costs on average, in runs with the study's own settings; substeps count like steps.
    pub fn run_cost(&self) -> f64 {
        self.settings().mean_cost(&self.cases()[0].experiment)
    }
}

/// The runs with a score, as a surface wants them.
pub(super) fn scored_runs(study: &Study, scores: &Scores) -> Vec<ScoredRun> {
    let (settings, grid) = (study.settings(), &study.definition().grid);
    let scored = scores.runs.iter().filter(|run| run.score.is_some());
    scored
        .map(|run| ScoredRun {
            at: grid.place_of(&run.values),
            setting: settings.of_trial(run.index),
            recordings: study.part_of(&run.recordings, false),
        })
        .collect()
}

/// Values of the points for the trials from number `from` on: each is the best point of one surface that the scores allow, so
/// that a point is chosen as often as it is probable that no other is better (Thompson 1933). A point that has been
/// simulated with a trial's setting already is passed over.
///
/// # Errors
/// As [`Surface::new`].
pub(super) fn choose(
    study: &Study,
    scores: &Scores,
    from: usize,
    count: usize,
) -> Result<Vec<Vec<f64>>> {
    const DRAWS: usize = 50;
    let (settings, grid) = (study.settings(), &study.definition().grid);
    let mut scored = scores.ranked();
    scored.truncate(MOST);
    let nodes: Vec<Vec<f64>> = scored
        .iter()
        .map(|position| grid.place_of(&scores.points[*position].values))
        .collect();
    let Some(surface) = Surface::new(&scored_runs(study, scores), &nodes)? else {
        return Ok(Vec::new());
    };
    let mut seen: Vec<Vec<Setting>> = scored
        .iter()
        .map(|position| {
            let runs = scores.runs_at(&scores.points[*position].values);
            runs.map(|run| settings.of_trial(run.index)).collect()
        })
        .collect();
    let seed = study.definition().seed;
    let mut chosen = Vec::new();
    for trial in from..from + count {
        let setting = settings.of_trial(trial);
        let mut rng = Numbered::Refinement.generator(seed, trial as u64);
        let drawn = (0..DRAWS).find_map(|_| {
            let best = surface.draw(&mut rng).imin();
            (!seen[best].contains(&setting)).then_some(best)
        });
        let unseen = || surface.lowest((0..nodes.len()).filter(|n| !seen[*n].contains(&setting)));
        let Some(node) = drawn.or_else(unseen) else {
            break;
        };
        seen[node].push(setting);
        chosen.push(scores.points[scored[node]].values.clone());
    }
    Ok(chosen)
}
