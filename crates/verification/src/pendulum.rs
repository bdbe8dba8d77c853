//! Checks that a double pendulum on a fixed mount, whose motion is chaotic, keeps its energy.

use nalgebra::{Isometry3, Translation3, Vector3};

use super::Settings;
use super::body::{STILL, block, no_servo, robot};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, measure};
use realgap_core::error::Result;
use realgap_core::statistics::mean;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::{Actuator, Assembly, Bearing, CommandScale, Freedom, Hinge, Solid};
use realgap_simulation::{JointFormulation, JointState, Snapshot};

const ROD_M: f64 = 0.2;
const ROD_KG: f64 = 0.1;
/// Height of the mount, metres.
const HIGH_M: f64 = 1.0;
const SECONDS: f64 = 10.0;
/// Length of the windows over which energies are averaged, seconds. Averaging is needed because some engines report speeds for
/// the middle of a step and positions for its end.
const WINDOW_S: f64 = 0.5;

fn hinge(number: usize) -> Hinge {
    Hinge {
        name: format!("hinge {number}"),
        module: 0,
        parent_part: number,
        child_part: number + 1,
        anchor_robot_m: Vector3::new(0.0, 0.0, -ROD_M * number as f64),
        axis_robot: Vector3::y_axis(),
        freedom: Freedom::Turn,
        actuator: Some(Actuator {
            servo: no_servo(),
            gait: STILL,
            command: CommandScale::default(),
        }),
        bearing: Bearing::default(),
        is_stated: false,
        start_rad: None,
    }
}

/// A mount and two rods that hang from it, one below the other; nothing touches anything.
fn double_pendulum() -> Assembly {
    let solid = |z: f64, half_z: f64| Solid {
        collides: false,
        tyre: None,
        turning: Default::default(),
        ..block(
            Vector3::new(0.0, 0.0, z),
            Vector3::new(0.01, 0.01, half_z),
            ROD_KG,
        )
    };
    let rod = |number: f64| solid(-(number + 0.5) * ROD_M, 0.5 * ROD_M);
    let parts = vec![vec![solid(0.0, 0.01)], vec![rod(0.0)], vec![rod(1.0)]];
    Assembly {
        world_from_mount: Some(Isometry3::from(Translation3::new(0.0, 0.0, HIGH_M))),
        ..robot(parts, vec![hinge(0), hinge(1)])
    }
}

/// Energy of a wide swing after ten seconds, relative to the energy at the start.
pub(super) fn check(settings: &Settings, kind: JointFormulation) -> Result<Check> {
    let mut experiment = settings.experiment(double_pendulum(), SECONDS);
    experiment.solver.joint = kind;
    let at_rest = |angle_rad| JointState {
        angle_rad,
        speed_rad_s: 0.0,
    };
    experiment.start_joints = vec![at_rest(1.5), at_rest(0.8)];
    let film = SimulationLog::record(&experiment, &[])?;
    // Potential energy where both rods hang straight down, relative to the mount.
    let lowest_j = -ROD_KG * GRAVITY_M_S2 * 2.0 * ROD_M;
    let energy_j = |s: &Snapshot| -> f64 {
        let rods = s.parts[1..].iter();
        let all = rods.map(|p| {
            p.kinetic_energy_j() + p.mass_kg * GRAVITY_M_S2 * (p.centre_world_m.z - HIGH_M)
        });
        all.sum::<f64>() - lowest_j
    };
    Ok(Check::new(
        format!("energy.double_pendulum.{}", settings.joint_name(kind)),
        "swing energy of a mounted double pendulum after 10 s, over the first, means over 0.5 s: 1",
        1.0,
        measure(film.as_ref(), |film| {
            let first: Vec<f64> = (film.iter().take_while(|s| s.time_s <= WINDOW_S))
                .map(energy_j)
                .collect();
            let last: Vec<f64> = film.since(SECONDS - WINDOW_S).map(energy_j).collect();
            Some(mean(&last) / mean(&first))
        }),
        Unit::One,
        Tolerance::Absolute(0.02),
    ))
}
