//! Closed-form checks of the simulation, run with the settings of the user's choice.
//!
//! Every [`Check`] compares a simulated value with a formula that can be worked out by hand:
//! stopping distance, bounce height, pendulum period, servo lag. A tolerance is the largest error that a user of the
//! results can accept. A check whose error exceeds its tolerance is reported as failed; the tolerance is not widened. If the
//! reason for a failure is known, a [`Limit`] states the reason and the range of errors that the reason explains.
//! `docs/validation.md` explains each check.
//!
//! ```
//! use realgap_verification::{Settings, CheckResult, Theme};
//!
//! let checks = Theme::Friction.run(&Settings::default())?;
//! assert!(checks.iter().any(|c| c.name.starts_with("friction.stop") && c.verdict == CheckResult::Pass));
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod balance;
mod body;
mod centre;
mod check;
mod dependence;
mod energy;
mod euler;
mod film;
mod friction;
mod impact;
mod limit;
mod pendulum;
mod restitution;
mod rolling;
mod servo;
mod slide;
mod spin;
mod standing;
mod structure;
mod topple;
mod toss;
mod turning;
mod wheel;

pub use check::{Check, CheckResult, Tolerance};
pub use dependence::known_limits;
pub use limit::{LIMITS, Limit};

use realgap_core::error::Result;
use realgap_robot::morphology::Assembly;
use realgap_simulation::{Contact, EngineChoice, Experiment, JointFormulation, Solver};

/// The simulation settings that the checks test; each check chooses everything else itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Numerical settings; the joint kind is taken from `joints`.
    pub solver: Solver,
    /// Contact model.
    pub contact: Contact,
    /// Joint formulations with which checks that involve hinges are run in Rapier.
    pub joints: Vec<JointFormulation>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            solver: Solver::default(),
            contact: Contact::default(),
            joints: vec![JointFormulation::Impulse, JointFormulation::Multibody],
        }
    }
}

impl Settings {
    /// An experiment with these settings, no restitution, and a floor the check may change.
    fn experiment(&self, assembly: Assembly, duration_s: f64) -> Experiment {
        let mut experiment = Experiment::new(assembly);
        experiment.solver = self.solver;
        experiment.contact = self.contact;
        experiment.duration_s = duration_s;
        experiment.floor.restitution = 0.0;
        experiment
    }

    /// Joint formulations that are checked separately. An engine other than the reference engine has one formulation only.
    pub fn kinds(&self) -> &[JointFormulation] {
        if self.is_reference() {
            &self.joints
        } else {
            &[JointFormulation::Auto]
        }
    }

    /// Last part of the name of a check that involves hinges: the joint formulation, or the name of an engine that has one
    /// formulation only.
    fn joint_name(&self, kind: JointFormulation) -> &'static str {
        match kind {
            _ if !self.is_reference() => self.solver.engine.get().name(),
            JointFormulation::Impulse => "impulse",
            JointFormulation::Multibody => "multibody",
            JointFormulation::Auto => "auto",
        }
    }

    fn is_reference(&self) -> bool {
        self.solver.engine == EngineChoice::default()
    }
}

/// A group of checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Theme {
    /// Sliding, sticking, creeping, rolling, wheels.
    Friction,
    /// Bouncing.
    Restitution,
    /// Free motion: falling, tumbling, swinging, colliding.
    Energy,
    /// Servos: torque, speed, tracking.
    Servo,
    /// Masses of rigidly attached modules, stiffness of their attachments, and hinges under load.
    Structure,
    /// Standing on a light plate: sinking into the floor, creeping, falling over.
    Standing,
}

impl Theme {
    /// All themes, in the order of the table.
    pub const ALL: [Self; 6] = [
        Self::Friction,
        Self::Restitution,
        Self::Energy,
        Self::Servo,
        Self::Structure,
        Self::Standing,
    ];

    /// Runs the checks of this theme.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn run(self, settings: &Settings) -> Result<Vec<Check>> {
        match self {
            Self::Friction => friction::checks(settings),
            Self::Restitution => restitution::checks(settings),
            Self::Energy => energy::checks(settings),
            Self::Servo => servo::checks(settings),
            Self::Structure => structure::checks(settings),
            Self::Standing => standing::checks(settings),
        }
    }
}

/// Runs every check.
///
/// # Errors
/// Settings that cannot be simulated. A check that fails is not an error but a [`CheckResult`].
pub fn run(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for theme in Theme::ALL {
        checks.extend(theme.run(settings)?);
    }
    Ok(checks)
}
