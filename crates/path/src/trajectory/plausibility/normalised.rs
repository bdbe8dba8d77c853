//! The doubt about normalised positions from −100 to 100 (as LeRobot records them) that were read as angles.

use super::Seen;
use super::series::measured;

/// The end of the normalised range; a gripper goes from 0 to this.
const END: f64 = 100.0;
/// The relative error of a number that was converted to radians and back.
const ROUNDING: f64 = 1e-9;
/// The number of ends of joints' ranges that must be met exactly.
const ENDS: usize = 2;

/// A message if no joint goes beyond 100, and the ends of the normalised range are met exactly.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    // Normalised numbers were read either as degrees or as radians.
    [("degrees", 1f64.to_radians()), ("radians", 1.0)]
        .into_iter()
        .find_map(|(unit, size_rad)| ends_met(seen, unit, size_rad))
}

fn ends_met(seen: &Seen<'_>, unit: &str, size_rad: f64) -> Option<String> {
    let mut met: Vec<String> = Vec::new();
    let mut ends = 0;
    for joint in measured(seen.trajectory) {
        let numbers = || {
            joint
                .angles_rad
                .iter()
                .map(|angle_rad| angle_rad / size_rad)
        };
        if numbers().any(|number| number.abs() > END * (1.0 + ROUNDING)) {
            return None;
        }
        let is_met = |end: f64| numbers().any(|number| (number - end).abs() < END * ROUNDING);
        // Angles of 0 are usual, so the lower end of a gripper counts only with its upper one.
        let (low, high) = (is_met(-END), is_met(END));
        let lowest = numbers().fold(f64::INFINITY, f64::min);
        let of_gripper = high && !low && lowest.abs() < END * ROUNDING;
        let own = [low, high, of_gripper]
            .into_iter()
            .filter(|met| *met)
            .count();
        if own > 0 {
            met.push(format!("`{}`", joint.name));
        }
        ends += own;
    }
    (ends >= ENDS).then(|| {
        format!(
            "{} reaches exactly 100 or -100 {unit}, and no joint goes beyond: these are probably positions normalised to -100 to 100, not angles; convert them with the calibration with which they were recorded, or record in degrees (`use_degrees`)",
            met.join(", ")
        )
    })
}
