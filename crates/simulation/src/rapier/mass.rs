//! How much bodies weigh for the engine.

use nalgebra::Matrix3;

use super::to_matrix;
use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::MassProperties;
use realgap_robot::morphology::{Assembly, ClusterMass};

/// A link without mass weighs this share of the whole robot for the engine.
pub(crate) const LEAST_SHARE: f64 = 1e-9;
/// … and is as hard to turn as that mass at this distance, metres.
const LEAST_ARM_M: f64 = 0.01;

pub(crate) fn total_kg(assembly: &Assembly) -> f64 {
    let solids = assembly.parts.iter().flat_map(|part| &part.solids);
    solids.map(|solid| solid.mass_kg).sum()
}

/// The engine takes a body without mass for one that nothing moves: a link between two joints gets next to nothing.
pub(crate) fn weighable(mass: ClusterMass, least_kg: f64) -> ClusterMass {
    if mass.mass_kg > 0.0 {
        return mass;
    }
    ClusterMass {
        mass_kg: least_kg,
        inertia_kg_m2: Matrix3::from_diagonal_element(least_kg * LEAST_ARM_M * LEAST_ARM_M),
        ..mass
    }
}

/// What Parry makes of a body's inertia. It takes moments that differ by less than 1e-5 kg m² for equal, and turns their axes to
/// wherever it likes: a power of two makes them large enough for that, and changes no digit of what it returns
/// (docs/upstream/small_inertia.md).
pub(super) fn mass_properties(mass: &ClusterMass) -> MassProperties {
    let largest_kg_m2 = mass.inertia_kg_m2.amax();
    let is_usual = largest_kg_m2.is_normal() && largest_kg_m2 < 1.0;
    let up = match is_usual {
        true => (-largest_kg_m2.log2().floor()).exp2(),
        false => 1.0,
    };
    let mut properties = MassProperties::with_inertia_matrix(
        Vector::ZERO,
        mass.mass_kg,
        to_matrix(&(mass.inertia_kg_m2 * up)),
    );
    properties.inv_principal_inertia *= up;
    properties
}
