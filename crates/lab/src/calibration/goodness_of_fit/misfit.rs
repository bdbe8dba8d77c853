//! Description of a misfit: where the nearest run differs most from the recordings, and which single change would bring it
//! nearest to them.

use serde::Serialize;

use crate::calibration::goodness_of_fit::path::{Nearest, QUARTERS, middle};
use realgap_path::trajectory::{Prepared, mean_square_m2, turned};

/// Where a model that explains no recordings is worst, and how: of the run that comes nearest to the recordings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Misfit {
    /// Beginning of the quarter of the path in which the run deviates most, seconds.
    pub from_s: f64,
    /// Its end, seconds.
    pub to_s: f64,
    /// Deviation of the run in that quarter, in standard deviations of the differences between recordings and between
    /// neighbouring runs.
    pub deviations: f64,
    /// The change of the run that brings it nearest to the mean recording.
    pub change: Change,
    /// How large that change is: a factor; for turning, radians over the whole path; for a mirror image 1.
    pub size: f64,
    /// Share of the mean square distance that the change takes away.
    pub share: f64,
}

/// A change of a path by one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// Mirror image: left and right exchanged.
    Mirrored,
    /// All lengths times a factor.
    Lengths,
    /// The same path, so many times as fast.
    Pace,
    /// More turning to the left, spread evenly along the path.
    Turning,
}

/// Number of tried changes on each side of no change; they are spaced evenly up to the largest factor, or to the largest angle in
/// radians.
const TRIED: i32 = 30;
const FACTOR: f64 = 1.5;
const TURN_RAD: f64 = std::f64::consts::PI;

impl Misfit {
    pub(in crate::calibration) fn new(
        nearest: Nearest,
        run: &Prepared,
        real: &[&Prepared],
        duration_s: f64,
    ) -> Self {
        let run_m = run.xy_m();
        let middle_m = middle(&real.iter().map(|path| path.xy_m()).collect::<Vec<_>>());
        // Only the common part of both paths is compared, because a faster run covers the recorded part earlier.
        let left = |path_m: &[[f64; 2]]| {
            let (path_m, middle_m) = (turned(path_m), turned(&middle_m[..path_m.len()]));
            mean_square_m2(&path_m, &middle_m)
        };
        let share = |path_m: &[[f64; 2]]| 1.0 - left(path_m) / left(&run_m[..path_m.len()]);
        let mirrored: Vec<[f64; 2]> = run_m.iter().map(|p| [p[0], -p[1]]).collect();
        let mut found = vec![(Change::Mirrored, 1.0, share(&mirrored))];
        for step in (-TRIED..=TRIED).filter(|step| *step != 0) {
            let of_most = f64::from(step) / f64::from(TRIED);
            let (factor, turn_rad) = (libm::pow(FACTOR, of_most), TURN_RAD * of_most);
            let longer: Vec<[f64; 2]> = run_m.iter().map(|p| p.map(|m| factor * m)).collect();
            found.push((Change::Lengths, factor, share(&longer)));
            found.push((Change::Pace, factor, share(&faster(run_m, factor))));
            found.push((Change::Turning, turn_rad, share(&bent(run_m, turn_rad))));
        }
        let best = found.into_iter().max_by(|a, b| a.2.total_cmp(&b.2));
        let (change, size, share) = best.unwrap_or((Change::Mirrored, 1.0, 0.0));
        let at_s = |quarter: usize| duration_s * quarter as f64 / QUARTERS as f64;
        Self {
            from_s: at_s(nearest.quarter),
            to_s: at_s(nearest.quarter + 1),
            deviations: nearest.deviations,
            change,
            size,
            share,
        }
    }
}

/// The path so many times as fast, up to its end or to the end of the recording.
fn faster(path_m: &[[f64; 2]], factor: f64) -> Vec<[f64; 2]> {
    let last = path_m.len() - 1;
    let within = (0..=last).map(|at| factor * at as f64);
    let there = within.take_while(|at| *at <= last as f64).map(|at| {
        let (before, share) = (at as usize, at.fract());
        let (a, b) = (path_m[before], path_m[(before + 1).min(last)]);
        [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]))
    });
    there.collect()
}

/// The path with every step turned by a share of `turn_rad` that is proportional to the length of path before it.
fn bent(path_m: &[[f64; 2]], turn_rad: f64) -> Vec<[f64; 2]> {
    let mut at_m = path_m[0];
    let steps = path_m.windows(2).enumerate().map(|(step, pair)| {
        let angle_rad = turn_rad * step as f64 / (path_m.len() - 1) as f64;
        let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
        let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        at_m = [at_m[0] + cos * x - sin * y, at_m[1] + sin * x + cos * y];
        at_m
    });
    std::iter::once(path_m[0]).chain(steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_path::trajectory::POINTS;

    fn way() -> Vec<[f64; 2]> {
        let at = |point: usize| {
            let t = point as f64 / (POINTS - 1) as f64;
            [t, 0.1 * libm::sin(9.0 * t) + 0.2 * t * t]
        };
        (0..POINTS).map(at).collect()
    }

    fn prepared(path_m: &[[f64; 2]]) -> Prepared {
        Prepared::from_xy_m(turned(path_m)).unwrap()
    }

    #[test]
    fn the_change_that_parts_run_and_recordings_is_named_with_its_size_and_the_quarter_in_seconds()
    {
        let (run, longer) = (prepared(&way()), |factor: f64| {
            run_of(&way(), |p| p.map(|m| factor * m))
        });
        let cases = [
            (run_of(&way(), |[x, y]| [x, -y]), Change::Mirrored, 1.0),
            (longer(1.25), Change::Lengths, 1.25),
            (faster(&way(), 0.8), Change::Pace, 0.8),
            (bent(&way(), 1.0), Change::Turning, 1.0),
        ];
        let nearest = Nearest {
            run: 0,
            p_value: 0.0,
            quarter: 1,
            deviations: 3.0,
        };
        for (recorded, change, size) in cases {
            let real = prepared(&recorded);
            let found = Misfit::new(nearest, &run, &[&real; 3], 8.0);
            assert_eq!(found.change, change, "{found:?}");
            // The tried changes are spaced by 1.4 % and 6 degrees.
            assert!((found.size - size).abs() < 0.06, "{found:?}");
            assert!(found.share > 0.95, "{found:?}");
            assert_eq!((found.from_s, found.to_s), (2.0, 4.0));
        }
    }

    fn run_of(path_m: &[[f64; 2]], change: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
        path_m.iter().map(|p| change(*p)).collect()
    }
}
