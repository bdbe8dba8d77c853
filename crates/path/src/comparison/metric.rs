//! The trait of metrics: distances between two trajectories, with what they need and what they return.

use serde::Serialize;

use super::association::Matched;
use super::basis::Basis;
use super::channel::ChannelSet;
use super::spread::Spread;
use crate::trajectory::{Prepared, Trajectory};
use realgap_core::error::{Error, Result};
use realgap_core::unit::{Unit, quantity};
use realgap_core::warning::{Code, Warning};

/// Two trajectories to be compared, raw and prepared.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    /// The reference, usually a recording.
    pub real: &'a Trajectory,
    /// The trajectory that is compared with the reference, usually a simulation.
    pub simulated: &'a Trajectory,
    /// `real`, prepared.
    pub real_prepared: &'a Prepared,
    /// `simulated`, prepared.
    pub simulated_prepared: &'a Prepared,
    /// The samples that belong together in time. Metrics of samples ([`Metric::is_of_samples`]) compare them where they are given, and
    /// the prepared points otherwise.
    pub matched: Option<&'a Matched>,
}

impl<'a> Pair<'a> {
    /// Two trajectories, each with its prepared form; no samples are matched.
    pub fn new(
        (real, real_prepared): (&'a Trajectory, &'a Prepared),
        (simulated, simulated_prepared): (&'a Trajectory, &'a Prepared),
    ) -> Self {
        Self {
            real,
            simulated,
            real_prepared,
            simulated_prepared,
            matched: None,
        }
    }

    /// The same pair with matched samples.
    #[must_use]
    pub fn with_matched(self, matched: Option<&'a Matched>) -> Self {
        Self { matched, ..self }
    }
}

/// Data that some metrics need in addition to the two trajectories.
#[derive(Debug, Clone, Copy, Default)]
pub struct Context<'a> {
    /// Principal components of all trajectories of the comparison.
    pub basis: Option<&'a Basis>,
    /// The covariance of repeated recordings of the run.
    pub spread: Option<&'a Spread>,
    /// Body length of the robot, metres.
    pub body_length_m: Option<f64>,
    /// The channels that a study scores.
    pub channels: Option<&'a ChannelSet>,
}

/// The data that a metric needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// The prepared trajectories (all metrics except `pose` and `joints`).
    pub preparation: bool,
    /// The basis of principal components ([`Context::basis`]).
    pub basis: bool,
    /// The covariance of repeated recordings ([`Context::spread`]).
    pub spread: bool,
    /// Orientations in both trajectories.
    pub orientation: bool,
    /// The body length of the robot ([`Context::body_length_m`]).
    pub body_length: bool,
    /// Joints in both trajectories.
    pub joints: bool,
}

impl Needs {
    /// A metric that needs only the prepared points.
    pub const POINTS: Self = Self {
        preparation: true,
        basis: false,
        spread: false,
        orientation: false,
        body_length: false,
        joints: false,
    };
}

/// A distance between two trajectories.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// The distance in `unit`; it is finite, and 0 for equal trajectories.
    pub value: f64,
    /// Unit of `value`.
    pub unit: Unit,
    /// Number of samples that were compared.
    pub samples: usize,
    /// Warnings that the reader should know.
    pub warnings: Vec<Warning>,
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&quantity(self.value, self.unit))
    }
}

/// The result of [`Metric::measure`].
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// The distance in the metric's unit.
    pub value: f64,
    /// Number of samples that were compared.
    pub samples: usize,
    /// Warnings that the reader should know.
    pub warnings: Vec<Warning>,
}

impl Measurement {
    /// A measurement without warnings.
    pub fn new(value: f64, samples: usize) -> Self {
        Self {
            value,
            samples,
            warnings: Vec::new(),
        }
    }
}

/// A distance between two trajectories. Implement [`Metric::measure`]; call [`Metric::compare`].
///
/// Contract, tested for all [`METRICS`](super::METRICS): the distance is 0 for equal trajectories, never negative, finite, unchanged
/// if both trajectories are turned about z, and symmetric if [`Metric::is_symmetric`] says so.
pub trait Metric: Sync {
    /// Name on the command line, e.g. `pca`.
    fn name(&self) -> &'static str;
    /// Name of the column in tables, with the unit, e.g. `pca_coefficients_m`.
    fn column(&self) -> &'static str;
    /// Unit of the values.
    fn unit(&self) -> Unit;
    /// Description of one line for people.
    fn doc(&self) -> &'static str;
    /// The data that the metric needs.
    fn needs(&self) -> Needs;
    /// True if the value stays the same when the two trajectories are exchanged.
    fn is_symmetric(&self) -> bool {
        true
    }
    /// True if the distance is the sum of the position and rotation parts of [`pose_errors`](super::pose_errors), so that a
    /// report can state both parts.
    fn is_pose(&self) -> bool {
        false
    }
    /// True if the distance is one of samples: it is computed over the matched samples where the pair has them ([`Pair::matched`]), and over
    /// the prepared points otherwise.
    fn is_of_samples(&self) -> bool {
        false
    }
    /// Computes the distance; the caller has made sure that everything in [`Metric::needs`] is present.
    ///
    /// # Errors
    /// Trajectories that this metric cannot compare.
    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement>;

    /// True if the distance is made of single errors ([`Metric::errors`]), which least squares need.
    fn has_errors(&self) -> bool {
        false
    }
    /// The single errors (residuals) from which the distance is computed, for least squares: about `most` residuals, the same number for every
    /// run, in an order in which neighbouring residuals are similar. `None` for a metric that has no residuals.
    ///
    /// # Errors
    /// The same as of [`Metric::measure`].
    fn errors(&self, pair: &Pair<'_>, most: usize) -> Result<Option<Vec<f64>>> {
        let _ = (pair, most);
        Ok(None)
    }

    /// Checks the needs, computes the distance, and adds the warnings of the preparation if it was used.
    ///
    /// # Errors
    /// Data that the metric needs are missing, or the distance is not a finite number.
    fn compare(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Score> {
        let needs = self.needs();
        check_needs(self.name(), needs, pair, context)?;
        let measured = self.measure(pair, context)?;
        if !measured.value.is_finite() {
            return Err(Error::invalid("the distance is not a finite number")
                .field(self.name())
                .found(measured.value)
                .hint("check the unit of the trajectories, and the tracker for lost samples"));
        }
        let mut warnings = measured.warnings;
        let uses_matched = self.is_of_samples() && pair.matched.is_some();
        if needs.preparation && !uses_matched {
            warnings.extend_from_slice(pair.real_prepared.warnings());
            warnings.extend_from_slice(pair.simulated_prepared.warnings());
            warnings.extend(different_durations(pair));
        }
        Ok(Score {
            value: measured.value,
            unit: self.unit(),
            samples: measured.samples,
            warnings,
        })
    }
}

/// A warning if the durations differ: preparation maps every run onto 182 points, so a run of half the duration looks half as fast.
fn different_durations(pair: &Pair<'_>) -> Option<Warning> {
    let (real_s, simulated_s) = (pair.real.duration_s(), pair.simulated.duration_s());
    let differ = (real_s - simulated_s).abs() > 0.01 * real_s.max(simulated_s);
    differ.then(|| {
        Code::DifferentDurations.warning(format!(
            "a trajectory of {real_s:.2} s is compared with one of {simulated_s:.2} s, point by point at equal fractions of their durations"
        ))
    })
}

impl std::fmt::Debug for dyn Metric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Metric({})", self.name())
    }
}

fn check_needs(name: &str, needs: Needs, pair: &Pair<'_>, context: &Context<'_>) -> Result<()> {
    let refuse = |what: &str, hint: &str| {
        Err(Error::invalid(format!("the metric `{name}` needs {what}")).hint(hint))
    };
    if needs.basis && context.basis.is_none() {
        return refuse(
            "a basis of principal components",
            "fit a basis with Basis::fit on all trajectories of the comparison",
        );
    }
    if needs.spread && context.spread.is_none() {
        return refuse(
            "the spread of repeated recordings",
            "compute it from repeats of the real run with Spread::of; in a study these are its recordings",
        );
    }
    if needs.body_length
        && !context
            .body_length_m
            .is_some_and(|m| m > 0.0 && m.is_finite())
    {
        return refuse("the body length of the robot", "it must be more than 0 m");
    }
    let lacks_joints = pair.real.joints().is_empty() || pair.simulated.joints().is_empty();
    // A study that names channels may name others than joints.
    if needs.joints && context.channels.is_none() && lacks_joints {
        return refuse("joints", "give both trajectories columns NAME_rad");
    }
    if needs.orientation {
        for (which, trajectory) in [("reference", pair.real), ("other", pair.simulated)] {
            if trajectory.orientations_world_from_body().is_none() {
                return Err(Error::invalid(format!(
                    "the metric `{name}` needs orientations, and the {which} trajectory has none"
                ))
                .allowed("columns qw,qx,qy,qz")
                .hint("choose a metric of positions, e.g. pca or rms"));
            }
        }
    }
    Ok(())
}
