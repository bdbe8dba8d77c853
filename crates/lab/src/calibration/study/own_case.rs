//! The cases of a study with its own simulator: what of a recording it is told.

use std::sync::Arc;

use crate::calibration::study::case::{Case, target};
use crate::calibration::{Definition, StartRule};
use realgap_core::Result;
use realgap_core::Warning;
use realgap_core::statistics::ends_of;
use realgap_path::trajectory::{COMMAND, COMMAND_SIGNALS, Recording, Trajectory};
use realgap_simulation::{Experiment, ForeignStart, Sampling, Start};

/// Samples per second that are asked of a run that all recordings share.
const SHARED_RATE_HZ: f64 = 60.0;
/// One case for all recordings where the simulator starts by itself, else one a recording.
pub(in crate::calibration) fn own_cases(
    definition: &Definition,
    base: &Experiment,
) -> Result<(Vec<Case>, Vec<Warning>)> {
    let mut warnings = Vec::new();
    let recordings = definition.recordings.iter().enumerate();
    let lengths_s = definition
        .recordings
        .iter()
        .map(|r| r.trajectory.duration_s());
    let shortest_s = definition
        .duration_s
        .unwrap_or(f64::INFINITY)
        .min(ends_of(lengths_s).0);
    let mut cases: Vec<Case> = Vec::new();
    for (index, recording) in recordings {
        let mut experiment = base.clone();
        definition.name_run(&mut experiment, recording);
        let own_s = recording.trajectory.duration_s();
        let duration_s = match definition.start {
            StartRule::Settled => shortest_s,
            StartRule::FromRecording => definition.duration_s.unwrap_or(own_s).min(own_s),
        };
        let target = target(definition, (index, recording), duration_s, &mut warnings)?;
        experiment.start = Start::Settled;
        let times_s = target.motion.times_s();
        experiment.duration_s = target.motion.duration_s();
        experiment.sampling = match definition.start {
            StartRule::Settled => Sampling::Rate(SHARED_RATE_HZ),
            StartRule::FromRecording => {
                Sampling::Times(times_s.iter().map(|t| t - times_s[0]).collect())
            }
        };
        if definition.start == StartRule::Settled {
            experiment.duration_s = duration_s;
        }
        experiment.foreign.start = Arc::new(start_of(definition.start, recording, &target.motion));
        experiment.check().map_err(|e| e.at_file(&recording.path))?;
        match cases.iter_mut().find(|case| case.experiment == experiment) {
            Some(shared) => shared.targets.push(target),
            None => cases.push(Case::new(experiment, vec![target])),
        }
    }
    Ok((cases, warnings))
}

/// What the simulator is told of a recording: its first values, where runs start from recordings, and its commands.
fn start_of(rule: StartRule, recording: &Recording, motion: &Trajectory) -> ForeignStart {
    let start_s = motion.times_s()[0];
    let mut commands = Vec::new();
    for joint in motion
        .joints()
        .iter()
        .filter(|joint| joint.name.ends_with(COMMAND))
    {
        commands.push((format!("{}_rad", joint.name), joint.angles_rad.clone()));
    }
    for signal in motion.signals() {
        let mut endings = COMMAND_SIGNALS.iter().chain([&COMMAND]);
        if endings.any(|ending| signal.name.ends_with(ending)) {
            commands.push((signal.name.clone(), signal.values.clone()));
        }
    }
    let times_s = match commands.is_empty() {
        true => Vec::new(),
        false => motion.times_s().iter().map(|t| t - start_s).collect(),
    };
    let is_from_recording = rule == StartRule::FromRecording;
    ForeignStart {
        // Recordings that share a run have no name in common.
        recording: if is_from_recording {
            recording.name.clone()
        } else {
            String::new()
        },
        values: if is_from_recording {
            first_values(motion)
        } else {
            Vec::new()
        },
        times_s,
        commands,
    }
}

/// The first value of every recorded column, by its name.
fn first_values(motion: &Trajectory) -> Vec<(String, f64)> {
    let mut values: Vec<(String, f64)> = Vec::new();
    let mut add = |names: &[&str], numbers: &[f64]| {
        values.extend(
            names
                .iter()
                .map(|name| (*name).to_owned())
                .zip(numbers.iter().copied()),
        );
    };
    if !motion.is_of_joints() {
        let places = match motion.is_planar() {
            true => &["x_m", "y_m"][..],
            false => &["x_m", "y_m", "z_m"],
        };
        add(places, motion.positions_world_m()[0].as_slice());
    }
    if let Some(turns) = motion.orientations_world_from_body() {
        let q = turns[0];
        add(&["qw", "qx", "qy", "qz"], &[q.w, q.i, q.j, q.k]);
    }
    if let Some(linear) = motion.velocities_world_m_s() {
        add(&["vx_m_s", "vy_m_s", "vz_m_s"], linear[0].as_slice());
    }
    if let Some(angular) = motion.angular_velocities_body_rad_s() {
        add(&["wx_rad_s", "wy_rad_s", "wz_rad_s"], angular[0].as_slice());
    }
    for joint in motion.joints() {
        values.push((format!("{}_rad", joint.name), joint.angles_rad[0]));
        if let Some(speeds) = &joint.speeds_rad_s {
            values.push((format!("{}_rad_s", joint.name), speeds[0]));
        }
    }
    let signals = motion.signals().iter();
    values.extend(signals.map(|signal| (signal.name.clone(), signal.values[0])));
    values
}
