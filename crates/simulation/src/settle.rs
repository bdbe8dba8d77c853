//! Settling test: whether a robot comes to rest on the floor without falling over.

use nalgebra::Vector3;
use serde::Serialize;

use super::experiment::{Experiment, Start};
use super::run::run;
use realgap_core::error::Result;
use realgap_core::warning::{Code, Warning};

/// Result of settling a robot on the floor with its servos held at their first command.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Settling {
    /// Duration of settling, seconds; the time limit if the robot did not come to rest.
    pub taken_s: f64,
    /// Angle between the tracked module's up before and after, radians; `None` when the simulation diverged.
    pub tilt_rad: Option<f64>,
    /// Whether the simulation completed, and whether it still moved at the limit.
    #[serde(rename = "outcome")]
    end: End,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum End {
    AtRest,
    Moving,
    Diverged { why: String },
}

/// Tilt beyond which a robot counts as fallen over, radians. Corners of plates lift a robot by less.
const TOPPLED_RAD: f64 = std::f64::consts::FRAC_PI_4;

impl Settling {
    /// True if it came to rest within the limit.
    pub fn is_at_rest(&self) -> bool {
        self.end == End::AtRest
    }

    /// True if it fell onto another side on the way.
    pub fn is_toppled(&self) -> bool {
        self.tilt_rad.is_some_and(|tilt| tilt > TOPPLED_RAD)
    }

    /// Flags: `diverged`, `not-settled`, `toppled`.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        match &self.end {
            End::AtRest => {}
            End::Moving => warnings.push(Code::NotSettled.warning(format!(
                "the robot was still moving after {:.1} s on the floor",
                self.taken_s
            ))),
            End::Diverged { why } => warnings.push(Code::Diverged.warning(format!(
                "the simulation diverged while the robot settled: {why}"
            ))),
        }
        if let Some(tilt_rad) = self.tilt_rad.filter(|_| self.is_toppled()) {
            warnings.push(Code::Toppled.warning(format!(
                "the robot fell over when it was placed on the floor: its tracked module tilted by {:.0} degrees",
                tilt_rad.to_degrees()
            )));
        }
        warnings
    }
}

/// Places the robot of the experiment on the floor and lets it settle, as a run with a settled start does; the experiment's start
/// and duration are ignored.
///
/// # Errors
/// Settings that cannot be simulated, as [`run`].
pub fn settle(experiment: &Experiment) -> Result<Settling> {
    let mut short = experiment.clone();
    short.start = Start::Settled;
    short.duration_s = experiment.solver.timestep_s.max(1e-3);
    short.sampling = super::Sampling::Times([0.0, short.duration_s].into());
    let run = run(&short)?;
    let end = match run.outcome.divergence() {
        Some(divergence) => End::Diverged {
            why: divergence.why.clone(),
        },
        None if run.warnings.iter().any(|w| w.code == Code::NotSettled) => End::Moving,
        None => End::AtRest,
    };
    let tilt_rad = run
        .outcome
        .get()
        .and_then(|motion| motion.orientations_world_from_body()?.first().copied())
        .map(|world_from_body| {
            // The robot frame is upright before settling, and so is the tracked module except for the angle of its own servo.
            let before = short.assembly.robot_from_track.rotation;
            let up_body = before.inverse() * Vector3::z();
            (world_from_body * up_body).angle(&Vector3::z())
        });
    Ok(Settling {
        taken_s: run.settle_steps as f64 * experiment.solver.timestep_s,
        tilt_rad,
        end,
    })
}
