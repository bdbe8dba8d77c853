//! Friction against rolling and spinning: a couple between two surfaces in contact, opposite to their relative rotation.
//!
//! The couple about the normal is at most the torsional coefficient times the normal force, and the couple about the tangents at
//! most the rolling coefficient times the normal force. Both coefficients are lengths, as in MuJoCo (Todorov 2014): the rolling one
//! is the distance by which the normal force acts ahead of the contact point (Johnson, *Contact Mechanics*, 1985, section 9.1).
//! Below its limit, a couple holds the surfaces still. A row does the work of a brake, which never adds energy.

use parry3d_f64::math::Vec3;

use crate::contact::{Side, friction, principal};
use crate::spatial::Spatial;
use crate::touch::Touch;

/// The law of friction against rolling and spinning. The coefficients of a pair are the sums of those of both shapes: the losses
/// of both materials add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TurningFriction {
    /// Largest couple about the tangents over the normal force, m.
    pub rolling_m: f64,
    /// Largest couple about the normal over the normal force, m.
    pub torsional_m: f64,
}

impl TurningFriction {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.rolling_m == 0.0 && self.torsional_m == 0.0
    }

    /// Whether the numbers are allowed.
    pub(crate) fn is_sound(&self) -> bool {
        let values = [self.rolling_m, self.torsional_m];
        values
            .iter()
            .all(|value| *value >= 0.0 && value.is_finite())
    }

    /// The coefficients of a pair.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self {
            rolling_m: self.rolling_m + other.rolling_m,
            torsional_m: self.torsional_m + other.torsional_m,
        }
    }
}

/// The rows of a couple at a contact point: about the normal and two tangents.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Couple {
    pub a: Side,
    /// The other body's side; zero against a fixture.
    pub b: Side,
    pub basis: [Vec3; 3],
    /// Angular velocity of the fixture, in the basis.
    led: [f64; 3],
    /// Angular velocity per unit couple: about the normal, and about the tangents.
    normal_k: f64,
    tangent_k: [f64; 2],
    /// Remaining angular velocity per unit couple of a rolling contact.
    slip_per_impulse: f64,
    law: TurningFriction,
    /// Angular impulse, in the basis, N m s.
    pub impulse: [f64; 3],
}

/// Smallest angular velocity per unit couple, as a fraction of the inverse mass of the trees, 1/m².
const LEAST: f64 = 1e-6;

/// Lever that converts the angular velocity of a couple's row into a speed comparable with that of contacts, m.
pub(crate) const LEVER_M: f64 = 0.05;

/// Rounds in which the rows of a contact point and its couple are solved together, and the change of speed that ends them, m/s: a
/// ball that comes to rest sticks in both at once.
pub(crate) const ROUNDS: usize = 40;
pub(crate) const SETTLED_M_S: f64 = 1e-13;

impl Couple {
    /// Builds the rows with the basis of the contact point; the responses of the bodies are added later by [`Couple::weigh`].
    pub fn new(touch: &Touch, basis: [Vec3; 3]) -> Self {
        let rows = |sign: f64| Side {
            jacobian: basis.map(|axis| Spatial::new(axis * sign, Vec3::ZERO)),
            ..Side::default()
        };
        Self {
            a: rows(1.0),
            b: rows(-1.0),
            basis,
            led: basis.map(|axis| touch.led_turn_world_rad_s.dot(axis)),
            normal_k: 0.0,
            tangent_k: [0.0; 2],
            slip_per_impulse: 0.0,
            law: touch.turning,
            impulse: basis.map(|axis| touch.couple_world_n_m_s.dot(axis)),
        }
    }

    /// Completes the rows once the responses of both bodies are known, and rotates the tangents to the principal directions.
    pub fn weigh(&mut self, whole_k: f64) {
        let (a, b) = (self.a, self.b);
        let give = |i: usize, j: usize| {
            a.jacobian[i].dot(&a.response[j]) + b.jacobian[i].dot(&b.response[j])
        };
        let least = LEAST * whole_k;
        self.normal_k = give(0, 0).max(least);
        let ([most, fewest], [c, s]) = principal(give(1, 1), give(2, 1), give(2, 2));
        self.tangent_k = [most.max(least), fewest.max(least)];
        if s == 0.0 {
            return;
        }
        let [_, t, u] = self.basis;
        (self.basis[1], self.basis[2]) = (t * c + u * s, u * c - t * s);
        for pair in [&mut self.led, &mut self.impulse] {
            (pair[1], pair[2]) = (c * pair[1] + s * pair[2], c * pair[2] - s * pair[1]);
        }
        self.a.turn([c, s]);
        self.b.turn([c, s]);
    }

    /// The angular impulse on the first body, world frame, N m s.
    pub fn impulse_world(&self) -> Vec3 {
        let [n, t, u] = self.basis;
        n * self.impulse[0] + t * self.impulse[1] + u * self.impulse[2]
    }

    /// Solves the rows once under a normal impulse; changes the velocities and returns the change of the angular impulse.
    pub fn solve(
        &mut self,
        normal_n_s: f64,
        a: &mut Spatial,
        mut b: Option<&mut Spatial>,
    ) -> [f64; 3] {
        let before = self.impulse;
        let slip = |couple: &Self, i: usize, a: &Spatial, b: &Option<&mut Spatial>| {
            let its = b.as_ref().map_or(0.0, |b| couple.b.jacobian[i].dot(b));
            couple.a.jacobian[i].dot(a) + its - couple.led[i]
        };
        let most = self.law.torsional_m * normal_n_s;
        let wish = before[0] - slip(self, 0, a, &b) / self.normal_k;
        self.impulse[0] = wish.clamp(-most, most);
        self.apply(0, self.impulse[0] - before[0], a, &mut b);
        let [t, u] = self.tangent_k;
        let wish = [
            t * before[1] - slip(self, 1, a, &b),
            u * before[2] - slip(self, 2, a, &b),
        ];
        let most = self.law.rolling_m * normal_n_s;
        let now = match most > 0.0 {
            true => friction(&self.tangent_k, wish, most, &mut self.slip_per_impulse),
            false => [0.0; 2],
        };
        for (row, now) in [(1, now[0]), (2, now[1])] {
            self.impulse[row] = now;
            self.apply(row, now - before[row], a, &mut b);
        }
        [0, 1, 2].map(|row| self.impulse[row] - before[row])
    }

    fn apply(&self, row: usize, change: f64, a: &mut Spatial, b: &mut Option<&mut Spatial>) {
        a.add_scaled(&self.a.response[row], change);
        if let Some(b) = b {
            b.add_scaled(&self.b.response[row], change);
        }
    }

    /// Work of the couple at these mean velocities.
    pub fn work(&self, a: &Spatial, b: Option<&Spatial>) -> f64 {
        let mut work = 0.0;
        for (row, impulse) in self.impulse.iter().enumerate() {
            let its = b.map_or(0.0, |b| self.b.jacobian[row].dot(b));
            work += impulse * (self.a.jacobian[row].dot(a) + its - self.led[row]);
        }
        work
    }

    /// Change of the relative rotation due to a change of the angular impulse, as a speed, m/s.
    pub fn speed_of(&self, change: &[f64; 3]) -> f64 {
        let turn_rad_s = (change[0] * self.normal_k).abs()
            + (change[1] * self.tangent_k[0]).abs()
            + (change[2] * self.tangent_k[1]).abs();
        turn_rad_s * LEVER_M
    }
}
