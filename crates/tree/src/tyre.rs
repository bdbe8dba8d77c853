//! A tyre: friction that grows with the slip, up to Coulomb's limit.
//!
//! The slip is the velocity of the tyre's surface against the ground over the speed at which the tyre travels, the larger one of
//! the speeds of its hub and of its rim over the ground. Slip along and across the tyre act together: the force is opposite to
//! the slip and follows the Magic Formula (Bakker, Nyborg and Pacejka 1987; Pacejka, *Tire and Vehicle Dynamics*, 2012, section
//! 4.3) without curvature and offsets: µ N sin(C atan(B s)) with B = k / (C µ), where k is the slip stiffness. For small slips
//! the force is k N s, whatever the friction coefficient µ is. A tyre at rest sticks as any other body does.

use parry3d_f64::math::Vec3;

/// The law of a tyre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tyre {
    /// Force per slip and per load at a small slip, k: the cornering stiffness over the load, 1/rad.
    pub slip_stiffness_1_rad: f64,
    /// Shape of the curve, C, from 1 to 2: with 1 the force grows up to Coulomb's limit; above, it has its peak there and falls
    /// to µ N sin(C π/2).
    pub shape: f64,
}

/// Below this speed of travel the slip counts as that at this speed, m/s: a tyre that hardly moves sticks.
const SLOWEST_M_S: f64 = 1e-3;

impl Tyre {
    /// Whether the numbers are allowed.
    pub(crate) fn is_sound(&self) -> bool {
        let stiff = self.slip_stiffness_1_rad > 0.0 && self.slip_stiffness_1_rad.is_finite();
        stiff && (1.0..2.0).contains(&self.shape)
    }

    /// Friction force over load at a slip.
    pub fn force_per_load(&self, slip: f64, friction: f64) -> f64 {
        if friction <= 0.0 {
            return 0.0;
        }
        let b = self.slip_stiffness_1_rad / (self.shape * friction);
        friction * (self.shape * (b * slip).atan()).sin()
    }

    /// Slip velocity per friction force over load (the secant of the law), m/s: infinite without friction.
    ///
    /// `slip_m_s` is the velocity of the surface over the ground, `hub_m_s` that of the hub.
    pub(crate) fn speed_per_force(&self, slip_m_s: Vec3, hub_m_s: Vec3, friction: f64) -> f64 {
        let travel_m_s = hub_m_s.length().max((slip_m_s - hub_m_s).length());
        let travel_m_s = travel_m_s.max(SLOWEST_M_S);
        let slip = slip_m_s.length() / travel_m_s;
        if friction <= 0.0 {
            return f64::INFINITY;
        }
        // At a vanishing slip the secant is the tangent.
        let secant = match slip > 1e-9 {
            true => self.force_per_load(slip, friction) / slip,
            false => self.slip_stiffness_1_rad,
        };
        travel_m_s / secant
    }
}
