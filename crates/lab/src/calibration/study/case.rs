//! One simulation of a study and the recordings that it is compared with.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Vector3;

use crate::calibration::recording::{digest, in_short, joints, plausibility};
use crate::calibration::study::own_case::own_cases;
use crate::calibration::study::{scene_file, scored_columns};
use crate::calibration::{BaseRule, Definition, StartRule};
use realgap_core::statistics::ends_of;
use realgap_core::unit::counted;
use realgap_core::{Advice, Code, Error, Result, Warning};
use realgap_identification::{Body, EQUAL_MOMENTS, KnownFlight, Refined, StartState, refine};
use realgap_path::trajectory::{
    Alignment, Prepared, Recording, State, Trajectory, clip, prepare_as,
};
use realgap_simulation::{Experiment, Sampling, Start};
use realgap_store::CaseRow;

/// One recording in the form that is compared: cut to the simulated duration, and prepared.
#[derive(Debug, Clone)]
pub struct Target {
    /// Index of the recording in the study.
    pub recording: usize,
    /// The motion, cut to the simulated duration.
    pub motion: Trajectory,
    /// The prepared motion.
    pub prepared: Prepared,
}

impl Target {
    /// The target in true lengths, where the recorded lengths are `length_scale` times the true ones.
    ///
    /// # Errors
    /// Lengths that are no longer finite.
    pub fn in_true_lengths(&self, length_scale: f64) -> Result<Cow<'_, Self>> {
        if length_scale == 1.0 {
            return Ok(Cow::Borrowed(self));
        }
        let motion = self.motion.scaled(1.0 / length_scale)?;
        let prepared = prepare_as(&motion, self.prepared.alignment())?;
        Ok(Cow::Owned(Self {
            recording: self.recording,
            motion,
            prepared,
        }))
    }
}

/// One simulation of a study: a start, and the recordings that share it.
#[derive(Debug, Clone)]
pub struct Case {
    /// The experiment before the study's parameters are set.
    pub experiment: Experiment,
    /// The recordings it is compared with, at least one.
    pub targets: Vec<Target>,
    /// The free flight that was identified last from the recording, kept as a cache for the next identification.
    pub(in crate::calibration) flight: Arc<Mutex<Option<KnownFlight>>>,
    /// The last rows, where parameters differ between runs: a parameter of another run does not change this one.
    known: Arc<Mutex<Vec<KnownRow>>>,
}

/// A run that was simulated.
#[derive(Debug)]
struct KnownRow {
    experiment: Experiment,
    has_errors: bool,
    row: CaseRow,
}

/// Rows that are kept of a case: of a point, and of others that are simulated at the same time.
const KNOWN_ROWS: usize = 4;

impl Case {
    pub(in crate::calibration) fn new(experiment: Experiment, targets: Vec<Target>) -> Self {
        Self {
            experiment,
            targets,
            flight: Arc::default(),
            known: Arc::default(),
        }
    }

    /// The row of an experiment of this case, which is `made` unless it is one of the last. Only where parameters differ between runs
    /// are rows kept.
    ///
    /// # Errors
    /// Those of `made`.
    pub(in crate::calibration) fn row(
        &self,
        experiment: &Experiment,
        has_errors: bool,
        made: impl FnOnce() -> Result<CaseRow>,
    ) -> Result<CaseRow> {
        if experiment.run.is_none() {
            return made();
        }
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same =
            |one: &KnownRow| one.has_errors == has_errors && one.experiment == *experiment;
        {
            let mut known = lock();
            if let Some(place) = known.iter().position(is_same) {
                let found = known.remove(place);
                let row = found.row.clone();
                known.push(found);
                return Ok(row);
            }
        }
        let row = made()?;
        let mut known = lock();
        if known.len() >= KNOWN_ROWS {
            known.remove(0);
        }
        known.push(KnownRow {
            experiment: experiment.clone(),
            has_errors,
            row: row.clone(),
        });
        Ok(row)
    }

    /// Body length of the robot, metres; `None` where nobody states it.
    pub fn body_length_m(&self) -> Option<f64> {
        let stated_m = self.experiment.assembly.body_length_m;
        (stated_m > 0.0).then_some(stated_m)
    }
}

/// Samples per second of a simulation that starts settled; the comparison resamples to 182 points anyway.
const SETTLED_RATE_HZ: f64 = 60.0;

/// The cases of a study, of each of its robots: one case for all recordings where the start is settled, otherwise one case per
/// recording.
pub(in crate::calibration) fn cases(definition: &Definition) -> Result<(Vec<Case>, Vec<Warning>)> {
    if definition.recordings.is_empty() {
        return Err(
            definition.at_file(Error::invalid("no recordings to compare with").field("recordings"))
        );
    }
    let mut recordings = definition.recordings.iter();
    if !definition.metric.needs().joints
        && let Some(recording) = recordings.find(|r| r.trajectory.is_of_joints())
    {
        return Err(Error::invalid("a recording of joints alone has no path")
            .field("metric")
            .found(definition.metric.name())
            .allowed("joints")
            .at_file(&recording.path));
    }
    if !definition.robots.is_empty() {
        return cases_of_all(definition);
    }
    let base = definition.experiment();
    if definition.own_simulator.is_some() {
        return own_cases(definition, &base);
    }
    match definition.start {
        StartRule::Settled => settled(definition, &base),
        StartRule::FromRecording => from_recordings(definition, &base),
    }
}

/// The cases of every robot, in the order of the robots.
fn cases_of_all(definition: &Definition) -> Result<(Vec<Case>, Vec<Warning>)> {
    let (mut all, mut warnings) = (Vec::new(), Vec::new());
    for member in &definition.robots {
        let (own, said) = cases(&definition.of_member(member))?;
        all.extend(own.into_iter().map(|mut case| {
            for target in &mut case.targets {
                target.recording += member.recordings.start;
            }
            case
        }));
        warnings.extend(said);
    }
    Ok((all, warnings))
}

/// The error of a run; where the times of recordings are doubtful, with a hint that says what to correct.
fn doubted(error: Error, recordings: &[Recording]) -> Error {
    let mut warnings = recordings.iter().flat_map(|recording| &recording.warnings);
    match warnings.find(|warning| warning.code == Code::UnlikelyTime) {
        Some(warning) => error.hint(&warning.message).advise(Advice::TimeUnit),
        None => error,
    }
}

fn settled(definition: &Definition, base: &Experiment) -> Result<(Vec<Case>, Vec<Warning>)> {
    let mut warnings = Vec::new();
    let durations_s = definition.recordings.iter();
    let (shortest_s, _) = ends_of(durations_s.map(|r| r.trajectory.duration_s()));
    let mut duration_s = definition.duration_s.unwrap_or(shortest_s);
    if duration_s > shortest_s + 1e-6 {
        warnings.push(Code::ShortRecording.warning(format!(
            "a recording lasts only {shortest_s:.3} s; {shortest_s:.3} s are simulated and compared instead of {duration_s} s"
        )));
        duration_s = shortest_s;
    }
    let mut experiment = base.clone();
    // Runs that begin at the same settled start share the tracks of the bodies in the first recording.
    scene_file::lead(&mut experiment, &definition.recordings[0])?;
    experiment.duration_s = duration_s;
    experiment.sampling = Sampling::Rate(SETTLED_RATE_HZ);
    experiment
        .check()
        .map_err(|e| definition.at_file(doubted(e, &definition.recordings)))?;
    let mut cases: Vec<Case> = Vec::new();
    // Recordings of one start share a run, unless they were commanded differently. Experiments are compared only where a digest of
    // their commands agrees, so that thousands of recordings take linear time.
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
    for (index, recording) in definition.recordings.iter().enumerate() {
        let target = target(definition, (index, recording), duration_s, &mut warnings)?;
        let mut own = experiment.clone();
        definition.name_run(&mut own, recording);
        scored_columns::instruments(&mut own, recording, &definition.channels)
            .map_err(|e| definition.at_file(e))?;
        warnings.extend(scored_columns::not_scored(recording, &definition.channels));
        if let Some(commands) = &definition.commands {
            commands
                .set_up(&mut own, recording)
                .map_err(|e| definition.at_file(e))?;
        }
        let commands = own.commands.values().flat_map(|track| track.values());
        let alike = known.entry(digest(commands)).or_default();
        if let Some(shared) = alike.iter().find(|case| cases[**case].experiment == own) {
            cases[*shared].targets.push(target);
            continue;
        }
        if definition.commands.is_none() {
            warnings.extend(joints::unused_commands(&own, recording));
        }
        alike.push(cases.len());
        cases.push(Case::new(own, vec![target]));
    }
    Ok((cases, warnings))
}

/// A warning where the study states a longer time than some recordings, or windows of them, last.
fn longer_than_recordings(definition: &Definition) -> Option<Warning> {
    let stated_s = definition.duration_s?;
    let lasting_s = definition.recordings.iter();
    let lasting_s = lasting_s.map(|recording| recording.trajectory.duration_s());
    let short: Vec<f64> = lasting_s.filter(|own_s| stated_s > own_s + 1e-6).collect();
    let shortest_s = short.iter().copied().reduce(f64::min)?;
    Some(Code::ShortRecording.warning(format!(
        "{} of {} last less than the {stated_s} s of the study, the shortest {shortest_s:.3} s: each is simulated as long as it lasts",
        short.len(),
        counted(definition.recordings.len(), "recording"),
    )))
}

fn from_recordings(
    definition: &Definition,
    base: &Experiment,
) -> Result<(Vec<Case>, Vec<Warning>)> {
    let mut warnings = Vec::new();
    let mut cases = Vec::with_capacity(definition.recordings.len());
    warnings.extend(longer_than_recordings(definition));
    for (index, recording) in definition.recordings.iter().enumerate() {
        let length_s = recording.trajectory.duration_s();
        let target = target(
            definition,
            (index, recording),
            definition.duration_s.unwrap_or(length_s).min(length_s),
            &mut warnings,
        )?;
        let times_s = target.motion.times_s();
        let mut experiment = base.clone();
        definition.name_run(&mut experiment, recording);
        if definition.base == BaseRule::Recorded {
            let led = experiment.lead_base(&recording.trajectory);
            led.map_err(|e| e.field("base").at_file(&recording.path))?;
            experiment.start = Start::Settled;
        } else if recording.trajectory.is_of_joints() && base.assembly.world_from_mount.is_some() {
            // A robot that is held at its root needs no start state but that of its joints.
            experiment.start = Start::Settled;
        } else {
            experiment.start = Start::State(first_state(recording, &mut warnings)?);
        }
        joints::set_up(
            &mut experiment,
            recording,
            definition.commands.as_ref(),
            &definition.left_out,
            &mut warnings,
        )
        .map_err(|e| definition.at_file(e))?;
        scored_columns::instruments(&mut experiment, recording, &definition.channels)
            .map_err(|e| definition.at_file(e))?;
        warnings.extend(scored_columns::not_scored(recording, &definition.channels));
        scene_file::lead(&mut experiment, recording)?;
        experiment.duration_s = target.motion.duration_s();
        experiment.sampling = Sampling::Times(times_s.iter().map(|t| t - times_s[0]).collect());
        experiment
            .check()
            .map_err(|e| doubted(e, std::slice::from_ref(recording)).at_file(&recording.path))?;
        cases.push(Case::new(experiment, vec![target]));
    }
    warnings.extend(start_state_warnings(definition, &cases)?);
    let doubts = cases.iter().zip(&definition.recordings);
    let doubts =
        doubts.filter_map(|(case, recording)| plausibility::floor(&case.experiment, recording));
    warnings.extend(in_short(doubts.collect()));
    Ok((cases, warnings))
}

/// Warnings about starts that were identified from more than the first sample: the runs are then no pure predictions from the
/// first sample, and every report has to say so.
fn start_state_warnings(definition: &Definition, cases: &[Case]) -> Result<Vec<Warning>> {
    let rule = definition.start_state;
    if rule == StartState::FirstSample {
        return Ok(Vec::new());
    }
    let mut warnings = vec![Code::RefinedStart.warning(format!("start states: {}", rule.label()))];
    if rule == StartState::Flight
        && Body::new(&cases[0].experiment)
            .is_ok_and(|body| body.linkage.is_none() && body.moment_ratio > EQUAL_MOMENTS)
    {
        warnings.push(Code::UnequalMoments.warning(
            "start states are fitted with a constant angular velocity, but the robot's moments of inertia differ",
        ));
    }
    let mut without = 0;
    for case in cases {
        let recorded = &definition.recordings[case.targets[0].recording].trajectory;
        let (_, refined) = refine(rule, case.experiment.clone(), recorded)
            .map_err(|e| definition.at_file(e).field("start_state"))?;
        without += usize::from(refined == Refined::NoFlight);
    }
    if without > 0 {
        warnings.push(Code::NoFlight.warning(format!(
            "{without} of {} recordings have no flight to fit; their start is corrected by half a sample instead",
            cases.len()
        )));
    }
    Ok(warnings)
}

/// What is compared of a recording along whose poses the base is led.
fn joints_alone(motion: &Trajectory) -> Result<Trajectory> {
    let nowhere = vec![Vector3::zeros(); motion.len()];
    Trajectory::new(motion.times_s().to_vec(), nowhere)?
        .with_joints(motion.joints().to_vec())?
        .with_signals(motion.signals().to_vec())
}

pub(super) fn target(
    definition: &Definition,
    (index, recording): (usize, &Recording),
    duration_s: f64,
    warnings: &mut Vec<Warning>,
) -> Result<Target> {
    let mut motion = clip(&recording.trajectory, duration_s)?;
    if definition.base == BaseRule::Recorded {
        motion = joints_alone(&motion)?;
    }
    let alignment = match motion.is_of_joints() {
        // A robot whose joints alone were recorded has no path.
        true => Alignment::default(),
        false => definition.align,
    };
    let prepared = prepare_as(&motion, alignment).map_err(|e| e.at_file(&recording.path))?;
    if !motion.is_of_joints() {
        warnings.extend(prepared.warnings().iter().cloned());
    }
    Ok(Target {
        recording: index,
        motion,
        prepared,
    })
}

/// The first recorded state. Velocities that were not recorded are differences of the first two samples.
fn first_state(recording: &Recording, warnings: &mut Vec<Warning>) -> Result<State> {
    let motion = &recording.trajectory;
    if motion.is_of_joints() {
        return Err(Error::invalid(
            "a recording of joints alone does not say where a free robot is",
        )
        .at_file(&recording.path)
        .found("a robot whose root is free")
        .allowed("a robot that is held: `mount: ()` in one of bodies, `mount_m` in one of modules")
        .advise(Advice::HoldRoot));
    }
    let Some(orientations) = motion.orientations_world_from_body() else {
        return Err(
            Error::invalid("a run cannot start from a recording without orientations")
                .at_file(&recording.path)
                .found("no columns qw, qx, qy, qz")
                .hint("record orientations, or use `start: Settled` in the study"),
        );
    };
    let dt_s = motion.times_s()[1] - motion.times_s()[0];
    let mut differences = || {
        warnings.push(Code::EstimatedVelocity.warning(
            "some recordings have no velocities; their start velocity is the difference of the first two samples",
        ));
        let linear: Vector3<f64> =
            (motion.positions_world_m()[1] - motion.positions_world_m()[0]) / dt_s;
        let angular = (orientations[0].inverse() * orientations[1]).scaled_axis() / dt_s;
        (linear, angular)
    };
    let (linear, angular) = match (
        motion.velocities_world_m_s(),
        motion.angular_velocities_body_rad_s(),
    ) {
        (Some(linear), Some(angular)) => (linear[0], angular[0]),
        _ => differences(),
    };
    Ok(State {
        position_world_m: motion.positions_world_m()[0],
        orientation_world_from_body: orientations[0],
        velocity_world_m_s: linear,
        angular_velocity_body_rad_s: angular,
    })
}
