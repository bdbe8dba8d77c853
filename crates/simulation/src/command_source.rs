//! Sources of servo commands: a gait, or a recorded track.

use std::borrow::Cow;

use super::command::{Between, CommandTrack, Quantity};
use super::experiment::Experiment;
use realgap_robot::morphology::{Gait, Hinge};

/// The source of commands of one hinge.
pub(super) enum CommandSource<'a> {
    /// No commands, because the hinge has no servo.
    None,
    /// A sinusoidal gait.
    Gait(Gait, Quantity),
    /// A recorded track, as the actuator passes it on to its joint.
    Track(Cow<'a, CommandTrack>),
}

impl<'a> CommandSource<'a> {
    /// The source of commands of a hinge.
    pub fn new(experiment: &'a Experiment, hinge: &Hinge) -> Self {
        match (&hinge.actuator, experiment.commands.get(&hinge.name)) {
            (None, _) => Self::None,
            (Some(actuator), Some(track)) => {
                let own = Quantity::of(&actuator.servo.law);
                // The scale is that of the quantity that the actuator itself takes.
                match track.quantity() == own && !actuator.command.is_none() {
                    true => Self::Track(Cow::Owned(track.passed(&actuator.command))),
                    false => Self::Track(Cow::Borrowed(track)),
                }
            }
            (Some(actuator), None) => Self::Gait(actuator.gait, Quantity::of(&actuator.servo.law)),
        }
    }

    /// The commanded quantity.
    pub fn quantity(&self) -> Quantity {
        match self {
            Self::None => Quantity::Position,
            Self::Gait(_, quantity) => *quantity,
            Self::Track(track) => track.quantity(),
        }
    }

    /// The command at `t_s`; 0 without a servo.
    pub fn value(&self, t_s: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Gait(gait, _) => gait.angle_rad(t_s),
            Self::Track(track) => track.value(t_s),
        }
    }

    /// The command for the step from `from_s` to `to_s` of a servo with the latency `latency_s`. Before the first command
    /// arrives, the servo follows it; a gait before time 0 is at its command of time 0.
    pub fn over(&self, from_s: f64, to_s: f64, latency_s: f64) -> f64 {
        match self {
            Self::Track(track) if track.between() == Between::Held => {
                track.mean(from_s - latency_s, to_s - latency_s)
            }
            Self::Track(track) => track.value(0.5 * (from_s + to_s) - latency_s),
            _ => self.value((0.5 * (from_s + to_s) - latency_s).max(0.0)),
        }
    }

    /// Whether the servo is switched on at `t_s`.
    pub(crate) fn is_on(&self, t_s: f64) -> bool {
        match self {
            Self::None | Self::Gait(..) => true,
            Self::Track(track) => track.is_on(t_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track() -> CommandTrack {
        CommandTrack::new(vec![1.0, 2.0, 4.0], vec![0.0, 1.0, -1.0], None).unwrap()
    }

    #[test]
    fn the_command_of_a_step_is_the_mean_of_the_held_commands() {
        let track = track();
        let commands = CommandSource::Track(Cow::Borrowed(&track));
        for (from_s, to_s, latency_s, mean) in [
            (1.5, 2.5, 0.0, 0.5),
            (1.75, 2.75, 0.25, 0.5),
            (0.0, 8.0, 0.0, -0.25),
            (2.5, 3.0, 0.0, 1.0),
            (0.0, 0.5, 5.0, 0.0),
        ] {
            assert_eq!(commands.over(from_s, to_s, latency_s), mean, "{from_s}");
        }
    }

    #[test]
    fn a_servo_is_switched_off_by_the_column_of_its_track() {
        let switched = track().switched(&[1.0, 0.0, 1.0]);
        let commands = CommandSource::Track(Cow::Borrowed(&switched));
        let on: Vec<bool> = [0.0, 1.9, 2.0, 3.9, 4.0, 9.0]
            .map(|t| commands.is_on(t))
            .into();
        assert_eq!(on, [true, true, false, false, true, true]);
        let off = CommandTrack::new(vec![0.0], vec![0.0], Some(2.0)).unwrap();
        let off = CommandSource::Track(Cow::Borrowed(&off));
        assert!(off.is_on(1.9) && !off.is_on(2.0));
    }
}
