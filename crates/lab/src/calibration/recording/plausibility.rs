//! Checks of recordings that are probably not as they are read: lengths, angles and heights that do not fit the robot, and a run
//! that occurs twice.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3};

use crate::calibration::recording::digest;
use realgap_core::unit::{LengthUnit, number};
use realgap_core::{Code, Warning};
use realgap_path::trajectory::{COMMAND, Recording, odd_axes};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Posture};

/// A robot that seems to move farther than this, in body lengths, may have been measured in another unit.
const FAR: f64 = 100.0;
/// No robot is faster than this, in body lengths per second.
const FAST_1_S: f64 = 5.0;
/// A recording that goes this many times as far as the others of the same robot may be in another unit.
const BEYOND_OTHERS: std::ops::Range<f64> = 300.0..3000.0;
/// A robot that seems to move less far than this, in body lengths, may have been measured in another unit.
const NEAR: f64 = 0.05;

/// Warnings about recordings whose lengths would fit the robot better in another unit.
pub(in crate::calibration) fn lengths(
    robot: &Morphology,
    recordings: &[Recording],
) -> Vec<Warning> {
    let body_m = robot.summary().body_length_m;
    let extents_m: Vec<f64> = recordings.iter().map(|r| r.trajectory.extent_m()).collect();
    let mut sorted_m = extents_m.clone();
    sorted_m.sort_by(f64::total_cmp);
    let unlikely = recordings.iter().zip(&extents_m);
    let unlikely = unlikely.filter_map(|(recording, extent_m)| {
        let motion = &recording.trajectory;
        let far = extent_m / body_m;
        let is_far = far > FAR && far > FAST_1_S * motion.duration_s();
        let is_near = recording.reading.scales_lengths() && far < NEAR;
        if !is_far && !is_near {
            return beyond_others(recording, *extent_m, &sorted_m);
        }
        let others = LengthUnit::METRIC
            .iter()
            .filter(|_| is_far)
            .filter_map(|unit| {
                let there = far * unit.metres();
                let fits = *unit != LengthUnit::Metre && (NEAR..FAR).contains(&there);
                fits.then(|| format!("`{}` makes it {}", recording.in_unit(*unit), number(there)))
            });
        let others: Vec<String> = others.collect();
        let remedy = if others.is_empty() {
            "is the unit of length right?".to_owned()
        } else {
            others.join(", ")
        };
        Some(Code::UnlikelyLength.warning(format!(
            "{}: the robot goes {} body lengths from where it starts; {remedy}",
            recording.name,
            number(far)
        )))
    });
    unlikely.collect()
}

/// The median of all extents but `own_m`, one of them; `None` if there is no other. `extents_m` increase.
fn usual_extent_m(extents_m: &[f64], own_m: f64) -> Option<f64> {
    let middle = extents_m.len().checked_sub(1)? / 2;
    let own = extents_m.partition_point(|extent_m| *extent_m < own_m);
    extents_m.get(middle + usize::from(middle >= own)).copied()
}

/// A warning about a recording that goes about 1000 times as far as the others: one file in millimetres among files in metres.
fn beyond_others(recording: &Recording, own_m: f64, extents_m: &[f64]) -> Option<Warning> {
    let usual_m = usual_extent_m(extents_m, own_m)?;
    let times = own_m / usual_m;
    (usual_m > 0.0 && BEYOND_OTHERS.contains(&times)).then(|| {
        Code::UnlikelyLength.warning(format!(
            "{}: the robot goes {} times as far as in the other recordings: is this file in millimetres (`length: \"mm\"`), and are the others in metres?",
            recording.name,
            number(times)
        ))
    })
}

/// A warning about axes that are probably not x forward, y to the left, z up.
pub(in crate::calibration) fn axes(
    robot: &Morphology,
    recordings: &[Recording],
) -> Option<Warning> {
    let body_m = robot.summary().body_length_m;
    Some(Code::UnknownAxes.warning(odd_axes(recordings, body_m)?))
}

/// A recorded angle is doubtful where it lies beyond its joint's limits by more than this share of the limits' range.
const BEYOND: f64 = 0.25;

/// Warnings about angles and commands far beyond the limits of their joint: most of them are degrees that are read as radians.
pub(in crate::calibration) fn angles(robot: &Morphology, recordings: &[Recording]) -> Vec<Warning> {
    let assembly = robot.assemble();
    let limited = |name: &str| {
        let whose = name.strip_suffix(COMMAND).unwrap_or(name);
        let hinge = assembly.hinges.iter().find(|hinge| hinge.name == whose)?;
        hinge.bearing.limits_rad
    };
    let of = |recording: &Recording| {
        let found = recording.trajectory.joints().iter().find_map(|joint| {
            let (low_rad, high_rad) = limited(&joint.name)?;
            let slack_rad = BEYOND * (high_rad - low_rad);
            let is_beyond =
                |angle_rad: &&f64| **angle_rad < low_rad - slack_rad || **angle_rad > high_rad + slack_rad;
            let angle_rad = joint.angles_rad.iter().find(is_beyond)?;
            Some(format!(
                "{}: `{}` is recorded at {}, its limits are {} and {}: are the angles in degrees (a column NAME_deg), or counted from elsewhere (joint.NAME.zero_rad)?",
                recording.name,
                joint.name,
                number(*angle_rad),
                number(low_rad),
                number(high_rad)
            ))
        })?;
        Some(Code::UnlikelyAngle.warning(found))
    };
    recordings.iter().filter_map(of).collect()
}

/// Warnings about recordings in which the body moves, of a robot that is held at its root.
pub(in crate::calibration) fn held(robot: &Morphology, recordings: &[Recording]) -> Vec<Warning> {
    if robot.assemble().world_from_mount.is_none() {
        return Vec::new();
    }
    let of = |recording: &Recording| {
        let motion = &recording.trajectory;
        if motion.is_of_joints() || motion.extent_m() <= NEAR * robot.summary().body_length_m {
            return None;
        }
        let message = format!(
            "{}: goes {} m from where it starts, and \"{}\" is held at its root: is this the robot that was recorded? If what holds it moves, `base: Recorded` in the study leads the root along the recorded pose",
            recording.name,
            number(motion.extent_m()),
            robot.name()
        );
        Some(Code::OtherRobot.warning(message))
    };
    recordings.iter().filter_map(of).collect()
}

/// Warnings about a run that occurs twice, which makes reality look more repeatable than it is.
pub(in crate::calibration) fn duplicate_recordings(recordings: &[Recording]) -> Vec<Warning> {
    // Trajectories are compared only where a digest of their numbers agrees, so that thousands of recordings take linear time.
    let mut known: HashMap<u64, Vec<&Recording>> = HashMap::new();
    let mut warnings = Vec::new();
    for recording in recordings {
        let motion = &recording.trajectory;
        let places = motion.positions_world_m().iter().flatten();
        let angles_rad = motion.joints().iter().flat_map(|joint| &joint.angles_rad);
        let alike = known.entry(digest(places.chain(angles_rad))).or_default();
        let mut twins = alike.iter();
        if let Some(twin) = twins.find(|other| other.trajectory == recording.trajectory) {
            let message = format!("{}: is the same run as {}", recording.name, twin.name);
            warnings.push(Code::SameRun.warning(message));
        }
        alike.push(recording);
    }
    warnings
}

/// Poses are doubtful where the robot's lowest point is always above the floor, or ever below it, by more than this share of the
/// body length.
const OFF: f64 = 0.1;

/// A warning about a rigid robot whose recorded poses reach into the floor, or stay above it for the whole run.
pub(in crate::calibration) fn floor(
    experiment: &Experiment,
    recording: &Recording,
) -> Option<Warning> {
    let (assembly, motion) = (&experiment.assembly, &recording.trajectory);
    let orientations = motion.orientations_world_from_body()?;
    // Above a height field, the distance from the flat floor says nothing.
    let is_rough = experiment.ground.heights.is_some();
    if motion.is_planar() || !assembly.hinges.is_empty() || is_rough {
        return None;
    }
    let posture = Posture::new(assembly);
    let places = motion.positions_world_m().iter().zip(orientations);
    let clearances_m: Vec<f64> = places
        .map(|(place_m, turn)| {
            let pose = Isometry3::from_parts(Translation3::from(*place_m), *turn);
            posture.rigid_clearance_m(&pose, &experiment.floor)
        })
        .collect();
    let (index, lowest_m) = clearances_m
        .iter()
        .copied()
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let off_m = OFF * assembly.body_length_m;
    let found = if lowest_m < -off_m {
        format!(
            "reaches {} m into the floor at {} s",
            number(-lowest_m),
            number(motion.times_s()[index])
        )
    } else if lowest_m > off_m && experiment.scene.is_empty() && experiment.ground.steps.is_empty()
    {
        format!(
            "never comes nearer to the floor than {} m",
            number(lowest_m)
        )
    } else {
        return None;
    };
    Some(Code::OffFloor.warning(format!(
        "{}: by its recorded poses the robot {found}: are its size, the unit of lengths, the axes, the order of the quaternion and the floor's height as recorded?",
        recording.name
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use realgap_path::trajectory::{JointTrack, Reading, Trajectory};

    fn recorded(angles_rad: Vec<f64>) -> Recording {
        let times_s: Vec<f64> = (0..angles_rad.len()).map(|k| 0.1 * k as f64).collect();
        let joint = JointTrack {
            name: "elbow_flex".to_owned(),
            angles_rad,
            speeds_rad_s: None,
        };
        let still = vec![Vector3::zeros(); times_s.len()];
        let trajectory =
            Trajectory::new(times_s, still).and_then(|motion| motion.with_joints(vec![joint]));
        Recording {
            name: "a".to_owned(),
            path: "a.csv".into(),
            trajectory: trajectory.unwrap(),
            log: None,
            bodies: Vec::new(),
            meta: None,
            reading: Reading::default(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn one_file_in_millimetres_among_files_in_metres_is_doubted() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../morphologies/cube.ron");
        let robot = Morphology::read(file).unwrap();
        let gone = |name: &str, factor: f64| {
            // So slow that its speed says nothing: a metre in ten hours.
            let times_s: Vec<f64> = (0..10).map(|k| 4000.0 * f64::from(k)).collect();
            let places = (0..10).map(|k| Vector3::new(0.005 * factor * f64::from(k), 0.0, 0.05));
            Recording {
                name: name.to_owned(),
                trajectory: Trajectory::new(times_s, places.collect()).unwrap(),
                ..recorded(vec![0.0; 4])
            }
        };
        let alike = [gone("a", 1.0), gone("b", 2.0), gone("c", 0.5)];
        assert!(lengths(&robot, &alike).is_empty());
        let odd = [gone("a", 1.0), gone("b", 1000.0), gone("c", 0.5)];
        let [doubt] = &lengths(&robot, &odd)[..] else {
            panic!("one doubt");
        };
        assert!(doubt.message.starts_with("b: "), "{doubt}");
    }

    #[test]
    fn degrees_in_a_column_of_radians_are_doubted_and_radians_are_not() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../morphologies/so101_arm.ron"
        );
        let robot = Morphology::read(file).unwrap();
        let rad = vec![0.0, 0.4, 0.8, 1.2];
        let deg: Vec<f64> = rad.iter().map(|angle: &f64| angle.to_degrees()).collect();
        assert!(angles(&robot, &[recorded(rad.clone())]).is_empty());
        let mut told = recorded(rad.clone());
        let mut joints = recorded(rad.clone()).trajectory.joints().to_vec();
        joints[0].name += "_command";
        joints[0].angles_rad.clone_from(&deg);
        joints.extend_from_slice(told.trajectory.joints());
        told.trajectory = told.trajectory.with_joints(joints).unwrap();
        for (odd, name) in [(recorded(deg), "elbow_flex"), (told, "elbow_flex_command")] {
            let [doubt] = &angles(&robot, &[odd])[..] else {
                panic!("one doubt of {name}");
            };
            assert_eq!(doubt.code, Code::UnlikelyAngle);
            assert!(doubt.message.contains(&format!("`{name}`")), "{doubt}");
        }
        let all = [recorded(rad.clone()), recorded(vec![0.0; 4]), recorded(rad)];
        assert_eq!(duplicate_recordings(&all).len(), 1);
    }
}
