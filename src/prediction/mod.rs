//! What the simulation says about reality, and how far it can be trusted.
//!
//! [`ensemble`] repeats one robot under noise; [`gap`] holds such repeats against recordings, in units of reality's own
//! noise floor.

pub mod ensemble;
pub mod gap;
