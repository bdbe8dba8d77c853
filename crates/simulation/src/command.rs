//! Recorded commands of servos over time.

use realgap_core::error::{Error, Result};
use realgap_robot::morphology::{CommandScale, ServoLaw};

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
    /// A current of the motor, A.
    Current,
    /// A share of the full voltage of the motor, from -1 to 1.
    Duty,
}

impl Quantity {
    /// The quantity that a servo with this law takes by itself.
    pub fn of(law: &ServoLaw) -> Self {
        match law {
            ServoLaw::Direct => Self::Torque,
            ServoLaw::Throttle => Self::Duty,
            law if law.follows_speeds() => Self::Velocity,
            ServoLaw::Velocity { .. } | ServoLaw::Torque { .. } | ServoLaw::Motor(_) => {
                Self::Position
            }
        }
    }
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
    lag: Option<Lag>,
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
            lag: None,
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
        let values: Vec<f64> = self
            .values
            .iter()
            .map(|value| scale.apply(*value))
            .collect();
        let is_held = self.between == Between::Held;
        let times_s: Vec<f64> = self.times_s.iter().map(|t| t + scale.delay_s).collect();
        Self {
            lag: (scale.lag_s > 0.0).then(|| Lag::new(scale.lag_s, &times_s, &values, is_held)),
            times_s,
            values,
            ..self.clone()
        }
    }

    /// The same commands `rate` times as fast, forwards and backwards until they are as long as before, and `gain` times as far from the
    /// first one; torques are multiplied by `gain`.
    #[must_use]
    pub fn played(&self, rate: f64, gain: f64) -> Self {
        let (first_s, last) = (self.times_s[0], self.times_s.len() - 1);
        let end_s = self.times_s[last];
        let middle = match self.quantity {
            Quantity::Position => self.values[0],
            Quantity::Velocity | Quantity::Torque | Quantity::Current | Quantity::Duty => 0.0,
        };
        let (mut times_s, mut values) = (vec![first_s], vec![self.values[0]]);
        let (mut at, mut forward, mut now_s) = (0, true, first_s);
        // Of commands that stand alone, nothing can be played.
        while last > 0 && now_s < end_s {
            let next = match (forward, at) {
                (true, at) if at < last => at + 1,
                (true, _) => last - 1,
                (false, 0) => 1,
                (false, at) => at - 1,
            };
            forward = next > at;
            now_s += (self.times_s[next] - self.times_s[at]).abs() / rate;
            at = next;
            times_s.push(now_s);
            values.push(self.values[at]);
        }
        let values = values.iter().map(|value| middle + gain * (value - middle));
        Self {
            values: values.collect(),
            times_s,
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

    /// The command at `t_s`, in the unit of its quantity, with the lag of its actuator.
    pub fn value(&self, t_s: f64) -> f64 {
        let asked = self.asked(t_s);
        self.lag
            .as_ref()
            .map_or(asked, |lag| lag.after(&self.times_s, t_s, asked))
    }

    fn asked(&self, t_s: f64) -> f64 {
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
        // A command that lags has no jumps.
        if self.between == Between::Interpolated || self.lag.is_some() || to_s <= from_s {
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

/// The lag of first order with which an actuator follows: what it lacks at each command, which decays from there on.
#[derive(Debug, Clone, PartialEq)]
struct Lag {
    lag_s: f64,
    /// What the actuator has reached beyond the command at the time of each command, and the rate of the command from there on.
    lacks: Vec<(f64, f64)>,
}

impl Lag {
    /// At the first command the actuator has arrived.
    fn new(lag_s: f64, times_s: &[f64], values: &[f64], is_held: bool) -> Self {
        let mut reached = values[0];
        let mut lacks = Vec::with_capacity(values.len());
        for (k, value) in values.iter().enumerate() {
            let next = times_s.get(k + 1).map(|next_s| next_s - times_s[k]);
            let rate = match next {
                Some(step_s) if !is_held => (values[k + 1] - value) / step_s,
                _ => 0.0,
            };
            lacks.push((reached - value, rate));
            if let Some(step_s) = next {
                let held = value + rate * step_s;
                reached = held + Self::left(lag_s, (reached - value, rate), step_s);
            }
        }
        Self { lag_s, lacks }
    }

    /// What the actuator has reached beyond the command, a time after a command: the solution of `lag y' = u - y` for a ramp u.
    fn left(lag_s: f64, (lack, rate): (f64, f64), time_s: f64) -> f64 {
        (lack + rate * lag_s) * (-time_s / lag_s).exp() - rate * lag_s
    }

    /// What the actuator has reached at a time at which `asked` is commanded.
    fn after(&self, times_s: &[f64], t_s: f64, asked: f64) -> f64 {
        match times_s.partition_point(|time_s| *time_s <= t_s) {
            0 => asked,
            past => asked + Self::left(self.lag_s, self.lacks[past - 1], t_s - times_s[past - 1]),
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
    fn played_twice_as_fast_and_far_commands_go_back_and_end_when_they_did() {
        let track = CommandTrack::new(vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 0.0], None).unwrap();
        let played = track.played(2.0, 2.0);
        assert_eq!(played.times_s, [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(played.values, [1.0, 3.0, -1.0, 3.0, 1.0]);
        assert_eq!(track.played(1.0, 1.0), track);
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

    /// Integrates `lag y' = u - y` in small steps.
    fn followed(track: &CommandTrack, lag_s: f64, until_s: f64) -> f64 {
        let steps = 200_000;
        let h = (until_s - 1.0) / f64::from(steps);
        (0..steps).fold(track.value(1.0), |y, k| {
            y + h * (track.value(1.0 + (f64::from(k) + 0.5) * h) - y) / lag_s
        })
    }

    #[test]
    fn a_lagging_actuator_follows_the_differential_equation_of_first_order() {
        let scale = CommandScale {
            lag_s: 0.3,
            ..CommandScale::default()
        };
        for between in [Between::Held, Between::Interpolated] {
            let track = track().with(between);
            let lagging = track.passed(&scale);
            for until_s in [1.5, 2.0, 2.2, 3.7, 5.0] {
                let (is, right) = (lagging.value(until_s), followed(&track, 0.3, until_s));
                assert!(
                    (is - right).abs() < 1e-4,
                    "{between:?} {until_s}: {is} {right}"
                );
            }
            assert_eq!(lagging.value(0.5), 0.0);
        }
    }
}
