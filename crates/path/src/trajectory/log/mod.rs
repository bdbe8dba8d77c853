//! Reads poses from logs of other programs, in which the recording is one of many topics.
//!
//! A log is converted into a table with a header, like a CSV file, so that units, cropping, and lost and repeated samples are handled in the
//! same way for all formats.

mod cdr;
mod foxglove;
mod mcap;
mod message;
mod ros;
mod rosbag;
mod stream;

pub use mcap::Mcap;
pub use rosbag::Rosbag;
