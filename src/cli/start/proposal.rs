//! A parameter that `start` proposes to fit, and what all proposals for joints go by.

use super::super::kit::*;
use realgap::simulation::parameter::by_name;

/// Simulations per parameter in the budget of least squares: its steps are few, and each takes one run per parameter.
const RUNS: usize = 8;
/// The largest delay of a servo or command, seconds.
pub(super) const MOST_DELAY_S: f64 = 0.1;
/// Largest inertia that only the joint feels, per torque of its drive, s²: with more, the drive could not reach 100 rad/s².
pub(super) const ARMATURE_S2: f64 = 0.01;
/// Largest friction as a share of a joint's torque (dry), and of its torque per rad/s (viscous).
pub(super) const FRICTION: f64 = 0.15;
/// The largest torque of a drive that fits a robot, as a multiple of the torque of its weight at its whole length.
pub(super) const DRIVE: f64 = 2.0;
/// Points of a grid along each axis.
const POINTS: usize = 11;

/// A parameter to fit, and its range.
#[derive(Debug, Clone)]
pub(super) struct Proposal {
    pub name: String,
    pub from: f64,
    pub to: f64,
    /// Its own value in the file of the robot or model, where that is weak knowledge.
    pub own: Option<f64>,
}

impl Proposal {
    /// The part of the range that the parameter allows.
    pub fn within_bounds(self) -> Result<Self> {
        let (low, high) = by_name(&self.name)?.bounds;
        let (from, to) = (self.from.clamp(low, high), self.to.clamp(low, high));
        Ok(Self {
            from,
            to,
            own: self.own.map(|own| own.clamp(from, to)),
            ..self
        })
    }

    /// Its line in the study. A robot's file is weak knowledge: a parameter about which the recordings say nothing stays near its own
    /// value, and does not wander to an end of its range. Without an own value it is an axis of a grid.
    pub fn line(&self) -> String {
        let Self {
            name,
            from,
            to,
            own,
        } = self;
        let more = match own {
            None => format!("points: {POINTS}"),
            Some(own) => format!("prior: ({own:?}, {:?})", rounded(0.5 * (to - from))),
        };
        format!("        (name: {name:?}, from: {from:?}, to: {to:?}, {more}),\n")
    }
}

/// The budget with which least squares fit so many parameters.
pub(super) fn budget(parameters: usize) -> usize {
    RUNS * (parameters + 2)
}

/// Rounds to three digits, for readability.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
