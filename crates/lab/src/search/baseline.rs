//! The baseline of a search: the robot that it starts from, judged as its best robots are.

use serde::{Deserialize, Serialize};

use super::evaluate::Repeats;
use super::{Body, Finalist, Search};
use crate::prediction::ensemble::Forecast;
use realgap_core::Result;
use realgap_optimization::{RunOptions, pool};

/// The robot that a search starts from, with the random draws that rank the finalists: the search has to find a better one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Baseline {
    /// Its name.
    pub robot: String,
    /// Fitness with fresh seeds; `None` where the robot failed.
    pub fitness: Option<f64>,
    /// Median net displacement with fresh seeds, metres; `None` where every repeat diverged.
    pub median_displacement_m: Option<f64>,
    /// 5 % and 95 % quantile of it, metres.
    pub displacement_q05_q95_m: Option<[f64; 2]>,
    /// Why it failed in the draws of the search.
    pub failure: Option<String>,
}

impl Baseline {
    /// The factor by which a finalist's fitness with fresh seeds is larger; `None` where either has none, or where the baseline's
    /// is 0.
    pub fn gain(&self, finalist: &Finalist) -> Option<f64> {
        let before = self.fitness.filter(|fitness| *fitness > 0.0)?;
        Some(finalist.finals.fitness? / before)
    }
}

impl Search {
    /// The baseline; `None` where the search starts from random robots.
    ///
    /// # Errors
    /// Interrupted; settings that cannot be simulated.
    pub fn baseline(&self, options: &RunOptions<'_>) -> Result<Option<Baseline>> {
        let robot = match (self.space.start(), self.body()) {
            (Some(genome), body) => body.build("start", genome)?,
            (None, Body::Fixed(robot, _)) => (**robot).clone(),
            (None, Body::Developed(_)) => return Ok(None),
        };
        pool(options.jobs)?.install(|| {
            let seen: Repeats =
                self.repeats_of(&robot, self.seed(), self.repeats, None, options)?;
            let ensemble = self.repeat_again(&robot, options)?;
            let displacement_m = Forecast::new(&ensemble)?.displacement_m;
            Ok(Some(Baseline {
                robot: robot.name().to_owned(),
                fitness: match &seen {
                    Ok(_) => self.fitness_of(&ensemble),
                    Err(_) => None,
                },
                median_displacement_m: displacement_m.map(|d| d.q50),
                displacement_q05_q95_m: displacement_m.map(|d| [d.q05, d.q95]),
                failure: seen.err().map(|failure| failure.to_string()),
            }))
        })
    }
}
