//! The doubt about a joint that moves over a few steps of its encoder only.

use super::Seen;
use super::obedience::Obedience;
use crate::trajectory::resolution;
use realgap_core::statistics::ends_of;
use realgap_core::unit::number;

/// A joint that moves over this many steps of its encoder or fewer is doubted: rounding then has a twentieth of the standard deviation of
/// the motion or more.
const FEW: f64 = 16.0;
/// A command that moves over fewer steps than this asks for rest, and a joint that rests is no fault.
const ASKED: f64 = 4.0;
/// The smallest number of samples from which a step follows.
const ENOUGH: usize = 60;

/// A message about the joints whose motion is a few steps of their encoders.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    if seen.trajectory.len() < ENOUGH {
        return None;
    }
    let obedience = Obedience::of(seen)?;
    let range = |values: &[f64]| {
        let (low, high) = ends_of(values.iter().copied());
        high - low
    };
    let found = obedience.joints.iter().filter_map(|(angle, command)| {
        let step_rad = resolution(&angle.angles_rad)?;
        let steps = range(&angle.angles_rad) / step_rad;
        let asked = range(&command.angles_rad) / step_rad;
        // A file of few digits rounds commands alike; then both come in the same steps, and the file is coarse.
        let is_few = steps <= FEW && asked >= ASKED;
        is_few.then_some((&angle.name, steps, step_rad))
    });
    let found: Vec<_> = found.collect();
    let (name, steps, step_rad) = found.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let more = match found.len() {
        1 => String::new(),
        many => format!(" (and {} other joints alike)", many - 1),
    };
    Some(format!(
        "`{name}` moves over {steps:.0} steps of its encoder only, {} mrad each{more}: a fit sees these steps more than the motion; record a larger motion of this joint, or leave its parameters out",
        number(1e3 * step_rad)
    ))
}
