//! Absolute and relative pose error (translation part), as evo 1.38 computes them.
//!
//! They compare the matched samples of a pair as they are, or the prepared points where no samples are matched. Unlike the other metrics,
//! they include the height if both trajectories have it.

use std::borrow::Cow;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use super::umeyama::best_turn;
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Absolute pose error (RMSE), metres. Of prepared points in the plane it equals `rms`.
#[derive(Debug, Clone, Copy)]
pub struct Ape;

impl Metric for Ape {
    constant_methods! {
        name: &'static str = "ape";
        column: &'static str = "ape_rmse_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "evo's absolute pose error, translation part, RMSE (with height, if both have it)";
        needs: Needs = Needs::POINTS;
        is_of_samples: bool = true;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let [a, b] = positions_m(pair);
        let errors_m = a.iter().zip(b.iter()).map(|(p, q)| p - q);
        Ok(root_mean_square(errors_m.map(|e| e.norm_squared())))
    }
}

/// Absolute pose error (RMSE) after the best rigid alignment, metres (Umeyama 1991 without scale).
///
/// The residual does not depend on the start and the heading of the trajectories, so prepared points give the same result as
/// resampled points. The rotation is computed after Horn (1987): it is the same optimum, always a proper rotation, and also defined for
/// straight lines and single points, which evo refuses.
#[derive(Debug, Clone, Copy)]
pub struct UmeyamaApe;

impl Metric for UmeyamaApe {
    constant_methods! {
        name: &'static str = "umeyama-ape";
        column: &'static str = "umeyama_ape_rmse_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "evo's absolute pose error, translation part, RMSE after Umeyama SE(3) alignment";
        needs: Needs = Needs::POINTS;
        is_of_samples: bool = true;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let [a, b] = positions_m(pair);
        let n = a.len() as f64;
        let centre_a = a.iter().sum::<Vector3<f64>>() / n;
        let centre_b = b.iter().sum::<Vector3<f64>>() / n;
        let moved_a = a.iter().map(|p| p - centre_a);
        let centred = moved_a.zip(b.iter().map(|q| q - centre_b));
        let covariance: Matrix3<f64> = centred.clone().map(|(p, q)| q * p.transpose()).sum();
        let turn = best_turn(&covariance);
        Ok(root_mean_square(
            centred.map(|(p, q)| (p - turn * q).norm_squared()),
        ))
    }
}

/// Relative pose error (RMSE) over single steps between consecutive samples, metres.
///
/// Steps are expressed in the body frame if both trajectories have orientations, as in evo; otherwise in the frame of the path.
#[derive(Debug, Clone, Copy)]
pub struct Rpe;

impl Metric for Rpe {
    constant_methods! {
        name: &'static str = "rpe";
        column: &'static str = "rpe_rmse_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "evo's relative pose error, translation part, RMSE, delta 1 frame";
        needs: Needs = Needs::POINTS;
        is_of_samples: bool = true;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let [a, b] = positions_m(pair);
        let steps = steps_m(&a).zip(steps_m(&b));
        Ok(match orientations(pair) {
            None => root_mean_square(steps.map(|(p, q)| (p - q).norm_squared())),
            Some([turns_a, turns_b]) => root_mean_square(
                steps
                    .zip(turns_a.iter().zip(turns_b))
                    .map(|((p, q), (a, b))| {
                        (a.inverse_transform_vector(&p) - b.inverse_transform_vector(&q))
                            .norm_squared()
                    }),
            ),
        })
    }
}

/// The steps from every position to the next, metres.
fn steps_m(positions: &[Vector3<f64>]) -> impl Iterator<Item = Vector3<f64>> {
    positions.windows(2).map(|pair| pair[1] - pair[0])
}

/// The compared orientations: those of the matched samples, or those of the prepared points.
pub(super) fn orientations<'a>(pair: &Pair<'a>) -> Option<[&'a [UnitQuaternion<f64>]; 2]> {
    match pair.matched {
        Some(matched) => matched.orientations(),
        None => {
            let (a, b) = (pair.real_prepared, pair.simulated_prepared);
            Some([a.orientations()?, b.orientations()?])
        }
    }
}

/// The compared positions: those of the matched samples, or the prepared points, whose height is 0 unless both trajectories have it.
fn positions_m<'a>(pair: &Pair<'a>) -> [Cow<'a, [Vector3<f64>]>; 2] {
    if let Some(matched) = pair.matched {
        return matched.positions_m().map(Cow::Borrowed);
    }
    let prepared = [pair.real_prepared, pair.simulated_prepared];
    let both = prepared.iter().all(|path| path.z_m().is_some());
    prepared.map(|path| {
        let z_m = path.z_m().filter(|_| both);
        let points = path.xy_m().iter().enumerate();
        points
            .map(|(i, [x, y])| Vector3::new(*x, *y, z_m.map_or(0.0, |z| z[i])))
            .collect()
    })
}

fn root_mean_square(squares: impl Iterator<Item = f64>) -> Measurement {
    let (mut sum, mut samples) = (0.0, 0_usize);
    for square in squares {
        sum += square;
        samples += 1;
    }
    Measurement::new((sum / samples.max(1) as f64).sqrt(), samples)
}
