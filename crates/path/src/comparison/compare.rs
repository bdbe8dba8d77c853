//! The distance of two trajectories in one call.

use super::association::Matched;
use super::basis::{Basis, Components};
use super::metric::{Context, Metric, Pair, Score};
use super::registry::by_name;
use super::timing::Timing;
use crate::trajectory::{Trajectory, prepare};
use realgap_core::Result;

/// The distance between a recording and a simulation (or another recording) by the metric of this name.
///
/// Both trajectories are prepared first (182 points at equal fractions of their durations, the same start, the same heading);
/// [`compare_in_time`] compares by the clock. A metric of principal components
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
    of_pair([real, simulated], None, by_name(metric)?)
}

/// As [`compare`], with moments that belong together by their stamps or by their times since each start.
///
/// Metrics of paths compare the parts of both trajectories in the common time; `ape`, `umeyama-ape`, `rpe` and `rotation` compare matched
/// samples, as evo does.
///
/// ```
/// use realgap_path::comparison::{TimeBase, Timing, compare_in_time};
/// use realgap_path::trajectory::Trajectory;
/// use nalgebra::Vector3;
///
/// let times = |from: u8| (from..from + 50).map(|k| 0.1 * f64::from(k));
/// let line = |from| Trajectory::new(times(from).collect(), times(from).map(|t| Vector3::new(t, 0.0, 0.0)).collect());
/// let (whole, later) = (line(0)?, line(20)?);
/// let ape = |base| compare_in_time(&whole, &later, "ape", &Timing::of(base));
/// assert!(ape(TimeBase::Clock)?.value < 1e-9);
/// assert!((ape(TimeBase::Start)?.value - 2.0).abs() < 1e-9);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// Those of [`compare`] and of [`Timing::synchronise`]; too few samples that belong together.
pub fn compare_in_time(
    real: &Trajectory,
    simulated: &Trajectory,
    metric: &str,
    timing: &Timing,
) -> Result<Score> {
    let metric = by_name(metric)?;
    let in_time = timing.synchronise(real, simulated)?;
    let matched = match metric.is_of_samples() {
        true => in_time.matched()?,
        false => None,
    };
    let both = [real, simulated];
    let mut score = match in_time.common() {
        Some(common) => {
            let [real, simulated] = in_time.cut(common, both)?;
            of_pair([&real, &simulated], matched, metric)?
        }
        None => of_pair(both, matched, metric)?,
    };
    score
        .warnings
        .extend(in_time.warnings(both, metric.is_of_samples()));
    Ok(score)
}

fn of_pair(
    [real, simulated]: [&Trajectory; 2],
    matched: Option<&Matched>,
    metric: &dyn Metric,
) -> Result<Score> {
    let (real_prepared, simulated_prepared) = (prepare(real)?, prepare(simulated)?);
    let basis = match metric.needs().basis {
        true => Some(Basis::fit(
            &[&real_prepared, &simulated_prepared],
            Components::default(),
        )?),
        false => None,
    };
    let pair =
        Pair::new((real, &real_prepared), (simulated, &simulated_prepared)).with_matched(matched);
    let context = Context {
        basis: basis.as_ref(),
        ..Context::default()
    };
    metric.compare(&pair, &context)
}
