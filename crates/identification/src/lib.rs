//! Identifies properties of a robot from its free flight and its resting poses, which do not depend on any contact model.
//!
//! [`Body`] finds the samples of a recording in which a robot without servos is in free flight. [`fit_flight`] fits the start
//! state to them. [`identify`] estimates the centre of mass, the apparent gravity and the lag of the recorded velocities from
//! many recordings of a rigid robot, and [`identify_joints`] the mass properties and hinge friction of a robot of parts on passive
//! hinges. [`RestReport`] counts the faces on which the robot comes to rest.

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
