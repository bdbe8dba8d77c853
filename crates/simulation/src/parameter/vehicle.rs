//! Parameters of the two-wheel robot.

use super::{Nudge, Parameter, field};

/// Defines parameters for the fields of the drive.
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
    "vehicle.coast_m" coast_m Metre (0.0, 1.0) Nudge::Absolute(0.002), false, "Coasting distance after a straight command.";
    "vehicle.coast_sd_m" coast_sd_m Metre (0.0, 1.0) Nudge::Absolute(0.001), false, "Standard deviation of the coasting distance after a straight command.";
    "vehicle.drift_rad_s" drift_rad_s RadianPerSecond (-10.0, 10.0) Nudge::Absolute(0.02), false, "Turn of the heading while driving straight, positive to the left.";
    "vehicle.drift_offset_rad" drift_offset_rad Radian (-3.0, 3.0) Nudge::Absolute(0.01), false, "Turn of the heading at the beginning of a straight command.";
    "vehicle.drift_sd_rad" drift_sd_rad Radian (0.0, 3.0) Nudge::Absolute(0.01), false, "Standard deviation of the turn at the beginning of a straight command.";
    "vehicle.turn_rate_rad_s" turn_rate_rad_s RadianPerSecond (0.01, 100.0) Nudge::Share(0.05), false, "Rate of a turn to the right.";
    "vehicle.turn_coast_rad" turn_coast_rad Radian (0.0, 3.0) Nudge::Absolute(0.03), false, "Coasting angle after a command to turn.";
    "vehicle.turn_sd_rad" turn_sd_rad Radian (0.0, 3.0) Nudge::Absolute(0.02), false, "Standard deviation of a turn.";
    "vehicle.turn_command_s" turn_command_s Second (0.0, 10.0) Nudge::Share(0.05), false, "Length of the command to turn.";
    "vehicle.threshold_m" threshold_m Metre (0.0, 100.0) Nudge::Absolute(0.005), false, "Distance of an object below which the robot turns.";
    "vehicle.sampling_s" sampling_s Second (0.01, 10.0) Nudge::Share(0.2), false, "Time between two readings of the sensor.";
    "vehicle.reaction_s" reaction_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Time between a decision and the reaction to it.";
    "vehicle.filter_readings" filter_readings One (0.0, 1000.0) Nudge::Absolute(1.0), true, "Number of readings that the Bayes filter combines for one decision; 0 means that every single reading decides.";
    "vehicle.false_alarm_hz" false_alarm_hz Hertz (0.0, 100.0) Nudge::Absolute(0.5), false, "Rate of false alarms (turns without an obstacle) per second of driving straight; none in a run without random draws.";
    "vehicle.start_s" start_s Second (-10.0, 10.0) Nudge::Absolute(0.02), false, "Time at which the robot begins to move, on the recording's clock.";
    "vehicle.start_sd_s" start_sd_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Standard deviation of the time at which the robot begins to move.";
    "vehicle.late_share" late_share One (0.0, 1.0) Nudge::Absolute(0.5), false, "Fraction of the runs in which the robot begins to move later, as if a second clock were used.";
    "vehicle.late_s" late_s Second (-10.0, 10.0) Nudge::Absolute(0.1), false, "Additional delay of the start in these runs.";
    "vehicle.stale_s" stale_s Second (0.0, 10.0) Nudge::Absolute(0.09), false, "Time until which the recording shows the robot at its start.";
    "vehicle.frame_rate_hz" frame_rate_hz Hertz (0.1, 10000.0) Nudge::Share(0.1), false, "Pictures per second of the recording, with linear interpolation between them.";
    "vehicle.frame_sd_s" frame_sd_s Second (0.0, 10.0) Nudge::Absolute(0.02), false, "Standard deviation of the time shift of all pictures of a run.";
    "vehicle.tag_ahead_m" tag_ahead_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "Distance of the tracked point ahead of the middle of the axle.";
    "vehicle.tag_left_m" tag_left_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "Distance of the tracked point to the left of the middle of the axle.";
    "vehicle.sensor_ahead_m" sensor_ahead_m Metre (-10.0, 10.0) Nudge::Absolute(0.005), false, "Distance of the sensor ahead of the middle of the axle.";
    "vehicle.sensor_noise" sensor_noise One (0.0, 100.0) Nudge::Share(0.2), false, "Factor on the spread of the sensor's readings.";
    "vehicle.actuator_noise" actuator_noise One (0.0, 100.0) Nudge::Share(0.2), false, "Factor on all standard deviations of the actuators.";
    "vehicle.ideal_sensor" ideal_sensor One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: an ideal sensor, which reads the exact distance and gives no false alarms.";
    "vehicle.ideal_actuator" ideal_actuator One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: ideal actuators without drift, coasting and random errors, whose turns are right angles.";
    "vehicle.ideal_control" ideal_control One (0.0, 1.0) Nudge::Absolute(1.0), true, "1: ideal control, which decides without delay in every epoch by single readings.";
}
