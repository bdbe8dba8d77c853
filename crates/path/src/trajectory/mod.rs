//! Recorded and simulated trajectories: types, file formats, resampling, preparation for comparison.
//!
//! [`read`] and [`write()`] support the file formats of [`FORMATS`]; [`prepare`] brings a path into the form in
//! which paths are compared.

mod align;
mod axes;
mod body_column;
mod clock;
mod column;
mod column_name;
mod crop;
mod csv;
mod distance;
mod euroc;
mod foreign;
mod format;
mod header;
mod inferred_reading;
mod joint_column;
mod kitti;
mod known_kind;
mod lerobot;
mod levelling;
mod log;
mod measured;
mod meta;
mod mixed_robots;
mod parquet;
mod plausibility;
mod prepare;
mod reading;
mod recording;
mod registry;
mod relabel;
mod resample;
mod resolution;
mod sample;
#[cfg(feature = "schema")]
mod schema;
mod sensor_noise;
mod span;
mod stamp;
mod state;
mod stated_header;
mod table;
mod text;
mod time_order;
mod tum;
mod wheels;
mod writing;

pub use align::Alignment;
pub use axes::Axes;
pub use column::{Column, Columns, Role};
pub use crop::{clip, cut_out, cut_to_shortest};
pub use csv::Csv;
pub use distance::{mean_square_m2, rms_m};
pub use euroc::Euroc;
pub use foreign::{
    DEEPLABCUT, ForeignTable, JSON_LINES, MOTIVE, NPY, NPZ, PLOTJUGGLER, QUALISYS, VICON,
};
pub use format::{Decoded, Format, Parsed, Rendered};
pub use inferred_reading::{
    Ambiguity, Candidate, Evidence, InferredReading, JointReading, Question, odd_axes,
};
pub use joint_column::{COMMAND, COMMAND_SIGNALS, UNITLESS_COMMANDS, may_be_attitude};
pub use kitti::Kitti;
pub use lerobot::is_data_set;
pub use log::{Mcap, Rosbag, Ulog};
pub use measured::MeasuredQuantity;
pub use meta::{META_FILE, read_meta, read_meta_beside, write_meta};
pub use parquet::PARQUET;
pub use prepare::{POINTS, Prepared, prepare, prepare_as, turned};
pub use reading::{Crop, Only, QuaternionOrder, Reading, Ticks};
pub use recording::{Meta, Recording, Source};
pub use registry::{
    FORMATS, GROUP_COLUMNS, format_of, parse_all, read, read_all, read_bytes, read_groups,
    read_sets,
};
pub use resample::{Interpolator, resample};
pub use resolution::resolution;
pub use sensor_noise::sensor_noise;
pub use span::Span;
pub use state::{JointTrack, Signal, State, Trajectory};
pub use text::{MAX_COLUMNS, MAX_FILE_BYTES, MAX_ROWS};
pub use tum::Tum;
pub use wheels::{TwistColumns, Wheel, WheelCommands};
pub use writing::{check_output, write, write_with_bodies};
