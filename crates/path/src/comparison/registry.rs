//! The registry of all metrics, and look-up by name.

use super::cluster::PcaCluster;
use super::evo::{Ape, Rpe, UmeyamaApe};
use super::joint::Joints;
use super::metric::Metric;
use super::pca::Pca;
use super::pointwise::{Displacement, Rms};
use super::pose::{Pose, Rotation};
use super::residual::Shape;
use super::shape::{Dtw, Frechet, Hausdorff};
use super::whitened::PcaWhitened;
use realgap_core::error::Result;
use realgap_core::file::look_up;

/// Name of the metric that is used by default.
pub const DEFAULT_METRIC: &str = "pca";

/// Every known metric; the first is the default.
pub const METRICS: &[&dyn Metric] = &[
    &Pca,
    &PcaWhitened,
    &PcaCluster,
    &Displacement,
    &Shape,
    &Rms,
    &Hausdorff,
    &Frechet,
    &Dtw,
    &Ape,
    &UmeyamaApe,
    &Rpe,
    &Rotation,
    &Pose,
    &Joints,
];

/// The metric with this `name`.
///
/// ```
/// use realgap_path::comparison::by_name;
///
/// assert_eq!(by_name("dtw")?.column(), "dtw_sum_m");
/// assert!(by_name("dwt").unwrap_err().to_string().contains("hausdorff"));
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// An unknown name; the error lists the known names.
pub fn by_name(name: &str) -> Result<&'static dyn Metric> {
    look_up("metric", name, METRICS.iter().copied(), |metric| {
        metric.name()
    })
    .map_err(|error| error.field("metric"))
}
