//! Parameters of a two-wheel robot: motion, control and camera.

use serde::Deserialize;

/// Parameters of motion, sensing and control of a two-wheel robot; the defaults are those of paper 000 and its public code.
///
/// An actuator coasts after its command ends: distance = speed · t + coast for a command of t seconds. So the constants of the
/// characterisation apply once per command. Angles are positive to the left.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// Speed straight ahead, m/s.
    pub speed_m_s: f64,
    /// Coasting distance after a straight command, metres.
    pub coast_m: f64,
    /// Standard deviation of the coasting distance, metres.
    pub coast_sd_m: f64,
    /// Turn of the heading while driving straight, rad/s.
    pub drift_rad_s: f64,
    /// Turn of the heading at the beginning of a straight command, radians.
    pub drift_offset_rad: f64,
    /// Standard deviation of the turn at the beginning of a straight command, radians.
    pub drift_sd_rad: f64,
    /// Rate of a turn to the right, rad/s.
    pub turn_rate_rad_s: f64,
    /// Coasting angle after a command to turn, radians.
    pub turn_coast_rad: f64,
    /// Standard deviation of the angle of a turn, radians.
    pub turn_sd_rad: f64,
    /// Length of the command to turn, seconds.
    pub turn_command_s: f64,
    /// Distance of an object below which the robot turns, metres.
    pub threshold_m: f64,
    /// Time between two readings of the sensor, seconds.
    pub sampling_s: f64,
    /// Time between a decision and the reaction to it, seconds.
    pub reaction_s: f64,
    /// Number of readings that the Bayes filter combines for one decision; 0 means that every single reading decides.
    pub filter_readings: f64,
    /// Rate of false alarms (turns without an obstacle) per second of driving straight; there are none in a run without random
    /// draws.
    pub false_alarm_hz: f64,
    /// Time at which the robot begins to move, on the recording's clock, seconds.
    pub start_s: f64,
    /// Standard deviation of the start time, seconds.
    pub start_sd_s: f64,
    /// Fraction of the runs in which the robot begins later, as if a second clock were used.
    pub late_share: f64,
    /// Additional delay of the start in these runs, seconds.
    pub late_s: f64,
    /// Time until which the recording shows the robot at its start, seconds.
    pub stale_s: f64,
    /// Pictures per second of the recording.
    pub frame_rate_hz: f64,
    /// Standard deviation of the time shift of all pictures of a run, seconds.
    pub frame_sd_s: f64,
    /// Distance of the tracked point ahead of the middle of the axle, metres.
    pub tag_ahead_m: f64,
    /// Distance of the tracked point to the left of the middle of the axle, metres.
    pub tag_left_m: f64,
    /// Distance of the sensor ahead of the middle of the axle, metres.
    pub sensor_ahead_m: f64,
    /// Factor on the spread of the sensor's readings.
    pub sensor_noise: f64,
    /// Factor on all standard deviations of the actuators.
    pub actuator_noise: f64,
    /// 1: an ideal sensor, which reads the exact distance and gives no false alarms.
    pub ideal_sensor: f64,
    /// 1: ideal actuators without drift, coasting and random errors.
    pub ideal_actuator: f64,
    /// 1: ideal control, which decides without delay in every epoch by single readings.
    pub ideal_control: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            speed_m_s: 0.2266,
            coast_m: 0.0134,
            coast_sd_m: 0.0015,
            drift_rad_s: -4.38_f64.to_radians(),
            drift_offset_rad: -1.387_f64.to_radians(),
            drift_sd_rad: 2.0_f64.to_radians(),
            turn_rate_rad_s: 237.53_f64.to_radians(),
            turn_coast_rad: 19.29_f64.to_radians(),
            turn_sd_rad: 3.0_f64.to_radians(),
            // A right angle: (90 − 19.29) / 237.53.
            turn_command_s: 0.2977,
            threshold_m: 0.10,
            sampling_s: 0.1,
            reaction_s: 0.0,
            filter_readings: 0.0,
            false_alarm_hz: 0.0,
            start_s: 0.0,
            start_sd_s: 0.0,
            late_share: 0.0,
            late_s: 0.0,
            stale_s: 0.0,
            frame_rate_hz: 11.6,
            frame_sd_s: 0.0,
            tag_ahead_m: 0.0,
            tag_left_m: 0.0,
            sensor_ahead_m: 0.0795,
            sensor_noise: 1.0,
            actuator_noise: 1.0,
            ideal_sensor: 0.0,
            ideal_actuator: 0.0,
            ideal_control: 0.0,
        }
    }
}

impl Drive {
    /// The parameters with the selected idealisations applied.
    pub(super) fn resolved(&self) -> Self {
        let mut drive = *self;
        if self.ideal_actuator > 0.5 {
            let right_angle_s = std::f64::consts::FRAC_PI_2 / self.turn_rate_rad_s;
            drive = Self {
                coast_m: 0.0,
                drift_rad_s: 0.0,
                drift_offset_rad: 0.0,
                turn_coast_rad: 0.0,
                turn_command_s: right_angle_s,
                actuator_noise: 0.0,
                ..drive
            };
        }
        if self.ideal_sensor > 0.5 {
            drive.false_alarm_hz = 0.0;
        }
        if self.ideal_control > 0.5 {
            drive = Self {
                sampling_s: EPOCH_S,
                reaction_s: 0.0,
                filter_readings: 0.0,
                ..drive
            };
        }
        drive
    }
}

/// One epoch, seconds (paper 000, section 3.2).
pub(super) const EPOCH_S: f64 = 0.01;
