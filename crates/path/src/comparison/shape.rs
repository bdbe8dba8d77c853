//! Metrics that compare the shapes of paths without their timing: Hausdorff, Fréchet, dynamic time warping.

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use super::pointwise::squared;
use realgap_core::constant_methods;
use realgap_core::error::Result;
use realgap_core::unit::Unit;

/// Symmetric Hausdorff distance of the prepared points, metres: the largest distance of any point of one path from
/// the other path.
#[derive(Debug, Clone, Copy)]
pub struct Hausdorff;

impl Metric for Hausdorff {
    constant_methods! {
        name: &'static str = "hausdorff";
        column: &'static str = "hausdorff_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "largest distance of any point of one path from the other path";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = points(pair);
        // One pass computes both directions: the row minimum for a, the column minima for b.
        let mut nearest_to_b = vec![f64::INFINITY; b.len()];
        let mut farthest: f64 = 0.0;
        for p in a {
            let mut nearest = f64::INFINITY;
            for (q, nearest_to_q) in b.iter().zip(&mut nearest_to_b) {
                let d = squared(*p, *q);
                nearest = if d < nearest { d } else { nearest };
                *nearest_to_q = if d < *nearest_to_q { d } else { *nearest_to_q };
            }
            farthest = farthest.max(nearest);
        }
        farthest = nearest_to_b.iter().fold(farthest, |m, d| m.max(*d));
        Ok(Measurement::new(farthest.sqrt(), a.len() + b.len()))
    }
}

/// Discrete Fréchet distance of the prepared points, metres: the shortest leash with which both paths can be
/// walked without going back (Eiter and Mannila 1994).
#[derive(Debug, Clone, Copy)]
pub struct Frechet;

impl Metric for Frechet {
    constant_methods! {
        name: &'static str = "frechet";
        column: &'static str = "discrete_frechet_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "shortest leash with which both paths can be walked without going back (discrete)";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = points(pair);
        let squared_m2 = warp(
            a,
            b,
            squared,
            |cheapest, d| if cheapest > d { cheapest } else { d },
        );
        Ok(Measurement::new(squared_m2.sqrt(), a.len() + b.len()))
    }
}

/// Dynamic time warping of the prepared points, metres: the sum of distances along the best monotone matching
/// (Sakoe and Chiba 1978, steps (1,0), (0,1), (1,1), no window, no normalisation).
#[derive(Debug, Clone, Copy)]
pub struct Dtw;

impl Metric for Dtw {
    constant_methods! {
        name: &'static str = "dtw";
        column: &'static str = "dtw_sum_m";
        unit: Unit = Unit::Metre;
        doc: &'static str = "dynamic time warping: sum of distances along the best matching";
        needs: Needs = Needs::POINTS;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (a, b) = points(pair);
        let sum_m = warp(
            a,
            b,
            |p, q| squared(p, q).sqrt(),
            |cheapest, d| cheapest + d,
        );
        Ok(Measurement::new(sum_m, a.len() + b.len()))
    }
}

type Points<'a> = &'a [[f64; 2]];

fn points<'a>(pair: &Pair<'a>) -> (Points<'a>, Points<'a>) {
    (pair.real_prepared.xy_m(), pair.simulated_prepared.xy_m())
}

/// Cost of the best monotone path through the table of distances, one row in memory at a time.
///
/// `join(cheapest predecessor, distance)` is the cost of a cell.
fn warp(
    a: Points<'_>,
    b: Points<'_>,
    distance: impl Fn([f64; 2], [f64; 2]) -> f64,
    join: impl Fn(f64, f64) -> f64,
) -> f64 {
    // `row[j + 1]` is the cell of b[j] in the row above; `row[0]` is outside of the table.
    let mut row = vec![f64::INFINITY; b.len() + 1];
    let mut distances = vec![0.0; b.len()];
    // The start costs nothing, and only the first cell can be reached from it.
    row[0] = 0.0;
    for p in a {
        // The distances have a loop of their own, so that the compiler can vectorise it.
        for (d, q) in distances.iter_mut().zip(b) {
            *d = distance(*p, *q);
        }
        let mut diagonal = row[0];
        let mut left = f64::INFINITY;
        for (d, above) in distances.iter().zip(&mut row[1..]) {
            let upper = if *above < diagonal { *above } else { diagonal };
            diagonal = *above;
            left = join(if left < upper { left } else { upper }, *d);
            *above = left;
        }
        row[0] = f64::INFINITY;
    }
    row[b.len()]
}
