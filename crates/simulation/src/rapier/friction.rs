//! Correction of Rapier's sliding friction: its direction becomes opposite to the slip.
//!
//! Rapier 0.36.1 caps the impulse that would stop the slip, K⁻¹v, in magnitude; K is the inverse effective mass of the contact in
//! the tangent plane. So friction points along K⁻¹v, not along v: a sliding cube brakes 6 % too little and a robot drifts
//! sideways. With the target tangent velocity `K v (v·v)/(v·K v) − v` of a contact, the impulse that Rapier computes is parallel
//! to v, and the cap then gives Coulomb's law. Measured in docs/validation.md.

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector3};

use super::driven::Driven;
use rapier3d_f64::dynamics::{MultibodyJointSet, RigidBodyHandle, RigidBodySet};
use rapier3d_f64::math::Vector;
use rapier3d_f64::pipeline::ContactModificationContext;

/// Below this slip a contact counts as sticking, so that the direction of friction does not matter, m/s. With a higher value, a
/// cube on a slope near the friction angle creeps at that speed.
const LEAST_SLIP_M_S: f64 = 1e-4;

/// Response of a multibody's links to an impulse: spatial velocity (linear, angular) of the link's
/// centre of mass per unit spatial impulse at it, J M⁻¹ Jᵀ.
type Response = SMatrix<f64, 6, 6>;

/// Corrects the friction of every sliding contact to the direction opposite to its slip.
#[derive(Default)]
pub(super) struct Friction {
    /// Responses of the links of multibodies; empty for robots with impulse joints.
    links: Vec<(RigidBodyHandle, Response)>,
    /// Rows of M⁻¹ Jᵀ of one link: a buffer that is reused.
    solved: Vec<SVector<f64, 6>>,
}

impl Friction {
    /// Recomputes the responses of the links of a multibody robot; has no effect for other robots.
    pub(crate) fn refresh(&mut self, joints: &MultibodyJointSet) {
        self.links.clear();
        for multibody in joints.multibodies() {
            let factors = multibody.inv_augmented_mass();
            let lu = factors.lu_internal();
            let freedoms = lu.nrows();
            let mut order = DVector::from_fn(freedoms, |row, _| row);
            factors.p().permute_rows(&mut order);
            for link in multibody.links() {
                let jacobian = multibody.body_jacobian(link.link_id());
                // Before the first step there is neither Jacobian nor mass matrix.
                if jacobian.ncols() == 0 || jacobian.ncols() != freedoms {
                    self.links.clear();
                    return;
                }
                self.solved.clear();
                let column = |&k: &usize| SVector::<f64, 6>::from_fn(|row, _| jacobian[(row, k)]);
                self.solved.extend(order.iter().map(column));
                solve(lu, &mut self.solved);
                let mut response = Response::zeros();
                for (k, row) in self.solved.iter().enumerate() {
                    response += column(&k) * row.transpose();
                }
                self.links.push((link.rigid_body_handle(), response));
            }
        }
    }

    /// Inverse effective mass of one side of a contact in two tangent directions.
    fn inverse_mass(
        &self,
        bodies: &RigidBodySet,
        handle: RigidBodyHandle,
        arm: Vector,
        tangents: [Vector; 2],
    ) -> [[f64; 2]; 2] {
        if let Some((_, response)) = self.links.iter().find(|(link, _)| *link == handle) {
            let wrench = tangents.map(|t| {
                let moment = arm.cross(t);
                SVector::<f64, 6>::from([t.x, t.y, t.z, moment.x, moment.y, moment.z])
            });
            // The solver's rows of a multibody contact are not coupled, so neither is this K.
            return [
                [wrench[0].dot(&(response * wrench[0])), 0.0],
                [0.0, wrench[1].dot(&(response * wrench[1]))],
            ];
        }
        let body = &bodies[handle];
        let inverse_mass = 1.0 / body.mass();
        let inverse_inertia = body.mass_properties().effective_world_inv_inertia;
        let moments = tangents.map(|t| arm.cross(t));
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let diagonal = if row == column { inverse_mass } else { 0.0 };
                diagonal + moments[row].dot(inverse_inertia * moments[column])
            })
        })
    }
}

impl Friction {
    /// Corrects the friction of one contact manifold; `driven` contains the velocities of driven bodies.
    pub(crate) fn oppose_slip(
        &self,
        context: &mut ContactModificationContext<'_>,
        driven: &[Driven],
    ) {
        let (first, second, bodies) = (context.rigid_body1, context.rigid_body2, context.bodies);
        let Some(manifold) = context.rigid_mut() else {
            return;
        };
        let tangents = tangents(-*manifold.normal);
        for contact in manifold.solver_contacts.iter_mut() {
            let mut slip = Vector::ZERO;
            let mut k = [[0.0; 2]; 2];
            for (handle, point, sign) in [
                (first, contact.anchor1, 1.0),
                (second, contact.anchor2, -1.0),
            ] {
                let Some(handle) = handle else { continue };
                let body = &bodies[handle];
                if !body.is_dynamic() {
                    if let Some(driven) = driven.iter().find(|driven| driven.body == handle) {
                        slip += driven.velocity_at(point) * sign;
                    }
                    continue;
                }
                let arm = point - body.center_of_mass();
                slip += (body.linvel() + body.angvel().cross(arm)) * sign;
                let side = self.inverse_mass(bodies, handle, arm, tangents);
                for row in 0..2 {
                    for column in 0..2 {
                        k[row][column] += side[row][column];
                    }
                }
            }
            let v = tangents.map(|t| slip.dot(t));
            let speed_squared = v[0] * v[0] + v[1] * v[1];
            if speed_squared < LEAST_SLIP_M_S * LEAST_SLIP_M_S {
                continue;
            }
            let kv = [
                k[0][0] * v[0] + k[0][1] * v[1],
                k[1][0] * v[0] + k[1][1] * v[1],
            ];
            let scale = speed_squared / (v[0] * kv[0] + v[1] * kv[1]);
            if scale.is_finite() {
                contact.tangent_velocity =
                    tangents[0] * (kv[0] * scale - v[0]) + tangents[1] * (kv[1] * scale - v[1]);
            }
        }
    }
}

/// Solves L U X = B in place, six columns at once; `lu` holds both factors, L with a unit diagonal. nalgebra's own solver takes
/// ten times as long for matrices this small.
fn solve(lu: &DMatrix<f64>, rows: &mut [SVector<f64, 6>]) {
    for i in 0..rows.len() {
        for j in 0..i {
            rows[i] -= rows[j] * lu[(i, j)];
        }
    }
    for i in (0..rows.len()).rev() {
        for j in i + 1..rows.len() {
            rows[i] -= rows[j] * lu[(i, j)];
        }
        rows[i] /= lu[(i, i)];
    }
}

/// Two unit vectors that complete `normal` to a right-handed basis, chosen as the solver chooses its own
/// (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
fn tangents(normal: Vector) -> [Vector; 2] {
    let n = Vector3::new(normal.x, normal.y, normal.z);
    let sign: f64 = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let first = Vector::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    [first, normal.cross(first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solver_for_six_columns_agrees_with_nalgebra() {
        let n = 9;
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            ((7 * i + 3 * j) % 11) as f64 + if i == j { 9.0 } else { 0.0 }
        });
        let right = DMatrix::from_fn(n, 6, |i, j| ((5 * i + j) % 7) as f64 - 3.0);
        let factors = matrix.lu();
        let expected = factors.solve(&right).unwrap();
        let mut order = DVector::from_fn(n, |row, _| row);
        factors.p().permute_rows(&mut order);
        let mut rows: Vec<SVector<f64, 6>> = order
            .iter()
            .map(|&k| SVector::from_fn(|column, _| right[(k, column)]))
            .collect();
        solve(factors.lu_internal(), &mut rows);
        for (k, row) in rows.iter().enumerate() {
            for column in 0..6 {
                assert!((row[column] - expected[(k, column)]).abs() < 1e-5);
            }
        }
    }
}
