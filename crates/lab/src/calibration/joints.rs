//! Joints of recordings and of the robot that is simulated in their place.

use super::command_file::Commands;
use realgap_core::warning::{Code, Warning};
use realgap_engine::{Experiment, JointState};
use realgap_path::trajectory::Recording;

/// Starts the robot's joints as recorded and has the run record them, where the recording has any of them.
pub(super) fn set_up(
    experiment: &mut Experiment,
    recording: &Recording,
    commands: Option<&Commands>,
    warnings: &mut Vec<Warning>,
) {
    let motion = &recording.trajectory;
    let hinges = &experiment.assembly.hinges;
    let unknown: Vec<&str> = motion
        .joints()
        .iter()
        .map(|joint| joint.name.as_str())
        .filter(|name| !commands.is_some_and(|commands| commands.is_command(name)))
        .filter(|name| !hinges.iter().any(|hinge| hinge.name == *name))
        .collect();
    if !unknown.is_empty() {
        warnings.push(Warning::new(
            Code::ColumnsIgnored,
            format!(
                "recorded joints that the robot does not have: {}",
                unknown.join(", ")
            ),
        ));
    }
    if !hinges
        .iter()
        .any(|hinge| motion.joint(&hinge.name).is_some())
    {
        return;
    }
    let dt_s = motion.times_s()[1] - motion.times_s()[0];
    experiment.start_joints = hinges
        .iter()
        .map(|hinge| match motion.joint(&hinge.name) {
            Some(joint) => JointState {
                angle_rad: joint.angles_rad[0],
                speed_rad_s: match &joint.speeds_rad_s {
                    Some(speeds) => speeds[0],
                    None => (joint.angles_rad[1] - joint.angles_rad[0]) / dt_s,
                },
            },
            None => JointState {
                angle_rad: hinge.actuator.map_or(0.0, |a| a.gait.angle_rad(0.0)),
                speed_rad_s: 0.0,
            },
        })
        .collect();
    experiment.records_joints = true;
}
