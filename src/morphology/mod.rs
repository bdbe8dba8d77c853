//! Robots: cube modules glued face to face, parsed from RON into validated types, assembled into rigid parts and hinges.

mod assembly;

pub use assembly::{Assembly, Gait, Hinge, Part, Role, Servo, ServoLaw, Solid};
