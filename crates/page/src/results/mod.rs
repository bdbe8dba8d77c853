//! What a results folder holds for people: tables, pictures, a report, the best values.
//!
//! Everything that is written here is put together elsewhere: [`write()`] takes an [`Answer`], [`write_ensemble`] an
//! [`EnsembleReport`](realgap_lab::prediction::EnsembleReport), [`write_gap`] a [`StudyGap`](realgap_lab::prediction::gap::StudyGap).
//!
//! ```
//! use realgap_lab::calibration::Study;
//! use realgap_robot::morphology::Morphology;
//! use realgap_core::unit::LengthUnit;
//! use realgap_optimization::RunOptions;
//! use realgap_path::comparison;
//! use realgap_page::results;
//! use realgap_path::trajectory;
//!
//! let study = Study::builder("friction", Morphology::read("../../morphologies/tripod.ron")?)
//!     .recording(trajectory::read("../../real_trajectories/tripod_standin/run_00.csv", LengthUnit::Metre)?)
//!     .duration_s(1.0)
//!     .vary("floor.friction", 0.2, 0.8, 2)
//!     .metric(comparison::by_name("rms")?)
//!     .build()?;
//! let answer = study.sweep(&RunOptions::default())?;
//! let folder = std::env::temp_dir().join(format!("realgap_results_{}", std::process::id()));
//! results::write(&folder, &study, &answer)?;
//! assert!(folder.join("points.csv").is_file() && folder.join("curve.png").is_file());
//! # std::fs::remove_dir_all(&folder).expect("it was just written");
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod arena;
pub(crate) mod best;
mod cell;
mod convergence;
mod corner;
mod draft;
mod ensemble;
mod folder;
mod gap;
pub(crate) mod joint;
pub(crate) mod kind;
mod odds;
mod over_time;
mod picture;
mod plane;
pub mod portrait;
#[cfg(feature = "papers")]
mod radio;
mod search;
#[cfg(feature = "papers")]
mod sensor;
mod table;
#[cfg(feature = "papers")]
mod task;
mod timing;
#[cfg(feature = "papers")]
mod vision;
#[cfg(feature = "papers")]
mod visit;

use std::path::Path;

use realgap_core::error::{Error, Result};
use realgap_lab::calibration::{Answer, Method, Study};

pub use arena::draw_arena;
pub use best::draws;
pub use ensemble::{write_ensemble, write_prediction, write_report};
pub use folder::{accept, check_folder, check_seal};
pub use gap::{write_floor, write_gap};
pub use kind::Kind;
pub use odds::draw_odds;
pub use over_time::{Timed, draw_over_time};
#[cfg(feature = "papers")]
pub use radio::{draw_error_map, draw_strength_map};
pub use search::{BestRobot, SearchSummary, write_search};
#[cfg(feature = "papers")]
pub use sensor::{draw_belief, draw_histograms, draw_segment, draw_sensor};
#[cfg(feature = "papers")]
pub use task::{draw_task_curves, draw_task_times};
pub use timing::{Timing, write_timing};
#[cfg(feature = "papers")]
pub use vision::draw_vision;
#[cfg(feature = "papers")]
pub use visit::{draw_visits, draw_way};

/// Writes what an answer holds into `folder`, next to the store where there is one: tables, pictures, the report, the best
/// values. They take the place of older results once all of them are written.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::io("make the results folder", folder, &e))?;
    draft::publish(folder, Kind::Study, |draft| {
        table::write_points(draft, study, answer)?;
        table::write_indistinguishable(draft, study, answer)?;
        table::write_scores(draft, study, answer)?;
        table::write_profiles(draft, answer)?;
        if let Method::Tune(tuned) = &answer.method {
            convergence::write_trials(draft, study, answer, tuned)?;
        }
        write_report(draft, kind::file::SUMMARY, &answer.report)?;
        best::write(draft, study, answer)?;
        plane::write_basis(draft, answer)?;
        picture::draw(draft, study, answer)?;
        joint::write(draft, study, answer)
    })
}
