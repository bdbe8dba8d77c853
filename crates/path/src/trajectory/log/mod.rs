//! Poses in the logs of other programs: messages of many topics, of which one is the recording.
//!
//! A log becomes a table with a header, as a CSV file is: units, cropping, lost and repeated samples are then the same for all.

mod cdr;
mod foxglove;
mod mcap;
mod message;
mod ros;
mod rosbag;
mod stream;

pub use mcap::Mcap;
pub use rosbag::Rosbag;
