//! What servos are told: a gait, or a recorded track.

use super::experiment::Experiment;
use realgap_core::error::{Error, Result};
use realgap_robot::morphology::{Gait, Hinge};

/// Recorded commands of one servo.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandTrack {
    times_s: Vec<f64>,
    angles_rad: Vec<f64>,
    off_from_s: Option<f64>,
}

impl CommandTrack {
    /// Commanded angles at times from the start of the run, straight lines between them; before the first and after the last
    /// the nearest holds. From `off_from_s` on the servo is switched off.
    ///
    /// # Errors
    /// No sample, columns of different lengths, times that do not increase, or a number that is none.
    pub fn new(times_s: Vec<f64>, angles_rad: Vec<f64>, off_from_s: Option<f64>) -> Result<Self> {
        let increasing = times_s.windows(2).all(|w| w[0] < w[1]);
        let finite = times_s.iter().chain(&angles_rad).chain(&off_from_s);
        if times_s.is_empty()
            || times_s.len() != angles_rad.len()
            || !increasing
            || !finite.into_iter().all(|value| value.is_finite())
        {
            return Err(Error::invalid("not a track of commands")
                .found(format!(
                    "{} times and {} angles",
                    times_s.len(),
                    angles_rad.len()
                ))
                .allowed("as many times, which increase, as angles, all finite"));
        }
        Ok(Self {
            times_s,
            angles_rad,
            off_from_s,
        })
    }

    /// The commanded angle at `t_s`, radians.
    pub fn angle_rad(&self, t_s: f64) -> f64 {
        let after = self.times_s.partition_point(|time_s| *time_s <= t_s);
        let last = self.angles_rad.len() - 1;
        if after == 0 || after > last {
            return self.angles_rad[after.min(last)];
        }
        let (from_s, to_s) = (self.times_s[after - 1], self.times_s[after]);
        let (from_rad, to_rad) = (self.angles_rad[after - 1], self.angles_rad[after]);
        from_rad + (t_s - from_s) / (to_s - from_s) * (to_rad - from_rad)
    }

    /// From when on the servo is switched off, seconds.
    pub fn off_from_s(&self) -> Option<f64> {
        self.off_from_s
    }
}

/// What one hinge is told.
pub(super) enum Orders<'a> {
    /// Nothing: there is no servo.
    None,
    /// A sine.
    Gait(Gait),
    /// What was recorded.
    Track(&'a CommandTrack),
}

impl<'a> Orders<'a> {
    /// The orders of a hinge.
    pub fn new(experiment: &'a Experiment, hinge: &Hinge) -> Self {
        match (&hinge.actuator, experiment.commands.get(&hinge.name)) {
            (None, _) => Self::None,
            (Some(_), Some(track)) => Self::Track(track),
            (Some(actuator), None) => Self::Gait(actuator.gait),
        }
    }

    /// The commanded angle at `t_s`, radians; 0 without a servo.
    pub fn angle_rad(&self, t_s: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Gait(gait) => gait.angle_rad(t_s),
            Self::Track(track) => track.angle_rad(t_s),
        }
    }

    /// Whether the servo is switched on at `t_s`.
    pub fn is_on(&self, t_s: f64) -> bool {
        match self {
            Self::None | Self::Gait(_) => true,
            Self::Track(track) => track.off_from_s.is_none_or(|off_s| t_s < off_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_is_straight_between_its_samples_and_holds_beyond_them() {
        let track = CommandTrack::new(vec![1.0, 2.0, 4.0], vec![0.0, 1.0, -1.0], None).unwrap();
        for (t_s, angle_rad) in [(0.0, 0.0), (1.5, 0.5), (2.0, 1.0), (3.0, 0.0), (9.0, -1.0)] {
            assert_eq!(track.angle_rad(t_s), angle_rad, "{t_s}");
        }
    }

    #[test]
    fn a_track_that_goes_back_is_refused() {
        assert!(CommandTrack::new(vec![1.0, 1.0], vec![0.0, 1.0], None).is_err());
        assert!(CommandTrack::new(vec![], vec![], None).is_err());
        assert!(CommandTrack::new(vec![0.0], vec![f64::NAN], None).is_err());
    }
}
