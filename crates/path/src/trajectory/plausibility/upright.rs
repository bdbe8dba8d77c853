//! The doubt about the axis that points up, where nobody has stated it and nothing is known of the robot.

use super::Seen;
use crate::trajectory::Axes;
use crate::trajectory::inferred_reading::motion::free_fall;
use realgap_core::statistics::ends_of;
use realgap_core::unit::number;

/// A robot on the ground goes along its height by less than this share of the way along either other axis, …
const LEVEL: f64 = 0.1;
/// … and its ways along the other two differ by less than this factor.
const ALIKE: f64 = 10.0;
/// It stays on one side of zero, and its height changes by less than this share of the height itself.
const STEADY: f64 = 0.5;

/// A message if the robot falls along another axis than z, or stays at one height of y while it goes to and fro along x and z.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let motion = seen.trajectory;
    if seen.has_axes || motion.is_planar() {
        return None;
    }
    if let Some(fall) = free_fall(motion) {
        let (name, axes) = fall.up.setting()?;
        return Some(format!(
            "it falls against {name}, so that {name} seems to point up: `axes: \"{}\"` reads it so",
            axes.name()
        ));
    }
    let ends_m = [0, 1, 2].map(|axis| {
        let places = motion.positions_world_m().iter();
        ends_of(places.map(|place| place[axis]))
    });
    let [x_m, y_m, z_m] = ends_m.map(|(low_m, high_m)| high_m - low_m);
    let (low_m, high_m) = ends_m[1];
    let is_level = y_m < LEVEL * x_m.min(z_m) && x_m.max(z_m) < ALIKE * x_m.min(z_m);
    let is_steady = low_m > 0.0 && y_m < STEADY * low_m;
    // A path that is never below zero along z may be one in a vertical plane.
    let is_below_floor = ends_m[2].0 < 0.0;
    (is_level && is_steady && is_below_floor).then(|| {
        format!(
            "it goes {} m along x and {} m along z, and stays between {} and {} m on y, as a robot on the ground does where y points up: `axes: \"{}\"` reads it so, `axes: \"{}\"` says that z points up",
            number(x_m),
            number(z_m),
            number(low_m),
            number(high_m),
            Axes::YUp.name(),
            Axes::World.name()
        )
    })
}
