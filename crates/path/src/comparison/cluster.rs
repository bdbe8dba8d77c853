//! The metric `pca-cluster`, which compares the principal spreads of two trajectories as clouds of points.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Distance of the spreads of two clouds of points, metres: ‖C_a^½ − C_b^½‖_F, where C is the 2×2 population covariance of the
/// prepared points (paper 003, section 2.2: "a trajectory as a cluster of data points").
#[derive(Debug, Clone, Copy)]
pub struct PcaCluster;

impl Metric for PcaCluster {
    constant_methods! {
        name: &'static str = "pca-cluster";
        column: &'static str = "pca_cluster_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "difference of the principal spreads of the two point clouds";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let a = root_covariance(pair.real_prepared.xy_m());
        let b = root_covariance(pair.simulated_prepared.xy_m());
        let [xx, xy, yy] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let value = (xx * xx + 2.0 * xy * xy + yy * yy).sqrt();
        Ok(Measurement::new(value, pair.real_prepared.xy_m().len()))
    }
}

/// The matrix square root C^½ as (xx, xy, yy), metres.
///
/// The spread along each principal axis is computed from the points themselves, because the square roots of the eigenvalues of C would lose
/// half of the digits of the smaller spread.
fn root_covariance(points_m: &[[f64; 2]]) -> [f64; 3] {
    let n = points_m.len() as f64;
    let (sx, sy) = points_m
        .iter()
        .fold((0.0, 0.0), |(sx, sy), [x, y]| (sx + x, sy + y));
    let centre = [sx / n, sy / n];
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in points_m {
        let (dx, dy) = (x - centre[0], y - centre[1]);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    let (mut along, mut across) = (0.0, 0.0);
    for [x, y] in points_m {
        let (dx, dy) = (x - centre[0], y - centre[1]);
        let (u, v) = (cos * dx + sin * dy, cos * dy - sin * dx);
        along += u * u;
        across += v * v;
    }
    let (along_m, across_m) = ((along / n).sqrt(), (across / n).sqrt());
    [
        along_m * cos * cos + across_m * sin * sin,
        (along_m - across_m) * cos * sin,
        along_m * sin * sin + across_m * cos * cos,
    ]
}
