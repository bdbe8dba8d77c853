//! Conversion of a joint of a file into its degree of freedom, axis, anchor and passive properties.

use super::super::assembly::{Bearing, Freedom, Spring};
use super::{JointKind, Triple};

/// The motion of a moving joint; for a joint that slides, read metres for radians.
pub(super) struct Motion {
    pub freedom: Freedom,
    pub axis: Triple,
    pub anchor_m: Triple,
    pub bearing: Bearing,
}

impl JointKind {
    /// The motion of the child; `None` for a fixed joint.
    pub(super) fn motion(&self) -> Option<Motion> {
        Some(match *self {
            Self::Fixed => return None,
            Self::Turn {
                axis,
                anchor_m,
                limits_rad,
                viscous_nm_s_rad,
                dry_nm,
                armature_kg_m2,
                spring,
            } => Motion {
                freedom: Freedom::Turn,
                axis,
                anchor_m,
                bearing: Bearing {
                    viscous_nm_s_rad,
                    dry_nm,
                    limits_rad,
                    armature_kg_m2,
                    spring: spring.map(|s| Spring {
                        stiffness_nm_rad: s.stiffness_nm_rad,
                        rest_rad: s.rest_rad,
                    }),
                    ..Bearing::default()
                },
            },
            Self::Slide {
                axis,
                limits_m,
                viscous_n_s_m,
                dry_n,
                armature_kg,
                spring,
            } => Motion {
                freedom: Freedom::Slide,
                axis,
                anchor_m: (0.0, 0.0, 0.0),
                bearing: Bearing {
                    viscous_nm_s_rad: viscous_n_s_m,
                    dry_nm: dry_n,
                    limits_rad: limits_m,
                    armature_kg_m2: armature_kg,
                    spring: spring.map(|s| Spring {
                        stiffness_nm_rad: s.stiffness_n_m,
                        rest_rad: s.rest_m,
                    }),
                    ..Bearing::default()
                },
            },
        })
    }
}
