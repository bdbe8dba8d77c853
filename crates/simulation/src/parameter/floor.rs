//! Parameters of the floor and of gravity.

use super::{Nudge, Parameter, entry, field};
use realgap_robot::morphology::TurningFriction;

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("floor.friction", One, (0.0, 10.0), Linear, Nudge::Share(0.1),
        "Coulomb friction coefficient of the pair robot and floor.", floor.friction),
    field!("floor.restitution", One, (0.0, 1.0), Linear, Nudge::Absolute(0.05),
        "Restitution coefficient of the pair robot and floor.", floor.restitution),
    entry!("floor.rolling_m", Metre, TurningFriction::COEFFICIENTS_M, Linear, Nudge::Absolute(1e-4),
        "Rolling friction of the floor: the largest couple against rolling over the normal force, to which that of a shape is added; tree engine only.",
        |e, _| Some(e.floor.rolling_m.unwrap_or(0.0)), |e, _, value| e.floor.rolling_m = Some(value)),
    entry!("floor.torsional_m", Metre, TurningFriction::COEFFICIENTS_M, Linear, Nudge::Absolute(1e-4),
        "Torsional friction of the floor: the largest couple against spinning about the normal over the normal force, to which that of a shape is added; tree engine only.",
        |e, _| Some(e.floor.torsional_m.unwrap_or(0.0)), |e, _, value| e.floor.torsional_m = Some(value)),
    field!("floor.height_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "Height of the floor at the world origin.", floor.height_m),
    field!("floor.slope_rad", Radian, (-1.2, 1.2), Linear, Nudge::Absolute(0.01),
        "Slope of the floor about world y; positive is downhill towards +x.", floor.slope_rad),
    field!("gravity_m_s2", MetrePerSecondSquared, (0.0, 100.0), Linear, Nudge::Share(0.01),
        "Magnitude of gravity, along -z of the world.", gravity_m_s2),
];
