//! Parameters of how actuators take recorded commands, of all or of those of selected joints: `command.NAME.dead_zone`.

use super::member::{change, shared};
use super::{Nudge, Parameter, entry};
use realgap_robot::morphology::CommandScale;

/// Defines a parameter that is a field of the actuators' command scale.
macro_rules! command {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $field:ident) => {
        entry!(
            $name,
            $unit,
            $bounds,
            $scale,
            $nudge,
            $doc,
            |e, of| shared(e, of, |hinge, _| hinge.actuator.map(|a| a.command.$field)),
            |e, of, value| {
                change(e, of, |hinge| {
                    if let Some(actuator) = &mut hinge.actuator {
                        actuator.command.$field = value;
                    }
                })
            }
        )
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    command!("command.factor", One, (-1e6, 1e6), Linear, Nudge::Share(0.1),
        "Factor on every recorded command, which makes it a command of its joint.", factor),
    command!("command.offset", One, (-1e6, 1e6), Linear, Nudge::Absolute(0.01),
        "Command of every joint (radians, N m or a share of the drive) that a recorded command of 0 means: the trim of a steering.", offset),
    command!("command.dead_zone", One, (0.0, 1e6), Linear, Nudge::Absolute(0.01),
        "Recorded commands up to this size have no effect, and larger ones that much less.", dead_zone),
    command!("command.bend", One, (0.0, 1e6), Linear, Nudge::Share(0.1),
        "How strongly large recorded commands are compressed: c becomes tanh(b c) / b.", bend),
    command!("command.delay_s", Second, (-CommandScale::LONGEST_LAG_S, CommandScale::LONGEST_LAG_S), Linear, Nudge::Absolute(0.01),
        "How much later than it was recorded every command takes effect; below 0 where a recorder is late.", delay_s),
    command!("command.lag_s", Second, (0.0, CommandScale::LONGEST_LAG_S), Linear, Nudge::Absolute(0.01),
        "Time constant of the lag of first order with which every actuator follows its recorded commands.", lag_s),
];
