//! What the method gets wrong of a lens: the real pictures are simulated with the camera that was found, at the places that were found,
//! and its lens is sought in these doubles as in the real ones (Efron & Tibshirani 1993, chapter 10: bias by parametric bootstrap).

use rayon::prelude::*;

use super::extrinsics::{Extrinsics, Prior};
use super::lens::in_degrees;
use super::room::Room;
use super::shot::{Shot, extrinsics_of};
use crate::camera::{Camera, expose, luminance};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, standard_deviation, student_quantile};

/// Doubles of all pictures.
const DOUBLES: u64 = 8;
/// Numbers of their noise begin here, and lie so far apart.
const FIRST_NUMBER: u64 = 1 << 25;
const APART: u64 = 1 << 16;

/// The three numbers of a lens: by how much the method finds them too large, and how far off that may leave them at this level.
pub(super) fn lens_bias(
    room: Room<'_>,
    camera: &Camera,
    (shots, extrinsics): (&[&Shot], &[Extrinsics]),
    prior: &Prior,
    (seed, level): (u64, f64),
) -> Result<[(f64, f64); 3]> {
    let lit: Vec<_> = extrinsics
        .par_iter()
        .map(|its| luminance(room.scene, camera, &its.pose(), room.light))
        .collect();
    let found: Vec<[f64; 3]> = (0..DOUBLES)
        .into_par_iter()
        .map(|double| {
            let first = FIRST_NUMBER + double * APART;
            let own: Vec<Shot> = shots
                .iter()
                .zip(&lit)
                .zip(first..)
                .map(|((shot, light), number)| {
                    let picture = expose(camera, light, seed, number)?;
                    Ok(Shot {
                        view: shot.view,
                        path: shot.path.clone(),
                        grey: picture.grey(),
                        picture,
                    })
                })
                .collect::<Result<_>>()?;
            let own: Vec<&Shot> = own.iter().collect();
            let (double, _) = extrinsics_of(room, camera, &own, prior)?;
            Ok(in_degrees(&double.lens))
        })
        .collect::<Result<_>>()?;
    let count = DOUBLES as f64;
    let its = in_degrees(&camera.lens);
    Ok([0, 1, 2].map(|k| {
        let own: Vec<f64> = found.iter().map(|numbers| numbers[k]).collect();
        // That of the real pictures, and that of the mean of the doubles.
        let sd = standard_deviation(&own) * (1.0 + 1.0 / count).sqrt();
        let half = student_quantile(0.5 + 0.5 * level, count - 1.0) * sd;
        (mean(&own) - its[k], half)
    }))
}
