//! Estimates the bias of the estimated lens by a parametric bootstrap (Efron & Tibshirani 1993, chapter 10).
//!
//! The real pictures are simulated with the estimated camera at the estimated poses, and the lens is estimated from these simulated
//! pictures in the same way as from the real ones.

use rayon::prelude::*;

use super::extrinsics::{Extrinsics, Prior};
use super::lens::in_degrees;
use super::room::LitScene;
use super::shot::{Shot, extrinsics_of};
use crate::camera::{Camera, expose, luminance};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, standard_deviation, student_quantile};

/// Number of bootstrap replicates of all pictures.
const REPLICATES: u64 = 8;
/// First number of the noise of simulated pictures, and difference of the first numbers of two replicates.
const FIRST_NUMBER: u64 = 1 << 25;
const STRIDE: u64 = 1 << 16;

/// For each of the three numbers of a lens, the bias of the method and the half width of the interval at this level.
pub(super) fn lens_bias(
    lit_scene: LitScene<'_>,
    camera: &Camera,
    (shots, extrinsics): (&[&Shot], &[Extrinsics]),
    prior: &Prior,
    (seed, level): (u64, f64),
) -> Result<[(f64, f64); 3]> {
    let lit: Vec<_> = extrinsics
        .par_iter()
        .map(|its| luminance(lit_scene.scene, camera, &its.pose(), lit_scene.light))
        .collect();
    let found: Vec<[f64; 3]> = (0..REPLICATES)
        .into_par_iter()
        .map(|replicate| {
            let first = FIRST_NUMBER + replicate * STRIDE;
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
            let (refitted, _) = extrinsics_of(lit_scene, camera, &own, prior)?;
            Ok(in_degrees(&refitted.lens))
        })
        .collect::<Result<_>>()?;
    let count = REPLICATES as f64;
    let its = in_degrees(&camera.lens);
    Ok([0, 1, 2].map(|k| {
        let own: Vec<f64> = found.iter().map(|numbers| numbers[k]).collect();
        // The variance is that of the estimate from the real pictures plus that of the mean over the replicates.
        let sd = standard_deviation(&own) * (1.0 + 1.0 / count).sqrt();
        let half = student_quantile(0.5 + 0.5 * level, count - 1.0) * sd;
        (mean(&own) - its[k], half)
    }))
}
