//! What a recording tells before any contact model can spoil it: the free flight, and how things come to rest.
//!
//! [`Body`] finds the flight of a rigid robot, [`fit_flight`] its start state, [`identify`] the centre of mass,
//! the apparent gravity and the lag of the velocities over many recordings, [`RestReport`] the resting faces.

mod bootstrap;
mod estimate;
mod flight;
mod rest;
mod solve;
mod start;

pub use bootstrap::Interval;
pub use estimate::{FlightStart, Grounded, Identification, LengthReading, Trimmed, identify};
pub use flight::{Body, EQUAL_MOMENTS};
pub use rest::{FaceCount, RestReport, face_down, is_at_rest};
pub use start::{FlightFit, LEAST_SAMPLES, Refined, StartState, fit_flight, refine};
