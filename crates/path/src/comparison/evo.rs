//! Absolute and relative pose error (translation part), as evo 1.38 computes them.
//!
//! Unlike the other metrics, these include the height if both trajectories have it.

use nalgebra::{Matrix3, Matrix4, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::Prepared;
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Absolute pose error (RMSE) of the prepared trajectories, metres. In the plane it equals `rms`.
#[derive(Debug, Clone, Copy)]
pub struct Ape;

impl Metric for Ape {
    constant_methods! {
        name: &'static str = "ape";
        column: &'static str = "ape_rmse_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "evo's absolute pose error, translation part, RMSE (with height, if both have it)";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = positions_m(pair);
        Ok(root_mean_square(
            a.zip(b).map(|(p, q)| (p - q).norm_squared()),
        ))
    }
}

/// Absolute pose error (RMSE) after the best rigid alignment, metres (Umeyama 1991 without scale).
///
/// The residual does not depend on the start and the heading of the trajectories, so the prepared points give the same result as
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
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = positions_m(pair);
        let n = a.len() as f64;
        let centre_a = a.clone().sum::<Vector3<f64>>() / n;
        let centre_b = b.clone().sum::<Vector3<f64>>() / n;
        let centred = a.map(|p| p - centre_a).zip(b.map(|q| q - centre_b));
        let covariance: Matrix3<f64> = centred.clone().map(|(p, q)| q * p.transpose()).sum();
        let turn = best_turn(&covariance);
        Ok(root_mean_square(
            centred.map(|(p, q)| (p - turn * q).norm_squared()),
        ))
    }
}

/// The rotation R that maximises Σ p·R q for S = Σ q pᵀ: the eigenvector of Horn's matrix with the largest eigenvalue.
fn best_turn(s: &Matrix3<f64>) -> UnitQuaternion<f64> {
    #[rustfmt::skip]
    let horn = Matrix4::new(
        s.m11 + s.m22 + s.m33, s.m23 - s.m32,          s.m31 - s.m13,          s.m12 - s.m21,
        s.m23 - s.m32,         s.m11 - s.m22 - s.m33,  s.m12 + s.m21,          s.m31 + s.m13,
        s.m31 - s.m13,         s.m12 + s.m21,          s.m22 - s.m11 - s.m33,  s.m23 + s.m32,
        s.m12 - s.m21,         s.m31 + s.m13,          s.m23 + s.m32,          s.m33 - s.m11 - s.m22,
    );
    let eigen = SymmetricEigen::new(horn);
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// Relative pose error (RMSE) over single steps of the prepared trajectories, metres.
///
/// Steps are expressed in the body frame if both trajectories have orientations, as in evo; otherwise in the frame of the prepared path.
#[derive(Debug, Clone, Copy)]
pub struct Rpe;

impl Metric for Rpe {
    constant_methods! {
        name: &'static str = "rpe";
        column: &'static str = "rpe_rmse_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "evo's relative pose error, translation part, RMSE, delta 1 frame";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = positions_m(pair);
        let steps = steps_m(a).zip(steps_m(b));
        let orientations = pair
            .real_prepared
            .orientations()
            .zip(pair.simulated_prepared.orientations());
        Ok(match orientations {
            None => root_mean_square(steps.map(|(p, q)| (p - q).norm_squared())),
            Some((turns_a, turns_b)) => root_mean_square(
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
fn steps_m(positions: impl Positions) -> impl Iterator<Item = Vector3<f64>> {
    let after = positions.clone().skip(1);
    after.zip(positions).map(|(after, before)| after - before)
}

trait Positions: ExactSizeIterator<Item = Vector3<f64>> + Clone {}
impl<I: ExactSizeIterator<Item = Vector3<f64>> + Clone> Positions for I {}

/// The prepared positions; the height is 0 unless both trajectories have it.
fn positions_m<'a>(pair: &Pair<'a>) -> (impl Positions + use<'a>, impl Positions + use<'a>) {
    let (a, b) = (pair.real_prepared, pair.simulated_prepared);
    let both = a.z_m().is_some() && b.z_m().is_some();
    let of = move |prepared: &'a Prepared| {
        let z_m = prepared.z_m().filter(|_| both);
        prepared
            .xy_m()
            .iter()
            .enumerate()
            .map(move |(i, [x, y])| Vector3::new(*x, *y, z_m.map_or(0.0, |z| z[i])))
    };
    (of(a), of(b))
}

fn root_mean_square(squares: impl Iterator<Item = f64>) -> Measurement {
    let (mut sum, mut samples) = (0.0, 0_usize);
    for square in squares {
        sum += square;
        samples += 1;
    }
    Measurement::new((sum / samples.max(1) as f64).sqrt(), samples)
}
