//! The distance of two trajectories in one call.

use super::basis::{Basis, Components};
use super::metric::{Context, Pair, Score};
use super::registry::by_name;
use crate::trajectory::{Trajectory, prepare};
use realgap_core::Result;

/// The distance between a recording and a simulation (or another recording) by the metric of this name.
///
/// Both trajectories are prepared first (182 points, the same start, the same heading). A metric of principal components
/// (`pca`, `pca-cluster`) takes the basis of these two trajectories; [`Comparison`](super::Comparison) takes the basis of many.
///
/// ```
/// use realgap_path::comparison::compare;
/// use realgap_path::trajectory::read;
/// use realgap_core::unit::LengthUnit;
///
/// let run = |number| read(format!("../../real_trajectories/tripod_mujoco/run_{number:02}.csv"), LengthUnit::Metre);
/// let (first, second) = (run(0)?.trajectory, run(1)?.trajectory);
/// let score = compare(&first, &second, "rms")?;
/// println!("{} {}", score.value, score.unit);
/// assert!(score.value > 0.0);
/// assert_eq!(compare(&first, &first, "rms")?.value, 0.0);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// No metric has this name (the error lists the names), a trajectory that cannot be prepared, or a metric that needs more than two
/// trajectories: the robot's body length (`pose`) or repeats of the real run (`pca-whitened`). Such a metric is called with
/// [`Metric::compare`](super::Metric::compare) and a [`Context`].
pub fn compare(real: &Trajectory, simulated: &Trajectory, metric: &str) -> Result<Score> {
    let metric = by_name(metric)?;
    let (real_prepared, simulated_prepared) = (prepare(real)?, prepare(simulated)?);
    let basis = match metric.needs().basis {
        true => Some(Basis::fit(
            &[&real_prepared, &simulated_prepared],
            Components::default(),
        )?),
        false => None,
    };
    let pair = Pair::new((real, &real_prepared), (simulated, &simulated_prepared));
    let context = Context {
        basis: basis.as_ref(),
        ..Context::default()
    };
    metric.compare(&pair, &context)
}
