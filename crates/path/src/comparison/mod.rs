//! Distances between two trajectories: metrics with units, and tables of several metrics.
//!
//! A trajectory may be simulated or recorded; the distance between two recordings of one run is the noise floor. A new metric
//! is one new file that implements [`Metric`] and one line in [`METRICS`].

mod association;
mod basis;
mod channel;
mod clock_doubt;
mod clock_offset;
mod cluster;
mod compare;
mod evo;
mod joint;
mod metric;
mod pca;
mod pointwise;
mod pose;
mod pose_residual;
mod registry;
mod residual;
mod saved_basis;
mod shape;
mod speed_profile;
mod spread;
mod synchronised;
mod table;
mod time_base;
mod timing;
mod umeyama;
mod whitened;

pub use association::{Association, MAX_DIFFERENCE_S, Matched};
pub use basis::{Basis, Components};
pub use channel::{
    Channel, ChannelError, ChannelQuantity, ChannelSamples, ChannelSeries, ChannelSet, Channels,
};
pub use clock_offset::{ClockOffset, clock_offset};
pub use cluster::PcaCluster;
pub use compare::{compare, compare_in_time};
pub use evo::{Ape, Rpe, UmeyamaApe};
pub use joint::{
    JointError, JointErrorSeries, JointSamples, Joints, joint_error_rad, joint_error_series,
    joint_errors, joint_samples,
};
pub use metric::{Context, Measurement, Metric, Needs, Pair, Score};
pub use pca::Pca;
pub use pointwise::{Displacement, Rms};
pub use pose::{Pose, PoseErrors, Rotation, pose_errors};
pub use pose_residual::{PoseQuantity, PoseSeries, pose_error_series};
pub use registry::{DEFAULT_METRIC, METRICS, by_name};
pub use residual::Shape;
#[cfg(feature = "schema")]
pub use saved_basis::SavedBasis;
pub use shape::{Dtw, Frechet, Hausdorff};
pub use spread::{Spread, TRACKER_NOISE_M};
pub use synchronised::{Synchronised, synchronise};
pub use table::{Comparison, Distance, Row, compare_all, position_metrics};
pub use time_base::TimeBase;
pub use timing::{InTime, Offset, Synchrony, Timing};
pub use umeyama::Umeyama;
pub use whitened::PcaWhitened;
