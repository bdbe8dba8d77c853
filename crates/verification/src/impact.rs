//! Checks of impacts with friction: a cube that lands on a flat face at an angle, and one that lands on a corner with spin.
//!
//! In both cases the normal impulse does not change the spin: on a flat face the impulse is distributed so that it balances the
//! moments, and a corner right below the centre has no lever arm. So the normal impulse is (1 + e) m v, and Coulomb's law gives
//! the tangential impulse.

use nalgebra::{UnitQuaternion, Vector3};

use super::Settings;
use super::body::{MASS_KG, SIDE_M, cube};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, measure, moving};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_simulation::PartState;

const RESTITUTION: f64 = 0.5;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = oblique(settings)?.to_vec();
    for (name, friction) in [("slides", 0.1), ("grips", 0.8)] {
        checks.extend(spinning(settings, name, friction)?);
    }
    Ok(checks)
}

/// A cube comes down flat at an angle and slides through the whole impact: u' = u - mu (1 + e) v.
fn oblique(settings: &Settings) -> Result<[Check; 2]> {
    let (friction, along_m_s, drop_m) = (0.3, 3.0, 0.3);
    let down_m_s = f64::sqrt(2.0 * GRAVITY_M_S2 * drop_m);
    let up_m_s = RESTITUTION * down_m_s;
    let after_m_s = along_m_s - friction * (1.0 + RESTITUTION) * down_m_s;
    let hit_s = down_m_s / GRAVITY_M_S2;
    let mut experiment = settings.experiment(cube(), hit_s + 1.5 * up_m_s / GRAVITY_M_S2);
    experiment.floor.friction = friction;
    experiment.floor.restitution = RESTITUTION;
    experiment.start = moving(
        Vector3::new(0.0, 0.0, 0.5 * SIDE_M + drop_m),
        UnitQuaternion::identity(),
        Vector3::new(along_m_s, 0.0, 0.0),
        Vector3::zeros(),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    // The speed is computed from positions alone, because engines differ in the moment of a step for which they report a speed.
    let along = |film: &SimulationLog| {
        let (from, to) = (film.at(hit_s + 0.01), film.last());
        let way_m = to.parts[0].centre_world_m.x - from.parts[0].centre_world_m.x;
        way_m / (to.time_s - from.time_s)
    };
    let up = |film: &SimulationLog| {
        let heights_m = film
            .since(hit_s + 0.01)
            .map(|s| s.parts[0].centre_world_m.z);
        let top_m = heights_m.fold(0.0, f64::max) - 0.5 * SIDE_M;
        (2.0 * GRAVITY_M_S2 * top_m.max(0.0)).sqrt()
    };
    Ok([
        Check::new(
            "restitution.oblique.speed",
            "speed along the floor after a cube comes down flat at 3 m/s along and from 0.3 m, mu 0.3, e 0.5: u - mu (1 + e) v",
            after_m_s,
            measure(film.as_ref(), |film| Some(along(film))),
            Unit::MetrePerSecond,
            Tolerance::Relative(0.01),
        ),
        Check::new(
            "restitution.oblique.direction",
            "angle at which it leaves the floor, its height giving the upward speed: atan(e v / u')",
            up_m_s.atan2(after_m_s),
            measure(film.as_ref(), |film| Some(up(film).atan2(along(film)))),
            Unit::Radian,
            Tolerance::Absolute(0.2_f64.to_radians()),
        ),
    ])
}

/// A cube that spins about the vertical comes down at an angle on the corner right below its centre. The impulse of friction is
/// mu (1 + e) m v, or the smaller impulse that stops the slip, u / (1/m + r^2/I), and turns the cube over. The spin about the
/// vertical stays, because friction at a point exerts no moment about the vertical through that point.
fn spinning(settings: &Settings, name: &str, friction: f64) -> Result<[Check; 2]> {
    let (spin_rad_s, along_m_s, down_m_s, gap_m) = (10.0, 2.0, 1.5, 0.01);
    let arm_m = 0.5 * SIDE_M * 3.0_f64.sqrt();
    let inertia_kg_m2 = MASS_KG * SIDE_M * SIDE_M / 6.0;
    let hit_s = gap_m / down_m_s;
    let hit_m_s = down_m_s + GRAVITY_M_S2 * hit_s;
    let stops_n_s = along_m_s / (1.0 / MASS_KG + arm_m * arm_m / inertia_kg_m2);
    let most_n_s = friction * (1.0 + RESTITUTION) * MASS_KG * hit_m_s;
    let impulse_n_s = stops_n_s.min(most_n_s);
    let corner_down = UnitQuaternion::rotation_between(&Vector3::repeat(1.0), &Vector3::z());
    let turn = corner_down.unwrap_or_default();
    let mut experiment = settings.experiment(cube(), hit_s + 0.01);
    experiment.floor.friction = friction;
    experiment.floor.restitution = RESTITUTION;
    let fallen_m = gap_m + 0.5 * GRAVITY_M_S2 * hit_s * hit_s;
    experiment.start = moving(
        Vector3::new(0.0, 0.0, arm_m + fallen_m),
        turn,
        Vector3::new(along_m_s, 0.0, -down_m_s),
        turn.inverse() * Vector3::new(0.0, 0.0, spin_rad_s),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    let after = |look: fn(&PartState) -> f64| {
        measure(film.as_ref(), |film| {
            let cube = &film.last().parts[0];
            (cube.velocity_world_m_s.z > 0.0).then(|| look(cube))
        })
    };
    let rolls_rad_s = arm_m * impulse_n_s / inertia_kg_m2;
    Ok([
        Check::new(
            format!("restitution.spin.{name}.speed"),
            format!(
                "speed along the floor after a cube that spins upright at 10 rad/s comes down at 2 m/s along and 1.5 m/s down on the corner below its centre, mu {friction}, e 0.5: u - J/m with Coulomb's J"
            ),
            along_m_s - impulse_n_s / MASS_KG,
            after(|cube| cube.velocity_world_m_s.x),
            Unit::MetrePerSecond,
            Tolerance::Relative(0.02),
        ),
        Check::new(
            format!("restitution.spin.{name}.rate"),
            "rate of turn after the same impact: the spin about the vertical stays, and r J / I is added across it",
            spin_rad_s.hypot(rolls_rad_s),
            after(|cube| cube.angular_velocity_world_rad_s.norm()),
            Unit::RadianPerSecond,
            Tolerance::Relative(0.02),
        ),
    ])
}
