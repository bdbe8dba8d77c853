//! What a metric is.

use serde::Serialize;

use super::basis::Basis;
use super::spread::Spread;
use crate::trajectory::{Prepared, Trajectory};
use realgap_core::error::{Error, Result};
use realgap_core::unit::{Unit, quantity};
use realgap_core::warning::{Code, Warning};

/// Two trajectories to be compared, raw and prepared.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    /// The recording (or whatever is the reference).
    pub real: &'a Trajectory,
    /// The simulation (or another recording).
    pub simulated: &'a Trajectory,
    /// `real`, prepared.
    pub real_prepared: &'a Prepared,
    /// `simulated`, prepared.
    pub simulated_prepared: &'a Prepared,
}

impl<'a> Pair<'a> {
    /// Two trajectories, each with what preparing has made of it.
    pub fn new(
        (real, real_prepared): (&'a Trajectory, &'a Prepared),
        (simulated, simulated_prepared): (&'a Trajectory, &'a Prepared),
    ) -> Self {
        Self {
            real,
            simulated,
            real_prepared,
            simulated_prepared,
        }
    }
}

/// What some metrics need besides the two trajectories.
#[derive(Debug, Clone, Copy, Default)]
pub struct Context<'a> {
    /// Principal components of all trajectories of the comparison.
    pub basis: Option<&'a Basis>,
    /// How recordings of the run differ.
    pub spread: Option<&'a Spread>,
    /// Width of the robot, metres.
    pub body_length_m: Option<f64>,
}

/// What a metric cannot do without.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// The prepared trajectories (all but `pose`).
    pub preparation: bool,
    /// [`Context::basis`].
    pub basis: bool,
    /// [`Context::spread`].
    pub spread: bool,
    /// Orientations in both trajectories.
    pub orientation: bool,
    /// [`Context::body_length_m`].
    pub body_length: bool,
    /// Joints in both trajectories.
    pub joints: bool,
}

impl Needs {
    /// Only the prepared points.
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
    /// The distance in `unit`, finite, 0 for equal trajectories.
    pub value: f64,
    /// Unit of `value`.
    pub unit: Unit,
    /// Number of samples that were compared.
    pub samples: usize,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&quantity(self.value, self.unit))
    }
}

/// What [`Metric::measure`] returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// The distance in the metric's unit.
    pub value: f64,
    /// Number of samples that were compared.
    pub samples: usize,
    /// What the reader should know.
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
/// Contract (a test runs over [`METRICS`](super::METRICS)): 0 for equal trajectories, never negative, finite, the same
/// after turning both about z, and symmetric where [`Metric::is_symmetric`] says so.
pub trait Metric: Sync {
    /// Name on the command line, e.g. `pca`.
    fn name(&self) -> &'static str;
    /// Name as a column, with the unit, e.g. `pca_coefficients_m`.
    fn column(&self) -> &'static str;
    /// Unit of the values.
    fn unit(&self) -> Unit;
    /// One line for people.
    fn doc(&self) -> &'static str;
    /// What it cannot do without.
    fn needs(&self) -> Needs;
    /// Whether exchanging the trajectories leaves the value.
    fn is_symmetric(&self) -> bool {
        true
    }
    /// Whether the distance is made of the two parts that [`pose_errors`](super::pose_errors) tells apart, so that a
    /// report can say how much of it is position and how much rotation.
    fn is_pose(&self) -> bool {
        false
    }
    /// The distance; everything that [`Metric::needs`] names is present.
    ///
    /// # Errors
    /// Trajectories that this metric cannot compare.
    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement>;

    /// Single errors whose sizes make the distance, about `most` of them and as many for every run, in an order in which neighbours
    /// are alike: what least squares look at. `None`: it is not made of any.
    ///
    /// # Errors
    /// As [`Metric::measure`].
    fn errors(&self, pair: &Pair<'_>, most: usize) -> Result<Option<Vec<f64>>> {
        let _ = (pair, most);
        Ok(None)
    }

    /// The distance, with the warnings of the preparation where it was used.
    ///
    /// # Errors
    /// Something is missing that the metric needs, or the distance is not a finite number.
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
        if needs.preparation {
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

/// Preparation maps whatever was recorded onto 182 points, so that a run half as long looks half as fast.
fn different_durations(pair: &Pair<'_>) -> Option<Warning> {
    let (real_s, simulated_s) = (pair.real.duration_s(), pair.simulated.duration_s());
    let differ = (real_s - simulated_s).abs() > 0.01 * real_s.max(simulated_s);
    differ.then(|| {
        Code::DifferentDurations.warning(format!(
            "a trajectory of {real_s:.2} s is compared with one of {simulated_s:.2} s, point by point in relative time"
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
            "fit one with Basis::fit on all trajectories of the comparison",
        );
    }
    if needs.spread && context.spread.is_none() {
        return refuse(
            "the spread of reality",
            "take it from repeats of the real run with Spread::of; in a study they are its recordings",
        );
    }
    if needs.body_length
        && !context
            .body_length_m
            .is_some_and(|m| m > 0.0 && m.is_finite())
    {
        return refuse("the body length of the robot", "it must be more than 0 m");
    }
    if needs.joints && (pair.real.joints().is_empty() || pair.simulated.joints().is_empty()) {
        return refuse("joints", "columns NAME_rad in both");
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
