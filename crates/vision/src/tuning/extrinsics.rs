//! Estimates the poses of cameras and their lens from points of a known scene (resection), by robust least squares.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use super::correspondence::Correspondence;
use crate::camera::{Lens, Pose};
use realgap_core::statistics::median;

/// The pose at which a picture was taken: the intended pose, and the estimated deviation from it.
#[derive(Debug, Clone)]
pub(super) struct Extrinsics {
    pub meant: Pose,
    /// Deviation from the intended pose: translation (metres) and rotation (radians).
    pub off: [f64; 6],
    pub correspondences: Vec<Correspondence>,
}

impl Extrinsics {
    pub(super) fn pose(&self) -> Pose {
        moved(&self.meant, &self.off)
    }
}

fn moved(meant: &Pose, off: &[f64; 6]) -> Pose {
    meant.moved([off[0], off[1], off[2]], [off[3], off[4], off[5]])
}

/// Prior knowledge: standard deviations of positions (metres), angles (radians) and distortion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    pub place_sd_m: f64,
    pub angle_sd_rad: f64,
    pub distortion_sd: f64,
    /// Whether the lens is estimated, too.
    pub lens: bool,
    /// Whether exposure, gain and blur are already known.
    pub sensor: bool,
}

/// Number of rounds of Gauss-Newton, and step of finite differences.
const ROUNDS: usize = 12;
const STEP: f64 = 1e-6;
/// Errors above this many robust standard deviations have reduced weights (Huber 1964).
const HUBER: f64 = 2.0;
/// Lower limit of the assumed standard deviation of the position of a corner, pixels.
const LEAST_PX: f64 = 0.05;

/// The three numbers of a lens that are estimated.
pub(super) fn numbers(lens: &Lens) -> [f64; 3] {
    [
        lens.field_of_view_rad,
        lens.distortion[0],
        lens.distortion[1],
    ]
}

pub(super) fn with(lens: &Lens, numbers: [f64; 3]) -> Lens {
    Lens {
        field_of_view_rad: numbers[0].clamp(0.02, 2.6),
        distortion: [numbers[1], numbers[2]],
        ..*lens
    }
}

fn errors(lens: &Lens, pose: &Pose, correspondence: &Correspondence) -> Option<[f64; 2]> {
    let said = lens.project_px(pose, correspondence.point_m)?;
    Some([0, 1].map(|k| correspondence.seen_px[k] - said[k]))
}

/// Robust root mean square distance of corners from their predicted positions, pixels: 1.2 times the median distance.
pub(super) fn reprojection_error_px(lens: &Lens, extrinsics: &[Extrinsics]) -> f64 {
    let mut all: Vec<f64> = Vec::new();
    for picture in extrinsics {
        let pose = picture.pose();
        let own = picture.correspondences.iter();
        all.extend(own.filter_map(|s| errors(lens, &pose, s).map(|e| e[0].hypot(e[1]))));
    }
    // The median of a distance whose two components are normal is 1.177 times the standard deviation of each component.
    if all.is_empty() {
        f64::NAN
    } else {
        median(&all) * 1.201
    }
}

/// Estimates the poses, and the lens if the prior asks for it, starting from the given values.
pub(super) fn resect(start: &Lens, extrinsics: &mut [Extrinsics], prior: &Prior) -> Lens {
    let mut lens = *start;
    for _ in 0..ROUNDS {
        let sd = (reprojection_error_px(&lens, extrinsics) / 2f64.sqrt()).max(LEAST_PX);
        if !sd.is_finite() {
            return lens;
        }
        let mut lens_side = Matrix3::<f64>::zeros();
        let mut lens_right = Vector3::<f64>::zeros();
        let its = numbers(&lens);
        for k in [1, 2] {
            let weight = prior.distortion_sd.powi(-2);
            lens_side[(k, k)] += weight;
            lens_right[k] -= weight * its[k];
        }
        // The six numbers of each picture's pose are eliminated (Schur complement).
        let mut own: Vec<(Matrix3x6<f64>, Matrix6<f64>, Vector6<f64>)> = Vec::new();
        for picture in extrinsics.iter() {
            let (mut cross, mut side, mut right) =
                (Matrix3x6::zeros(), Matrix6::zeros(), Vector6::zeros());
            for k in 0..6 {
                let sd = if k < 3 {
                    prior.place_sd_m
                } else {
                    prior.angle_sd_rad
                };
                side[(k, k)] += sd.powi(-2);
                right[k] -= sd.powi(-2) * picture.off[k];
            }
            for correspondence in &picture.correspondences {
                let Some((error, of_lens, of_pose)) = linear(&lens, picture, correspondence) else {
                    continue;
                };
                let far = error[0].hypot(error[1]) / sd;
                let weight = sd.powi(-2) * if far > HUBER { HUBER / far } else { 1.0 };
                for row in 0..2 {
                    lens_side += weight * of_lens[row] * of_lens[row].transpose();
                    lens_right += weight * error[row] * of_lens[row];
                    cross += weight * of_lens[row] * of_pose[row].transpose();
                    side += weight * of_pose[row] * of_pose[row].transpose();
                    right += weight * error[row] * of_pose[row];
                }
            }
            own.push((cross, side, right));
        }
        let mut step = Vector3::zeros();
        if prior.lens {
            for (cross, side, right) in &own {
                if let Some(inverse) = side.try_inverse() {
                    lens_side -= cross * inverse * cross.transpose();
                    lens_right -= cross * inverse * right;
                }
            }
            step = lens_side
                .try_inverse()
                .map_or(step, |inverse| inverse * lens_right);
        }
        for (picture, (cross, side, right)) in extrinsics.iter_mut().zip(&own) {
            if let Some(inverse) = side.try_inverse() {
                let moved = inverse * (right - cross.transpose() * step);
                (0..6).for_each(|k| picture.off[k] += moved[k]);
            }
        }
        lens = with(&lens, [0, 1, 2].map(|k| its[k] + step[k]));
    }
    lens
}

/// The error of a correspondence, and its derivatives with respect to the lens and the pose.
type Linear = ([f64; 2], [Vector3<f64>; 2], [Vector6<f64>; 2]);

fn linear(lens: &Lens, picture: &Extrinsics, correspondence: &Correspondence) -> Option<Linear> {
    let pose = picture.pose();
    let error = errors(lens, &pose, correspondence)?;
    let its = numbers(lens);
    let mut of_lens = [Vector3::zeros(); 2];
    for k in 0..3 {
        let ends = [STEP, -STEP].map(|step| {
            let mut changed = its;
            changed[k] += step;
            with(lens, changed).project_px(&pose, correspondence.point_m)
        });
        let (up, down) = (ends[0]?, ends[1]?);
        (0..2).for_each(|row| of_lens[row][k] = (up[row] - down[row]) / (2.0 * STEP));
    }
    let mut of_pose = [Vector6::zeros(); 2];
    for k in 0..6 {
        let ends = [STEP, -STEP].map(|step| {
            let mut off = picture.off;
            off[k] += step;
            lens.project_px(&moved(&picture.meant, &off), correspondence.point_m)
        });
        let (up, down) = (ends[0]?, ends[1]?);
        (0..2).for_each(|row| of_pose[row][k] = (up[row] - down[row]) / (2.0 * STEP));
    }
    Some((error, of_lens, of_pose))
}
