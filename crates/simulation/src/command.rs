//! Recorded commands of servos over time.

use realgap_core::error::{Error, Result};
use realgap_robot::morphology::CommandScale;

/// The quantity that a track commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// An angle, radians.
    #[default]
    Position,
    /// A speed, rad/s.
    Velocity,
    /// A torque, N m.
    Torque,
}

/// The command in force between two recorded commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Between {
    /// The earlier command is held, as real servos do.
    #[default]
    Held,
    /// Linear interpolation between the two.
    Interpolated,
}

/// Recorded commands of one servo.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandTrack {
    times_s: Vec<f64>,
    values: Vec<f64>,
    quantity: Quantity,
    between: Between,
    /// Times at which the servo is switched on or off, in order; it is on before the first.
    switches: Vec<(f64, bool)>,
}

impl CommandTrack {
    /// Commanded angles (radians) at times from the start of the run. Each is held until the next; before the first time the
    /// first command is in force. From `off_from_s` on the servo is switched off.
    ///
    /// # Errors
    /// No sample, columns of different lengths, times that do not increase, or a number that is not finite.
    pub fn new(times_s: Vec<f64>, values: Vec<f64>, off_from_s: Option<f64>) -> Result<Self> {
        let increasing = times_s.windows(2).all(|w| w[0] < w[1]);
        let finite = times_s.iter().chain(&values).chain(&off_from_s);
        if times_s.is_empty()
            || times_s.len() != values.len()
            || !increasing
            || !finite.into_iter().all(|value| value.is_finite())
        {
            return Err(Error::invalid("not a track of commands")
                .found(format!(
                    "{} times and {} values",
                    times_s.len(),
                    values.len()
                ))
                .allowed("as many times, which increase, as values, all finite"));
        }
        Ok(Self {
            times_s,
            values,
            quantity: Quantity::Position,
            between: Between::Held,
            switches: off_from_s.map(|off_s| (off_s, false)).into_iter().collect(),
        })
    }

    /// The same numbers as commands of another quantity.
    #[must_use]
    pub fn of(self, quantity: Quantity) -> Self {
        Self { quantity, ..self }
    }

    /// The same commands with another rule for the time between them.
    #[must_use]
    pub fn with(self, between: Between) -> Self {
        Self { between, ..self }
    }

    /// The same commands, each multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            values: self.values.iter().map(|value| factor * value).collect(),
            ..self.clone()
        }
    }

    /// The same commands as an actuator passes them on to its joint.
    #[must_use]
    pub(super) fn passed(&self, scale: &CommandScale) -> Self {
        Self {
            values: self
                .values
                .iter()
                .map(|value| scale.apply(*value))
                .collect(),
            ..self.clone()
        }
    }

    /// The same commands with a column that switches the servo: on where the value is not 0, one value per command.
    #[must_use]
    pub fn switched(mut self, on: &[f64]) -> Self {
        for (time_s, is_on) in self.times_s.iter().zip(on.iter().map(|on| *on != 0.0)) {
            if self.switches.last().map_or(!is_on, |last| last.1 != is_on) {
                self.switches.push((*time_s, is_on));
            }
        }
        self.switches.sort_by(|a, b| a.0.total_cmp(&b.0));
        self
    }

    /// The same commands, each delayed by its own time in seconds; no command overtakes another.
    pub(super) fn late(&self, mut by_s: impl FnMut() -> f64) -> Self {
        let mut latest_s = f64::NEG_INFINITY;
        let arrivals = self.times_s.iter().map(|time_s| {
            latest_s = latest_s.max(time_s + by_s());
            latest_s
        });
        Self {
            times_s: arrivals.collect(),
            ..self.clone()
        }
    }

    /// The commanded quantity.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The recorded commands, in the unit of the quantity.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The rule for the time between two commands.
    pub(super) fn between(&self) -> Between {
        self.between
    }

    /// Whether the servo is switched on at `t_s`.
    pub(super) fn is_on(&self, t_s: f64) -> bool {
        let past = self.switches.partition_point(|(at_s, _)| *at_s <= t_s);
        past == 0 || self.switches[past - 1].1
    }

    /// The command at `t_s`, in the unit of its quantity.
    pub fn value(&self, t_s: f64) -> f64 {
        let after = self.times_s.partition_point(|time_s| *time_s <= t_s);
        let last = self.values.len() - 1;
        if after == 0 || after > last {
            return self.values[after.min(last)];
        }
        if self.between == Between::Held {
            return self.values[after - 1];
        }
        let (from_s, to_s) = (self.times_s[after - 1], self.times_s[after]);
        let (from, to) = (self.values[after - 1], self.values[after]);
        from + (t_s - from_s) / (to_s - from_s) * (to - from)
    }

    /// The command for a whole step: the mean of the held commands over the step, so that a run is a smooth function of the
    /// delay.
    pub(super) fn mean(&self, from_s: f64, to_s: f64) -> f64 {
        if self.between == Between::Interpolated || to_s <= from_s {
            return self.value(0.5 * (from_s + to_s));
        }
        let (mut at_s, mut value, mut sum) = (from_s, self.value(from_s), 0.0);
        let first = self.times_s.partition_point(|time_s| *time_s <= from_s);
        for (time_s, next) in self.times_s.iter().zip(&self.values).skip(first) {
            if *time_s >= to_s {
                break;
            }
            sum += value * (time_s - at_s);
            (at_s, value) = (*time_s, *next);
        }
        if at_s == from_s {
            return value;
        }
        (sum + value * (to_s - at_s)) / (to_s - from_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track() -> CommandTrack {
        CommandTrack::new(vec![1.0, 2.0, 4.0], vec![0.0, 1.0, -1.0], None).unwrap()
    }

    #[test]
    fn a_command_is_held_until_the_next_unless_it_is_interpolated() {
        for (t_s, held, line) in [
            (0.0, 0.0, 0.0),
            (1.5, 0.0, 0.5),
            (2.0, 1.0, 1.0),
            (3.0, 1.0, 0.0),
            (9.0, -1.0, -1.0),
        ] {
            assert_eq!(track().value(t_s), held, "{t_s}");
            let between = track().with(Between::Interpolated);
            assert_eq!(between.value(t_s), line, "{t_s}");
        }
    }

    #[test]
    fn late_commands_do_not_overtake_each_other() {
        let mut delays_s = [1.5, 0.0, 0.25].into_iter();
        let late = track().late(|| delays_s.next().unwrap_or_default());
        // The first command arrives together with the second, which replaces it immediately.
        assert_eq!(late.times_s, [2.5, 2.5, 4.25]);
        assert_eq!(
            [2.4, 2.5, 4.2, 4.25].map(|t_s| late.value(t_s)),
            [0.0, 1.0, 1.0, -1.0]
        );
        let line = late.with(Between::Interpolated);
        assert!(
            [2.4, 2.5, 3.0, 5.0]
                .iter()
                .all(|t_s| line.value(*t_s).is_finite())
        );
    }

    #[test]
    fn a_track_whose_times_do_not_increase_is_refused() {
        assert!(CommandTrack::new(vec![1.0, 1.0], vec![0.0, 1.0], None).is_err());
        assert!(CommandTrack::new(vec![], vec![], None).is_err());
        assert!(CommandTrack::new(vec![0.0], vec![f64::NAN], None).is_err());
    }
}
