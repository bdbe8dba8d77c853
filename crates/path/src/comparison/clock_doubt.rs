//! Doubts about the clocks of two recordings that are said to have one clock.

use nalgebra::Vector3;

use super::association::{Association, Matched, Stamped};
use super::clock_offset::{clock_offset, longer_interval_s};
use super::umeyama::Similarity;
use realgap_core::unit::{Unit, decimals, number, quantity};
use realgap_core::warning::{Code, Warning};

/// An offset is visible if it is larger than this many sample intervals …
const INTERVALS: f64 = 3.0;
/// … and than this many standard deviations, …
const DEVIATIONS: f64 = 4.0;
/// … if the speeds correlate at least this well when the stamps are shifted, …
const CORRELATED: f64 = 0.8;
/// … and if the error after alignment then falls to less than this share of what it was, …
const FALL: f64 = 0.5;
/// … in every one of so many parts of the common time, each aligned by itself: two different runs may have one event in common.
const PARTS: usize = 4;
/// A part counts if its error is at least this share of that of the largest part; in the others the body hardly moves.
const COUNTS: f64 = 0.25;

/// A doubt about the clocks if an offset explains most of the error.
///
/// Recordings whose stamps both begin at 0 are not doubted: their times are counted from their own starts and not by a clock, and two
/// tosses or pushes that were triggered at different moments are no fault.
pub(super) fn visible_offset(reference: Stamped<'_>, other: Stamped<'_>) -> Option<Warning> {
    let starts_s = [reference, other].map(|stamped| stamped.trajectory.times_s()[0].abs());
    let interval_s = longer_interval_s(reference.trajectory, other.trajectory);
    // The search for an offset is dear, so it comes after what excludes one.
    if starts_s.iter().all(|start_s| *start_s < interval_s) {
        return None;
    }
    let found = clock_offset(reference.trajectory, other.trajectory, 0.0)?;
    let least_s = (INTERVALS * interval_s).max(DEVIATIONS * found.deviation_s);
    if found.offset_s.abs() <= least_s || found.correlation < CORRELATED {
        return None;
    }
    let errors_m = |offset_s: f64| {
        let matched = Matched::new(reference, other, offset_s, Association::Interpolated).ok()?;
        let [p, q] = matched.positions_m();
        let end = |part: usize| part * p.len() / PARTS;
        let parts = (0..PARTS).map(|part| end(part)..end(part + 1));
        let of_parts: Vec<f64> = parts
            .map(|part| aligned_error_m(&p[part.clone()], &q[part]))
            .collect();
        Some((aligned_error_m(p, q), of_parts))
    };
    let (as_stamped_m, parts_as_stamped_m) = errors_m(0.0)?;
    let (shifted_m, parts_shifted_m) = errors_m(found.offset_s)?;
    let largest_m = parts_as_stamped_m.iter().copied().fold(0.0, f64::max);
    let parts = parts_as_stamped_m.iter().zip(&parts_shifted_m);
    let mut counting = parts.filter(|(before_m, _)| **before_m > COUNTS * largest_m);
    let falls = shifted_m < FALL * as_stamped_m
        && counting.all(|(before_m, after_m)| *after_m < FALL * before_m);
    falls.then(|| {
        let direction = match found.offset_s > 0.0 {
            true => "late",
            false => "early",
        };
        Code::ClockOffset.warning(format!(
            "the stamps look {} s {direction} (± {} s): shifted by this, the error after alignment falls from {} to {}",
            decimals(found.offset_s.abs(), 3),
            number(found.deviation_s),
            quantity(as_stamped_m, Unit::Metre),
            quantity(shifted_m, Unit::Metre),
        ))
    })
}

/// Root mean square distance of points after the best rigid alignment, metres.
fn aligned_error_m(reference_m: &[Vector3<f64>], other_m: &[Vector3<f64>]) -> f64 {
    let best = Similarity::best(reference_m, other_m, false);
    let moved = other_m.iter().map(|q| best.turn * q + best.shift_m);
    let squares = reference_m
        .iter()
        .zip(moved)
        .map(|(p, q)| (p - q).norm_squared());
    (squares.sum::<f64>() / reference_m.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Trajectory;

    fn stamped(trajectory: &Trajectory) -> Stamped<'_> {
        Stamped {
            trajectory,
            start_s: 0.0,
        }
    }

    /// A walk along a winding way, with speeds that change; `way` tells walks apart.
    fn walk(way: f64) -> Trajectory {
        let times_s: Vec<f64> = (0..900).map(|i| 50.0 + f64::from(i) / 30.0).collect();
        let at = |t: &f64| {
            let t = t - 50.0;
            Vector3::new(
                0.2 * t + 0.1 * (1.1 * t + way).sin(),
                0.15 * (0.7 * way * t).sin(),
                0.0,
            )
        };
        Trajectory::new(times_s.clone(), times_s.iter().map(at).collect()).unwrap()
    }

    #[test]
    fn a_clock_that_is_late_or_early_is_doubted_with_its_offset() {
        let whole = walk(1.0);
        for (offset_s, words) in [(0.5, "0.500 s late"), (-0.8, "0.800 s early")] {
            let warning = visible_offset(stamped(&whole), stamped(&whole.later(offset_s).unwrap()));
            let warning = warning.unwrap();
            assert!(warning.message.contains(words), "{warning}");
            assert_eq!(warning.code, Code::ClockOffset);
        }
    }

    #[test]
    fn times_since_each_start_are_no_clock() {
        let whole = walk(1.0);
        let stamps = whole.times_s();
        let from = |index: usize| {
            let part = whole.positions_world_m()[index..].to_vec();
            let times_s = stamps[index..].iter().map(|t| t - stamps[index]);
            Trajectory::new(times_s.collect(), part).unwrap()
        };
        let (whole, begun_later) = (from(0), from(30));
        assert_eq!(visible_offset(stamped(&whole), stamped(&begun_later)), None);
        let by_a_clock = [&whole, &begun_later].map(|path| path.later(5.0).unwrap());
        let [a, b] = by_a_clock.each_ref().map(stamped);
        assert!(
            visible_offset(a, b)
                .unwrap()
                .message
                .contains("1.000 s early")
        );
    }

    #[test]
    fn the_same_clock_and_another_run_are_not_doubted() {
        let whole = walk(1.0);
        for other in [
            whole.clone(),
            whole.later(0.05).unwrap(),
            walk(2.3),
            walk(0.4),
        ] {
            assert_eq!(visible_offset(stamped(&whole), stamped(&other)), None);
        }
    }
}
