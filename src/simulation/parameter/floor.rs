//! The ground and gravity.

use super::{Nudge, Parameter, Scale};
use crate::unit::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "floor.friction",
        unit: Unit::One,
        bounds: (0.0, 10.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.1),
        doc: "Coulomb friction coefficient of the pair robot and floor.",
        get: |e| Some(e.floor.friction),
        set: |e, value| e.floor.friction = value,
    },
    Parameter {
        name: "floor.restitution",
        unit: Unit::One,
        bounds: (0.0, 1.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.05),
        doc: "Restitution coefficient of the pair robot and floor.",
        get: |e| Some(e.floor.restitution),
        set: |e, value| e.floor.restitution = value,
    },
    Parameter {
        name: "floor.height_m",
        unit: Unit::Metre,
        bounds: (-10.0, 10.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.001),
        doc: "Height of the floor at the world origin.",
        get: |e| Some(e.floor.height_m),
        set: |e, value| e.floor.height_m = value,
    },
    Parameter {
        name: "floor.slope_rad",
        unit: Unit::Radian,
        bounds: (-1.2, 1.2),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.01),
        doc: "Slope of the floor about world y; positive is downhill towards +x.",
        get: |e| Some(e.floor.slope_rad),
        set: |e, value| e.floor.slope_rad = value,
    },
    Parameter {
        name: "gravity_m_s2",
        unit: Unit::MetrePerSecondSquared,
        bounds: (0.0, 100.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.01),
        doc: "Magnitude of gravity, along -z of the world.",
        get: |e| Some(e.gravity_m_s2),
        set: |e, value| e.gravity_m_s2 = value,
    },
];
