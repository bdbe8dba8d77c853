//! `shape`: what two paths differ in besides how far they lead.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::{POINTS, Prepared};
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Root mean square distance, metres, of what remains of each path when the straight, uniform walk from its first to its last
/// point is taken away. Together with [`Displacement`](super::Displacement) it parts the distance into fitness, as the
/// papers call the distance travelled (paper 003, figure 2), and shape.
#[derive(Debug, Clone, Copy)]
pub struct Shape;

impl Metric for Shape {
    constant_methods! {
        name: &'static str = "shape";
        column: &'static str = "shape_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "distance of what remains of each path without its straight walk from start to end";
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

/// The path minus the straight walk to its end.
fn remainder(prepared: &Prepared) -> impl Iterator<Item = [f64; 2]> + '_ {
    let xy_m = prepared.xy_m();
    let end = xy_m[POINTS - 1];
    xy_m.iter().enumerate().map(move |(index, point)| {
        let share = index as f64 / (POINTS - 1) as f64;
        [point[0] - share * end[0], point[1] - share * end[1]]
    })
}
