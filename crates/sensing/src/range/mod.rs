//! Models of sensors that measure one distance.
//!
//! A [`RangeModel`] is such a sensor; anything that implements [`RangeSensor`] can be simulated and believed. With the feature
//! `papers` models are calibrated, too: a [`ReadingLog`] holds readings at known distances, and a [`Characterisation`] makes a
//! [`RangeModel`] of them, with intervals and with the tests that the model fails.

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
