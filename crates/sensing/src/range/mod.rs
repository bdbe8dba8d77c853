//! Models of sensors that measure one distance.
//!
//! A [`RangeModel`] is such a model. Every type that implements [`RangeSensor`] can be simulated and used in a Bayes filter. With the
//! feature `papers`, models can also be fitted: a [`ReadingLog`] contains readings at known distances, and a [`Characterisation`] fits
//! a [`RangeModel`] to them, with confidence intervals and tests of the model.

#[cfg(feature = "papers")]
mod calibration;
pub mod form;
mod model;

#[cfg(feature = "papers")]
pub use calibration::{
    Candidate, Characterisation, DistanceReport, DrawOptions, DrawnLog, LEVEL, LogOptions,
    NextSession, Normality, Options, Peak, Reading, ReadingLog, SampleSize, SessionSpread,
    SizeStep, Spread, Value,
};
pub use model::{
    Beam, InSession, Outliers, RangeModel, RangeSensor, ReadingUnit, find_sensor, sensor_by_name,
    shipped_sensors,
};
