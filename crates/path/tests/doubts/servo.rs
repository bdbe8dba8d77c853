//! Distortions of recordings of joints with commands: what goes wrong between a computer and its servos.

use realgap_path::trajectory::{JointTrack, Recording, Trajectory};

use super::distortion::{Draw, command, joint, range, spread, step_rad, with_angles};

/// A random joint and the index of its command; `None` where the command does not move.
fn commanded<'a>(
    motion: &'a Trajectory,
    draw: &mut Draw,
) -> Option<(usize, &'a JointTrack, usize)> {
    let (index, joint) = joint(motion, draw)?;
    let command = command(motion, joint)?;
    let mut all = motion.joints().iter();
    let told = all.position(|other| other.name == command.name)?;
    (spread(&command.angles_rad) > 0.02).then_some((index, joint, told))
}

/// Commands cut off so narrowly that most of them are at an end.
pub(super) fn saturated(
    recording: &Recording,
    _: &[Recording],
    draw: &mut Draw,
) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (_, _, told) = commanded(motion, draw)?;
    let values = &motion.joints()[told].angles_rad;
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
    let outside = draw.between(0.6, 0.9);
    let low = draw.between(0.35, 0.65) * outside;
    let (low, high) = (at(low), at(1.0 - (outside - low)));
    let clipped: Vec<f64> = values.iter().map(|value| value.clamp(low, high)).collect();
    // It must be cut off again and again, and not once on the way to a place where it waits anyway.
    let is_end = |value: f64| value == low || value == high;
    let arrivals = clipped.windows(2).filter(|w| !is_end(w[0]) && is_end(w[1]));
    let between = clipped.iter().filter(|value| !is_end(**value)).count();
    (high > low && arrivals.count() >= 6 && between >= 40).then_some(())?;
    Some(with_angles(motion, told, clipped))
}

/// An encoder with so few steps that the motion is a staircase.
pub(super) fn coarse(
    recording: &Recording,
    _: &[Recording],
    draw: &mut Draw,
) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint, _) = commanded(motion, draw)?;
    let (low, high) = range(joint);
    let step = (high - low) / draw.between(4.0, 15.0);
    let zero = draw.between(0.0, step);
    let read = |angle: &f64| zero + step * ((angle - zero) / step).round();
    Some(with_angles(
        motion,
        index,
        joint.angles_rad.iter().map(read).collect(),
    ))
}

/// Rows that are missing here and there.
pub(super) fn lost_rows(
    recording: &Recording,
    _: &[Recording],
    draw: &mut Draw,
) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let _ = commanded(motion, draw)?;
    let often = draw.between(0.03, 0.3);
    let mut kept: Vec<usize> = Vec::new();
    for k in 0..motion.len() {
        if k == 0 || k + 1 == motion.len() || draw.share() > often {
            kept.push(k);
        }
    }
    let pick = |values: &[f64]| kept.iter().map(|k| values[*k]).collect::<Vec<f64>>();
    let joints = motion.joints().iter().map(|joint| joint.map(pick));
    let path = kept
        .iter()
        .map(|k| motion.positions_world_m()[*k])
        .collect();
    Trajectory::new(pick(motion.times_s()), path)
        .and_then(|thinned| thinned.with_joints(joints.collect()))
        .ok()
}

/// Packets that do not arrive for a while: all angles are those of the last one.
pub(super) fn held(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (_, joint, _) = commanded(motion, draw)?;
    let fast = step_rad(joint);
    let mut joints = motion.joints().to_vec();
    let mut is_seen = false;
    for _ in 0..draw.index(2..12) {
        let many = draw.index(5..25);
        let from = draw.index(1..motion.len() - many - 2);
        for joint in joints.iter_mut().filter(|j| !j.name.ends_with("_command")) {
            let last = joint.angles_rad[from];
            joint.angles_rad[from..from + many].fill(last);
        }
        // The joint must be so far on as to show a jump, and not be as fast afterwards.
        let next = joint.angles_rad[from + many..(from + many + 5).min(motion.len())].windows(2);
        let next = next.map(|w| (w[1] - w[0]).abs()).fold(fast, f64::max);
        is_seen |= (joint.angles_rad[from + many] - joint.angles_rad[from + 1]).abs() > 4.0 * next;
    }
    // Nobody sees lost packets of a robot that rests.
    is_seen.then(|| motion.clone().with_joints(joints).ok())?
}

/// The robot, or one of its servos, is off for a while; then it goes back to its command.
pub(super) fn off(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint, told) = commanded(motion, draw)?;
    let command = &motion.joints()[told].angles_rad;
    let times_s = motion.times_s();
    let (low, high) = range(joint);
    let share = draw.between(0.1, 0.4);
    let many = (share * motion.len() as f64) as usize;
    let from = draw.index(motion.len() / 10..motion.len() - many - 1);
    let off = from..from + many;
    let (least, most) = command[off.clone()]
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| {
            (a.min(*value), b.max(*value))
        });
    // The command must move, and the servo must have followed it: a joint that hangs on its stop cannot tell.
    let apart: Vec<f64> = joint
        .angles_rad
        .iter()
        .zip(command)
        .map(|(a, c)| a - c)
        .collect();
    let is_clear = most - least > 0.6 * (high - low)
        && times_s[off.end - 1] - times_s[off.start] > 1.2
        && spread(&apart) < 0.4 * spread(command);
    is_clear.then_some(())?;
    let is_whole = draw.share() < 0.5;
    let back_s = draw.between(0.02, 0.3);
    let mut joints = motion.joints().to_vec();
    for (k, joint) in joints.iter_mut().enumerate() {
        if joint.name.ends_with("_command") || !(is_whole || k == index) {
            continue;
        }
        let stuck = joint.angles_rad[from];
        for (k, angle) in joint.angles_rad.iter_mut().enumerate().skip(from) {
            let on_s = times_s[k] - times_s[off.end - 1];
            let share = if on_s <= 0.0 {
                1.0
            } else {
                (-3.0 * on_s / back_s).exp()
            };
            *angle += share * (stuck - *angle);
        }
    }
    motion.clone().with_joints(joints).ok()
}
