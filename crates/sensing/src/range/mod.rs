//! Models of sensors that measure one distance.
//!
//! A [`ReadingLog`] contains readings at known distances. [`Characterisation`] fits a [`RangeModel`] to them, with confidence
//! intervals and tests of the model. Every type that implements [`RangeSensor`] can be simulated and used in a Bayes filter.

mod cell;
mod characterisation;
mod choice;
mod drawn;
mod fit;
pub mod form;
mod log;
mod model;
mod peak;
mod sample_size;
mod session;

pub use characterisation::{Characterisation, DistanceReport, LEVEL, Normality, Options, Value};
pub use choice::Candidate;
pub use drawn::{DrawOptions, DrawnLog};
pub use log::{LogOptions, Reading, ReadingLog};
pub use model::{
    Beam, InSession, Outliers, RangeModel, RangeSensor, ReadingUnit, find_sensor, sensor_by_name,
    shipped_sensors,
};
pub use peak::Peak;
pub use sample_size::{SampleSize, SizeStep};
pub use session::{NextSession, SessionSpread, Spread};
