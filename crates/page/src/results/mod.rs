//! What a results folder holds for people: tables, pictures, a report, the best values.
//!
//! Other crates compute what is written here: [`write()`] takes an [`Answer`](realgap_lab::calibration::Answer), [`write_ensemble`] an
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
mod draft;
mod ensemble;
mod folder;
mod gap;
pub(crate) mod kind;
mod odds;
mod over_time;
#[cfg(feature = "papers")]
mod papers;
pub mod portrait;
mod search;
pub(crate) mod study;
pub(crate) mod table;
mod timing;

pub use arena::draw_arena;
pub(crate) use ensemble::ensemble_plot;
pub use ensemble::{write_ensemble, write_prediction, write_report};
pub use folder::{accept, check_folder, check_seal};
pub(crate) use gap::{confidence_chart, over_time_chart};
pub use gap::{write_floor, write_gap};
pub use kind::Kind;
pub use odds::draw_odds;
pub use over_time::{Timed, draw_over_time};
#[cfg(feature = "papers")]
pub use papers::radio::{draw_error_map, draw_strength_map};
#[cfg(feature = "papers")]
pub use papers::sensor::{draw_belief, draw_histograms, draw_segment, draw_sensor};
#[cfg(feature = "papers")]
pub use papers::task::{draw_task_curves, draw_task_times};
#[cfg(feature = "papers")]
pub use papers::vision::draw_vision;
#[cfg(feature = "papers")]
pub use papers::visit::{draw_visits, draw_way};
pub use search::{BestRobot, SearchSummary, write_search};
pub(crate) use search::{History, fitness_chart};
pub use study::{
    FittedStudy, JointSample, RankedPoints, draws, joint_samples, ranked_points, write,
};
pub use timing::{Timing, write_timing};
