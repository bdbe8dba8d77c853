//! Random shipped recordings that are distorted in each of the ways that are doubted.

use nalgebra::Vector3;
use realgap_core::warning::Code;
use realgap_path::trajectory::{
    COMMAND, Csv, Format as _, JointTrack, Reading, Recording, Trajectory, parse_all,
};

use super::{doubts, servo, shipped};

/// Random numbers from 0 to 1 (SplitMix64).
pub(super) struct Draw(u64);

impl Draw {
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// A size between two others, with its logarithm evenly spread.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(super) fn index(&mut self, range: std::ops::Range<usize>) -> usize {
        range.start + (self.share() * range.len() as f64) as usize
    }

    fn direction(&mut self, is_planar: bool) -> Vector3<f64> {
        loop {
            let [x, y, z] = [(); 3].map(|()| self.between(-1.0, 1.0));
            let v = Vector3::new(x, y, if is_planar { 0.0 } else { z });
            if (0.1..1.0).contains(&v.norm()) {
                return v.normalize();
            }
        }
    }
}

/// The step that a share of all steps that go anywhere does not exceed.
fn step(lengths: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = lengths.filter(|length| *length > 0.0).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() * 95 / 100).copied().unwrap_or(0.0)
}

fn step_m(path: &[Vector3<f64>]) -> f64 {
    step(path.windows(2).map(|w| (w[1] - w[0]).norm()))
}

pub(super) fn step_rad(joint: &JointTrack) -> f64 {
    step(joint.angles_rad.windows(2).map(|w| (w[1] - w[0]).abs()))
}

pub(super) fn range(joint: &JointTrack) -> (f64, f64) {
    let all = || joint.angles_rad.iter().copied();
    (
        all().fold(f64::INFINITY, f64::min),
        all().fold(f64::NEG_INFINITY, f64::max),
    )
}

/// A random joint that was measured.
pub(super) fn joint<'a>(
    motion: &'a Trajectory,
    draw: &mut Draw,
) -> Option<(usize, &'a JointTrack)> {
    let measured = motion.joints().iter().enumerate();
    let all: Vec<_> = measured
        .filter(|(_, joint)| !joint.name.ends_with(COMMAND))
        .collect();
    (!all.is_empty()).then(|| all[draw.index(0..all.len())])
}

pub(super) fn command<'a>(motion: &'a Trajectory, joint: &JointTrack) -> Option<&'a JointTrack> {
    motion.joint(&format!("{}{COMMAND}", joint.name))
}

/// The motion with other angles of one joint.
pub(super) fn with_angles(motion: &Trajectory, joint: usize, angles_rad: Vec<f64>) -> Trajectory {
    let mut joints = motion.joints().to_vec();
    joints[joint].angles_rad = angles_rad;
    motion.clone().with_joints(joints).unwrap()
}

fn has_path(motion: &Trajectory) -> bool {
    !motion.is_of_joints() && motion.len() >= 60
}

/// A way to distort a recording; `None` if the recording does not have what it needs.
type Distort = fn(&Recording, &[Recording], &mut Draw) -> Option<Trajectory>;

fn spike(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    has_path(motion).then_some(())?;
    let mut path = motion.positions_world_m().to_vec();
    let extent_m = motion.extent_m();
    let least_m = (10.0 * step_m(&path)).max(0.1 * extent_m);
    let many = draw.index(1..4);
    let from = draw.index(2..path.len() - 6);
    let by_m =
        draw.direction(motion.is_planar()) * draw.size(least_m, 100.0 * extent_m.max(least_m));
    path[from..from + many]
        .iter_mut()
        .for_each(|place| *place += by_m);
    motion.clone().with_positions(path).ok()
}

fn joint_spike(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint) = joint(motion, draw)?;
    let least_rad = (10.0 * step_rad(joint)).max(0.15);
    let mut angles_rad = joint.angles_rad.clone();
    let at = draw.index(2..angles_rad.len() - 6);
    let by_rad = draw.size(least_rad, 2.5_f64.max(2.0 * least_rad));
    angles_rad[at] += if draw.share() < 0.5 { by_rad } else { -by_rad };
    Some(with_angles(motion, index, angles_rad))
}

fn zeros(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    has_path(motion).then_some(())?;
    let mut path = motion.positions_world_m().to_vec();
    let many = draw.index(1..path.len() / 8);
    let from = draw.index(2..path.len() - many - 2);
    let far_m = path[from - 1].norm().max(path[from + many].norm());
    (far_m > 10.0 * step_m(&path)).then_some(())?;
    path[from..from + many].fill(Vector3::zeros());
    motion.clone().with_positions(path).ok()
}

fn frozen(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    has_path(motion).then_some(())?;
    let mut path = motion.positions_world_m().to_vec();
    let many = draw.index(8..(path.len() / 5).max(9));
    let from = draw.index(12..path.len() - many - 2);
    // The robot moves on by as much as one sees as a jump.
    let moved_m = (path[from + many] - path[from]).norm();
    let beside = || (from - 10..from).chain(from + many..(from + many + 10).min(path.len() - 1));
    let usual_m = beside()
        .map(|k| (path[k + 1] - path[k]).norm())
        .fold(0.0, f64::max);
    (moved_m > 4.0 * usual_m && moved_m > 3.0 * step_m(&path)).then_some(())?;
    let held = path[from];
    path[from..from + many].fill(held);
    let turns = motion.orientations_world_from_body().map(<[_]>::to_vec);
    let frozen = motion.clone().with_positions(path).ok()?;
    match turns {
        None => Some(frozen),
        Some(mut turns) => {
            let held = turns[from];
            turns[from..from + many].fill(held);
            frozen.with_orientations(turns).ok()
        }
    }
}

fn joint_zeros(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint) = joint(motion, draw)?;
    let mut angles_rad = joint.angles_rad.clone();
    let many = draw.index(1..40.min(angles_rad.len() / 8));
    let from = draw.index(2..angles_rad.len() - many - 2);
    let far_rad = angles_rad[from - 1].abs();
    (far_rad > 0.1 && far_rad > 10.0 * step_rad(joint)).then_some(())?;
    angles_rad[from..from + many].fill(0.0);
    Some(with_angles(motion, index, angles_rad))
}

fn wrapped(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    use std::f64::consts::{PI, TAU};
    let motion = &recording.trajectory;
    let (index, joint) = joint(motion, draw)?;
    let (low, high) = range(joint);
    (high - low > 20.0 * step_rad(joint) && high - low > 0.2).then_some(())?;
    let edge = draw.between(low + 0.1 * (high - low), high - 0.1 * (high - low));
    let wrap = |angle: &f64| angle + PI - edge - TAU * ((angle + PI - edge + PI) / TAU).floor();
    Some(with_angles(
        motion,
        index,
        joint.angles_rad.iter().map(wrap).collect(),
    ))
}

pub(super) fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

fn exchanged(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let [(one, a), (other, b)] = [joint(motion, draw)?, joint(motion, draw)?];
    let [ca, cb] = [command(motion, a)?, command(motion, b)?];
    let apart: Vec<f64> = ca
        .angles_rad
        .iter()
        .zip(&cb.angles_rad)
        .map(|(a, b)| a - b)
        .collect();
    // Both stand still, or both are told the same: nobody could see it.
    (one != other && spread(&apart) > 0.1).then_some(())?;
    let mut joints = motion.joints().to_vec();
    joints[one].angles_rad.clone_from(&b.angles_rad);
    joints[other].angles_rad.clone_from(&a.angles_rad);
    motion.clone().with_joints(joints).ok()
}

fn flipped(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint) = joint(motion, draw)?;
    let told = command(motion, joint).is_some_and(|command| spread(&command.angles_rad) > 0.05);
    (told || joint.speeds_rad_s.is_some()).then_some(())?;
    Some(with_angles(
        motion,
        index,
        joint.angles_rad.iter().map(|angle| -angle).collect(),
    ))
}

fn degrees(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let (index, joint) = joint(motion, draw)?;
    let told = command(motion, joint);
    (told.is_some_and(|told| spread(&told.angles_rad) > 0.05) || joint.speeds_rad_s.is_some())
        .then_some(())?;
    // A motion so small that its degrees pass for radians.
    let (low, high) = range(joint);
    let small = draw.between(0.5, 3.0) / high.abs().max(low.abs()).to_degrees();
    let mut joints: Vec<JointTrack> = motion
        .joints()
        .iter()
        .map(|joint| joint.map(|values| values.iter().map(|value| value * small).collect()))
        .collect();
    joints[index]
        .angles_rad
        .iter_mut()
        .for_each(|angle| *angle = angle.to_degrees());
    motion.clone().with_joints(joints).ok()
}

fn normalised(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    let _ = joint(motion, draw)?;
    let mut joints = motion.joints().to_vec();
    let is_degrees = draw.share() < 0.5;
    for joint in &mut joints {
        // The calibration is the range that was seen, or a little less: then positions are clipped.
        let (low, high) = range(joint);
        (high > low).then_some(())?;
        let inset = draw.between(0.0, 0.05) * (high - low);
        let (low, high) = (low + inset, high - inset);
        for angle in &mut joint.angles_rad {
            let number = ((200.0 * (*angle - low) / (high - low)) - 100.0).clamp(-100.0, 100.0);
            *angle = if is_degrees {
                number.to_radians()
            } else {
                number
            };
        }
        joint.speeds_rad_s = None;
    }
    motion.clone().with_joints(joints).ok()
}

fn interleaved(recording: &Recording, all: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    has_path(motion).then_some(())?;
    let alike: Vec<&Recording> = all
        .iter()
        .filter(|other| {
            other.path.parent() == recording.path.parent() && !other.trajectory.is_of_joints()
        })
        .collect();
    let other = &alike[draw.index(0..alike.len())].trajectory;
    let (a, b) = (motion.positions_world_m(), other.positions_world_m());
    let least_m = (12.0 * step_m(a).max(step_m(b))).max(0.3 * motion.extent_m());
    let by_m = draw.direction(motion.is_planar()) * draw.size(least_m, 10.0 * least_m);
    let often = draw.between(0.3, 0.7);
    let count = a.len().min(b.len());
    let path: Vec<Vector3<f64>> = (0..count)
        .map(|k| {
            if draw.share() < often {
                a[k]
            } else {
                b[k] + by_m
            }
        })
        .collect();
    // The paths may cross; then one sees two bodies only where they are apart.
    let near = (0..count)
        .filter(|k| (a[*k] - b[*k] - by_m).norm() < least_m)
        .count();
    (near * 2 < count).then_some(())?;
    Trajectory::new(motion.times_s()[..count].to_vec(), path).ok()
}

fn other_unit(recording: &Recording, _: &[Recording], draw: &mut Draw) -> Option<Trajectory> {
    let motion = &recording.trajectory;
    has_path(motion).then_some(())?;
    let mut path = motion.positions_world_m().to_vec();
    let from = draw.index(path.len() / 10..path.len() * 9 / 10);
    let factor = [1e3, 1e-3, 1e2, 1e-2][draw.index(0..4)];
    path[from..].iter_mut().for_each(|place| *place *= factor);
    motion.clone().with_positions(path).ok()
}

const DISTORTIONS: [(&str, Code, Distort); 17] = [
    ("spike of the position", Code::Spike, spike),
    ("spike of a joint", Code::Spike, joint_spike),
    ("zeros over lost samples", Code::LostAsZero, zeros),
    ("frozen tracker", Code::FrozenTracker, frozen),
    ("joint that drops to 0", Code::JointDropout, joint_zeros),
    ("wrapped encoder", Code::WrappedAngle, wrapped),
    ("two joints exchanged", Code::ExchangedJoints, exchanged),
    ("flipped sign", Code::FlippedSign, flipped),
    ("degrees as radians", Code::DegreesAsRadians, degrees),
    ("normalised -100 to 100", Code::NormalisedAngles, normalised),
    ("two bodies interleaved", Code::SeveralRobots, interleaved),
    ("millimetres for metres", Code::ChangedUnit, other_unit),
    (
        "saturated commands",
        Code::SaturatedCommands,
        servo::saturated,
    ),
    ("coarse encoder", Code::CoarseEncoder, servo::coarse),
    ("missing rows", Code::LostPackets, servo::lost_rows),
    ("held packets", Code::LostPackets, servo::held),
    ("robot switched off", Code::SwitchedOff, servo::off),
];

/// The runs in which each distortion is tried.
const RUNS: usize = 20;
/// The runs in which it must be doubted.
const DOUBTED: usize = 18;

/// The shipped recordings; the servo pendulum's command gets the name of its angle, except where its torque is off for most of the time.
fn to_distort() -> Vec<Recording> {
    let mut all = shipped();
    for recording in &mut all {
        if recording.name.contains("lift_and_drop") {
            continue;
        }
        let mut joints = recording.trajectory.joints().to_vec();
        for joint in &mut joints {
            if joint.name == "command" {
                joint.name = format!("angle{COMMAND}");
            }
        }
        recording.trajectory = recording.trajectory.clone().with_joints(joints).unwrap();
    }
    all
}

/// Distorts random recordings in every way, and returns the table of how many were doubted.
fn power(seed: u64) -> (String, Vec<usize>) {
    let all = to_distort();
    let (mut table, mut counts) = (String::new(), Vec::new());
    for (number, (name, code, distort)) in DISTORTIONS.iter().enumerate() {
        let mut draw = Draw(seed.wrapping_mul(1000) + number as u64);
        let (mut tried, mut doubted, mut beside) = (0, 0, 0);
        let mut missed = String::new();
        for _ in 0..200_000 {
            if tried == RUNS {
                break;
            }
            let recording = &all[draw.index(0..all.len())];
            let Some(motion) = distort(recording, &all, &mut draw) else {
                continue;
            };
            tried += 1;
            let bytes = Csv.render(&motion).unwrap().bytes;
            let read = parse_all("distorted.csv", bytes, Reading::default()).unwrap();
            let said = doubts(&read[0].warnings);
            if said.iter().any(|doubt| doubt.code == *code) {
                doubted += 1;
            } else {
                let instead: Vec<String> = said.iter().map(ToString::to_string).collect();
                missed += &format!(
                    "    missed in {}, try {tried}: {}\n",
                    recording.name,
                    instead.join("; ")
                );
            }
            beside += usize::from(said.iter().any(|doubt| doubt.code != *code));
        }
        assert_eq!(tried, RUNS, "{name}: recordings that have what it needs");
        table += &format!(
            "{name:26} {doubted:2} of {tried}, other doubts beside it in {beside}\n{missed}"
        );
        counts.push(doubted);
    }
    (table, counts)
}

#[test]
fn distorted_recordings_are_doubted() {
    let seed = std::env::var("REALGAP_SEED")
        .ok()
        .and_then(|text| text.parse().ok());
    let (table, counts) = power(seed.unwrap_or(51));
    println!("{table}");
    assert!(
        counts.iter().all(|doubted| *doubted >= DOUBTED),
        "\n{table}"
    );
}
