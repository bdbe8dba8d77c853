//! Changes of an inertia tensor that any fit may make, because no value of theirs gives a body that cannot exist.
//!
//! A rigid body has the inertia I about its centre of mass if, and only if, the second moments of its mass, Σ = ½ tr(I) 1 − I, are positive
//! semidefinite; this contains the triangle inequality of the principal moments (Wensing, Kim & Slotine, "Linear Matrix Inequalities for
//! Physically-Consistent Inertial Parameter Identification", IEEE Robotics and Automation Letters 3(1), 2018, pages 60–67). With Σ = L Lᵀ, a
//! triangular factor whose diagonal is an exponential covers all of them without any bound: the log-Cholesky parametrisation of Rucker &
//! Wensing, "Smooth Parameterization of Rigid-Body Inertia", IEEE Robotics and Automation Letters 7(2), 2022, pages 2771–2778, here about
//! the centre of mass and relative to the inertia that the robot's file states.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A relative change of a body's inertia: of the distribution of its mass, which keeps mass and centre of mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InertiaChange {
    /// Logarithms of the factors by which the mass is spread along x, y and z of the body's own frame.
    pub stretch: Vector3<f64>,
    /// Shears of the distribution: of y along x, of z along y, of z along x.
    pub shear: Vector3<f64>,
}

impl InertiaChange {
    /// Whether it changes nothing.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The changed inertia about the centre of mass. An inertia that no body can have is first replaced by the nearest one that a body can.
    pub fn apply(&self, inertia: &Matrix3<f64>) -> Matrix3<f64> {
        if self.is_none() {
            return *inertia;
        }
        let moments = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
        let root = square_root(&moments);
        let [x, y, z] = [0, 1, 2].map(|axis| self.stretch[axis].exp());
        let s = &self.shear;
        let change = Matrix3::new(x, s.x, s.z, 0.0, y, s.y, 0.0, 0.0, z);
        let half = change * root;
        let moments = half * half.transpose();
        Matrix3::identity() * moments.trace() - moments
    }
}

/// A matrix whose product with its transpose is the positive semidefinite part of `of`: its symmetric square root.
fn square_root(of: &Matrix3<f64>) -> Matrix3<f64> {
    let parts = SymmetricEigen::new(*of);
    let roots = parts.eigenvalues.map(|value| value.max(0.0).sqrt());
    parts.eigenvectors * Matrix3::from_diagonal(&roots) * parts.eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2 kg.
    fn of_box(x: f64, y: f64, z: f64) -> Matrix3<f64> {
        let m = 2.0 / 12.0;
        Matrix3::from_diagonal(&Vector3::new(
            m * (y * y + z * z),
            m * (x * x + z * z),
            m * (x * x + y * y),
        ))
    }

    #[test]
    fn a_stretched_box_has_the_inertia_of_the_longer_box() {
        let change = InertiaChange {
            stretch: Vector3::new(2.0_f64.ln(), 0.0, 3.0_f64.ln()),
            shear: Vector3::zeros(),
        };
        let found = change.apply(&of_box(0.1, 0.2, 0.3));
        assert!((found - of_box(0.2, 0.2, 0.9)).norm() < 1e-12, "{found}");
        let none = InertiaChange::default();
        assert_eq!(none.apply(&of_box(0.1, 0.2, 0.3)), of_box(0.1, 0.2, 0.3));
    }

    #[test]
    fn no_change_gives_an_inertia_that_no_body_can_have() {
        // SplitMix-like draws from -3 to 3; thin bodies, too.
        let mut seed = 1_u64;
        let mut draw = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            6.0 * ((seed >> 33) as f64 / (1u64 << 31) as f64) - 3.0
        };
        for thin in [0.3, 0.0] {
            for _ in 0..500 {
                let mut vector = || Vector3::from_fn(|_, _| draw());
                let change = InertiaChange {
                    stretch: vector(),
                    shear: vector(),
                };
                let inertia = change.apply(&of_box(0.1, 0.2, thin));
                let mut moments = SymmetricEigen::new(inertia).eigenvalues;
                moments.as_mut_slice().sort_by(f64::total_cmp);
                let least = -1e-12 * moments[2];
                assert!(moments[0] >= least, "{moments}");
                assert!(moments[0] + moments[1] - moments[2] >= least, "{moments}");
            }
        }
    }

    #[test]
    fn every_number_of_a_change_is_told_from_the_others() {
        let inertia = of_box(0.1, 0.2, 0.3);
        let changed = |number: usize| {
            let mut change = InertiaChange::default();
            match number {
                0..3 => change.stretch[number] = 0.2,
                _ => change.shear[number - 3] = 0.2,
            }
            change.apply(&inertia)
        };
        for a in 0..6 {
            for b in 0..a {
                assert!((changed(a) - changed(b)).norm() > 1e-4, "{a} {b}");
            }
        }
    }
}
