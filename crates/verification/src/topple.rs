//! Checks how long a cube on its plate takes to fall over the plate's edge.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{
    CUBE_ON_PLATE_M, MASS_KG, PLATE_HALF_M, PLATE_KG, PLATE_THICKNESS_M, SIDE_M, STILL, on_plate,
    velocity_servo,
};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, measure};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_simulation::JointFormulation;

/// Angles beyond the balance between which the fall is timed, radians: at the start, and at the end.
const FROM_RAD: f64 = 0.05;
const TO_RAD: f64 = 0.5;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for &kind in settings.kinds() {
        checks.push(fall(settings, kind)?);
    }
    Ok(checks)
}

/// The cube and its plate as one body about the plate's edge.
struct Block {
    /// Distance of the centre of mass from the edge, metres.
    arm_m: f64,
    /// Angle between the plate's underside and the line from the edge to the centre of mass, radians.
    rise_rad: f64,
    /// Inertia about the edge, kg m².
    inertia_kg_m2: f64,
}

fn block() -> Block {
    let centre_m =
        (MASS_KG * CUBE_ON_PLATE_M + PLATE_KG * 0.5 * PLATE_THICKNESS_M) / (MASS_KG + PLATE_KG);
    let about_edge = |mass_kg: f64, height_m: f64, wide_m: f64, high_m: f64| {
        mass_kg
            * ((wide_m * wide_m + high_m * high_m) / 12.0
                + PLATE_HALF_M.powi(2)
                + height_m * height_m)
    };
    Block {
        arm_m: PLATE_HALF_M.hypot(centre_m),
        rise_rad: centre_m.atan2(PLATE_HALF_M),
        inertia_kg_m2: about_edge(MASS_KG, CUBE_ON_PLATE_M, SIDE_M, SIDE_M)
            + about_edge(
                PLATE_KG,
                0.5 * PLATE_THICKNESS_M,
                2.0 * PLATE_HALF_M,
                PLATE_THICKNESS_M,
            ),
    }
}

/// Time from rest at `FROM_RAD` to `TO_RAD` beyond the balance, seconds: ∫ dθ/ω with I ω²/2 = m g r (cos θ₀ − cos θ).
/// The substitution θ = θ₀ + u² removes the singularity at the start; Simpson's rule integrates the result.
fn closed_form_s(block: &Block) -> f64 {
    let rate = 2.0 * (MASS_KG + PLATE_KG) * GRAVITY_M_S2 * block.arm_m / block.inertia_kg_m2;
    let integrand = |u: f64| {
        // cos θ₀ − cos(θ₀ + u²) = 2 sin(θ₀ + u²/2) sin(u²/2), and 2u/√sin(u²/2) → 2√2 for u → 0.
        let half = 0.5 * u * u;
        let shape = if u == 0.0 {
            8.0
        } else {
            4.0 * u * u / half.sin()
        };
        (shape / (2.0 * rate * (FROM_RAD + half).sin())).sqrt()
    };
    let (pieces, end) = (1000, (TO_RAD - FROM_RAD).sqrt());
    let width = end / f64::from(pieces);
    let sum: f64 = (0..=pieces)
        .map(|k| {
            let weight = match k {
                0 => 1.0,
                _ if k == pieces => 1.0,
                _ if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * integrand(f64::from(k) * width)
        })
        .sum();
    sum * width / 3.0
}

/// Leaning over the plate's edge, friction high enough that it does not slip.
fn fall(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let block = block();
    // In balance the centre of mass is straight above the edge.
    let balance_rad = std::f64::consts::FRAC_PI_2 - block.rise_rad;
    let lean_rad = balance_rad + FROM_RAD;
    let lean = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), lean_rad);
    let mut experiment = settings.experiment(on_plate(velocity_servo(30.0, 0.2, 8.0), STILL), 1.0);
    experiment.solver.joint = kind;
    experiment.floor.friction = 2.0;
    // The edge at +x of the plate's underside stands on the floor at the origin.
    let edge_m = Vector3::new(PLATE_HALF_M, 0.0, -CUBE_ON_PLATE_M);
    experiment.start = at_rest(-(lean * edge_m), lean);
    let film = SimulationLog::record(&experiment, &[])?;
    let lean_of = |snapshot: &realgap_simulation::Snapshot| {
        let up = snapshot.parts[0].world_from_part * Vector3::z();
        up.x.atan2(up.z) - balance_rad
    };
    let measured = measure(film.as_ref(), |film| {
        film.pairs().find_map(|(a, b)| {
            let (before, after) = (lean_of(a) - TO_RAD, lean_of(b) - TO_RAD);
            (before < 0.0 && after >= 0.0)
                .then(|| a.time_s + (b.time_s - a.time_s) * before / (before - after))
        })
    });
    Ok(Check::new(
        format!("standing.topple.{}", settings.joint_name(kind)),
        "time that a cube on its plate takes to fall over the plate's edge from 0.05 to 0.5 rad beyond the balance: integral of d theta / omega",
        closed_form_s(&block),
        measured,
        Unit::Second,
        Tolerance::Relative(0.02),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_agrees_with_a_step_by_step_simulation_of_the_motion() {
        let block = block();
        let rate = (MASS_KG + PLATE_KG) * GRAVITY_M_S2 * block.arm_m / block.inertia_kg_m2;
        let (mut angle, mut speed, mut time_s, step_s) = (FROM_RAD, 0.0, 0.0, 1e-6);
        while angle < TO_RAD {
            speed += step_s * rate * f64::sin(angle + 0.5 * step_s * speed);
            angle += step_s * speed;
            time_s += step_s;
        }
        assert!((closed_form_s(&block) - time_s).abs() < 1e-4 * time_s);
    }
}
