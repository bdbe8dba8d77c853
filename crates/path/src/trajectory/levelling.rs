//! Levels recordings whose floor is tilted in the recorded axes, because few trackers know the vertical to within a degree.

use nalgebra::{Rotation3, Vector3};

use super::{Trajectory, axes};
use realgap_core::error::Result;

/// True if the tilt of the floor is within the allowed range; with a larger tilt, another axis would point up.
pub(super) fn is_sound((x, y): (f64, f64)) -> bool {
    x.abs() <= 1.0 && y.abs() <= 1.0
}

/// The same trajectory, turned so that the floor's normal (x, y, 1) becomes z. The centre of the turn is the last position, because the
/// height there is known for a body that has come to rest.
pub(super) fn levelled(there: &Trajectory, (x, y): (f64, f64)) -> Result<Trajectory> {
    let normal = Vector3::new(x, y, 1.0);
    let turn = Rotation3::rotation_between(&normal, &Vector3::z()).unwrap_or_default();
    let end_m = there.positions_world_m().last().copied();
    let centre_m = end_m.unwrap_or_default();
    axes::moved(
        there,
        ("floor_leans", turn),
        centre_m,
        Rotation3::identity(),
    )
}
