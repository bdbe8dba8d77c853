//! The fastest vibration of a robot's joints on their springs and servos.

use nalgebra::DMatrix;

use super::assembly::{Assembly, Hinge};
use super::law::ServoLaw;

/// A joint whose damping is above this share of the critical one hardly vibrates: engines follow it with any timestep.
const DAMPED: f64 = 0.5;
/// Robots of more joints are not looked at: the time would grow with the cube of their number.
const MOST: usize = 300;

/// The joint that vibrates fastest on its spring or servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffestJoint {
    /// Index of its hinge.
    pub hinge: usize,
    /// The inverse of its angular frequency while all other joints are free: with solves of half of it, a vibration of the spring keeps its
    /// period within 2 %.
    pub timestep_s: f64,
}

/// Stiffness and damping of a joint by its bearing and its servo.
fn resistance(hinge: &Hinge) -> (f64, f64) {
    let servo = hinge.actuator.map(|actuator| actuator.servo.law);
    let (stiffness, damping) = match servo {
        Some(ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        }) => (stiffness_nm_rad, damping_nm_s_rad),
        _ => (0.0, 0.0),
    };
    let bearing = &hinge.bearing;
    let spring = bearing.spring.map_or(0.0, |spring| spring.stiffness_nm_rad);
    (stiffness + spring, damping + bearing.viscous_nm_s_rad)
}

impl Assembly {
    /// The joint that vibrates fastest, at the start; `None` where no joint has a spring or a servo with stiffness that is not damped.
    pub fn stiffest_joint(&self) -> Option<StiffestJoint> {
        let stiff = |hinge: &Hinge| resistance(hinge).0 > 0.0;
        if self.is_modular || self.hinges.len() > MOST || !self.hinges.iter().any(stiff) {
            return None;
        }
        let hinges = self.hinges.iter();
        let start: Vec<f64> = hinges.map(|hinge| hinge.start_rad.unwrap_or(0.0)).collect();
        let rows = self.dynamics(&start).mass_matrix;
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
        let inverse = matrix.cholesky()?.inverse();
        let steps = self.hinges.iter().enumerate().filter_map(|(index, hinge)| {
            let (stiffness, damping) = resistance(hinge);
            // The inertia of a joint while all others are free.
            let inertia = 1.0 / inverse[(index, index)];
            let critical = 2.0 * (stiffness * inertia).sqrt();
            (stiffness > 0.0 && damping < DAMPED * critical).then(|| StiffestJoint {
                hinge: index,
                timestep_s: (inertia / stiffness).sqrt(),
            })
        });
        steps.min_by(|a, b| a.timestep_s.total_cmp(&b.timestep_s))
    }
}
