//! Numerical settings: worth a sweep of their own, because they change results too.

use super::{Nudge, Parameter, Scale, field};
use crate::{ENGINES, EngineChoice, JointKind};
use realgap_core::unit::Unit;

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("timestep_s", Second, (1e-6, 0.1), Log, Nudge::Share(0.25),
        "Time per simulation step.", solver.timestep_s),
    Parameter {
        name: "solver.substeps",
        unit: Unit::One,
        bounds: (1.0, 256.0),
        whole: true,
        scale: Scale::Log,
        nudge: Nudge::Absolute(2.0),
        doc: "Solver substeps per step.",
        subject: "",
        get: |e, _| Some(e.solver.substeps as f64),
        set: |e, _, value| e.solver.substeps = value as usize,
    },
    Parameter {
        name: "solver.sweeps",
        unit: Unit::One,
        bounds: (1.0, 256.0),
        whole: true,
        scale: Scale::Log,
        nudge: Nudge::Absolute(1.0),
        doc: "Passes over joints and contacts in every substep; more of them hold light plates still.",
        subject: "",
        get: |e, _| Some(e.solver.sweeps as f64),
        set: |e, _, value| e.solver.sweeps = value as usize,
    },
    Parameter {
        name: "solver.relaxations",
        unit: Unit::One,
        bounds: (0.0, 16.0),
        whole: true,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(1.0),
        doc: "Passes without bias at the end of every substep; each drains some energy of the hinges.",
        subject: "",
        get: |e, _| Some(e.solver.relaxations as f64),
        set: |e, _, value| e.solver.relaxations = value as usize,
    },
    Parameter {
        name: "solver.joint",
        unit: Unit::One,
        bounds: (0.0, 1.0),
        whole: true,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(1.0),
        doc: "0: impulse joints (constraints); 1: multibody joints (reduced coordinates).",
        subject: "",
        get: |e, _| {
            let is_multibody = e.joint_kind() == JointKind::Multibody;
            Some(f64::from(u8::from(is_multibody)))
        },
        set: |e, _, value| {
            e.solver.joint = if value == 0.0 {
                JointKind::Impulse
            } else {
                JointKind::Multibody
            };
        },
    },
    Parameter {
        name: "solver.engine",
        unit: Unit::One,
        bounds: (0.0, (ENGINES.len() - 1) as f64),
        whole: true,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(1.0),
        doc: "0: Rapier; 1: the tree solver, in reduced coordinates.",
        subject: "",
        get: |e, _| {
            let is_it = |engine: &EngineChoice| *engine == e.solver.engine;
            ENGINES.iter().position(is_it).map(|index| index as f64)
        },
        set: |e, _, value| {
            if let Some(engine) = ENGINES.get(value as usize) {
                e.solver.engine = *engine;
            }
        },
    },
];
