#![allow(clippy::print_stdout)]
//! Shows how to write your own robot as text, simulate it, and print how far it went.
//!
//! `cargo run --example own_robot`

use realgap::Result;
use realgap::file::Source;
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, run};

const ROBOT: &str = r#"(
    name: "inchworm",
    defaults: (side_m: 0.06, mass_kg: 0.1),
    modules: [
        (name: "tail", kind: Active(face: PosX, axis: Tangent(axis: PosY),
            servo: (law: Velocity(gain_1_s: 20.0), max_torque_nm: 0.5, max_speed_rad_s: 6.0),
            gait: (amplitude_rad: 0.6, frequency_hz: 1.0))),
        (name: "middle", kind: Active(face: PosX, axis: Tangent(axis: PosY),
            servo: (law: Velocity(gain_1_s: 20.0), max_torque_nm: 0.5, max_speed_rad_s: 6.0),
            gait: (amplitude_rad: 0.6, frequency_hz: 1.0, phase_rad: 1.57))),
        (name: "head", kind: Passive()),
    ],
    glue: [
        (parent: "tail", face: PosX, child: "middle"),
        (parent: "middle", face: PosX, child: "head"),
    ],
    track: "middle",
)"#;

fn main() -> Result<()> {
    let robot = Morphology::parse(&Source::new("inchworm", ROBOT))?;
    let mut experiment = Experiment::new(robot.assemble());
    for friction in [0.2, 0.5, 0.8] {
        experiment.floor.friction = friction;
        let motion = run(&experiment)?.outcome.into_result()?;
        let net_m = motion.net_displacement_world_m().xy().norm();
        println!(
            "friction {friction}: {:.1} cm in {} s",
            100.0 * net_m,
            experiment.duration_s
        );
    }
    Ok(())
}
