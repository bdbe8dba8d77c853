//! Channels of a residual: what is compared of a run and its recording, one series of numbers over time each.
//!
//! Positions are split along the recorded way, to its left and upwards, because what a model lacks acts along the motion whatever
//! its direction is, so that residuals of recordings with different directions can be put together.

use nalgebra::Vector3;

use crate::calibration::study::Study;
use realgap_core::unit::Unit;
use realgap_path::trajectory::Trajectory;

/// What a channel measures.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::calibration) enum Quantity {
    /// Position along the net displacement of the recording, in the plane.
    Along,
    /// Position to the left of it.
    Left,
    /// Height.
    Up,
    /// Rotation from recorded to simulated orientation about the direction of the motion.
    Roll,
    /// The same about the axis to the left.
    Pitch,
    /// The same about the vertical.
    Heading,
    /// Angle of a joint.
    Joint(String),
}

impl Quantity {
    /// Its name in sentences.
    pub fn name(&self) -> String {
        match self {
            Self::Along => "the position along the way".to_owned(),
            Self::Left => "the position to the left of the way".to_owned(),
            Self::Up => "the height".to_owned(),
            Self::Roll => "the tilt about the way".to_owned(),
            Self::Pitch => "the tilt across the way".to_owned(),
            Self::Heading => "the heading".to_owned(),
            Self::Joint(name) => format!("the joint {name}"),
        }
    }

    /// Its unit.
    pub fn unit(&self) -> Unit {
        match self {
            Self::Along | Self::Left | Self::Up => Unit::Metre,
            _ => Unit::Radian,
        }
    }
}

/// One channel of one recording.
#[derive(Debug, Clone)]
pub(in crate::calibration) struct Series {
    /// What it measures.
    pub quantity: Quantity,
    /// Simulated minus recorded value at each sample.
    pub residual: Vec<f64>,
    /// The simulated value at each sample: the motion without noise.
    pub motion: Vec<f64>,
}

/// Shortest net displacement that has a direction, metres, and as a share of the recording's extent.
const STILL_M: f64 = 1e-3;
const STILL_SHARE: f64 = 0.01;

/// Direction of a recording's net displacement in the plane, and the directions to its left and upwards.
pub(in crate::calibration) fn axes_of(recorded: &Trajectory) -> [Vector3<f64>; 3] {
    let mut way = recorded.net_displacement_world_m();
    way.z = 0.0;
    let has_direction = way.norm() > STILL_M.max(STILL_SHARE * recorded.extent_m());
    let along = match has_direction {
        true => way.normalize(),
        false => Vector3::x(),
    };
    [along, Vector3::z().cross(&along), Vector3::z()]
}

/// The channels that the study's metric compares, of a run and a recording with the same samples; none where the samples differ.
/// `axes` are those of [`axes_of`].
pub(in crate::calibration) fn series_of(
    study: &Study,
    axes: &[Vector3<f64>; 3],
    recorded: &Trajectory,
    run: &Trajectory,
) -> Vec<Series> {
    let metric = study.definition().metric;
    if recorded.len() != run.len() {
        return Vec::new();
    }
    if metric.needs().joints {
        return joints(recorded, run);
    }
    let mut all = positions(axes, recorded, run);
    if !metric.is_pose() {
        all.truncate(2);
        return all;
    }
    let mut turns = rotations(axes, recorded, run);
    if recorded.is_planar() {
        // A path in a plane says nothing about height and tilt.
        all.truncate(2);
        turns.retain(|series| series.quantity == Quantity::Heading);
    }
    all.extend(turns);
    all
}

fn joints(recorded: &Trajectory, run: &Trajectory) -> Vec<Series> {
    let pairs = recorded.joints().iter();
    let pairs = pairs.filter_map(|joint| Some((joint, run.joint(&joint.name)?)));
    let series = pairs.map(|(joint, simulated)| {
        let both = simulated.angles_rad.iter().zip(&joint.angles_rad);
        let difference = |(s, r): (&f64, &f64)| {
            let error_rad = s - r;
            let turn_rad = std::f64::consts::TAU;
            error_rad - turn_rad * (error_rad / turn_rad).round()
        };
        Series {
            quantity: Quantity::Joint(joint.name.clone()),
            residual: both.map(difference).collect(),
            motion: simulated.angles_rad.clone(),
        }
    });
    series.collect()
}

fn positions(axes: &[Vector3<f64>; 3], recorded: &Trajectory, run: &Trajectory) -> Vec<Series> {
    let (real, simulated) = (recorded.positions_world_m(), run.positions_world_m());
    let quantities = [Quantity::Along, Quantity::Left, Quantity::Up];
    let series = quantities.into_iter().zip(axes).map(|(quantity, axis)| {
        let both = simulated.iter().zip(real);
        Series {
            quantity,
            residual: both.map(|(s, r)| (s - r).dot(axis)).collect(),
            motion: simulated.iter().map(|s| s.dot(axis)).collect(),
        }
    });
    series.collect()
}

fn rotations(axes: &[Vector3<f64>; 3], recorded: &Trajectory, run: &Trajectory) -> Vec<Series> {
    let all = recorded.orientations_world_from_body();
    let Some((real, simulated)) = all.zip(run.orientations_world_from_body()) else {
        return Vec::new();
    };
    let quantities = [Quantity::Roll, Quantity::Pitch, Quantity::Heading];
    let series = quantities.into_iter().zip(axes).map(|(quantity, axis)| {
        let both = simulated.iter().zip(real);
        let since_start = simulated
            .iter()
            .map(|s| (s * simulated[0].inverse()).scaled_axis().dot(axis));
        Series {
            quantity,
            residual: both
                .map(|(s, r)| (s * r.inverse()).scaled_axis().dot(axis))
                .collect(),
            motion: since_start.collect(),
        }
    });
    series.collect()
}
