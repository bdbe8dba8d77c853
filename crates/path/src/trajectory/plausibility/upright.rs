//! The doubt about the axis that points up, if the reading does not state it; the robot is not needed for it.

use nalgebra::{Rotation3, Vector3};

use super::Seen;
use crate::trajectory::inferred_reading::motion::{ends_m, free_fall};
use crate::trajectory::{Axes, Trajectory};
use realgap_core::unit::number;

/// A robot on the ground goes along its height by less than this share of the way along either other axis, …
const LEVEL: f64 = 0.1;
/// … and its ways along the other two differ by less than this factor.
const ALIKE: f64 = 10.0;
/// It stays on one side of zero, and its height changes by less than this share of the height itself.
const STEADY: f64 = 0.5;
/// A robot on the ground turns by this angle, radians, and more about the axis that points up, …
const TURNED_RAD: f64 = 1.0;
/// … and its own axis that points up leans by less than this angle, radians.
const LEANS_RAD: f64 = 0.2;

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
    let [x, (low_m, high_m), z] = ends_m(motion);
    let [x_m, y_m, z_m] = [x, (low_m, high_m), z].map(|(low_m, high_m)| high_m - low_m);
    let is_level = y_m < LEVEL * x_m.min(z_m) && x_m.max(z_m) < ALIKE * x_m.min(z_m);
    let is_steady = low_m > 0.0 && y_m < STEADY * low_m;
    // Else it may be a path in a vertical plane.
    let is_ground = z.0 < 0.0 || turns_about_y(motion);
    (is_level && is_steady && is_ground).then(|| {
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

/// True if the body turns about y only, and far, as a robot on the ground does about the axis that points up.
fn turns_about_y(motion: &Trajectory) -> bool {
    let Some(all) = motion.orientations_world_from_body() else {
        return false;
    };
    let turned = all.iter().map(|turn| turn * all[0].inverse());
    let turned: Vec<Rotation3<f64>> = turned.map(|q| q.to_rotation_matrix()).collect();
    let leans_rad = |turn: &Rotation3<f64>| (turn * Vector3::y()).angle(&Vector3::y());
    turned.iter().all(|turn| leans_rad(turn) < LEANS_RAD)
        && turned.iter().any(|turn| turn.angle() > TURNED_RAD)
}
