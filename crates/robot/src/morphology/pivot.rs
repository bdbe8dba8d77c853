//! Hinges that a file states by anchor and axis, with friction and limits, passive or actuated.

use std::f64::consts::TAU;

use nalgebra::{Unit, Vector3};

use super::assembly::{Actuator, Bearing};
use super::flaw::{Checked, Flaw, Range};
use super::module::{Module, check_actuator, check_name};
use realgap_core::Error;

/// A hinge between two modules that are not attached to each other. At angle 0 the axes of both frames are parallel.
#[derive(Debug, Clone, PartialEq)]
pub struct Pivot {
    /// Unique name, with the same characters as names of modules; joint columns of recordings have this name.
    pub name: String,
    /// Index of the parent module.
    pub parent: usize,
    /// Index of the child module: it turns by +angle about the axis, right-handed.
    pub child: usize,
    /// A point on the axis, in the parent's frame, m.
    pub anchor_parent_m: Vector3<f64>,
    /// The same point in the child's frame, m.
    pub anchor_child_m: Vector3<f64>,
    /// The axis, in the parent's frame.
    pub axis_parent: Unit<Vector3<f64>>,
    /// Friction and limits.
    pub bearing: Bearing,
    /// Servo and gait; `None` for a passive hinge.
    pub actuator: Option<Actuator>,
}

impl Pivot {
    /// Checks the range of every value. `at` is the path of this hinge in a file, e.g. `hinges[0]`.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        check_name(&self.name, "a hinge", &format!("{at}.name"))?;
        let length = Range::within(-10.0, 10.0, "m");
        for (field, anchor_m) in [
            ("anchor_m", &self.anchor_parent_m),
            ("child_anchor_m", &self.anchor_child_m),
        ] {
            for (index, value) in anchor_m.iter().enumerate() {
                length.check(*value, &format!("{at}.{field}[{index}]"))?;
            }
        }
        if !self.axis_parent.iter().all(|value| value.is_finite()) {
            return Err(Flaw::new(
                format!("{at}.axis"),
                Error::invalid("an axis needs a direction")
                    .allowed("a vector that is not zero, e.g. (0, 1, 0)"),
            ));
        }
        let Bearing {
            viscous_nm_s_rad,
            dry_nm,
            limits_rad,
            ..
        } = self.bearing;
        Range::within(0.0, 1e4, "N m s/rad")
            .check(viscous_nm_s_rad, &format!("{at}.viscous_nm_s_rad"))?;
        Range::within(0.0, 1e4, "N m").check(dry_nm, &format!("{at}.dry_nm"))?;
        if let Some((low_rad, high_rad)) = limits_rad {
            let is_range = (low_rad..=high_rad).contains(&0.0) && high_rad - low_rad <= TAU;
            if !is_range || low_rad == high_rad {
                return Err(Flaw::new(
                    format!("{at}.limits_rad"),
                    Error::invalid("not the limits of a hinge")
                        .found(format!("{low_rad} to {high_rad} rad"))
                        .allowed(
                            "the smaller first, 0 between them, and a range of at most a full turn",
                        )
                        .hint("leave limits_rad out for a hinge without limits"),
                ));
            }
        }
        match &self.actuator {
            Some(actuator) => check_actuator(actuator, at),
            None => Ok(()),
        }
    }

    /// Centre of the child in the frame of the parent at angle 0, m.
    pub(super) fn child_centre_m(&self) -> Vector3<f64> {
        self.anchor_parent_m - self.anchor_child_m
    }
}

/// Checks that names are unique among hinges and active modules, because both are names of joints.
pub(super) fn check_names(pivots: &[Pivot], modules: &[Module]) -> Checked<()> {
    for (index, pivot) in pivots.iter().enumerate() {
        pivot.check(&format!("hinges[{index}]"))?;
        let is_active = |module: &&Module| module.drive.is_some() && module.name == pivot.name;
        let taken = pivots[..index].iter().any(|other| other.name == pivot.name)
            || modules.iter().any(|module| is_active(&module));
        if taken {
            return Err(Flaw::new(
                format!("hinges[{index}].name"),
                Error::invalid("two joints have the same name")
                    .found(format!("`{}`", pivot.name))
                    .allowed("a unique name for every hinge and active module"),
            ));
        }
    }
    Ok(())
}
