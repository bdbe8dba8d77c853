//! The study of recorded paths, which fits the floor.

use realgap::calibration::RunStart;
use realgap::robot::morphology::Hinge;
use realgap::trajectory::Recording;

use super::super::kit::*;
use super::{Draft, Drive, Subject, noise};

/// The study of friction and restitution; `falls` says that the recordings fall freely.
///
/// # Errors
/// Recordings that fall freely, of a robot that stands on the floor when its run begins.
pub(super) fn draft(
    subject: &Subject,
    recordings: &[Recording],
    falls: bool,
    drive: &Drive,
) -> Result<Draft> {
    let is_posed = recordings.iter().all(|recording| {
        let motion = &recording.trajectory;
        !motion.is_planar() && motion.orientations_world_from_body().is_some()
    });
    let has_velocities = recordings
        .iter()
        .all(|r| r.trajectory.velocities_world_m_s().is_some());
    // A robot that drives itself starts from rest; a thrown robot starts from its first recorded state.
    let is_passive = |hinge: &Hinge| {
        let is_known = |r: &Recording| r.trajectory.joint(&hinge.name).is_some();
        hinge.actuator.is_none() && recordings.iter().all(is_known)
    };
    let is_thrown = is_posed && subject.robot.assemble().hinges.iter().all(is_passive);
    let is_commanded = is_posed && drive.has_commands;
    let starts_as_seen = is_thrown || is_commanded;
    if falls && !starts_as_seen {
        let (found, hint) = match is_posed {
            true => (
                "servos, or joints that were not recorded",
                "name the robot that was thrown",
            ),
            false => (
                "no orientations (qw, qx, qy, qz)",
                "say which columns hold them, e.g. --column qw=NAME",
            ),
        };
        return Err(
            Error::usage("the recorded robot falls freely, but its simulation would start standing on the floor")
                .at_file(&recordings[0].path)
                .found(format!("{found}; the robot is \"{}\"", subject.robot.name()))
                .allowed("a robot without servos, which starts from its first recorded state, with orientations and all of its joints")
                .hint(format!("{hint}, or use the part after it has landed: --crop FROM:TO")),
        );
    }
    if !starts_as_seen {
        drive.check_at_rest(subject, recordings)?;
    }
    let mut before = match starts_as_seen {
        true if is_commanded => "    start: FromRecording, // each run starts from the first sample, as the commands do\n    commands: Commands(), // columns NAME_command_rad, NAME_command_rad_s or NAME_command_nm, held until the next\n",
        true => "    start: FromRecording, // without servos, each run starts from the first sample\n",
        false if drive.has_commands => "    start: Settled, // the robot settles on the floor, then its commands begin\n    commands: Commands(), // columns NAME_command_rad, NAME_command_rad_s or NAME_command_nm, held until the next\n",
        false if drive.has_own_gait => "    start: Settled, // the robot settles on the floor, then it moves by the gait of its own file\n",
        false => "    start: Settled, // the robot settles on the floor, where nothing drives it\n",
    }
    .to_owned();
    if starts_as_seen && !has_velocities {
        before += "    start_state: HalfSampleCorrected, // no velocities are recorded: they are computed from differences\n";
    }
    let fixed = drive.fixed_values();
    if !fixed.is_empty() {
        before += &format!(
            "    set: {{{}}}, // {}\n",
            fixed.join(", "),
            match drive.has_own_gait {
                true => "the gait of the robot's own file drives it",
                false => "the gains that were stated",
            }
        );
    }
    let metric = if is_thrown { "pose" } else { "rms" };
    let start = match starts_as_seen {
        true => RunStart::Recorded,
        false => RunStart::Settled,
    };
    let (noise, clue) = noise::section(recordings, start, &subject.robot);
    Ok(Draft {
        head: "\
// Which friction and restitution make the simulated robot move like the recorded one?
//   realgap check STUDY     is this file valid, and what is in it?
//   realgap sweep STUDY     every combination; then: realgap report FOLDER
//   realgap tune STUDY      an optimizer chooses the points
"
        .to_owned(),
        before,
        timestep_s: None,
        horizon: None,
        parameters: "        (name: \"floor.friction\", from: 0.05, to: 1.0, points: 11),\n        (name: \"floor.restitution\", from: 0.0, to: 0.8, points: 11),\n".to_owned(),
        after: format!(
            "    metric: \"{metric}\",\n    // On a slope, between walls or beside other bodies directions matter: align: World,\n{noise}"
        ),
        clues: vec![clue],
        next: "sweep STUDY".to_owned(),
    })
}
