//! The random draws behind the repeats of a finalist, so that another engine can simulate the same repeats.

use std::collections::BTreeMap;

use serde::Serialize;

use realgap_core::error::Result;
use realgap_lab::prediction::ensemble::Motion;
use realgap_lab::search::{Finalist, Search};
use realgap_robot::morphology::{Module, Role};
use realgap_simulation::Experiment;
use realgap_simulation::export::{Robot, format_named};

/// One repeat for another engine, and how far it went here.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Draw {
    /// Number of the repeat, from 0.
    pub number: u64,
    /// Net displacement here, metres; `None` where it diverged.
    pub displacement_m: Option<f64>,
    /// Shift of the start, world frame, metres.
    pub shift_world_m: [f64; 3],
    /// Rotation of the start, world frame, rotation vector, radians.
    pub turn_world_rad: [f64; 3],
    /// Age of the command that every servo acts on, seconds, by the servo's name in `mjcf`.
    pub servo_latency_s: BTreeMap<String, f64>,
    /// Friction of every box with the floor, by the box's name in `mjcf`.
    pub friction: BTreeMap<String, f64>,
    /// The robot with this draw's masses, servo zeros, phases and gains.
    pub mjcf: String,
}

/// The draws of a finalist's repeats.
///
/// # Errors
/// None for a validated search.
pub(super) fn draws(search: &Search, finalist: &Finalist) -> Result<Vec<Draw>> {
    let base = search.experiment(&finalist.robot);
    let mjcf = format_named("mjcf")?;
    let repeats = finalist.ensemble.repeats.iter();
    repeats
        .map(|repeat| {
            let drawn = &repeat.perturbation;
            let mut experiment: Experiment = search
                .uncertain()
                .draw(search.finals_seed(), repeat.number)?
                .apply(&base);
            experiment.perturbation = drawn.clone();
            let modules: &[Module] = finalist.robot.modules();
            let friction = modules.iter().enumerate().flat_map(|(index, module)| {
                [("cube", Role::Cube), ("plate", Role::Plate)].map(|(suffix, role)| {
                    let value = experiment.floor.friction * drawn.friction_factor_of(index, role);
                    (format!("{}.{suffix}", module.name), value)
                })
            });
            let hinges = experiment.assembly.hinges.iter();
            let latency = hinges.zip(&drawn.servo_latency_s).enumerate();
            let latency = latency.map(|(index, (hinge, drawn_s))| {
                let name = modules[hinge.module].name.clone();
                (name, experiment.hinge_adjustment(index).latency_s + drawn_s)
            });
            Ok(Draw {
                number: repeat.number,
                displacement_m: repeat.outcome.get().map(Motion::net_displacement_m),
                shift_world_m: drawn.shift_world_m.into(),
                turn_world_rad: drawn.turn_world_rad.into(),
                servo_latency_s: latency.collect(),
                friction: friction.collect(),
                mjcf: mjcf.render(&Robot::new(&finalist.robot, &experiment)).text,
            })
        })
        .collect()
}
