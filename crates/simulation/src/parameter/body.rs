//! Parameters of masses, inertias and centres of mass.

use super::{Nudge, Parameter, field};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("body.mass_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Factor on every mass; inertia follows.", adjustment.mass_scale),
    field!("body.inertia_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Further factor on every inertia.", adjustment.inertia_scale),
    field!("body.com_offset_x_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of every cube's centre of mass along the module's own x axis.", adjustment.centre_of_mass_offset_m.x),
    field!("body.com_offset_y_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of every cube's centre of mass along the module's own y axis.", adjustment.centre_of_mass_offset_m.y),
    field!("body.com_offset_z_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of every cube's centre of mass along the module's own z axis.", adjustment.centre_of_mass_offset_m.z),
    field!("body.edge_radius_m", Metre, (0.0, 0.5), Linear, Nudge::Absolute(0.001),
        "Radius of the edges and corners of every cube, less than half its side; 0 is sharp.", adjustment.edge_radius_m),
];
