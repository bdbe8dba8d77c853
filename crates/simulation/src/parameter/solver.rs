//! Parameters of the solver: numerical settings, which also affect results and can be swept.

use super::{Nudge, Parameter, choice, entry, field};
use crate::{ENGINES, JointFormulation};

/// Defines a parameter for a whole-number setting of the solver.
macro_rules! count {
    ($name:literal, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $field:ident) => {
        Parameter {
            whole: true,
            ..entry!(
                $name,
                One,
                $bounds,
                $scale,
                $nudge,
                $doc,
                |e, _| Some(e.solver.$field as f64),
                |e, _, value| e.solver.$field = value as usize
            )
        }
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("timestep_s", Second, (1e-6, 0.1), Log, Nudge::Share(0.25),
        "Time per simulation step.", solver.timestep_s),
    count!("solver.substeps", (1.0, 256.0), Log, Nudge::Absolute(2.0),
        "Solver substeps per step.", substeps),
    count!("solver.sweeps", (1.0, 256.0), Log, Nudge::Absolute(1.0),
        "Passes over joints and contacts in every substep; more passes reduce vibrations of light plates.", sweeps),
    count!("solver.relaxations", (0.0, 16.0), Linear, Nudge::Absolute(1.0),
        "Passes without bias at the end of every substep; each dissipates some energy of the hinges.", relaxations),
    Parameter {
        whole: true,
        ..entry!("solver.joint", One, (0.0, 1.0), Linear, Nudge::Absolute(1.0),
            "0: impulse joints (constraints); 1: multibody joints (reduced coordinates).",
            |e, _| Some(f64::from(u8::from(e.joint_kind() == JointFormulation::Multibody))),
            |e, _, value| {
                e.solver.joint = match value == 0.0 {
                    true => JointFormulation::Impulse,
                    false => JointFormulation::Multibody,
                };
            })
    },
    choice!("solver.engine", ENGINES,
        "0: Rapier; 1: the tree solver, in reduced coordinates.", solver.engine),
];
