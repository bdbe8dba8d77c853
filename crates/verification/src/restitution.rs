//! Checks of restitution: bounce heights of cubes that are dropped flat, on a corner and tilted.

use nalgebra::{UnitQuaternion, Vector3};

use super::body::{MASS_KG, SIDE_M, cube};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, at_rest, measure};
use super::{Settings, impact};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};

/// Gap under the lowest point at the start, metres.
const DROP_M: f64 = 0.1;
/// Tolerances of the heights of the first and second bounce. Restitution is fitted to two digits at best: an error of 2.5 % in
/// it is one of 5 % in the height of the first bounce, and of 10 % in that of the second.
const FIRST: f64 = 0.05;
const SECOND: f64 = 0.10;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let flat = UnitQuaternion::identity();
    // The cube lands on a corner with its centre right above that corner: the impulse has no lever arm, so the cube bounces
    // like a ball.
    let corner = UnitQuaternion::rotation_between(&Vector3::new(1.0, 1.0, 1.0), &Vector3::z())
        .unwrap_or_default();
    let mut checks = Vec::new();
    for (name, turn) in [("flat", flat), ("corner", corner)] {
        for restitution in [0.3, 0.5, 0.8] {
            let apexes = bounces_m(settings, turn, restitution)?;
            let square = restitution * restitution;
            checks.push(Check::new(
                format!("restitution.{name}.first.{restitution}"),
                format!("height of the first bounce of a cube dropped {name} from 0.1 m: e^2 h"),
                square * DROP_M,
                apexes[0],
                Unit::Metre,
                Tolerance::Relative(FIRST),
            ));
            if restitution > 0.4 {
                checks.push(Check::new(
                    format!("restitution.{name}.second.{restitution}"),
                    format!(
                        "height of the second bounce of a cube dropped {name} from 0.1 m: e^4 h"
                    ),
                    square * square * DROP_M,
                    apexes[1],
                    Unit::Metre,
                    Tolerance::Relative(SECOND),
                ));
            }
        }
    }
    let edge = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.5);
    let skew = UnitQuaternion::from_scaled_axis(Vector3::new(0.5, 0.3, 0.0));
    for (name, turn) in [("edge", edge), ("skew", skew)] {
        checks.extend(tilted(settings, name, turn)?);
    }
    checks.extend(impact::checks(settings)?);
    Ok(checks)
}

/// Arms from the centre to the eight corners, world frame.
fn corners_m(turn: UnitQuaternion<f64>) -> Vec<Vector3<f64>> {
    let half = 0.5 * SIDE_M;
    let signs = [-half, half];
    signs
        .iter()
        .flat_map(|&x| signs.iter().map(move |&y| (x, y)))
        .flat_map(|(x, y)| signs.iter().map(move |&z| turn * Vector3::new(x, y, z)))
        .collect()
}

/// Mean arm of the lowest corners.
fn lowest_arm_m(turn: UnitQuaternion<f64>) -> Vector3<f64> {
    let corners = corners_m(turn);
    let lowest = corners.iter().map(|c| c.z).fold(f64::INFINITY, f64::min);
    let touching: Vec<_> = corners.iter().filter(|c| c.z < lowest + 1e-9).collect();
    touching.iter().copied().sum::<Vector3<f64>>() / touching.len() as f64
}

fn drop(
    settings: &Settings,
    turn: UnitQuaternion<f64>,
    restitution: f64,
    seconds: f64,
) -> Result<Option<SimulationLog>> {
    let mut experiment = settings.experiment(cube(), seconds);
    experiment.floor.friction = 0.0;
    experiment.floor.restitution = restitution;
    let height_m = DROP_M - lowest_arm_m(turn).z;
    experiment.start = at_rest(Vector3::new(0.0, 0.0, height_m), turn);
    SimulationLog::record(&experiment, &[])
}

/// Heights of the first and second bounce above the height of contact.
fn bounces_m(settings: &Settings, turn: UnitQuaternion<f64>, restitution: f64) -> Result<[f64; 2]> {
    let fall_s = (2.0 * DROP_M / GRAVITY_M_S2).sqrt();
    let seconds = fall_s * (1.0 + 2.0 * restitution + 2.2 * restitution * restitution);
    let film = drop(settings, turn, restitution, seconds)?;
    let touching_m = -lowest_arm_m(turn).z;
    let apex = |number: usize| {
        measure(film.as_ref(), |film| {
            film.pairs()
                .filter(|(a, b)| {
                    a.parts[0].velocity_world_m_s.z > 0.0 && b.parts[0].velocity_world_m_s.z <= 0.0
                })
                .map(|(a, b)| a.parts[0].centre_world_m.z.max(b.parts[0].centre_world_m.z))
                .nth(number)
                .map(|z| z - touching_m)
        })
    };
    Ok([apex(0), apex(1)])
}

/// A frictionless impact on an edge or corner that is not below the centre: the impulse (1 + e) v / k with
/// k = 1/m + (r × n) · I⁻¹ (r × n) changes the vertical speed and starts a spin.
fn tilted(settings: &Settings, name: &str, turn: UnitQuaternion<f64>) -> Result<[Check; 2]> {
    let restitution = 0.5;
    let fall_s = (2.0 * DROP_M / GRAVITY_M_S2).sqrt();
    let speed_m_s = GRAVITY_M_S2 * fall_s;
    let inertia_kg_m2 = MASS_KG * SIDE_M * SIDE_M / 6.0;
    let lever_m = lowest_arm_m(turn).cross(&Vector3::z());
    let k = 1.0 / MASS_KG + lever_m.norm_squared() / inertia_kg_m2;
    let impulse_n_s = (1.0 + restitution) * speed_m_s / k;
    let up_m_s = impulse_n_s / MASS_KG - speed_m_s;
    let spin_rad_s = lever_m.norm() * impulse_n_s / inertia_kg_m2;

    let film = drop(settings, turn, restitution, fall_s + 0.03)?;
    let after = |look: fn(&realgap_simulation::Snapshot) -> f64| {
        measure(film.as_ref(), |film| {
            film.iter()
                .find(|s| s.parts[0].angular_velocity_world_rad_s.norm() > 0.1)
                .map(look)
        })
    };
    // Gravity has acted on the velocity since the moment of impact.
    let measured_up = after(|s| {
        let since_s = s.time_s - (2.0 * DROP_M / GRAVITY_M_S2).sqrt();
        s.parts[0].velocity_world_m_s.z + GRAVITY_M_S2 * since_s
    });
    let measured_spin = after(|s| s.parts[0].angular_velocity_world_rad_s.norm());
    Ok([
        Check::new(
            format!("restitution.{name}.speed"),
            "vertical speed after a cube dropped tilted hits without friction, e = 0.5: (1 + e) v / (k m) - v",
            up_m_s,
            measured_up,
            Unit::MetrePerSecond,
            Tolerance::Absolute(FIRST * speed_m_s),
        ),
        Check::new(
            format!("restitution.{name}.spin"),
            "rate of turn after the same impact: |r x n| (1 + e) v / (k I)",
            spin_rad_s,
            measured_spin,
            Unit::RadianPerSecond,
            Tolerance::Relative(FIRST),
        ),
    ])
}
