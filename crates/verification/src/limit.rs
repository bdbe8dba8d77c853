//! The list of checks that an engine is known to fail at the default settings, with the size of the error and the reason.

use super::check::{Check, CheckResult};
use realgap_simulation::EngineChoice;

/// A check that fails for a known reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Name of the engine.
    pub engine: &'static str,
    /// Name of the check.
    pub name: &'static str,
    /// Smallest and largest error that the reason explains, relative or absolute as the tolerance of the check is.
    pub error: (f64, f64),
    /// The reason why the check fails, in one sentence.
    pub why: &'static str,
}

const RESTITUTION: &str = "the engine applies restitution in one pass over the contact points, and a flat bounce picks up spin";
const FROZEN: &str = "the engine keeps contact forces of a multibody as they were at the start of the step, so that a free swing gains energy in proportion to the timestep; servos drain it";
const SINGLE_BODY: &str = "the engine takes the stiffness of a contact from the single body's mass under impulse joints: light plates give way";

const FRICTION_NOT_RESOLVED: &str = "the engine applies restitution after friction and does not solve friction again: what slides through a bounce keeps too much speed, more with shorter steps";
const FIRST_ORDER: &str = "the engine turns a spinning body with an error in proportion to the substep, which a spin about the middle axis magnifies";
const DRAINED: &str = "the engine's multibody on a mount loses swing energy, less with shorter steps and more substeps";

const TOSS: &str = "one of twenty tosses gains 2 to 3 % of its energy in an impact; the cause is unknown, and a timestep of 1/960 s avoids it for multibody joints";

const fn limit(name: &'static str, low: f64, high: f64, why: &'static str) -> Limit {
    Limit {
        engine: "rapier",
        name,
        error: (low, high),
        why,
    }
}

/// Every known limit, in the order of the checks. The entry of a check that starts to pass must be removed from this list; a
/// check whose error is outside its range counts as failed.
pub static LIMITS: &[Limit] = &[
    limit("restitution.flat.first.0.3", 0.06, 0.09, RESTITUTION),
    limit("restitution.flat.first.0.5", 0.06, 0.08, RESTITUTION),
    limit("restitution.flat.second.0.5", 0.20, 0.26, RESTITUTION),
    limit("restitution.flat.first.0.8", 0.06, 0.08, RESTITUTION),
    limit("restitution.flat.second.0.8", 0.24, 0.30, RESTITUTION),
    limit(
        "restitution.oblique.speed",
        0.10,
        0.13,
        FRICTION_NOT_RESOLVED,
    ),
    limit(
        "restitution.oblique.direction",
        0.05,
        0.065,
        FRICTION_NOT_RESOLVED,
    ),
    limit(
        "restitution.spin.slides.speed",
        0.035,
        0.055,
        FRICTION_NOT_RESOLVED,
    ),
    limit(
        "restitution.spin.slides.rate",
        0.22,
        0.28,
        FRICTION_NOT_RESOLVED,
    ),
    limit("energy.euler", 0.025, 0.032, FIRST_ORDER),
    limit("energy.pendulum.period.multibody", 0.007, 0.010, FROZEN),
    limit("energy.pendulum.energy.multibody", 0.8, 1.0, FROZEN),
    limit("energy.double_pendulum.multibody", 0.10, 0.14, DRAINED),
    limit("energy.collision.turn", 0.9, 1.3, RESTITUTION),
    limit("energy.toss.impulse", 0.020, 0.036, TOSS),
    limit("energy.toss.multibody", 0.020, 0.023, TOSS),
    limit("standing.sag.impulse", 4e-5, 5e-5, SINGLE_BODY),
    limit("standing.topple.impulse", 0.020, 0.024, SINGLE_BODY),
    limit("standing.gap.setting", 0.5, 0.75, SINGLE_BODY),
    limit("standing.gap.quarter", 0.4, 0.65, SINGLE_BODY),
];

impl Limit {
    /// The known limit that explains why this check failed; `None` if the check passed, or if its error is outside the known
    /// range.
    pub fn of(check: &Check, engine: EngineChoice) -> Option<&'static Self> {
        let engine = engine.get().name();
        let mut limits = LIMITS.iter();
        let limit = limits.find(|limit| limit.name == check.name && limit.engine == engine)?;
        let (low, high) = limit.error;
        let is_known = check.verdict == CheckResult::Fail && (low..=high).contains(&check.error);
        is_known.then_some(limit)
    }
}
