//! Parameters of the floor and of gravity.

use super::{Nudge, Parameter, field};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("floor.friction", One, (0.0, 10.0), Linear, Nudge::Share(0.1),
        "Coulomb friction coefficient of the pair robot and floor.", floor.friction),
    field!("floor.restitution", One, (0.0, 1.0), Linear, Nudge::Absolute(0.05),
        "Restitution coefficient of the pair robot and floor.", floor.restitution),
    field!("floor.height_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "Height of the floor at the world origin.", floor.height_m),
    field!("floor.slope_rad", Radian, (-1.2, 1.2), Linear, Nudge::Absolute(0.01),
        "Slope of the floor about world y; positive is downhill towards +x.", floor.slope_rad),
    field!("gravity_m_s2", MetrePerSecondSquared, (0.0, 100.0), Linear, Nudge::Share(0.01),
        "Magnitude of gravity, along -z of the world.", gravity_m_s2),
];
