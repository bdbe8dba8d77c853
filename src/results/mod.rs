//! What a results folder holds for people: tables, pictures, a report, the best values.
//!
//! Everything that is written here is put together elsewhere: [`write()`] takes an [`Answer`], [`write_ensemble`] an
//! [`EnsembleReport`](crate::prediction::EnsembleReport), [`write_gap`] a [`StudyGap`](crate::prediction::gap::StudyGap).
//!
//! ```
//! use realgap::calibration::Study;
//! use realgap::robot::morphology::Morphology;
//! use realgap::unit::LengthUnit;
//! use realgap::{RunOptions, comparison, results, trajectory};
//!
//! let study = Study::builder("friction", Morphology::read("morphologies/tripod.ron")?)
//!     .recording(trajectory::read("real_trajectories/tripod_standin/run_00.csv", LengthUnit::Metre)?)
//!     .duration_s(1.0)
//!     .vary("floor.friction", 0.2, 0.8, 2)
//!     .metric(comparison::by_name("rms")?)
//!     .build()?;
//! let answer = study.sweep(&RunOptions::default())?;
//! let folder = std::env::temp_dir().join(format!("realgap_results_{}", std::process::id()));
//! results::write(&folder, &study, &answer)?;
//! assert!(folder.join("points.csv").is_file() && folder.join("curve.png").is_file());
//! # std::fs::remove_dir_all(&folder).expect("it was just written");
//! # Ok::<(), realgap::Error>(())
//! ```

mod best;
mod convergence;
mod ensemble;
mod gap;
mod picture;
pub mod portrait;
mod search;
mod table;

use std::path::Path;

use crate::calibration::{Answer, Method, Study};
use crate::error::{Error, Result};

pub use ensemble::{write_ensemble, write_prediction, write_report};
pub use gap::write_gap;
pub use search::{BestRobot, SearchSummary, write_search};

/// Writes what an answer holds into `folder`, next to the store where there is one: tables, pictures, the report, the best
/// values.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::io("make the results folder", folder, &e))?;
    remove_old(folder)?;
    table::write_points(folder, study, answer)?;
    table::write_indistinguishable(folder, study, answer)?;
    table::write_scores(folder, study, answer)?;
    table::write_profiles(folder, answer)?;
    if let Method::Tune(tuned) = &answer.method {
        convergence::write_trials(folder, study, answer, tuned)?;
    }
    write_report(folder, "summary.json", &answer.report)?;
    best::write(folder, study, answer)?;
    picture::draw(folder, study, answer)
}

/// Removes what an earlier run wrote for people: a heat map must not outlive its study.
fn remove_old(folder: &Path) -> Result<()> {
    let ours = |name: &str| {
        let is_picture = [".png", ".svg"].iter().any(|end| name.ends_with(end))
            && [
                "heatmap",
                "curve",
                "trajectories",
                "profile_",
                "convergence",
            ]
            .iter()
            .any(|start| name.starts_with(start));
        is_picture
            || [
                "points.csv",
                "indistinguishable.csv",
                "scores.csv",
                "profiles.csv",
                "trials.csv",
                "summary.json",
                "best.ron",
            ]
            .contains(&name)
    };
    let entries = std::fs::read_dir(folder)
        .map_err(|e| Error::io("look into the results folder", folder, &e))?;
    for entry in entries.flatten() {
        if ours(&entry.file_name().to_string_lossy()) {
            std::fs::remove_file(entry.path())
                .map_err(|e| Error::io("remove an old result", entry.path(), &e))?;
        }
    }
    Ok(())
}
