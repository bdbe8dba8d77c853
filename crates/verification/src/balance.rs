//! Checks that a robot that balances on the edge of its plate walks equally far with both joint formulations.
//!
//! As the square plate of this walker turns, its support shrinks to a strip, and a tenth of a millimetre of sag decides to which
//! side the robot falls. There is no closed form for the distance, but both joint formulations describe the same robot, so their
//! distances must agree.

use super::Settings;
use super::check::{Check, Tolerance};
use realgap_core::error::Result;
use realgap_core::file::Source;
use realgap_core::unit::Unit;
use realgap_robot::morphology::{Assembly, Morphology};
use realgap_simulation::{Experiment, JointFormulation, run};

const SECONDS: f64 = 20.0;
/// Largest relative difference between a robot and its rerun that a search accepts.
const GAP: f64 = 0.1;

/// A robot that a search has found: one cube with a square plate of its own size, which rocks on a side face.
const WALKER: &str = "(name: \"walker\", modules: [(name: \"m0\", kind: Active(side_m: 0.058, mass_kg: 0.068, face: NegY, \
    axis: Normal(plate: (side_m: 0.058, thickness_m: 0.006, mass_kg: 0.012)), \
    servo: (law: Velocity(gain_1_s: 30.0), max_torque_nm: 0.2, max_speed_rad_s: 8.0), \
    gait: (offset_rad: 0.745, amplitude_rad: 0.989, frequency_hz: 0.674, phase_rad: 5.322)))], attachments: [], track: \"m0\")";

fn walker() -> Result<Assembly> {
    Ok(Morphology::parse(&Source::new("walker.ron", WALKER))?.assemble())
}

pub(super) fn checks(settings: &Settings) -> Result<Vec<Check>> {
    let both = [JointFormulation::Impulse, JointFormulation::Multibody];
    if !both.iter().all(|kind| settings.kinds().contains(kind)) {
        return Ok(Vec::new());
    }
    let mut checks = Vec::new();
    let cases: [(&str, &str, Change); 3] = [
        ("standing.gap.setting", "", |_| ()),
        (
            "standing.gap.quarter",
            ", at a quarter of the timestep",
            |e| {
                e.solver.timestep_s *= 0.25;
            },
        ),
        (
            "standing.gap.limit",
            ", each at its limit of hard contact",
            |e| {
                *e = e.at_limit(e.joint_kind());
            },
        ),
    ];
    for (name, when, change) in cases {
        let [impulse_m, multibody_m] = both.map(|kind| displacement_m(settings, kind, change));
        let (impulse_m, multibody_m) = (impulse_m?, multibody_m?);
        checks.push(Check::new(
            name,
            format!("net displacement in 20 s of a walker that balances on its plate, impulse joints over multibody joints{when}: 1"),
            1.0,
            impulse_m / multibody_m,
            Unit::One,
            Tolerance::Relative(GAP),
        ));
    }
    Ok(checks)
}

type Change = fn(&mut Experiment);

fn displacement_m(settings: &Settings, kind: JointFormulation, change: Change) -> Result<f64> {
    let mut experiment = settings.experiment(walker()?, SECONDS);
    experiment.solver.joint = kind;
    change(&mut experiment);
    Ok(run(&experiment)?
        .outcome
        .completed()
        .map_or(f64::NAN, |path| path.net_displacement_world_m().xy().norm()))
}
