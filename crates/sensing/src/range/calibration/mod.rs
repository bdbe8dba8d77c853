//! From a log of readings at known distances to a sensor's model, and from a model to a log.

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
