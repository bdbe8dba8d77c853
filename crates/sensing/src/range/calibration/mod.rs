//! Calibration of a range sensor: fits a model to a log of readings at known distances, and draws a synthetic log from a model.

mod cell;
mod characterisation;
mod choice;
mod drawn;
mod fit;
mod log;
mod peak;
mod sample_size;
mod session;

pub use characterisation::{Characterisation, DistanceReport, LEVEL, Normality, Options, Value};
pub use choice::Candidate;
pub use drawn::{DrawOptions, DrawnLog};
pub use log::{LogOptions, Reading, ReadingLog};
pub use peak::Peak;
pub use sample_size::{SampleSize, SizeStep};
pub use session::{NextSession, SessionSpread, Spread};
