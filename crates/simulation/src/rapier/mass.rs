//! Mass properties of bodies in Rapier, including replacements for links without mass.

use nalgebra::Matrix3;

use super::to_matrix;
use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::MassProperties;
use realgap_robot::morphology::{Assembly, ClusterMass};

/// A link without mass gets this fraction of the robot's mass in the engine.
pub(crate) const LEAST_SHARE: f64 = 1e-9;
/// Radius of gyration of such a link, metres.
const LEAST_ARM_M: f64 = 0.01;

pub(crate) fn total_kg(assembly: &Assembly) -> f64 {
    let solids = assembly.parts.iter().flat_map(|part| &part.solids);
    solids.map(|solid| solid.mass_kg).sum()
}

/// Replaces zero mass by a negligible one, because the engine treats a body without mass as immovable.
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

/// Parry's form of a body's mass properties. Parry treats moments that differ by less than 1e-5 kg m² as equal and then chooses
/// arbitrary axes. Scaling the inertia by a power of two makes the moments large enough, and does not change the digits of the
/// result (docs/upstream/small_inertia.md).
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
