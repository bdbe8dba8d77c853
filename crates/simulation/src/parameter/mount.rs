//! Parameters of the stand of a held robot: a spring in place of a rigid mount.

use super::{Nudge, Parameter, entry};
use crate::mount::Mount;

/// Defines a parameter that is a field of the mount's spring; a first one makes the rigid mount a spring.
macro_rules! spring {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $doc:literal, $field:ident) => {
        entry!(
            $name,
            $unit,
            $bounds,
            $scale,
            Nudge::Share(0.25),
            $doc,
            |e, _| e.mount.map(|mount| mount.$field),
            |e, _, value| e.mount.get_or_insert_with(Mount::default).$field = value
        )
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    spring!("mount.stiffness_n_m", NewtonPerMetre, (1.0, 1e9), Log,
        "Stiffness of the stand that holds the robot, in all directions; without any parameter of the stand, it is rigid.", stiffness_n_m),
    spring!("mount.stiffness_nm_rad", NewtonMetrePerRadian, (0.01, 1e8), Log,
        "Stiffness of the stand that holds the robot against rotations, about all axes.", stiffness_nm_rad),
    spring!("mount.damping_s", Second, (0.0, 10.0), Linear,
        "Damping of the stand that holds the robot, over its stiffness.", damping_s),
];
