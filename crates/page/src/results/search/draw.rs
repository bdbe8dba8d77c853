//! The random draws behind the repeats of a finalist, so that another engine can simulate the same repeats.

use serde::Serialize;

use realgap_core::error::Result;
use realgap_lab::prediction::ensemble::Motion;
use realgap_lab::search::{Finalist, Search};
use realgap_simulation::Experiment;
use realgap_simulation::export::DrawnRobot;

/// One repeat for another engine, and how far it went here.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Draw {
    /// Number of the repeat, from 0.
    pub number: u64,
    /// Net displacement here, metres; `None` where it diverged.
    pub displacement_m: Option<f64>,
    /// The robot of the repeat.
    #[serde(flatten)]
    pub robot: DrawnRobot,
}

/// The draws of a finalist's repeats.
///
/// # Errors
/// None for a validated search.
pub(super) fn draws(search: &Search, finalist: &Finalist) -> Result<Vec<Draw>> {
    let base = search.experiment(&finalist.robot);
    let repeats = finalist.ensemble.repeats.iter();
    repeats
        .map(|repeat| {
            let mut experiment: Experiment = search
                .uncertain()
                .draw(search.finals_seed(), repeat.number)?
                .apply(&base);
            experiment.perturbation = repeat.perturbation.clone();
            Ok(Draw {
                number: repeat.number,
                displacement_m: repeat.outcome.get().map(Motion::net_displacement_m),
                robot: DrawnRobot::new(finalist.robot.name(), &experiment)?,
            })
        })
        .collect()
}
