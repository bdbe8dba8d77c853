//! The gap between simulation and reality, in units of reality's own spread, and the time until which the simulation may be
//! trusted.
//!
//! [`noise_floor`] is the distance between repeats of the same real run; [`distances`] adds the gap between simulation and
//! reality, and the gap ratio; [`OverTime`] and [`Confidence`] have the same over time. All of them work on any [`Sample`]s;
//! [`StudyGap::new`] simulates what a study needs, [`read_sets`] and [`FloorReport`] are for repeats that have no study.
//!
//! ```
//! use realgap_optimization::RunOptions;
//! use realgap_lab::calibration::{Overrides, Study};
//! use realgap_lab::prediction::gap::{GapOptions, StudyGap};
//!
//! let overrides = Overrides { limit_recordings: Some(3), ..Overrides::default() };
//! let study = Study::read("../../sweeps/tripod_self.ron", &overrides)?;
//! let options = GapOptions { repeats: 2, ..GapOptions::of(&study)? };
//! let gap = StudyGap::new(&study, &options, &RunOptions::default())?;
//! assert!(gap.metrics[0].floor.is_some_and(|floor| floor.value > 0.0));
//! println!("{gap}");
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod between;
mod confidence;
mod distance;
mod estimate;
mod fitness;
mod floor;
mod gap_text;
mod over_time;
mod sample;
mod set;
mod study;

pub use between::{Alike, Between, LEAST_REPEATS, RepeatsTest};
pub use confidence::Confidence;
pub use distance::{Distances, GapAndRatio, MetricGap, distances};
pub use estimate::{Estimate, INTERVAL_LEVEL};
pub use fitness::Fitness;
pub use floor::{MetricFloor, NoiseFloor, noise_floor};
pub use over_time::OverTime;
pub use sample::{CaseRuns, Sample, Scoring};
pub use set::{FloorReport, SetFloor, SetOfRuns, read_sets};
pub use study::{GapOptions, StudyGap};
