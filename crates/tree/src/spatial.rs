//! Spatial vectors: rotation and translation, or moment and force, in one column of six (Featherstone 2008, chapter 2).
//!
//! All spatial vectors of a tree are written in world axes about one point, the tree's reference. So vectors of a parent and of
//! its child can be combined without a transform, and a recursion along the tree consists of additions and dot products.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use parry3d_f64::math::{Mat3, Vec3};

/// A spatial vector: motion (angular velocity, velocity of the reference) or force (moment about the reference, force).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Spatial(pub [f64; 6]);

impl Spatial {
    pub const ZERO: Self = Self([0.0; 6]);

    #[inline]
    pub fn new(angular: Vec3, linear: Vec3) -> Self {
        Self([
            angular.x, angular.y, angular.z, linear.x, linear.y, linear.z,
        ])
    }

    /// A force that acts at `arm` from the reference; also the row of a Jacobian that reads the velocity of that point.
    #[inline]
    pub fn at(arm: Vec3, direction: Vec3) -> Self {
        Self::new(arm.cross(direction), direction)
    }

    #[inline]
    pub fn angular(&self) -> Vec3 {
        Vec3::new(self.0[0], self.0[1], self.0[2])
    }

    #[inline]
    pub fn linear(&self) -> Vec3 {
        Vec3::new(self.0[3], self.0[4], self.0[5])
    }

    /// Velocity of the point at `arm` from the reference.
    #[inline]
    pub fn velocity_at(&self, arm: Vec3) -> Vec3 {
        self.linear() + self.angular().cross(arm)
    }

    /// Power of a force along a motion.
    #[inline]
    pub fn dot(&self, other: &Self) -> f64 {
        let (a, b) = (&self.0, &other.0);
        (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5])
    }

    /// Adds `factor` times another.
    #[inline]
    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f64) {
        for (mine, its) in self.0.iter_mut().zip(&other.0) {
            *mine += its * factor;
        }
    }

    /// Rate of change of a motion vector that moves with this velocity: v × m (equation 2.31).
    #[inline]
    pub(crate) fn cross_motion(&self, motion: &Self) -> Self {
        let (w, v) = (self.angular(), self.linear());
        Self::new(
            w.cross(motion.angular()),
            v.cross(motion.angular()) + w.cross(motion.linear()),
        )
    }
}

impl Add for Spatial {
    type Output = Self;
    #[inline]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sub for Spatial {
    type Output = Self;
    #[inline]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}

impl AddAssign for Spatial {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        for (mine, its) in self.0.iter_mut().zip(&other.0) {
            *mine += its;
        }
    }
}

impl SubAssign for Spatial {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        for (mine, its) in self.0.iter_mut().zip(&other.0) {
            *mine -= its;
        }
    }
}

impl Mul<f64> for Spatial {
    type Output = Self;
    #[inline]
    fn mul(mut self, factor: f64) -> Self {
        for mine in &mut self.0 {
            *mine *= factor;
        }
        self
    }
}

impl Neg for Spatial {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self * -1.0
    }
}

/// A symmetric matrix of 6 × 6 by columns: an inertia, or the inverse of one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Symmetric(pub [[f64; 6]; 6]);

impl Symmetric {
    pub const ZERO: Self = Self([[0.0; 6]; 6]);

    /// Inertia about the reference of a body with its centre of mass at `arm` (equation 2.63).
    pub fn rigid(mass: f64, arm: Vec3, about_centre: &Mat3) -> Self {
        let first = arm * mass;
        let mut m = Self::ZERO;
        let (i, c) = (about_centre, arm);
        let xx = first.x * c.x;
        let yy = first.y * c.y;
        let zz = first.z * c.z;
        m.0[0][0] = i.x_axis.x + yy + zz;
        m.0[1][1] = i.y_axis.y + xx + zz;
        m.0[2][2] = i.z_axis.z + xx + yy;
        m.pair(0, 1, i.y_axis.x - first.x * c.y);
        m.pair(0, 2, i.z_axis.x - first.x * c.z);
        m.pair(1, 2, i.z_axis.y - first.y * c.z);
        // Angular momentum of a translation: first moment × velocity.
        m.pair(0, 4, -first.z);
        m.pair(0, 5, first.y);
        m.pair(1, 3, first.z);
        m.pair(1, 5, -first.x);
        m.pair(2, 3, -first.y);
        m.pair(2, 4, first.x);
        for k in 3..6 {
            m.0[k][k] = mass;
        }
        m
    }

    fn pair(&mut self, i: usize, j: usize, value: f64) {
        self.0[i][j] = value;
        self.0[j][i] = value;
    }

    #[inline]
    pub fn times(&self, vector: &Spatial) -> Spatial {
        let mut out = [0.0; 6];
        for (column, x) in self.0.iter().zip(&vector.0) {
            for (y, m) in out.iter_mut().zip(column) {
                *y += m * x;
            }
        }
        Spatial(out)
    }

    /// Adds another.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        for (mine, its) in self.0.iter_mut().zip(&other.0) {
            for (y, x) in mine.iter_mut().zip(its) {
                *y += x;
            }
        }
    }

    /// Adds a bᵀ.
    #[inline]
    pub(crate) fn add_outer(&mut self, a: &Spatial, b: &Spatial) {
        for (column, b) in self.0.iter_mut().zip(&b.0) {
            for (y, a) in column.iter_mut().zip(&a.0) {
                *y += a * b;
            }
        }
    }

    /// The inverse of a positive definite matrix, by Cholesky factorisation; `None` for any other matrix.
    pub fn inverse(&self) -> Option<Self> {
        // First L by rows, then its inverse in place, then L⁻ᵀ L⁻¹.
        let mut l = self.0;
        for i in 0..6 {
            for j in 0..=i {
                let mut sum = self.0[i][j];
                for (a, b) in l[i][..j].iter().zip(&l[j][..j]) {
                    sum -= a * b;
                }
                if i == j {
                    if sum <= 0.0 || !sum.is_finite() {
                        return None;
                    }
                    l[i][i] = 1.0 / sum.sqrt();
                } else {
                    l[i][j] = sum * l[j][j];
                }
            }
        }
        for i in 1..6 {
            for j in 0..i {
                let mut sum = 0.0;
                for (k, row) in l.iter().enumerate().take(i).skip(j) {
                    sum -= l[i][k] * row[j];
                }
                l[i][j] = sum * l[i][i];
            }
        }
        let mut inverse = Self::ZERO;
        for i in 0..6 {
            for j in 0..=i {
                let mut sum = 0.0;
                for row in &l[i..] {
                    sum += row[i] * row[j];
                }
                inverse.pair(i, j, sum);
            }
        }
        Some(inverse)
    }
}
