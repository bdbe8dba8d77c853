//! The runs after the first ones: waves of points that are not implausible yet, then all settings of candidates for the best
//! point.

use rayon::prelude::*;

use crate::calibration::numerics::setting::{Setting, is_large_map};
use crate::calibration::{PointScore, Scores, Study};
use crate::prediction::ensemble::rms_m;
use realgap_core::Result;
use realgap_core::random::Numbered;
use realgap_inference::{Emulator, HistoryMatching, ObservationUncertainty, ScoredRun};
use realgap_optimization::{RunOptions, Step};
use realgap_path::trajectory::Prepared;

/// Number of waves after the first runs; every wave uses all runs before it.
pub(in crate::calibration) const WAVES: usize = 3;
/// Number of runs of one wave: one in so many of the first runs, fewer for a large grid, within bounds.
const SHARE: usize = 6;
const SHARE_OF_A_LARGE_MAP: usize = 8;
const LEAST: usize = 16;
const MOST: usize = 500;
/// Sampled points and simulated points among which the points of a wave are chosen.
const PLACES: usize = 200;
const VISITED: usize = 60;
/// No further wave is made where the emulator has less than this share in the variance of the difference between points and the
/// best point.
const LEAST_EMULATOR_SHARE: f64 = 0.1;
/// Most candidates for the best point whose settings are completed.
const CANDIDATES: usize = 5;
/// Points of a large map whose settings are completed.
const SETTLED_OF_A_LARGE_MAP: usize = 16;
/// Points of a grid that were not simulated are candidates only where the grid has at most so many points.
const NODES: usize = 2000;

/// Runs of one wave after so many first runs; 0 where there is one setting only.
pub(in crate::calibration) fn runs_a_wave(study: &Study, first: usize) -> usize {
    let share = match is_large_map(first) {
        true => SHARE_OF_A_LARGE_MAP,
        false => SHARE,
    };
    match study.settings().count {
        1 => 0,
        _ => (first / share).clamp(LEAST.min(first), MOST),
    }
}

impl Study {
    /// Most simulations of a sweep, each of all cases: the grid, the waves after it, and the settings of the best point;
    /// `usize::MAX` where the number is too large to count.
    pub fn sweep_runs(&self) -> usize {
        let grid = self.definition().grid.len();
        let again = WAVES * runs_a_wave(self, grid) + self.settings().count - 1;
        grid.saturating_add(again)
    }
}

/// The runs with a score, in the form that the emulator needs.
pub(in crate::calibration) fn scored_runs(study: &Study, scores: &Scores) -> Vec<ScoredRun> {
    let (settings, grid) = (study.settings(), &study.definition().grid);
    let scored = scores.runs.iter().filter(|run| run.score.is_some());
    let surrogate_recordings = surrogate_recordings(study, scores);
    scored
        .map(|run| ScoredRun {
            point: grid.place_of(&run.values),
            setting: settings.of_trial(run.index).number(),
            variant: settings.engine_of_trial(run.index),
            scores: study.part_of(&run.recordings, false),
            surrogate_scores: surrogate_recordings
                .iter()
                .map(|engine| engine.iter().map(|real| distance(study, scores, real, run)))
                .map(Iterator::collect)
                .collect(),
        })
        .collect()
}

/// Least runs of the best point, and of one engine there, from which the variability of a single recording is estimated.
const LEAST_RUNS: usize = 8;
const LEAST_RUNS_OF_AN_ENGINE: usize = 4;

/// Surrogates of a single recording: paths of the best point's runs, by engine; empty where there are more recordings, or where
/// the metric needs more than paths.
fn surrogate_recordings(study: &Study, scores: &Scores) -> Vec<Vec<Prepared>> {
    let is_of_paths = scores.basis.is_some() || study.definition().metric.name() == "rms";
    let best = scores
        .best
        .filter(|_| is_of_paths && study.fitted_recordings() == 1);
    let Some(best) = best.filter(|_| study.cases().len() == 1) else {
        return Vec::new();
    };
    let path = |run: &PointScore| Prepared::from_xy_m(run.path_xy_m.clone()).ok();
    let [own, second] = scores.runs_by_engine(&study.settings(), best);
    // The recording is like a run of an engine that explains it.
    let engines = match scores.engine {
        1.0 => vec![own],
        -1.0 => vec![second],
        _ => vec![own, second],
    };
    let engines = engines.into_iter();
    let engines = engines.map(|runs| runs.into_iter().filter_map(path).collect());
    let has_enough = |runs: &Vec<Prepared>| runs.len() >= LEAST_RUNS_OF_AN_ENGINE;
    let engines: Vec<Vec<Prepared>> = engines.into_iter().filter(has_enough).collect();
    match engines.iter().map(Vec::len).sum::<usize>() {
        LEAST_RUNS.. => engines,
        _ => Vec::new(),
    }
}

/// Distance of a run to a surrogate recording, by the study's metric.
fn distance(study: &Study, scores: &Scores, real: &Prepared, run: &PointScore) -> f64 {
    let Ok(path) = Prepared::from_xy_m(run.path_xy_m.clone()) else {
        return 0.0;
    };
    let scale = study.recording_length_scale(&run.values);
    match &scores.basis {
        Some(basis) => basis.discrepancy_m(real, &path) / scale,
        None => rms_m(real, &path) / scale,
    }
}

/// Coordinates of the best points, and their positions.
pub(in crate::calibration) fn leading(
    study: &Study,
    scores: &Scores,
    emulator: Option<&Emulator>,
    most: usize,
) -> (Vec<usize>, Vec<Vec<f64>>) {
    let mut positions = scores.ranked();
    let grid = &study.definition().grid;
    if let Some(emulator) = emulator.filter(|emulator| emulator.has_two_variants()) {
        // The score of a single run depends on its engine more than on its point, so points are ranked by their expected scores, each
        // in the engine that suits it better.
        let expected = |position: &usize| {
            let place = grid.place_of(&scores.points[*position].values);
            let in_each = emulator.standardised_in(&place, emulator.variants());
            in_each.into_iter().fold(f64::INFINITY, f64::min)
        };
        let mut all: Vec<(f64, usize)> = positions.iter().map(|p| (expected(p), *p)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        positions = all.into_iter().map(|(_, position)| position).collect();
    }
    positions.truncate(most);
    let place = |position: &usize| grid.place_of(&scores.points[*position].values);
    let places = positions.iter().map(place).collect();
    (positions, places)
}

/// Values of the points of the wave whose first trial has the number `from`; empty where more runs would hardly change the
/// answer.
///
/// # Errors
/// As [`Emulator::new`].
pub(in crate::calibration) fn next_wave(
    study: &Study,
    scores: &Scores,
    from: usize,
    count: usize,
) -> Result<Vec<Vec<f64>>> {
    let definition = study.definition();
    let Some(emulator) = Emulator::new(&scored_runs(study, scores))? else {
        return Ok(Vec::new());
    };
    let uncertainty = ObservationUncertainty {
        observations: study.fitted_recordings(),
        discrepancy: 0.0,
    };
    let (_, visited) = leading(study, scores, Some(&emulator), VISITED);
    let places = PLACES.max(2 * count);
    let seed = definition.seed.wrapping_add(from as u64);
    let grid = &definition.grid;
    // Both engines are as probable, so that runs go to the valleys of both.
    let weights = emulator.equal_weights();
    let of = (&emulator, weights.as_slice());
    let matching = HistoryMatching::new(of, grid, &visited, uncertainty, places, seed);
    if matching.emulator_share() < LEAST_EMULATOR_SHARE {
        return Ok(Vec::new());
    }
    let mut rng = Numbered::Refinement.generator(definition.seed, from as u64);
    let chosen = matching.wave(count, &mut rng).into_iter();
    Ok(chosen.map(|place| grid.values_at(place)).collect())
}

/// The scores with the waves after so many first runs, in memory.
///
/// # Errors
/// As [`Study::simulate`].
pub(in crate::calibration) fn with_waves(
    (study, run): (&Study, &RunOptions<'_>),
    mut scores: Scores,
) -> Result<Scores> {
    let count = runs_a_wave(study, scores.runs.len());
    for _ in 0..WAVES {
        let from = next_trial(study, &scores);
        let chosen = match count {
            0 => Vec::new(),
            count => next_wave(study, &scores, from, count)?,
        };
        if chosen.is_empty() {
            break;
        }
        let chosen: Vec<(usize, Vec<f64>)> = (from..).zip(chosen).collect();
        let step = run.step("exploring further", chosen.len());
        scores = scores.with_more(study, &simulated(study, chosen, &step)?)?;
    }
    Ok(scores)
}

/// Simulates points, each given by the number of its trial and its values.
///
/// # Errors
/// As [`Study::simulate`].
pub(in crate::calibration) fn simulated(
    study: &Study,
    chosen: Vec<(usize, Vec<f64>)>,
    step: &Step<'_>,
) -> Result<Vec<realgap_store::Trial>> {
    let trials = chosen.into_par_iter();
    trials
        .map(|(index, values)| {
            let trial = study.simulate_trial(index, values, false);
            step.count();
            trial
        })
        .collect()
}

/// A number after those of all trials and of the grid, with the study's own setting.
pub(in crate::calibration) fn next_trial(study: &Study, scores: &Scores) -> usize {
    let settings = study.settings();
    let last = scores.runs.iter().map(|run| run.index).max().unwrap_or(0);
    (last + 1)
        .max(settings.of_map)
        .next_multiple_of(settings.count)
}

/// Points of the grid that were not simulated. With these, the candidates after an optimizer, which converges to one valley, are
/// those after a sweep.
fn unvisited(study: &Study, scores: &Scores) -> impl Iterator<Item = Vec<f64>> {
    let grid = &study.definition().grid;
    let nodes = if grid.len() > NODES { 0 } else { grid.len() };
    let nodes = (0..nodes).map(|index| grid.values(index));
    nodes.filter(|values| scores.points.iter().all(|point| point.values != *values))
}

/// Finds the best point: the one with the lowest mean over all of its settings, those of an engine that the recordings speak
/// against left out ([`Scores::engine`]). Whenever the emulator expects a lower score at another point, all settings of that point
/// are simulated; then those of some more points of the lowest expected scores, so that the map around the best point is known
/// from more than single runs.
///
/// # Errors
/// As [`Study::simulate`].
pub(in crate::calibration) fn with_best_completed(
    (study, run): (&Study, &RunOptions<'_>),
    mut scores: Scores,
    mut emulator: Option<Emulator>,
) -> Result<(Scores, Option<Emulator>)> {
    let settings = study.settings();
    if settings.count == 1 {
        // A study of single runs takes the lowest one, with its chance.
        return Ok((scores, emulator));
    }
    let grid = &study.definition().grid;
    let wanted = settled_points(study, scores.runs.len());
    for candidate in 0..=CANDIDATES {
        let Some(known) = &emulator else { break };
        let is_whole = |position: &usize| scores.points[*position].runs >= settings.count;
        let (whole, open): (Vec<usize>, Vec<usize>) =
            scores.ranked().into_iter().partition(is_whole);
        let best = whole.first().copied();
        let lowest = best.and_then(|best| scores.points[best].score);
        let visited = open.iter().map(|at| scores.points[*at].values.clone());
        let candidates = visited.chain(unvisited(study, &scores));
        let expected = candidates.map(|values| {
            let expected = known.mean_in(&grid.place_of(&values), scores.engine);
            (expected, values)
        });
        let mut expected: Vec<(f64, Vec<f64>)> = expected.collect();
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_promising = |(score, _): &&(f64, Vec<f64>)| lowest.is_none_or(|low| *score < low);
        let promising = expected.first().filter(is_promising).is_some();
        scores.best = best.or(scores.best);
        let count = match promising && candidate < CANDIDATES {
            true => 1,
            false => wanted.saturating_sub(whole.len()),
        };
        let mut missing = Vec::new();
        for (_, values) in expected.into_iter().take(count) {
            let runs = scores.runs.iter().filter(|run| run.values == values);
            let seen: Vec<Setting> = runs.map(|run| settings.of_trial(run.index)).collect();
            let from = next_trial(study, &scores);
            let own = (0..settings.count).filter(|number| !seen.contains(&Setting::new(*number)));
            // Runs of several points in one batch need numbers of their own.
            let from = from + (missing.len().div_ceil(settings.count)) * settings.count;
            missing.extend(own.map(|number| (from + number, values.clone())));
        }
        if missing.is_empty() {
            break;
        }
        let step = run.step("completing the best points", missing.len());
        scores = scores.with_more(study, &simulated(study, missing, &step)?)?;
        emulator = emulator.map(|known| known.conditioned_on(&scored_runs(study, &scores)));
    }
    let is_whole = |position: &usize| scores.points[*position].runs >= settings.count;
    let best = scores.ranked().into_iter().find(is_whole);
    scores.best = best.or(scores.best);
    Ok((scores, emulator))
}

/// Points whose settings are all simulated after so many runs: sixteen on a large map, whose picture is looked at, otherwise as
/// many as cost a quarter of the runs.
fn settled_points(study: &Study, runs: usize) -> usize {
    let settings = study.settings().count;
    match is_large_map(study.definition().grid.len()) {
        true => SETTLED_OF_A_LARGE_MAP,
        false => (runs / (4 * settings)).max(1),
    }
}
