//! The numbers of a two-wheel robot.

use serde::Deserialize;

/// How a two-wheel robot moves, sees and decides; defaults are those of paper 000 and its public code.
///
/// An actuator goes on for a while after its command ends: distance = speed · t + coast for a command of t seconds. So the constants
/// of the characterisation come once a command. Angles are positive to the left.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// Speed straight ahead, m/s.
    pub speed_m_s: f64,
    /// How much farther a straight command goes, metres.
    pub coast_m: f64,
    /// Standard deviation of that.
    pub coast_sd_m: f64,
    /// Turn of the heading while driving straight, rad/s.
    pub drift_rad_s: f64,
    /// Turn of the heading at the beginning of a straight command, radians.
    pub drift_offset_rad: f64,
    /// Standard deviation of that.
    pub drift_sd_rad: f64,
    /// Rate of a turn to the right, rad/s.
    pub turn_rate_rad_s: f64,
    /// How much farther a turn goes, radians.
    pub turn_coast_rad: f64,
    /// Standard deviation of that.
    pub turn_sd_rad: f64,
    /// Length of the command to turn, seconds.
    pub turn_command_s: f64,
    /// A turn begins where something is nearer than this, metres.
    pub threshold_m: f64,
    /// Time from one reading to the next, seconds.
    pub sampling_s: f64,
    /// Time from a decision to what follows, seconds.
    pub reaction_s: f64,
    /// Readings of one belief; 0 decides by single readings.
    pub filter_readings: f64,
    /// How often it turns where nothing stands, false alarms a second of driving straight; none in a run without draws.
    pub false_alarm_hz: f64,
    /// When it begins to move, on the recording's clock, seconds.
    pub start_s: f64,
    /// Standard deviation of that.
    pub start_sd_s: f64,
    /// In which share of the runs it begins later: two clocks.
    pub late_share: f64,
    /// By how much, seconds.
    pub late_s: f64,
    /// Until when the recording shows it where it started, seconds.
    pub stale_s: f64,
    /// Pictures a second of the recording.
    pub frame_rate_hz: f64,
    /// Standard deviation of when the pictures of a run are taken, seconds.
    pub frame_sd_s: f64,
    /// The tracked point ahead of the axle's middle, metres.
    pub tag_ahead_m: f64,
    /// The tracked point to the left of it, metres.
    pub tag_left_m: f64,
    /// The sensor ahead of the axle's middle, metres.
    pub sensor_ahead_m: f64,
    /// Factor on the spread of the sensor's readings.
    pub sensor_noise: f64,
    /// Factor on all standard deviations of the actuators.
    pub actuator_noise: f64,
    /// 1: a sensor that reads the distance, without false alarms.
    pub ideal_sensor: f64,
    /// 1: actuators without drift, coast and error.
    pub ideal_actuator: f64,
    /// 1: control that decides at once, at every epoch, by single readings.
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
    /// What really moves: with the ideal parts that are switched on.
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
