//! Imitated recordings: what would have been recorded if the model were right.
//!
//! A run takes the place of reality and is recorded with the noise of measurement that the recordings show or the study states.
//! The imitation is then treated like a recording: the study's runs start from its own noisy first sample. So every error of a
//! measured start has the effect in an imitation that it has in the recordings, however it grows in time, and no formula has to
//! say how.

use std::collections::BTreeMap;

use nalgebra::{UnitQuaternion, Vector3};
use rand_distr::{Distribution as _, StandardNormal};

use crate::calibration::goodness_of_fit::visible_noise::VisibleNoise;
use crate::calibration::study::Study;
use realgap_core::error::Result;
use realgap_core::random::{Generator, Numbered};
use realgap_core::statistics::median;
use realgap_path::trajectory::{JointTrack, Trajectory};

/// Noise of measurement of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::calibration) struct JointNoise {
    /// Of its angle, radians.
    pub angle_rad: VisibleNoise,
    /// Standard deviation of its recorded speed, rad/s.
    pub speed_rad_s: f64,
}

/// Noise of measurement of the recordings of a study, in true lengths.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::calibration) struct MeasurementNoise {
    /// Of a position along each axis in the plane, metres.
    pub plane_m: f64,
    /// Of a height, metres.
    pub height_m: f64,
    /// Of an orientation about each axis, radians.
    pub turn_rad: f64,
    /// Of a recorded velocity along each axis, m/s.
    pub velocity_m_s: f64,
    /// Of a recorded angular velocity about each axis, rad/s.
    pub spin_rad_s: f64,
    /// Of each joint.
    pub joints: BTreeMap<String, JointNoise>,
    /// Additional errors of the velocities from which runs start, which the study states: m/s, rad/s.
    pub start_velocity: [f64; 2],
}

/// A recording and the run that starts from it.
pub(in crate::calibration) type Pair<'a> = (&'a Trajectory, &'a Trajectory);

impl MeasurementNoise {
    /// What the high frequencies and the resolution of these recordings show: the median over recordings, because noise of
    /// measurement is the same in all of them.
    pub fn visible(pairs: &[Pair<'_>], is_cut: bool) -> Self {
        let place = |axis: usize| over(pairs, &|t| Some(coordinates(t.positions_world_m(), axis)));
        let plane = [place(0), place(1)].map(|noise| noise.size());
        // Half a turn of the axis is a quarter of the quaternion's length.
        let quaternion = (0..4).map(|part| over(pairs, &|t| quaternion_part(t, part)).size());
        let quaternion: f64 = quaternion.map(|sd| sd * sd).sum();
        let speed = |of: fn(&Trajectory) -> Option<&[Vector3<f64>]>| {
            let axes = (0..3).map(|axis| over(pairs, &|t| Some(coordinates(of(t)?, axis))).size());
            rms(&axes.collect::<Vec<f64>>())
        };
        let names = pairs.iter().flat_map(|(real, _)| real.joints());
        let names = names.map(|joint| joint.name.clone());
        let joint = |name: String| {
            let angle = |t: &Trajectory| Some(t.joint(&name)?.angles_rad.clone());
            let angle_rad = over(pairs, &angle);
            let speeds = |t: &Trajectory| t.joint(&name)?.speeds_rad_s.clone();
            let speed_rad_s = match is_cut {
                true => cut_speed(pairs, &angle_rad, over(pairs, &speeds).size()),
                false => over(pairs, &speeds).size(),
            };
            let noise = JointNoise {
                angle_rad,
                speed_rad_s,
            };
            (name, noise)
        };
        Self {
            plane_m: rms(&plane),
            height_m: place(2).size(),
            turn_rad: (4.0 / 3.0 * quaternion).sqrt(),
            velocity_m_s: speed(Trajectory::velocities_world_m_s),
            spin_rad_s: speed(Trajectory::angular_velocities_body_rad_s),
            joints: names.map(joint).collect(),
            start_velocity: [0.0; 2],
        }
    }

    /// What would have been recorded of `truth`, in true lengths, with the columns of `like`: imitation number `number` of the
    /// recording `case`. Recorded lengths are `scale` times the true ones.
    ///
    /// # Errors
    /// None for valid trajectories.
    pub fn record(
        &self,
        truth: &Trajectory,
        like: &Trajectory,
        scale: f64,
        mut rng: Generator,
    ) -> Result<Trajectory> {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut vector = |sd: Vector3<f64>| sd.map(|sd| sd * normal());
        let camera = Vector3::new(self.plane_m, self.plane_m, self.height_m);
        let mut copy = like.clone();
        if !like.is_of_joints() {
            let places = truth.positions_world_m().iter();
            let is_planar = like.is_planar();
            let places = places.map(|place| {
                let mut seen = (place + vector(camera)) * scale;
                seen.z = if is_planar { 0.0 } else { seen.z };
                seen
            });
            copy = copy.with_positions(places.collect())?;
        }
        if let (Some(_), Some(turns)) = (
            like.orientations_world_from_body(),
            truth.orientations_world_from_body(),
        ) {
            let error = Vector3::repeat(self.turn_rad);
            let seen = turns
                .iter()
                .map(|turn| UnitQuaternion::from_scaled_axis(vector(error)) * turn);
            copy = copy.with_orientations(seen.collect())?;
        }
        if let (Some(_), Some(_), Some(linear), Some(angular)) = (
            like.velocities_world_m_s(),
            like.angular_velocities_body_rad_s(),
            truth.velocities_world_m_s(),
            truth.angular_velocities_body_rad_s(),
        ) {
            let mut seen = |all: &[Vector3<f64>], sd: f64, at_start: f64, scale: f64| {
                let values = all.iter().enumerate().map(|(sample, value)| {
                    let extra = if sample == 0 { at_start } else { 0.0 };
                    let sd = (sd * sd + extra * extra).sqrt();
                    (value + vector(Vector3::repeat(sd))) * scale
                });
                values.collect::<Vec<_>>()
            };
            let [at_start_m_s, at_start_rad_s] = self.start_velocity;
            let linear = seen(linear, self.velocity_m_s, at_start_m_s, scale);
            let angular = seen(angular, self.spin_rad_s, at_start_rad_s, 1.0);
            copy = copy.with_velocities(linear, angular)?;
        }
        let joints = like.joints().iter().map(|joint| {
            let known = self.joints.get(&joint.name).zip(truth.joint(&joint.name));
            known.map_or_else(
                || joint.clone(),
                |(noise, truth)| noise.record(truth, joint, &mut rng),
            )
        });
        let joints = joints.collect();
        copy.with_joints(joints)
    }
}

impl JointNoise {
    fn record(&self, truth: &JointTrack, like: &JointTrack, rng: &mut Generator) -> JointTrack {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let angles = truth.angles_rad.iter();
        let angles_rad = angles.map(|angle| self.angle_rad.record(*angle, normal()));
        let angles_rad = angles_rad.collect();
        let has_speeds = like.speeds_rad_s.is_some();
        let speeds = truth.speeds_rad_s.as_ref().filter(|_| has_speeds);
        let speeds_rad_s = speeds.map(|speeds| {
            let seen = speeds
                .iter()
                .map(|speed| speed + self.speed_rad_s * normal());
            seen.collect()
        });
        JointTrack {
            name: like.name.clone(),
            angles_rad,
            speeds_rad_s,
        }
    }
}

/// The random numbers of imitation number `number` of recording `case` of `cases`.
pub(in crate::calibration) fn random(
    seed: u64,
    number: usize,
    case: usize,
    cases: usize,
) -> Generator {
    Numbered::ImitatedRecording.generator(seed, (number * cases + case) as u64)
}

/// The same study with these trajectories in place of its recordings; `None` stands for one that is kept.
///
/// # Errors
/// As [`Study::new`].
pub(in crate::calibration) fn with_recordings(
    study: &Study,
    trajectories: Vec<Option<Trajectory>>,
) -> Result<Study> {
    let mut definition = study.definition().clone();
    for (recording, trajectory) in definition.recordings.iter_mut().zip(trajectories) {
        if let Some(trajectory) = trajectory {
            recording.trajectory = trajectory;
        }
    }
    Study::new(definition)
}

/// The noise of a series of every recording: the median of its parts.
fn over(pairs: &[Pair<'_>], of: &dyn Fn(&Trajectory) -> Option<Vec<f64>>) -> VisibleNoise {
    let known = pairs.iter().filter_map(|(real, run)| {
        let (recorded, simulated) = (of(real)?, of(run)?);
        let is_same = recorded.len() == simulated.len();
        is_same.then(|| VisibleNoise::of(real.times_s(), &recorded, &simulated))
    });
    let known: Vec<VisibleNoise> = known.collect();
    let steps = known.iter().filter(|noise| noise.step > 0.0);
    // A recording in which a joint hardly moves can show multiples of the step only.
    let finest = steps.min_by(|a, b| a.step.total_cmp(&b.step)).copied();
    let independent: Vec<f64> = known.iter().map(|noise| noise.independent).collect();
    VisibleNoise {
        independent: match independent.is_empty() {
            true => 0.0,
            false => median(&independent),
        },
        ..finest.unwrap_or_default()
    }
}

/// A window starts with the mean of seven recorded speeds, or else with the slope of seven angles.
fn cut_speed(pairs: &[Pair<'_>], angle: &VisibleNoise, recorded: f64) -> f64 {
    if recorded > 0.0 {
        return recorded / 7.0_f64.sqrt();
    }
    let intervals = pairs
        .iter()
        .map(|(real, _)| real.times_s()[1] - real.times_s()[0]);
    let interval_s = median(&intervals.collect::<Vec<f64>>());
    // The sum of the squares of −3, …, 3 is 28.
    angle.size() / (28.0_f64.sqrt() * interval_s)
}

fn coordinates(all: &[Vector3<f64>], axis: usize) -> Vec<f64> {
    all.iter().map(|v| v[axis]).collect()
}

/// A part of the quaternion, with signs that do not jump from sample to sample.
fn quaternion_part(motion: &Trajectory, part: usize) -> Option<Vec<f64>> {
    let all = motion.orientations_world_from_body()?;
    let mut last = all[0].coords;
    let parts = all.iter().map(|turn| {
        let near = if turn.coords.dot(&last) < 0.0 {
            -1.0
        } else {
            1.0
        };
        last = near * turn.coords;
        last[part]
    });
    Some(parts.collect())
}

fn rms(all: &[f64]) -> f64 {
    let squares: f64 = all.iter().map(|v| v * v).sum();
    (squares / all.len().max(1) as f64).sqrt()
}
