//! Checks of a body that slides and spins at once (a cube, and a plate under a free hinge) against Coulomb's law.
//!
//! A square of half side a slides on its four corners. Corner i at r_i carries the load N_i, and friction −µ N_i v_i/|v_i|
//! acts on it. Friction acts at a height h below the centre of mass and so shifts the load. Corners of equal compliance
//! share the load linearly, N_i = m g/4 + c·r_i, and the balance of moments, Σ N_i r_i = −h F with
//! Σ r_i r_iᵀ = 4 a² 1, requires c = −h F/(4 a²). F depends on the loads in turn, which gives two linear equations at each
//! moment; the motion that follows from them is integrated numerically.

use nalgebra::{Matrix2, Rotation2, UnitQuaternion, Vector2, Vector3};

use super::Settings;
use super::body::{
    CUBE_ON_PLATE_M, MASS_KG, PLATE_HALF_M, PLATE_KG, PLATE_THICKNESS_M, SIDE_M, STILL, cube,
    no_servo, on_plate,
};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, centre_world_m, moving};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_simulation::JointFormulation;

const FRICTION: f64 = 0.5;
const SPEED_M_S: f64 = 0.5;
const SPIN_RAD_S: f64 = 20.0;

/// A body that slides and spins on the four corners of a square.
struct Slider {
    mass_kg: f64,
    /// Moment of inertia of the spinning part about the vertical, kg m².
    inertia_kg_m2: f64,
    half_side_m: f64,
    /// Height of the centre of mass, metres.
    height_m: f64,
}

/// How far a sliding body has moved and turned when it comes to rest.
#[derive(Debug, Clone, Copy)]
struct Rest {
    travel_m: Vector2<f64>,
    yaw_rad: f64,
}

impl Slider {
    fn corners(&self, yaw_rad: f64) -> [Vector2<f64>; 4] {
        let a = self.half_side_m;
        [(a, a), (-a, a), (-a, -a), (a, -a)]
            .map(|(x, y)| Rotation2::new(yaw_rad) * Vector2::new(x, y))
    }

    /// Force and torque of friction on the sliding square.
    fn friction(
        &self,
        yaw_rad: f64,
        velocity_m_s: Vector2<f64>,
        spin_rad_s: f64,
    ) -> (Vector2<f64>, f64) {
        let corners = self.corners(yaw_rad);
        let against = corners.map(|r| {
            let slip = velocity_m_s + spin_rad_s * Vector2::new(-r.y, r.x);
            let speed = slip.norm();
            if speed > 0.0 {
                -FRICTION * slip / speed
            } else {
                Vector2::zeros()
            }
        });
        let share = self.mass_kg * GRAVITY_M_S2 / 4.0;
        // F = Σ (share + c·r_i) d_i with c = −h F / 4a²: (1 + h/4a² Σ d_i r_iᵀ) F = share Σ d_i.
        let lever = self.height_m / (4.0 * self.half_side_m.powi(2));
        let mut matrix = Matrix2::identity();
        let mut even = Vector2::zeros();
        for (r, d) in corners.iter().zip(&against) {
            matrix += lever * d * r.transpose();
            even += share * d;
        }
        let force = matrix.lu().solve(&even).unwrap_or(even);
        let tilt = -lever * force;
        let torque = corners
            .iter()
            .zip(&against)
            .map(|(r, d)| (share + tilt.dot(r)) * (r.x * d.y - r.y * d.x))
            .sum();
        (force, torque)
    }

    /// Integrates the motion by the midpoint rule until the body is at rest.
    fn rest(&self) -> Rest {
        let step_s = 2e-6;
        let (mut travel_m, mut yaw_rad) = (Vector2::zeros(), 0.0);
        let (mut velocity, mut spin) = (Vector2::new(SPEED_M_S, 0.0), SPIN_RAD_S);
        let speed_now =
            |velocity: Vector2<f64>, spin: f64| velocity.norm().max(spin.abs() * self.half_side_m);
        // Sliding and spinning end at the same time, because each of them keeps the corners slipping. One second, the limit
        // of this loop, is much longer than the motion takes.
        for _ in 0..500_000 {
            if speed_now(velocity, spin) < 1e-4 {
                break;
            }
            let (force, torque) = self.friction(yaw_rad, velocity, spin);
            let middle_velocity = velocity + 0.5 * step_s * force / self.mass_kg;
            let middle_spin = spin + 0.5 * step_s * torque / self.inertia_kg_m2;
            let (force, torque) =
                self.friction(yaw_rad + 0.5 * step_s * spin, middle_velocity, middle_spin);
            travel_m += step_s * middle_velocity;
            yaw_rad += step_s * middle_spin;
            velocity += step_s * force / self.mass_kg;
            spin += step_s * torque / self.inertia_kg_m2;
        }
        Rest { travel_m, yaw_rad }
    }
}

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = cube_spin(settings)?.to_vec();
    for &kind in settings.kinds() {
        checks.extend(plate_spin(settings, kind)?);
    }
    Ok(checks)
}

/// Three checks of the final pose: the distance to 2 %, the sideways distance to 2 % of the whole distance, and the turn to one
/// degree, which is what a camera resolves.
fn compare(name: &str, what: &str, expected: Rest, measured: Option<Rest>) -> [Check; 3] {
    let seen = |look: fn(Rest) -> f64| measured.map_or(f64::NAN, look);
    let across_m = 0.02 * expected.travel_m.x;
    [
        Check::new(
            format!("friction.spin.along.{name}"),
            format!(
                "distance that {what} slides from 0.5 m/s and 20 rad/s at friction 0.5: Coulomb at four corners, integrated"
            ),
            expected.travel_m.x,
            seen(|r| r.travel_m.x),
            Unit::Metre,
            Tolerance::Relative(0.02),
        ),
        Check::new(
            format!("friction.spin.across.{name}"),
            "how far it swerves meanwhile: the same integral",
            expected.travel_m.y,
            seen(|r| r.travel_m.y),
            Unit::Metre,
            Tolerance::Absolute(across_m),
        ),
        Check::new(
            format!("friction.spin.turn.{name}"),
            "by how much it turns meanwhile: the same integral",
            expected.yaw_rad,
            seen(|r| r.yaw_rad),
            Unit::Radian,
            Tolerance::Absolute(1f64.to_radians()),
        ),
    ]
}

fn yaw_rad(film: &SimulationLog, part: usize) -> f64 {
    film.pairs()
        .map(|(a, b)| {
            let turn = a.parts[part].world_from_part.rotation.inverse()
                * b.parts[part].world_from_part.rotation;
            turn.scaled_axis().z
        })
        .sum()
}

fn rest(film: Option<&SimulationLog>, part: usize) -> Option<Rest> {
    let film = film?;
    let travel_m = (centre_world_m(film.last()) - centre_world_m(film.first())).xy();
    Some(Rest {
        travel_m,
        yaw_rad: yaw_rad(film, part),
    })
}

fn cube_spin(settings: &Settings) -> Result<[Check; 3]> {
    let slider = Slider {
        mass_kg: MASS_KG,
        inertia_kg_m2: MASS_KG * SIDE_M * SIDE_M / 6.0,
        half_side_m: 0.5 * SIDE_M,
        height_m: 0.5 * SIDE_M,
    };
    let mut experiment = settings.experiment(cube(), 0.5);
    experiment.floor.friction = FRICTION;
    experiment.start = moving(
        Vector3::new(0.0, 0.0, 0.5 * SIDE_M),
        UnitQuaternion::identity(),
        Vector3::new(SPEED_M_S, 0.0, 0.0),
        Vector3::new(0.0, 0.0, SPIN_RAD_S),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(compare(
        "cube",
        "a cube",
        slider.rest(),
        rest(film.as_ref(), 0),
    ))
}

/// Cube and plate spin together at first; then friction with the floor stops the plate, while the free hinge lets the cube go on
/// spinning.
fn plate_spin(settings: &Settings, kind: JointFormulation) -> Result<[Check; 3]> {
    let mass_kg = MASS_KG + PLATE_KG;
    let slider = Slider {
        mass_kg,
        inertia_kg_m2: PLATE_KG * 4.0 * PLATE_HALF_M * PLATE_HALF_M / 6.0,
        half_side_m: PLATE_HALF_M,
        height_m: (MASS_KG * CUBE_ON_PLATE_M + PLATE_KG * 0.5 * PLATE_THICKNESS_M) / mass_kg,
    };
    let mut experiment = settings.experiment(on_plate(no_servo(), STILL), 0.5);
    experiment.solver.joint = kind;
    experiment.floor.friction = FRICTION;
    experiment.start = moving(
        Vector3::new(0.0, 0.0, CUBE_ON_PLATE_M),
        UnitQuaternion::identity(),
        Vector3::new(SPEED_M_S, 0.0, 0.0),
        Vector3::new(0.0, 0.0, SPIN_RAD_S),
    );
    let film = SimulationLog::record(&experiment, &[])?;
    Ok(compare(
        settings.joint_name(kind),
        "a cube on a plate under a free hinge",
        slider.rest(),
        rest(film.as_ref(), 1),
    )
    .map(|check| Check {
        name: check.name.replace("friction.spin", "friction.plate_spin"),
        ..check
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_spin_the_integral_is_the_stopping_distance() {
        let slider = Slider {
            mass_kg: 0.1,
            inertia_kg_m2: 6e-5,
            half_side_m: 0.03,
            height_m: 0.03,
        };
        let (force, torque) = slider.friction(0.3, Vector2::new(0.5, 0.0), 0.0);
        assert!((force - Vector2::new(-FRICTION * 0.1 * GRAVITY_M_S2, 0.0)).norm() < 1e-12);
        // The load shifts along the direction of motion only, so that no torque turns the square.
        assert!(torque.abs() < 1e-12);
    }

    #[test]
    fn turning_in_place_meets_the_friction_of_all_four_corners() {
        let slider = Slider {
            mass_kg: 0.1,
            inertia_kg_m2: 6e-5,
            half_side_m: 0.03,
            height_m: 0.03,
        };
        let (force, torque) = slider.friction(0.3, Vector2::zeros(), 1.0);
        assert!(force.norm() < 1e-12);
        let arm_m = 0.03 * 2f64.sqrt();
        assert!((torque + FRICTION * 0.1 * GRAVITY_M_S2 * arm_m).abs() < 1e-12);
    }
}
