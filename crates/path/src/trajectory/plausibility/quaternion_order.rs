//! The doubt about the order of the four numbers of quaternions.

use nalgebra::{UnitQuaternion, Vector3};

use super::Seen;
use crate::trajectory::QuaternionOrder;

/// The largest tilt, radians, in the other order of quaternions, if that is the right order.
const UPRIGHT_RAD: f64 = 0.175;
/// The smallest tilt, radians, in the order as read, that casts doubt on this order.
const TILTED_RAD: f64 = 0.524;

/// A message if the other order of quaternions keeps the robot upright, but the order as read does not.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let all = seen.trajectory.orientations_world_from_body()?;
    let tilt_rad = |q: UnitQuaternion<f64>| (q * Vector3::z()).z.clamp(-1.0, 1.0).acos();
    let most = |of: &dyn Fn(&UnitQuaternion<f64>) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let as_read = most(&|q| tilt_rad(*q));
    if as_read < TILTED_RAD {
        return None;
    }
    let parts = |w, i, j, k| {
        tilt_rad(UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(
            w, i, j, k,
        )))
    };
    let (other, order) = match seen.read_as {
        QuaternionOrder::Wxyz => (most(&|q| parts(q.k, q.w, q.i, q.j)), QuaternionOrder::Xyzw),
        QuaternionOrder::Xyzw => (most(&|q| parts(q.i, q.j, q.k, q.w)), QuaternionOrder::Wxyz),
    };
    (other < UPRIGHT_RAD).then(|| {
        format!(
            "the robot tilts by up to {:.0} deg as its quaternions are read; as `quaternion: \"{}\"` it stays upright within {:.0} deg",
            as_read.to_degrees(),
            order.name(),
            other.to_degrees()
        )
    })
}
