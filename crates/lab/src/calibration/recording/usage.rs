//! Which recorded columns a study uses: a column is used if doubling its values changes what is simulated or compared.

use crate::calibration::{Definition, StartRule, Study, Target};
use realgap_core::Result;
use realgap_path::comparison::{Context, Pair};
use realgap_path::trajectory::{COMMAND, MeasuredQuantity, Recording, Signal, Trajectory};
use realgap_simulation::Experiment;
use realgap_simulation::parameter::ParameterSet;

/// Columns of a study's recordings that change neither its runs nor its scores.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnusedColumns {
    /// Names of the columns as in realgap's own files.
    pub columns: Vec<String>,
    /// Why they have no effect.
    pub because: String,
    /// What the user can do to use them.
    pub remedy: String,
}

/// A distance below this is that of a motion from itself, whose angles are rounded.
const SAME: f64 = 1e-6;

/// A recorded quantity whose columns are used together.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Recorded {
    Path,
    Height,
    Orientation,
    Velocity,
    JointAngle(String),
    JointSpeed(String),
    Signal(String),
    Body(String),
}

impl Recorded {
    /// All that a recording holds.
    fn all_in(recording: &Recording) -> Vec<Self> {
        let motion = &recording.trajectory;
        let mut all = Vec::new();
        if !motion.is_of_joints() {
            all.push(Self::Path);
            let has_height = motion.positions_world_m().iter().any(|p| p.z != 0.0);
            if !motion.is_planar() && has_height {
                all.push(Self::Height);
            }
        }
        if motion.orientations_world_from_body().is_some() {
            all.push(Self::Orientation);
        }
        if motion.velocities_world_m_s().is_some() {
            all.push(Self::Velocity);
        }
        for joint in motion.joints() {
            all.push(Self::JointAngle(joint.name.clone()));
            // Windows give every track a speed; that of a command is not recorded.
            if joint.speeds_rad_s.is_some() && !joint.name.contains(COMMAND) {
                all.push(Self::JointSpeed(joint.name.clone()));
            }
        }
        all.extend(
            motion
                .signals()
                .iter()
                .map(|s| Self::Signal(s.name.clone())),
        );
        all.extend(
            recording
                .bodies
                .iter()
                .map(|(name, _)| Self::Body(name.clone())),
        );
        all
    }

    /// The names of its columns.
    fn columns(&self) -> Vec<String> {
        let all = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        match self {
            Self::Path => all(&["x_m", "y_m"]),
            Self::Height => all(&["z_m"]),
            Self::Orientation => all(&["qw", "qx", "qy", "qz"]),
            Self::Velocity => all(&[
                "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s",
            ]),
            Self::JointAngle(name) => vec![format!("{name}_rad")],
            Self::JointSpeed(name) => vec![format!("{name}_rad_s")],
            Self::Signal(name) => vec![name.clone()],
            Self::Body(name) => vec![format!("{name}_x_m, {name}_y_m, …")],
        }
    }

    /// The recording with the values of these columns doubled; switches are turned over.
    fn doubled_in(&self, recording: &Recording) -> Result<Recording> {
        let motion = recording.trajectory.clone();
        // A constant is added, because the double of 0 is 0.
        let double =
            |values: &[f64]| -> Vec<f64> { values.iter().map(|value| 2.0 * value + 0.1).collect() };
        let places = |of: fn(nalgebra::Vector3<f64>) -> nalgebra::Vector3<f64>,
                      motion: &Trajectory| {
            motion.positions_world_m().iter().map(|p| of(*p)).collect()
        };
        let mut bodies = recording.bodies.clone();
        let changed = match self {
            Self::Path => {
                let twice = places(
                    |p| nalgebra::Vector3::new(2.0 * p.x, 2.0 * p.y, p.z),
                    &motion,
                );
                motion.with_positions(twice)?
            }
            Self::Height => {
                let twice = places(|p| nalgebra::Vector3::new(p.x, p.y, 2.0 * p.z), &motion);
                motion.with_positions(twice)?
            }
            Self::Orientation => {
                let turns = motion.orientations_world_from_body().unwrap_or_default();
                // A turn of a quarter is added, because the double of no turn is no turn.
                let quarter = nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.2, 1.2);
                let turned = turns.iter().map(|turn| quarter * turn * turn).collect();
                motion.with_orientations(turned)?
            }
            Self::Velocity => match (
                motion.velocities_world_m_s(),
                motion.angular_velocities_body_rad_s(),
            ) {
                (Some(linear), Some(angular)) => {
                    let more = |all: &[nalgebra::Vector3<f64>]| {
                        all.iter()
                            .map(|v| 2.0 * v + nalgebra::Vector3::repeat(0.1))
                            .collect()
                    };
                    let (linear, angular) = (more(linear), more(angular));
                    motion.with_velocities(linear, angular)?
                }
                _ => motion,
            },
            Self::JointAngle(name) | Self::JointSpeed(name) => {
                let mut joints = motion.joints().to_vec();
                for joint in joints.iter_mut().filter(|joint| joint.name == *name) {
                    match (self, &mut joint.speeds_rad_s) {
                        (Self::JointSpeed(_), Some(speeds)) => {
                            // A constant is added, because the double of a standstill is a standstill.
                            *speeds = speeds.iter().map(|speed| 2.0 * speed + 0.1).collect();
                        }
                        _ => {
                            joint.angles_rad =
                                joint.angles_rad.iter().map(|a| 2.0 * a + 0.1).collect()
                        }
                    }
                }
                motion.with_joints(joints)?
            }
            Self::Signal(name) => {
                let signals = motion
                    .signals()
                    .iter()
                    .map(|signal| match signal.name == *name {
                        true if name.ends_with("_on") => Signal {
                            name: name.clone(),
                            values: signal
                                .values
                                .iter()
                                .map(|on| f64::from(u8::from(*on == 0.0)))
                                .collect(),
                        },
                        true => Signal {
                            name: name.clone(),
                            values: double(&signal.values),
                        },
                        false => signal.clone(),
                    });
                let signals = signals.collect();
                motion.with_signals(signals)?
            }
            Self::Body(name) => {
                for (_, body) in bodies.iter_mut().filter(|(body, _)| body == name) {
                    let moved = body.positions_world_m().iter();
                    let moved = moved
                        .map(|p| 2.0 * p + nalgebra::Vector3::repeat(0.1))
                        .collect();
                    *body = body.clone().with_positions(moved)?;
                }
                motion
            }
        };
        Ok(Recording {
            trajectory: changed,
            bodies,
            ..recording.clone()
        })
    }

    /// Why a study does not use it, and what the user can do.
    fn reason(&self, definition: &Definition) -> (String, String) {
        let metric = definition.metric.name();
        let is_settled = definition.start == StartRule::Settled;
        let is_command = |name: &str| name.contains(COMMAND) || name.ends_with("_on");
        let start = match is_settled {
            true => "each run starts settled, at rest".to_owned(),
            false => "each run starts from the first sample".to_owned(),
        };
        let from_recording = "with `start: FromRecording` runs start from it".to_owned();
        match self {
            Self::Path | Self::Height | Self::Orientation => (
                format!("{start}, and the metric `{metric}` does not compare it"),
                "with `metric: \"pose\"` positions and orientations are compared".to_owned(),
            ),
            Self::Velocity if is_settled => (start, from_recording),
            Self::JointAngle(name) | Self::Signal(name) if is_command(name) => {
                let joint = name
                    .split(COMMAND)
                    .next()
                    .unwrap_or(name)
                    .trim_end_matches("_on");
                let hinges = definition.morphology.assemble().hinges;
                match hinges.iter().find(|hinge| hinge.name == joint) {
                    Some(hinge) if hinge.actuator.is_none() => (
                        format!("`{joint}` has no servo in the robot's file"),
                        "give it a servo there, or fit the robot without its commands".to_owned(),
                    ),
                    Some(_) if definition.commands.is_none() => (
                        "the study names no commands, so servos follow the gait of the robot's file".to_owned(),
                        "add `commands: Commands()` to the study".to_owned(),
                    ),
                    Some(_) => (
                        format!("another column commands `{joint}`, or its values are all 0"),
                        "name the column in `commands: Commands(columns: [...])`".to_owned(),
                    ),
                    None => (
                        "the robot has no joints of these names".to_owned(),
                        "rename columns after its joints: `reading: (names: {...})`".to_owned(),
                    ),
                }
            }
            Self::JointAngle(name) | Self::JointSpeed(name) => {
                let hinges = definition.morphology.assemble().hinges;
                match hinges.iter().any(|hinge| hinge.name == *name) {
                    false => (
                        "the robot has no joints of these names".to_owned(),
                        "rename columns after its joints: `reading: (names: {...})`".to_owned(),
                    ),
                    true => (
                        format!("{start}, and the metric `{metric}` does not compare it"),
                        "with `start: FromRecording` runs start from it, with `metric: \"joints\"` angles are compared".to_owned(),
                    ),
                }
            }
            Self::Velocity => (start, from_recording),
            Self::Signal(name) if MeasuredQuantity::of_column(name).is_some() => (
                "it was measured, and the study does not score it".to_owned(),
                "add `channels: [(columns: \"*_rad\"), (columns: \"NAME\")]` with its name to the study"
                    .to_owned(),
            ),
            Self::Signal(_) => (
                "it is no command of a joint of this robot".to_owned(),
                "name what it commands in `commands: Commands(columns: [...])`".to_owned(),
            ),
            Self::Body(name) => (
                format!("the study's `scene` has no body `{name}`"),
                "add it to `scene` if it touches the robot".to_owned(),
            ),
        }
    }
}

impl Study {
    /// The recorded columns that this study does not use, found by doubling the values of each in the first recording: neither the
    /// experiment nor the score may change. Nothing is simulated. Empty for studies of several robots.
    ///
    /// # Errors
    /// None for a valid study.
    pub fn unused_columns(&self) -> Result<Vec<UnusedColumns>> {
        let definition = self.definition();
        if !definition.robots.is_empty() || definition.vehicle.is_some() {
            return Ok(Vec::new());
        }
        let Some(first) = definition.recordings.first() else {
            return Ok(Vec::new());
        };
        // What is doubled is the recording itself: of a window, what surrounds it in its log would remain.
        let first = &Recording {
            log: None,
            ..first.clone()
        };
        // Thousands of recordings are not copied once more for every column.
        let alone = Definition {
            recordings: Vec::new(),
            recordings_sha256: vec![String::new()],
            split: None,
            ..definition.clone()
        };
        let Some(as_recorded) = run_of(&alone, first) else {
            return Ok(Vec::new());
        };
        let mut found: Vec<UnusedColumns> = Vec::new();
        let switches = definition.switches();
        for quantity in Recorded::all_in(first) {
            // A switch that is on all the time is used as well.
            if matches!(&quantity, Recorded::Signal(name) if switches.contains(name)) {
                continue;
            }
            let doubled = quantity.doubled_in(first)?;
            // A value that the study refuses is used.
            let Some(changed) = run_of(&alone, &doubled) else {
                continue;
            };
            if is_used(definition, &as_recorded, &changed)? {
                continue;
            }
            let (because, remedy) = quantity.reason(definition);
            let columns = quantity.columns();
            match found
                .iter_mut()
                .find(|u| u.because == because && u.remedy == remedy)
            {
                Some(alike) => alike.columns.extend(columns),
                None => found.push(UnusedColumns {
                    columns,
                    because,
                    remedy,
                }),
            }
        }
        Ok(found)
    }
}

/// The first run of a study, which names no recordings, of this recording alone, and what it is compared with; `None` where the study refuses the recording.
fn run_of(study: &Definition, recording: &Recording) -> Option<(Experiment, Target)> {
    let alone = Definition {
        recordings: vec![recording.clone()],
        ..study.clone()
    };
    let study = Study::new(alone).ok()?;
    let experiment = study.experiment_with(0, &ParameterSet::new()).ok()?;
    Some((experiment, study.cases()[0].targets[0].clone()))
}

/// Whether two recordings of one study are simulated or compared differently.
fn is_used(
    definition: &Definition,
    (as_recorded, a): &(Experiment, Target),
    (changed, b): &(Experiment, Target),
) -> Result<bool> {
    if as_recorded != changed {
        return Ok(true);
    }
    let needs = definition.metric.needs();
    if needs.basis || needs.spread {
        return Ok(a.prepared.xy_m() != b.prepared.xy_m());
    }
    let context = Context {
        body_length_m: Some(as_recorded.assembly.body_length_m),
        channels: Some(&definition.channels),
        ..Context::default()
    };
    // A simulation has the joints of the robot only, so tracks of commands are not compared.
    let hinges = &as_recorded.assembly.hinges;
    let is_hinge = |name: &str| hinges.iter().any(|hinge| hinge.name == name);
    let mut joints = b.motion.joints().to_vec();
    joints.retain(|joint| is_hinge(&joint.name));
    let simulated = b.motion.clone().with_joints(joints)?;
    let pair = Pair::new((&a.motion, &a.prepared), (&simulated, &b.prepared));
    Ok(definition.metric.compare(&pair, &context)?.value > SAME)
}
