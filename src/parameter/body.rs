//! Masses and where they sit.

use super::Parameter;
use crate::quantity::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "body.mass_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        doc: "Factor on every mass; inertia follows.",
        get: |e| Some(e.adjustment.mass_scale),
        set: |e, value| e.adjustment.mass_scale = value,
    },
    Parameter {
        name: "body.inertia_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        doc: "Further factor on every inertia.",
        get: |e| Some(e.adjustment.inertia_scale),
        set: |e, value| e.adjustment.inertia_scale = value,
    },
    Parameter {
        name: "body.com_offset_x_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        doc: "Shift of every cube's centre of mass along the module's own x axis.",
        get: |e| Some(e.adjustment.centre_of_mass_offset_m.x),
        set: |e, value| e.adjustment.centre_of_mass_offset_m.x = value,
    },
    Parameter {
        name: "body.com_offset_y_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        doc: "Shift of every cube's centre of mass along the module's own y axis.",
        get: |e| Some(e.adjustment.centre_of_mass_offset_m.y),
        set: |e, value| e.adjustment.centre_of_mass_offset_m.y = value,
    },
    Parameter {
        name: "body.com_offset_z_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        doc: "Shift of every cube's centre of mass along the module's own z axis.",
        get: |e| Some(e.adjustment.centre_of_mass_offset_m.z),
        set: |e, value| e.adjustment.centre_of_mass_offset_m.z = value,
    },
    Parameter {
        name: "body.edge_radius_m",
        unit: Unit::Metre,
        bounds: (0.0, 0.5),
        whole: false,
        doc: "Radius of the edges and corners of every cube, less than half its side; 0 is sharp.",
        get: |e| Some(e.adjustment.edge_radius_m),
        set: |e, value| e.adjustment.edge_radius_m = value,
    },
];
