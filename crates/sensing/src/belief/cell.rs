//! The density of a reading over a cell of distances that the sensor may tell apart.

use crate::range::{Beam, RangeSensor};

/// Halvings until a distance within a cell is found: to a billionth of the cell.
const HALVINGS: usize = 30;

/// Logarithm of the mean density of a reading over the distances between the edges.
///
/// Where the mean reading changes by less than its spread within the cell, the middle stands for all of it. Elsewhere only a share of
/// the cell, the spread over that change, can have given the reading: it has the density of the distance that fits the reading best,
/// and the rest that of the edge that fits worst (which is 0, or that of nonsense).
pub(super) fn log_density(
    sensor: &dyn RangeSensor,
    reading: f64,
    middle_m: f64,
    [low_m, high_m]: [f64; 2],
) -> f64 {
    let mean = |distance_m: f64| sensor.mean(&Beam::straight(distance_m));
    let at = |distance_m: f64| sensor.log_density(reading, &Beam::straight(distance_m));
    let (low, high) = (mean(low_m), mean(high_m));
    let change = (high - low).abs();
    let sd = sensor.sd(&Beam::straight(middle_m));
    // A mean that is not finite leaves the middle, too.
    if change.is_nan() || change <= sd {
        return at(middle_m);
    }
    let best_m = if (reading - low) * (reading - high) < 0.0 {
        let (mut before_m, mut after_m) = (low_m, high_m);
        for _ in 0..HALVINGS {
            let half_m = 0.5 * (before_m + after_m);
            if (mean(half_m) - reading) * (low - reading) > 0.0 {
                before_m = half_m;
            } else {
                after_m = half_m;
            }
        }
        0.5 * (before_m + after_m)
    } else if (reading - low).abs() < (reading - high).abs() {
        low_m
    } else {
        high_m
    };
    let share = (sd * std::f64::consts::TAU.sqrt() / change).min(1.0);
    let (best, worst) = (at(best_m), at(low_m).min(at(high_m)));
    let most = best.max(worst);
    if !most.is_finite() {
        return most;
    }
    most + libm::log(share * libm::exp(best - most) + (1.0 - share) * libm::exp(worst - most))
}
