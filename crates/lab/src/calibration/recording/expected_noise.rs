//! The noise that a new study states: measured from its recordings where they show it, otherwise a careful guess.

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::statistics::{median, standard_deviation};
use realgap_core::unit::{Unit, counted, quantity};
use realgap_path::trajectory::{Recording, Trajectory};
use realgap_simulation::{Camera, Distribution, Noise};

use crate::calibration::goodness_of_fit::visible_noise::VisibleNoise;

/// How the runs of a new study start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunStart {
    /// At rest, put down by hand.
    Settled,
    /// From the first sample of each recording.
    Recorded,
    /// From recorded joints of a robot that is held.
    Joints,
}

/// Noise for a study, and what each part of it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedNoise {
    /// How repeats differ.
    pub noise: Noise,
    /// What was measured of it; empty where everything is a careful guess.
    pub measured: Vec<String>,
}

/// Careful guesses for servos of a robot that is held: an eighth of a degree of zero, and 1 % of each mass.
const CAREFUL_ZERO_RAD: f64 = 2e-3;
const CAREFUL_MASS: f64 = 0.01;
/// Fewer recordings than this do not show how starts differ.
const REPEATS: usize = 3;
/// Starts that differ more than this were meant to differ, metres and radians.
const ONE_PLACE_M: f64 = 0.05;
const ONE_HEADING_RAD: f64 = 0.2;

impl ExpectedNoise {
    /// The noise of a study of these recordings.
    pub fn of(recordings: &[Recording], start: RunStart, has_servos: bool) -> Self {
        let motions: Vec<&Trajectory> = recordings.iter().map(|r| &r.trajectory).collect();
        let mut measured = Vec::new();
        let mut noise = match start {
            RunStart::Settled if has_servos => Noise::careful_repeat(),
            RunStart::Settled => Noise::careful_start(),
            RunStart::Recorded => Noise::default(),
            RunStart::Joints => {
                let zero = if has_servos { CAREFUL_ZERO_RAD } else { 0.0 };
                let noise = Noise {
                    servo_zero_rad: Distribution::Normal(zero),
                    mass_relative: Distribution::LogNormal(CAREFUL_MASS),
                    ..Noise::default()
                };
                return Self { noise, measured };
            }
        };
        let position_m = seen(&motions, &|motion| Some(positions(motion)));
        let angle_rad = seen(&motions, &turns);
        let of_recordings = counted(recordings.len(), "recording");
        if let Some(m) = position_m {
            measured.push(format!(
                "the camera's position error of {} (high frequencies of {of_recordings})",
                quantity(m, Unit::Metre)
            ));
        }
        // Parts of a quaternion change by half of the angle; three axes make one error about a random axis.
        let angle_rad = angle_rad.map(|part| part * 2.0 * 3.0_f64.sqrt());
        if let Some(rad) = angle_rad {
            measured.push(format!(
                "its angle error of {} (the same)",
                quantity(rad, Unit::Radian)
            ));
        }
        let careful = Camera::careful();
        noise.camera = Camera {
            position_m: Distribution::Normal(rounded(
                position_m.unwrap_or(careful.position_m.size()),
            )),
            angle_rad: match motions
                .iter()
                .all(|m| m.orientations_world_from_body().is_some())
            {
                true => {
                    Distribution::Normal(rounded(angle_rad.unwrap_or(careful.angle_rad.size())))
                }
                false => Distribution::default(),
            },
            ..Camera::default()
        };
        if start == RunStart::Settled && motions.len() >= REPEATS {
            measured.extend(measure_start(&mut noise, &motions));
        }
        Self { noise, measured }
    }

    /// What the noise rests on, in one sentence without a full stop.
    pub fn because(&self) -> String {
        match self.measured.as_slice() {
            [] => "nothing in the recordings shows it: replace it by what you measured".to_owned(),
            all => format!("measured: {}; the rest is a careful guess", all.join(", ")),
        }
    }
}

/// Replaces guesses of the start by the spread of first samples, where the robot was put to one place, and says so.
fn measure_start(noise: &mut Noise, motions: &[&Trajectory]) -> Option<String> {
    let first = motions.iter().map(|motion| motion.positions_world_m()[0]);
    let first: Vec<Vector3<f64>> = first.collect();
    let spread =
        |axis: usize| standard_deviation(&first.iter().map(|p| p[axis]).collect::<Vec<f64>>());
    let beside = |spread: f64, camera: Distribution| {
        let rest = spread.powi(2) - camera.size().powi(2);
        (rest > 0.0).then(|| rounded(rest.sqrt()))
    };
    let spread_m = spread(0).max(spread(1));
    let place_m = beside(spread_m, noise.camera.position_m).filter(|m| *m < ONE_PLACE_M);
    let heading = |motion: &&Trajectory| {
        let turn = motion.orientations_world_from_body()?[0];
        Some((turn * Vector3::x()).xy())
    };
    let headings: Option<Vec<_>> = motions.iter().map(heading).collect();
    let heading_rad = headings.and_then(|all| {
        let middle = all.iter().sum::<nalgebra::Vector2<f64>>();
        let off = all.iter().map(|h| middle.perp(h).atan2(middle.dot(h)));
        let spread = standard_deviation(&off.collect::<Vec<f64>>());
        beside(spread, noise.camera.angle_rad).filter(|rad| *rad < ONE_HEADING_RAD)
    });
    let mut said = Vec::new();
    if let Some(m) = place_m {
        noise.start_position_m = Distribution::Normal(m);
        said.push(format!("positions by {}", quantity(m, Unit::Metre)));
    }
    if let Some(rad) = heading_rad {
        noise.start_heading_rad = Distribution::Normal(rad);
        said.push(format!("headings by {}", quantity(rad, Unit::Radian)));
    }
    (!said.is_empty()).then(|| {
        format!(
            "starts differ in {} (first samples of {})",
            said.join(" and "),
            motions.len()
        )
    })
}

/// The median over recordings of the largest visible noise of their series; `None` where no recording shows any.
fn seen(
    motions: &[&Trajectory],
    series: &dyn Fn(&Trajectory) -> Option<Vec<Vec<f64>>>,
) -> Option<f64> {
    let of_motion = |motion: &&Trajectory| {
        let sizes = series(motion)?.into_iter().map(|values| {
            let still = vec![0.0; values.len()];
            VisibleNoise::of(motion.times_s(), &values, &still).size()
        });
        Some(sizes.fold(0.0, f64::max))
    };
    let sizes: Vec<f64> = motions.iter().filter_map(of_motion).collect();
    let size = if sizes.is_empty() {
        0.0
    } else {
        median(&sizes)
    };
    (size > 0.0).then_some(size)
}

fn positions(motion: &Trajectory) -> Vec<Vec<f64>> {
    let axes = if motion.is_planar() { 2 } else { 3 };
    let axis = |axis: usize| motion.positions_world_m().iter().map(|p| p[axis]).collect();
    (0..axes).map(axis).collect()
}

/// The parts of the rotations since the first sample that are proportional to an axis.
fn turns(motion: &Trajectory) -> Option<Vec<Vec<f64>>> {
    let all = motion.orientations_world_from_body()?;
    let mut last = all[0].coords;
    let parts: Vec<[f64; 4]> = all
        .iter()
        .map(|turn: &UnitQuaternion<f64>| {
            let near = if turn.coords.dot(&last) < 0.0 {
                -1.0
            } else {
                1.0
            };
            last = near * turn.coords;
            last.into()
        })
        .collect();
    Some(
        (0..4)
            .map(|part| parts.iter().map(|p| p[part]).collect())
            .collect(),
    )
}

/// Rounds to two digits, for readability.
fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution as _, StandardNormal};
    use realgap_core::random::Generator;
    use realgap_path::trajectory::Reading;

    /// Drives of 1 m that start with headings and places that differ, seen by a camera.
    fn drives(count: usize, [camera_m, place_m, heading_rad]: [f64; 3]) -> Vec<Recording> {
        let mut rng = Generator::seed_from_u64(9);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let drives = (0..count).map(|number| {
            let start = Vector3::new(place_m * normal(), place_m * normal(), 0.0);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad * normal());
            let times_s: Vec<f64> = (0..100).map(|k| f64::from(k) / 30.0).collect();
            let seen = times_s.iter().map(|t| {
                let error = Vector3::from_fn(|_, _| camera_m * normal());
                start + turn * Vector3::new(0.3 * t, 0.0, 0.0) + error
            });
            let motion = Trajectory::new(times_s.clone(), seen.collect()).unwrap();
            Recording {
                name: format!("drive {number}"),
                path: format!("drive_{number}.csv").into(),
                trajectory: motion.with_orientations(vec![turn; 100]).unwrap(),
                log: None,
                bodies: Vec::new(),
                meta: None,
                reading: Reading::default(),
                warnings: Vec::new(),
            }
        });
        drives.collect()
    }

    #[test]
    fn camera_and_starts_are_measured_where_recordings_show_them() {
        let recordings = drives(20, [0.002, 0.01, 0.05]);
        let expected = ExpectedNoise::of(&recordings, RunStart::Settled, true);
        let noise = expected.noise;
        let near = |found: Distribution, truth: f64| (0.6..1.6).contains(&(found.size() / truth));
        assert!(near(noise.camera.position_m, 0.002), "{noise:?}");
        assert!(near(noise.start_position_m, 0.01), "{noise:?}");
        assert!(near(noise.start_heading_rad, 0.05), "{noise:?}");
        assert!(
            expected.because().contains("first samples of 20"),
            "{}",
            expected.because()
        );
        assert!(noise.check().is_ok());
    }

    #[test]
    fn starts_that_were_meant_to_differ_and_few_or_smooth_recordings_leave_the_careful_guess() {
        let careful = Noise::careful_start();
        for (count, sizes) in [(20, [0.002, 1.0, 1.0]), (2, [0.0, 0.01, 0.05])] {
            let noise = ExpectedNoise::of(&drives(count, sizes), RunStart::Settled, false).noise;
            assert_eq!(noise.start_position_m, careful.start_position_m);
            assert_eq!(noise.start_heading_rad, careful.start_heading_rad);
        }
        let smooth = ExpectedNoise::of(&drives(1, [0.0; 3]), RunStart::Recorded, false);
        let careful = Camera::careful();
        assert_eq!(smooth.noise.camera.position_m, careful.position_m);
        assert!(smooth.measured.is_empty());
    }
}
