//! A floor that leans in the recorded axes: few trackers know to a degree where up is.

use nalgebra::{Rotation3, Vector3};

use super::{Trajectory, axes};
use realgap_core::error::Result;

/// Whether a floor may lean so far; beyond, another axis points up.
pub(super) fn is_sound((x, y): (f64, f64)) -> bool {
    x.abs() <= 1.0 && y.abs() <= 1.0
}

/// The same motion, turned until the floor's normal (x, y, 1) is z: about where it ends, since it is there that heights are known
/// of whatever came to rest.
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
