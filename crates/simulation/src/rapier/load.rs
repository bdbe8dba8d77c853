//! Contact impulses on the parts of the robot during the previous step, read from Rapier.

use nalgebra::Vector3;

use super::{RapierWorld, from_vector};
use crate::engine::Load;
use rapier3d_f64::geometry::NEW_CONTACT_BIT;

impl RapierWorld {
    /// All contacts of the previous step, once for each part of the robot that is in contact.
    pub(super) fn read_loads(&self, loads: &mut Vec<Load>) {
        loads.clear();
        let part_of = |handle| self.parts.iter().position(|part| Some(part.body) == handle);
        let pairs = self.narrow_phase.contact_pairs();
        let manifolds = pairs
            .filter_map(|pair| pair.rigid())
            .flat_map(|rigid| rigid.solver_manifolds());
        for manifold in manifolds.filter(|manifold| !manifold.data.solver_contacts.is_empty()) {
            let data = &manifold.data;
            let direction = -from_vector(data.normal);
            let [across, along] = tangents(&direction);
            let sides = [part_of(data.rigid_body1), part_of(data.rigid_body2)];
            for contact in data.solver_contacts.iter() {
                let index = (contact.contact_id[0] & !NEW_CONTACT_BIT) as usize;
                let Some(point) = manifold.points.get(index) else {
                    continue;
                };
                let done = &point.data;
                let normal_n_s = direction * done.impulse;
                let friction_n_s = across * done.tangent_impulse.x + along * done.tangent_impulse.y;
                let arms = [done.solver_dp1, done.solver_dp2];
                for ((part, arm), sign) in sides.into_iter().zip(arms).zip([1.0, -1.0]) {
                    if let Some(part) = part {
                        loads.push(Load {
                            part,
                            arm_world_m: from_vector(arm),
                            normal_world_n_s: normal_n_s * sign,
                            friction_world_n_s: friction_n_s * sign,
                            couple_world_n_m_s: Vector3::zeros(),
                        });
                    }
                }
            }
        }
    }
}

/// The two directions across a contact's normal in which the solver counts friction (Duff et al. 2017).
fn tangents(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let sign = 1.0_f64.copysign(direction.z);
    let a = -1.0 / (sign + direction.z);
    let b = direction.x * direction.y * a;
    let first = Vector3::new(b, sign + direction.y * direction.y * a, -direction.y);
    [first, direction.cross(&first)]
}
