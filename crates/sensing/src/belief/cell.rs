//! The mean density of a reading over a cell of distances, for sensors that resolve distances within a cell.

use crate::range::{Beam, RangeSensor};

/// Number of bisection steps by which a distance within a cell is found, to a billionth of the cell.
const HALVINGS: usize = 30;

/// Logarithm of the mean density of a reading over the distances between the edges.
///
/// If the mean reading changes within the cell by less than the standard deviation of readings, the density at the middle is used for
/// the whole cell. Otherwise only a share of the cell (the standard deviation divided by that change) can have given the reading.
/// This share gets the density at the distance that fits the reading best, and the rest the density at the edge that fits worst
/// (which is 0, or the density of outliers).
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
    // The middle is used, too, if the mean is not finite.
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
