//! Pictures of papers 001 and 002: range sensors, radio, task times, cameras, and where scans were taken.

pub(super) mod radio;
pub(super) mod sensor;
pub(super) mod task;
pub(super) mod vision;
pub(super) mod visit;
