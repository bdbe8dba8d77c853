//! Simulates a study before it is written, to find out whether it can answer its question.

use realgap::calibration::{PriorRuns, Study};
use realgap::file::Source;

use super::super::kit::*;
use super::{Caller, Draft, Overrides};

/// Recordings that are simulated beforehand.
const MOST: usize = 3;
/// Joints whose mean error is above this share of the spread of their angles are hardly predicted over the whole run: a fit of whole
/// runs may then end far from the truth.
const LOST: f64 = 0.3;
/// Motion that multiplies a small error by more than this over a recording is predicted over windows only.
const UNSTABLE: f64 = 10.0;
/// The largest spread of angles that counts, radians.
const WOUND_RAD: f64 = 1.0;
/// Joints whose mean error is below this share are predicted well over a window.
const FOLLOWED: f64 = 0.2;
/// Lengths of windows that are tried, seconds, from the longest.
const WINDOWS_S: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
/// Windows of one recording.
const MOST_WINDOWS: f64 = 40.0;
/// How often the timestep is halved, where runs diverge or change with it.
const HALVINGS: usize = 3;

/// A study that was simulated before it is written.
pub(super) struct Rehearsed {
    pub text: String,
    pub study: Study,
    /// What the reader must know first.
    pub doubts: Vec<String>,
}

/// Simulates the study of a draft with the robot's own values and in the middle of the ranges, and changes its timestep and its
/// horizon where runs diverge or are lost; `caller` shows the runs, `text_of` writes a draft.
///
/// # Errors
/// A study that is not valid.
pub(super) fn rehearse(
    draft: &mut Draft,
    output: &Path,
    caller: &impl Caller,
    text_of: impl Fn(&Draft) -> Result<String>,
) -> Result<Rehearsed> {
    let parsed = |draft: &Draft| {
        let text = text_of(draft)?;
        let study = Study::parse(&Source::new(output, text.clone()), &Overrides::default())?;
        Ok::<(String, Study), Error>((text, study))
    };
    let run = |study: &Study| caller.during(2 * MOST, |run| study.prior_runs(MOST, run));
    let mut doubts = Vec::new();
    let (mut text, mut study) = parsed(draft)?;
    let mut prior = run(&study)?;
    for _ in 0..HALVINGS {
        let timestep_s = study.cases()[0].experiment.solver.timestep_s;
        let Some(because) = too_long(&prior, timestep_s) else {
            break;
        };
        draft.timestep_s = Some(timestep_s / 2.0);
        draft.clues.retain(|(what, _)| *what != SHORTER);
        draft.clues.push((SHORTER, because));
        (text, study) = parsed(draft)?;
        prior = run(&study)?;
    }
    if let Some(horizon) = windows(&study, &prior, draft, &parsed, &run)? {
        draft.horizon = Some(horizon);
        draft.clues.push((
            "runs start again and again from what was recorded (`horizon`)",
            format!(
                "over whole recordings the joints are {:.0} mrad off before anything is fitted, and small errors grow by a factor of {:.0}",
                1e3 * prior.joint_error_rad().unwrap_or_default(),
                prior.growth().unwrap_or_default()
            ),
        ));
        (text, study) = parsed(draft)?;
        prior = run(&study)?;
    }
    let count = prior.runs.len();
    match prior.diverged() {
        0 => {}
        diverged if diverged == count => doubts.push(format!(
            "every one of {count} runs before the fit diverges: this study cannot answer; check masses and inertias of the robot, and its timestep"
        )),
        diverged => doubts.push(format!("{diverged} of {count} runs before the fit diverge")),
    }
    if let Some(still) = prior.standing_still() {
        doubts.push(format!(
            "the simulated robot moves {} {}, and {} was recorded in {}: a fit would explain nothing; does the robot's file have the servos, gears and sizes of the recorded robot, and do the recordings hold its commands?",
            quantity(still.simulated.unwrap_or_default(), still.unit),
            still.point.label(),
            quantity(still.recorded, still.unit),
            still.recording
        ));
    }
    if !prior.idle_commands.is_empty() {
        doubts.push(format!(
            "the recorded commands of {} change nothing: with commands twice as large the robot moves alike; check servo and limits of these joints in the robot's file",
            prior.idle_commands.join(", ")
        ));
    }
    Ok(Rehearsed {
        text,
        study,
        doubts,
    })
}

/// Why runs need a shorter timestep than this, if they do: some diverge, or half of it changes the joints by more than a fit overlooks. Joints
/// that multiply small errors are changed by any other timestep.
fn too_long(prior: &PriorRuns, timestep_s: f64) -> Option<String> {
    if prior.diverged() > 0 {
        return Some(format!("runs diverge with {timestep_s} s"));
    }
    let is_stable = prior.growth().is_none_or(|growth| growth < UNSTABLE);
    let (change_rad, most_rad) = prior.coarse_step_rad().filter(|_| is_stable)?;
    Some(format!(
        "with {timestep_s} s, half of it changes the joints by {:.2} mrad on average, and a fit would see more than {:.2} mrad",
        1e3 * change_rad,
        1e3 * most_rad
    ))
}

/// The clue of a shorter timestep.
const SHORTER: &str = "the timestep is shorter than usual";

/// The longest windows over which the joints are followed, where they are lost over whole recordings; the shortest windows if
/// none is followed.
fn windows(
    study: &Study,
    prior: &PriorRuns,
    draft: &mut Draft,
    parsed: &impl Fn(&Draft) -> Result<(String, Study)>,
    run: &impl Fn(&Study) -> Result<PriorRuns>,
) -> Result<Option<(f64, f64)>> {
    // Joints that wind up spread without limit, but one that is a radian off is lost, too.
    let spread_rad = prior.joint_spread_rad().min(WOUND_RAD);
    let is_lost = match prior.joint_error_rad() {
        // A servo with wrong gains is as far off in a window as over the whole run; only motion that multiplies errors is not.
        Some(error_rad) => {
            error_rad > LOST * spread_rad && prior.growth().is_some_and(|growth| growth > UNSTABLE)
        }
        None => prior.diverged() > 0 && study.definition().metric.needs().joints,
    };
    let recordings = study.definition().recordings.iter();
    let shortest_s = recordings
        .map(|r| r.trajectory.duration_s())
        .fold(f64::INFINITY, f64::min);
    if !is_lost || draft.horizon.is_some() {
        return Ok(None);
    }
    let mut chosen = None;
    for length_s in WINDOWS_S
        .into_iter()
        .filter(|length_s| 4.0 * length_s <= shortest_s)
    {
        let every_s = length_s.max((100.0 * shortest_s / MOST_WINDOWS).ceil() / 100.0);
        draft.horizon = Some((length_s, every_s));
        chosen = draft.horizon;
        let error_rad = run(&parsed(draft)?.1)?.joint_error_rad();
        if error_rad.is_some_and(|error_rad| error_rad < FOLLOWED * spread_rad) {
            break;
        }
    }
    draft.horizon = None;
    Ok(chosen)
}
