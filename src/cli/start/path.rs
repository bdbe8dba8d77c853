//! The study of recorded paths: which floor makes the robot move like this?

use realgap::trajectory::Recording;

use super::joint::is_commanded;
use super::{Draft, Subject};

/// The study of friction and restitution.
pub(super) fn draft(subject: &Subject, recordings: &[Recording]) -> Draft {
    let is_posed = recordings.iter().all(|recording| {
        let motion = &recording.trajectory;
        !motion.is_planar() && motion.orientations_world_from_body().is_some()
    });
    let has_velocities = recordings
        .iter()
        .all(|r| r.trajectory.velocities_world_m_s().is_some());
    // What drives itself starts from rest; what is thrown goes on from where it was seen first.
    let is_thrown = is_posed && subject.robot.summary().hinges == 0;
    let is_commanded = is_posed && is_commanded(&subject.robot, recordings);
    let starts_as_seen = is_thrown || is_commanded;
    let mut before = match starts_as_seen {
        true if is_commanded => "    start: FromRecording, // it goes on from the first sample, as its commands do\n    commands: Commands(), // columns NAME_command_rad, each held until the next\n",
        true => "    start: FromRecording, // nothing drives it: it goes on from the first sample\n",
        false => "    start: Settled, // it stands on the floor, then its commands begin\n",
    }
    .to_owned();
    if starts_as_seen && !has_velocities {
        before += "    start_state: HalfSampleCorrected, // no velocities are recorded: differences stand for them\n";
    }
    let metric = if is_thrown { "pose" } else { "rms" };
    Draft {
        head: "\
// Which friction and restitution make the simulated robot move like the recorded one?
//   realgap check STUDY     what is in this file, and is it sound?
//   realgap sweep STUDY     every combination; then: realgap report FOLDER
//   realgap tune STUDY      an optimizer chooses the points
"
        .to_owned(),
        before,
        parameters: "        (name: \"floor.friction\", from: 0.05, to: 1.0, points: 11),\n        (name: \"floor.restitution\", from: 0.0, to: 0.8, points: 11),\n".to_owned(),
        after: format!("    metric: \"{metric}\",\n"),
        clues: Vec::new(),
        next: "sweep STUDY".to_owned(),
    }
}
