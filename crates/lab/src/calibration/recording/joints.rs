//! The joints of recordings, and of the robot that is simulated in their place.

use crate::calibration::recording::file_pattern::name_matches;
use crate::calibration::recording::start_speed::StartSpeed;
use crate::calibration::study::command_file::ON;
use crate::calibration::{CommandColumn, Commands};
use realgap_core::{Code, Error, Result, Warning};
use realgap_path::trajectory::{
    MeasuredQuantity, Recording, Trajectory, UNITLESS_COMMANDS, may_be_attitude,
};
use realgap_robot::morphology::{Hinge, Morphology};
use realgap_simulation::{Experiment, JointState};

/// Starts the robot's joints at the recorded angles, has the run record the joints, and gives the servos the recorded commands,
/// where the recording has any of the robot's joints.
///
/// # Errors
/// Joints of the robot without a column, and columns without a joint, that `left_out` does not name; the errors of
/// [`Commands::set_up`].
pub(in crate::calibration) fn set_up(
    experiment: &mut Experiment,
    recording: &Recording,
    commands: Option<&Commands>,
    left_out: &[String],
    warnings: &mut Vec<Warning>,
) -> Result<()> {
    let motion = &recording.trajectory;
    warnings.extend(check_names(experiment, recording, commands, left_out)?);
    let hinges = &experiment.assembly.hinges;
    if hinges.iter().any(|h| motion.joint(&h.name).is_some()) {
        experiment.start_joints = hinges
            .iter()
            .map(|hinge| match motion.joint(&hinge.name) {
                Some(joint) => JointState {
                    angle_rad: joint.angles_rad[0],
                    speed_rad_s: match &joint.speeds_rad_s {
                        Some(speeds) => speeds[0],
                        None => StartSpeed::of(motion.times_s(), &joint.angles_rad).rad_s,
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
    match commands {
        Some(commands) => commands.set_up(experiment, recording),
        None => Ok(()),
    }
}

/// Joints of a robot and columns of a recording that do not match each other, by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unmatched<'a> {
    /// Joints without a recorded angle.
    pub joints: Vec<&'a str>,
    /// Columns of joints, commands and switches that match no joint.
    pub columns: Vec<&'a str>,
}

impl<'a> Unmatched<'a> {
    /// Those of this robot and recording. Columns that command servos are matched where there are `commands`.
    pub fn of(hinges: &'a [Hinge], motion: &'a Trajectory, commands: Option<&Commands>) -> Self {
        let is_hinge = |name: &str| hinges.iter().any(|hinge| hinge.name == name);
        let taken = commands.map_or_else(Vec::new, |c| c.columns_of(hinges, motion));
        let is_taken = |name: &str| {
            let switches = || commands.is_some() && name.strip_suffix(ON).is_some_and(is_hinge);
            let commands_it = |command: &CommandColumn| {
                command.column == name || command.on.as_deref() == Some(name)
            };
            taken.iter().any(commands_it) || switches()
        };
        let joints = motion.joints().iter().map(|joint| joint.name.as_str());
        let signals = motion.signals().iter().map(|signal| signal.name.as_str());
        // What sensors measured is no command; a study that does not score it says so.
        let signals = signals.filter(|name| MeasuredQuantity::of_column(name).is_none());
        let columns = joints.filter(|name| !is_hinge(name)).chain(signals);
        let names = hinges.iter().map(|hinge| hinge.name.as_str());
        Self {
            joints: names.filter(|name| motion.joint(name).is_none()).collect(),
            columns: columns.filter(|name| !is_taken(name)).collect(),
        }
    }
}

/// A warning about the forms of names in `left_out` that leave nothing out: they are no column without a joint and no joint without a
/// column in any recording, misspelt for example.
pub(in crate::calibration) fn left_out_in_vain(
    robot: &Morphology,
    recordings: &[Recording],
    commands: Option<&Commands>,
    left_out: &[String],
) -> Option<Warning> {
    let mut vain: Vec<&str> = left_out.iter().map(String::as_str).collect();
    if vain.is_empty() {
        return None;
    }
    let hinges = robot.assemble().hinges;
    for recording in recordings {
        let Unmatched { joints, columns } = Unmatched::of(&hinges, &recording.trajectory, commands);
        vain.retain(|form| {
            let mut names = joints.iter().chain(&columns);
            !names.any(|name| name_matches(form, name))
        });
    }
    (!vain.is_empty()).then(|| {
        Code::NoEffect.warning(format!(
            "`left_out` names {}, but no recording has such a column without a joint, and no joint of this name is without a column",
            vain.iter().map(|form| format!("\"{form}\"")).collect::<Vec<_>>().join(", ")
        ))
    })
}

/// Checks that every joint has its column and every column its joint.
fn check_names(
    experiment: &Experiment,
    recording: &Recording,
    commands: Option<&Commands>,
    left_out: &[String],
) -> Result<Option<Warning>> {
    let motion = &recording.trajectory;
    let hinges = &experiment.assembly.hinges;
    if motion.joints().is_empty() && motion.signals().is_empty() {
        return Ok(None);
    }
    let is_left_out = |name: &&str| left_out.iter().any(|form| name_matches(form, name));
    let Unmatched {
        joints: mut missing,
        columns: mut others,
    } = Unmatched::of(hinges, motion, commands);
    missing.retain(|name| !is_left_out(name));
    others.retain(|name| !is_left_out(name));
    // Beside a recorded pose, a column with an angle's name belongs to the attitude of the body.
    let (attitude, others): (Vec<&str>, Vec<&str>) = others
        .into_iter()
        .partition(|name| may_be_attitude(name) && !motion.is_of_joints());
    if hinges.is_empty() || (missing.len() == hinges.len() && !motion.is_of_joints()) {
        // The recording has poses, so its other columns need not match joints.
        let all: Vec<&str> = attitude.into_iter().chain(others).collect();
        return Ok((!all.is_empty()).then(|| unused(&all)));
    }
    if missing.is_empty() && others.is_empty() {
        return Ok((!attitude.is_empty()).then(|| unused(&attitude)));
    }
    // The name of a joint is that of its column without the unit, so only what stands as a signal has none.
    let is_signal = |name: &str| motion.signals().iter().any(|signal| signal.name == name);
    let has_no_unit =
        |name: &&&str| is_signal(name) && UNITLESS_COMMANDS.iter().any(|end| name.ends_with(end));
    if let Some(command) = others.iter().find(has_no_unit) {
        return Err(Error::invalid("a column of commands states no unit")
            .at_file(&recording.path)
            .field(*command)
            .allowed("NAME_command_rad, NAME_command_rad_s, NAME_command_nm, NAME_command_a or NAME_command_duty (-1 to 1)")
            .hint(format!(
                "rename it in the study, `reading: (names: {{\"{command}\": \"NAME_command_nm\"}})`, or leave it out: `left_out: [\"{command}\"]`"
            )));
    }
    let list = |names: &[&str]| match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    };
    let mut error = Error::invalid("joints of the robot and columns of the recording do not match")
        .at_file(&recording.path)
        .found(format!(
            "joints without a column: {}; columns without a joint: {}",
            list(&missing),
            list(&others)
        ))
        .allowed("a column NAME_rad for every joint NAME");
    error = if commands.is_none() && others.iter().any(|name| name.contains("command")) {
        error.hint(
            "add `commands: Commands()` to the study: servos then do what NAME_command_rad says",
        )
    } else {
        error.hint("name columns in the study, `reading: (names: {\"theirs\": \"NAME_rad\"})`, or what is meant to be left out, `left_out: [\"NAME\"]`")
    };
    Err(error)
}

/// A warning where recorded commands of the robot's servos are not used, because the study does not say so.
pub(in crate::calibration) fn unused_commands(
    experiment: &Experiment,
    recording: &Recording,
) -> Option<Warning> {
    let commands = Commands::default();
    let hinges = &experiment.assembly.hinges;
    let columns = commands.columns_of(hinges, &recording.trajectory);
    let names: Vec<&str> = columns
        .iter()
        .map(|command| command.column.as_str())
        .collect();
    (!names.is_empty()).then(|| {
        Code::ColumnsIgnored.warning(format!(
            "recorded commands are not used: {}; the servos follow the gait in the robot's file; with `commands: Commands()` in the study they do what was recorded",
            names.join(", ")
        ))
    })
}

fn unused(names: &[&str]) -> Warning {
    let message = format!(
        "recorded joints that the robot does not have: {}",
        names.join(", ")
    );
    Code::ColumnsIgnored.warning(message)
}
