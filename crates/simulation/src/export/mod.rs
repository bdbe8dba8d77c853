//! Export of robots for other simulators: one trait, one registry, one file per format.
//!
//! The exported robot is that of an [`Experiment`](crate::Experiment), so it includes calibrated parameters. Properties that a
//! format cannot represent are reported both as warnings and as comments in the file.
//!
//! ```
//! use realgap_simulation::export::{Robot, format_named};
//! use realgap_robot::morphology::Morphology;
//! use realgap_simulation::Experiment;
//!
//! let morphology = Morphology::read("../../morphologies/tripod.ron")?;
//! let experiment = Experiment::new(morphology.assemble());
//! let exported = format_named("mjcf")?.render(&Robot::new(&morphology, &experiment));
//! assert!(exported.text.starts_with("<?xml"));
//! assert!(!exported.warnings.is_empty());
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! Both formats use the same body frames: axes of the robot frame at zero servo angles.

mod amendment;
mod drawn;
mod format;
mod ground;
mod mjcf;
mod registry;
mod robot;
mod stand;
mod urdf;
mod xml;

pub use amendment::{Calibrated, Fate, calibrate};
pub use drawn::DrawnRobot;
pub use format::{Exported, Format};
pub use registry::{FORMATS, format_named};
pub use robot::Robot;
