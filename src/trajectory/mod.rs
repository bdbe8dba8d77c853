//! Recorded and simulated motion: types, file formats, resampling, alignment.

mod recording;
mod state;

pub use recording::{Meta, Recording, Source};
pub use state::{State, Trajectory};
