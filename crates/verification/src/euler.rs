//! Checks a body that tumbles in free space against a numerical solution of Euler's equations.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{MASS_KG, block, robot};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, measure, moving, weightless};
use realgap_core::error::Result;
use realgap_core::unit::Unit;

const SECONDS: f64 = 2.0;
/// Half of the body's edges: three different inertias.
const HALF_M: Vector3<f64> = Vector3::new(0.03, 0.06, 0.01);
/// Nearly about the axis of the middle moment of inertia, where spin is unstable, so that the body turns over.
const SPIN_BODY_RAD_S: Vector3<f64> = Vector3::new(8.0, 0.3, 0.5);
/// Smallest change of orientation that a camera resolves, radians.
const TURN_RAD: f64 = 0.0035;

/// Angle between the simulated orientation after two seconds and the solution of Euler's equations.
pub(super) fn check(settings: &Settings) -> Result<Check> {
    let solid = block(Vector3::zeros(), HALF_M, MASS_KG);
    let inertia_kg_m2 = solid.inertia_kg_m2.diagonal();
    let block = robot(vec![vec![solid]], Vec::new());
    let mut experiment = weightless(settings.experiment(block, SECONDS));
    experiment.start = moving(
        Vector3::zeros(),
        UnitQuaternion::identity(),
        Vector3::zeros(),
        SPIN_BODY_RAD_S,
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(Check::new(
        "energy.euler",
        "how far a block that turns over is from where it should point after 2 s at 8 rad/s: Euler's equations, integrated",
        0.0,
        measure(film.as_ref(), |film| {
            let last = film.last();
            let turned = last.parts[0].world_from_part.rotation;
            Some(turned.angle_to(&tumbled(inertia_kg_m2, last.time_s)))
        }),
        Unit::Radian,
        Tolerance::Absolute(TURN_RAD),
    ))
}

/// Orientation after a time: I dw/dt = (I w) x w in the body's frame, by Runge and Kutta's fourth order.
fn tumbled(inertia_kg_m2: Vector3<f64>, time_s: f64) -> UnitQuaternion<f64> {
    let rate = |w: Vector3<f64>| {
        let turning = inertia_kg_m2.component_mul(&w).cross(&w);
        turning.component_div(&inertia_kg_m2)
    };
    let (steps, mut w, mut turn) = (50_000, SPIN_BODY_RAD_S, UnitQuaternion::identity());
    let h = time_s / f64::from(steps);
    for _ in 0..steps {
        let k1 = rate(w);
        let k2 = rate(w + k1 * (0.5 * h));
        let k3 = rate(w + k2 * (0.5 * h));
        let k4 = rate(w + k3 * h);
        let middle = w + k1 * (0.5 * h);
        turn *= UnitQuaternion::from_scaled_axis(middle * h);
        w += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_with_one_inertia_turns_evenly() {
        let turned = tumbled(Vector3::repeat(1.0), 0.2);
        let right = UnitQuaternion::from_scaled_axis(SPIN_BODY_RAD_S * 0.2);
        assert!(turned.angle_to(&right) < 1e-9);
    }
}
