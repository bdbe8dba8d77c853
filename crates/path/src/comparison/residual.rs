//! The metric `shape`: the distance of two paths without the difference in the distance travelled.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::{POINTS, Prepared};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Root mean square distance, metres, of the remainders of two paths after the uniform straight motion from the first to the last
/// point is subtracted from each. Together with [`Displacement`](super::Displacement) it separates the distance into shape and fitness, as
/// the papers call the distance travelled (paper 003, figure 2).
#[derive(Debug, Clone, Copy)]
pub struct Shape;

impl Metric for Shape {
    constant_methods! {
        name: &'static str = "shape";
        column: &'static str = "shape_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "distance of the paths without their straight motion from start to end";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = (
            remainder(pair.real_prepared),
            remainder(pair.simulated_prepared),
        );
        let sum_m2: f64 = a
            .zip(b)
            .map(|(p, q)| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2))
            .sum();
        Ok(Measurement::new((sum_m2 / POINTS as f64).sqrt(), POINTS))
    }
}

/// The path minus the uniform straight motion from its start to its end.
fn remainder(prepared: &Prepared) -> impl Iterator<Item = [f64; 2]> + '_ {
    let xy_m = prepared.xy_m();
    let end = xy_m[POINTS - 1];
    xy_m.iter().enumerate().map(move |(index, point)| {
        let share = index as f64 / (POINTS - 1) as f64;
        [point[0] - share * end[0], point[1] - share * end[1]]
    })
}
