//! Checks that a body that is tossed onto the floor never gains energy.

use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::Settings;
use super::body::{STILL, cube, on_plate, velocity_servo};
use super::check::{Check, Tolerance};
use super::film::{SimulationLog, largest, moving};
use realgap_core::error::Result;
use realgap_core::unit::{GRAVITY_M_S2, Unit};
use realgap_robot::morphology::Assembly;
use realgap_simulation::{JointFormulation, Snapshot};

/// Number of tosses of each robot.
const TOSSES: u64 = 20;
const SECONDS: f64 = 1.0;
/// A gain below this share of the first energy does not show in a bounce's height (5 %).
const GAIN: f64 = 0.02;

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let mut checks = vec![energy(settings, "cube", settings.solver.joint, &cube())?];
    // The servo holds its angle, so that the robot is nearly rigid and the servo supplies a negligible amount of energy.
    let robot = on_plate(velocity_servo(30.0, 1.0, 8.0), STILL);
    for &kind in settings.kinds() {
        checks.push(energy(settings, settings.joint_name(kind), kind, &robot)?);
    }
    Ok(checks)
}

/// Largest rise of the energy above an earlier value, over the first value, in tosses of all orientations.
fn energy(
    settings: &Settings,
    name: &str,
    kind: JointFormulation,
    assembly: &Assembly,
) -> Result<Check> {
    let mut rises = Vec::new();
    for toss in 0..TOSSES {
        let mut random = ChaCha8Rng::seed_from_u64(toss);
        let mut unit = || random.random_range(-1.0..1.0);
        let mut vector = || Vector3::new(unit(), unit(), unit());
        let turn = UnitQuaternion::from_scaled_axis(vector() * 3.0);
        let (spin, velocity) = (vector() * 10.0, vector());
        let mut experiment = settings.experiment(assembly.clone(), SECONDS);
        experiment.solver.joint = kind;
        experiment.floor.friction = 0.2;
        experiment.floor.restitution = 0.2;
        experiment.start = moving(Vector3::new(0.0, 0.0, 0.15), turn, velocity, spin);
        let film = SimulationLog::record(&experiment, &[])?;
        rises.push(film.map_or(f64::NAN, |film| rise(&film)));
    }
    Ok(Check::new(
        format!("energy.toss.{name}"),
        "largest rise of the energy above an earlier value in 20 tosses of 1 s, over the first value: it only falls",
        0.0,
        largest(rises.into_iter()),
        Unit::One,
        Tolerance::Absolute(GAIN),
    ))
}

fn rise(film: &SimulationLog) -> f64 {
    let energy_j = |s: &Snapshot| -> f64 {
        s.parts
            .iter()
            .map(|p| p.kinetic_energy_j() + p.mass_kg * GRAVITY_M_S2 * p.centre_world_m.z)
            .sum()
    };
    let first = energy_j(film.first());
    let mut least = first;
    largest(film.iter().map(|s| {
        let now = energy_j(s);
        let rise = (now - least) / first;
        least = least.min(now);
        rise
    }))
}
