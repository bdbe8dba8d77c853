//! The answer of a study: the best point, and how sure it is.

use std::fmt;

use rayon::prelude::*;

use super::audit::Audit;
use super::engines::engine_answers;
use super::method::Method;
use super::posterior::BestDraws;
use super::profile::Profile;
use super::report::{Evidence, Report};
use super::score::{PointScore, Scores};
use super::setting::Setting;
use super::study::Study;
use super::uncertainty::{Known, Uncertainty};
use super::validation::Validation;
use realgap_core::error::Result;
use realgap_optimize::Ending;

/// Result of a sweep or of tuning; its `Display` is the report.
#[derive(Debug, Clone)]
pub struct Answer {
    /// How the points were chosen.
    pub method: Method,
    /// Complete, or stopped early.
    pub ending: Ending,
    /// Scores of the points evaluated so far.
    pub scores: Scores,
    /// What cannot be told apart from the best; `None` where nothing has a score.
    pub uncertainty: Option<Uncertainty>,
    /// Where the best lies when reality is sampled again; `None` where nothing has a score.
    pub draws: Option<BestDraws>,
    /// The best score along each parameter.
    pub profiles: Vec<Profile>,
    /// What all of it says: the best point, verdicts, what numerics change, how held-out recordings fare.
    pub report: Report,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}

/// How often the best point may change its place while its settings are completed.
const CHAMPIONS: usize = 4;

impl Answer {
    /// Works out how sure the best of these scores is; simulations run on the current rayon pool. `refits`: as
    /// [`Validation::new`] wants them.
    pub(super) fn new(
        study: &Study,
        method: Method,
        ending: Ending,
        scores: Scores,
        refits: Option<Vec<PointScore>>,
    ) -> Result<Self> {
        let (scores, known) = match ending {
            Ending::Complete => settled(study, scores)?,
            // Whoever interrupts does not want to wait for more simulations.
            Ending::Interrupted => {
                let known = Known::new(study, &scores)?;
                (scores, known)
            }
        };
        let judged = known.as_ref().zip(scores.best);
        let (uncertainty, draws) = judged
            .map(|(known, best)| known.judge(study, &scores, best))
            .unzip();
        let profiles = profiles(study, &scores, known.as_ref(), uncertainty.as_ref());
        let audit = match ending {
            Ending::Complete => Audit::new(study, &scores, &profiles)?,
            // Whoever interrupts does not want to wait for more simulations.
            Ending::Interrupted => None,
        };
        let engines = match ending {
            Ending::Complete => engine_answers(study, &scores)?,
            Ending::Interrupted => Vec::new(),
        };
        let evidence = Evidence {
            engines,
            method: &method,
            ending,
            scores: &scores,
            uncertainty: uncertainty.as_ref(),
            draws: draws.as_ref(),
            audit,
            validation: Validation::new(study, &scores, refits)?,
        };
        let report = Report::new(study, &evidence)?;
        Ok(Self {
            method,
            ending,
            scores,
            uncertainty,
            draws,
            profiles,
            report,
        })
    }
}

/// The best point on average over equally valid settings: whichever point is best is simulated with all of them, until one
/// that has been is still the best.
fn settled(study: &Study, mut scores: Scores) -> Result<(Scores, Option<Known>)> {
    let settings = study.settings();
    // Numbers behind those of all trials, which say the setting as theirs do.
    let last = scores.runs.iter().map(|run| run.index).max().unwrap_or(0);
    let mut next = (last / settings.count + 1) * settings.count;
    let mut known = Known::new(study, &scores)?;
    if settings.count == 1 {
        // Who asks for single runs gets the lowest of them, luck included.
        return Ok((scores, known));
    }
    for _ in 0..CHAMPIONS {
        let Some(best) = known.as_ref().and_then(Known::best) else {
            break;
        };
        scores.best = Some(best);
        let values = scores.points[best].values.clone();
        let seen: Vec<Setting> = scores
            .runs
            .iter()
            .filter(|run| run.values == values)
            .map(|run| settings.of_trial(run.index))
            .collect();
        let missing: Vec<usize> = (0..settings.count)
            .filter(|number| !seen.contains(&Setting::new(*number)))
            .collect();
        if missing.is_empty() {
            break;
        }
        let trials = missing
            .into_par_iter()
            .map(|number| study.simulate_values(next + number, values.clone()))
            .collect::<Result<Vec<_>>>()?;
        next += settings.count;
        scores = scores.with_more(study, &trials)?;
        known = Known::new(study, &scores)?;
        scores.best = known.as_ref().and_then(Known::best).or(scores.best);
    }
    Ok((scores, known))
}

/// The best score at every value of each parameter, as far as points and what lies between them say.
fn profiles(
    study: &Study,
    scores: &Scores,
    known: Option<&Known>,
    uncertainty: Option<&Uncertainty>,
) -> Vec<Profile> {
    let ranges = study.definition().grid.ranges().iter().enumerate();
    ranges
        .map(|(dimension, range)| {
            let points = scores.points.iter().enumerate().map(|(position, point)| {
                let inside = uncertainty.is_some_and(|u| u.indistinguishable[position]);
                let score = point.score.map(|score| {
                    known
                        .and_then(|known| known.mean(position))
                        .unwrap_or(score)
                });
                (point.values[dimension], score, inside)
            });
            let unvisited = uncertainty.into_iter().flat_map(|u| &u.unvisited);
            let unvisited = unvisited.map(|place| {
                (
                    place.values[dimension],
                    Some(place.score),
                    place.indistinguishable,
                )
            });
            Profile::new(range, points.chain(unvisited))
        })
        .collect()
}
