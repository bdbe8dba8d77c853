//! What a recording tells before any contact model can spoil it: the free flight, and how things come to rest.
//!
//! [`Body`] finds the flight of a robot without servos, [`fit_flight`] its start state, [`identify`] the centre of mass,
//! the apparent gravity and the lag of the velocities over many recordings, [`identify_joints`] what flights of parts on passive hinges
//! tell, [`RestReport`] the resting faces.

mod bootstrap;
mod estimate;
mod flight;
mod joint_estimate;
mod joint_flight;
mod joint_prior;
mod linkage;
mod rest;
mod solve;
mod start;

pub use bootstrap::Interval;
pub use estimate::{FlightStart, Grounded, Identification, LengthReading, Trimmed, identify};
pub use flight::{Body, EQUAL_MOMENTS};
pub use joint_estimate::{FlightErrors, JointIdentification, JointVerdict, identify_joints};
pub use linkage::Linkage;
pub use rest::{FaceCount, RestReport, face_down, is_at_rest};
pub use start::{
    FlightFit, KnownFlight, LEAST_SAMPLES, Refined, StartState, fit_flight, refine, refine_again,
};
