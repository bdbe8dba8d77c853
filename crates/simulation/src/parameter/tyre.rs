//! Parameters of the tyres of wheels, of all or of those of selected bodies: `tyre.NAME.slip_stiffness_1_rad`.

use super::member::matches;
use super::{Nudge, Parameter, entry};
use crate::Experiment;
use realgap_robot::morphology::{Assembly, Tyre};

/// The tyres of the bodies whose names match the pattern.
fn tyres<'a>(assembly: &'a Assembly, subject: &'a str) -> impl Iterator<Item = &'a Tyre> {
    let solids = assembly.parts.iter().flat_map(|part| &part.solids);
    let chosen = solids.filter(move |solid| matches(subject, &assembly.module_names[solid.module]));
    chosen.filter_map(|solid| solid.tyre.as_ref())
}

/// The value that all of them share.
fn shared(experiment: &Experiment, subject: &str, own: impl Fn(&Tyre) -> f64) -> Option<f64> {
    let mut values = tyres(&experiment.assembly, subject).map(own);
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

fn change(experiment: &mut Experiment, subject: &str, to: impl Fn(&mut Tyre)) {
    let assembly = std::sync::Arc::make_mut(&mut experiment.assembly);
    let names = std::mem::take(&mut assembly.module_names);
    for solid in assembly.parts.iter_mut().flat_map(|part| &mut part.solids) {
        if matches(subject, &names[solid.module]) {
            solid.tyre.iter_mut().for_each(&to);
        }
    }
    assembly.module_names = names;
}

/// Defines a parameter that is a field of the tyres.
macro_rules! tyre {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $field:ident) => {
        entry!(
            $name,
            $unit,
            $bounds,
            $scale,
            $nudge,
            $doc,
            |e, of| shared(e, of, |tyre| tyre.$field),
            |e, of, value| change(e, of, |tyre| tyre.$field = value)
        )
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    tyre!("tyre.slip_stiffness_1_rad", PerRadian, Tyre::SLIP_STIFFNESSES, Log, Nudge::Share(0.1),
        "Friction force of every tyre per load and per slip, for small slips.", slip_stiffness_1_rad),
    tyre!("tyre.shape", One, Tyre::SHAPES, Linear, Nudge::Absolute(0.05),
        "Shape of the curve of every tyre's force over its slip: from 1, which grows up to the limit of friction, to below 2, which falls beyond its peak.", shape),
];
