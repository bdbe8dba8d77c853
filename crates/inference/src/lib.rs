//! History matching's numbers: what runs say about the points that nobody visited, and how implausible these are (docs/design.md).
//!
//! What a point or a setting is, this room need not know: points are coordinates from 0 to 1, settings are numbers.

mod emulator;
mod implausibility;
mod kernel;

pub use emulator::{Emulator, Field};
pub use implausibility::{Doubt, Variance, emulator_share, implausibility};
pub use kernel::ScoredRun;
