//! Reads poses and joints from logs of other programs, in which the recording is one of many topics.
//!
//! A log is converted into a table with a header, like a CSV file, so that units, cropping, and lost and repeated samples are handled in the
//! same way for all formats.

mod cdr;
mod chain;
mod foxglove;
mod joined;
mod mcap;
mod message;
mod plan;
mod pose_stream;
mod ros;
mod rosbag;
mod series;
mod stream;
mod ulog;

pub use mcap::Mcap;
pub use rosbag::Rosbag;
pub use ulog::Ulog;
