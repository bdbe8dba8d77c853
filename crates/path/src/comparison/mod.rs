//! Distances between two trajectories: metrics with units, and tables of several metrics.
//!
//! A trajectory may be simulated or recorded; the distance between two recordings of one run is the noise floor. A new metric
//! is one new file that implements [`Metric`] and one line in [`METRICS`].

mod basis;
mod cluster;
mod compare;
mod evo;
mod joint;
mod metric;
mod pca;
mod pointwise;
mod pose;
mod registry;
mod residual;
mod saved_basis;
mod shape;
mod spread;
mod table;
mod whitened;

pub use basis::{Basis, Components};
pub use cluster::PcaCluster;
pub use compare::compare;
pub use evo::{Ape, Rpe, UmeyamaApe};
pub use joint::{
    JointError, JointErrorSeries, JointSamples, Joints, joint_error_rad, joint_error_series,
    joint_errors, joint_samples,
};
pub use metric::{Context, Measurement, Metric, Needs, Pair, Score};
pub use pca::Pca;
pub use pointwise::{Displacement, Rms};
pub use pose::{Pose, PoseErrors, Rotation, pose_errors};
pub use registry::{DEFAULT_METRIC, METRICS, by_name};
pub use residual::Shape;
#[cfg(feature = "schema")]
pub use saved_basis::SavedBasis;
pub use shape::{Dtw, Frechet, Hausdorff};
pub use spread::{Spread, TRACKER_NOISE_M};
pub use table::{Comparison, Distance, Row, compare_all, position_metrics};
pub use whitened::PcaWhitened;
