//! The two-wheel robot.

use super::{Nudge, Parameter, field};

/// A number of the drive.
macro_rules! drive {
    ($($name:literal $field:ident $unit:ident ($low:literal, $high:literal) $nudge:expr, $whole:literal, $doc:literal;)*) => {
        pub(super) static PARAMETERS: &[Parameter] = &[
            $(Parameter {
                whole: $whole,
                ..field!($name, $unit, ($low, $high), Linear, $nudge, $doc, drive.$field)
            },)*
        ];
    };
}

drive! {
    "vehicle.speed_m_s" speed_m_s MetrePerSecond (0.001, 10.0) Nudge::Share(0.05), false, "Speed straight ahead.";
    "vehicle.coast_m" coast_m Metre (0.0, 1.0) Nudge::Absolute(0.002), false, "How much farther a straight command goes.";
    "vehicle.coast_sd_m" coast_sd_m Metre (0.0, 1.0) Nudge::Absolute(0.001), false, "Standard deviation of how much farther a straight command goes.";
    "vehicle.drift_rad_s" drift_rad_s RadianPerSecond (-10.0, 10.0) Nudge::Absolute(0.02), false, "Turn of the heading while driving straight, positive to the left.";
    "vehicle.drift_offset_rad" drift_offset_rad Radian (-3.0, 3.0) Nudge::Absolute(0.01), false, "Turn of the heading at the beginning of a straight command.";
    "vehicle.drift_sd_rad" drift_sd_rad Radian (0.0, 3.0) Nudge::Absolute(0.01), false, "Standard deviation of the turn at the beginning of a straight command.";
    "vehicle.turn_rate_rad_s" turn_rate_rad_s RadianPerSecond (0.01, 100.0) Nudge::Share(0.05), false, "Rate of a turn to the right.";
    "vehicle.turn_coast_rad" turn_coast_rad Radian (0.0, 3.0) Nudge::Absolute(0.03), false, "How much farther a turn goes than its command.";
    "vehicle.turn_sd_rad" turn_sd_rad Radian (0.0, 3.0) Nudge::Absolute(0.02), false, "Standard deviation of a turn.";
    "vehicle.turn_command_s" turn_command_s Second (0.0, 10.0) Nudge::Share(0.05), false, "Length of the command to turn.";
    "vehicle.threshold_m" threshold_m Metre (0.0, 100.0) Nudge::Absolute(0.005), false, "A turn begins where something is nearer than this.";
    "vehicle.sampling_s" sampling_s Second (0.01, 10.0) Nudge::Share(0.2), false, "Time from one reading of the sensor to the next.";
    "vehicle.reaction_s" reaction_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Time from a decision to what follows.";
    "vehicle.filter_readings" filter_readings One (0.0, 1000.0) Nudge::Absolute(1.0), true, "Readings of one belief of the Bayes filter; 0 decides by single readings.";
    "vehicle.false_alarm_hz" false_alarm_hz Hertz (0.0, 100.0) Nudge::Absolute(0.5), false, "How often it turns where nothing stands, a second of driving straight; never in a run without draws.";
    "vehicle.start_s" start_s Second (-10.0, 10.0) Nudge::Absolute(0.02), false, "When it begins to move, on the recording's clock.";
    "vehicle.start_sd_s" start_sd_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Standard deviation of when it begins to move.";
    "vehicle.late_share" late_share One (0.0, 1.0) Nudge::Absolute(0.5), false, "Share of the runs that begin later, as by another clock.";
    "vehicle.late_s" late_s Second (-10.0, 10.0) Nudge::Absolute(0.1), false, "How much later these begin to move.";
    "vehicle.stale_s" stale_s Second (0.0, 10.0) Nudge::Absolute(0.09), false, "Until when the recording shows it where it started.";
    "vehicle.frame_rate_hz" frame_rate_hz Hertz (0.1, 10000.0) Nudge::Share(0.1), false, "Pictures a second of the recording; straight lines between them.";
    "vehicle.frame_sd_s" frame_sd_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Standard deviation of when the pictures of a run are taken.";
    "vehicle.tag_ahead_m" tag_ahead_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "The tracked point ahead of the middle of the axle.";
    "vehicle.tag_left_m" tag_left_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "The tracked point to the left of the middle of the axle.";
    "vehicle.sensor_ahead_m" sensor_ahead_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "The sensor ahead of the middle of the axle.";
    "vehicle.sensor_noise" sensor_noise One (0.0, 100.0) Nudge::Share(0.2), false, "Factor on the spread of the sensor's readings.";
    "vehicle.actuator_noise" actuator_noise One (0.0, 100.0) Nudge::Share(0.2), false, "Factor on all standard deviations of the actuators.";
    "vehicle.ideal_sensor" ideal_sensor One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: a sensor that reads the distance, without false alarms.";
    "vehicle.ideal_actuator" ideal_actuator One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: actuators without drift, coast and error, whose turns are right angles.";
    "vehicle.ideal_control" ideal_control One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: control that decides in every epoch, at once and by single readings.";
}
