//! How much one recorder's clock is ahead of the other's, from the correlation of speeds.

use super::speed_profile::SpeedProfile;
use crate::trajectory::Trajectory;
use realgap_core::statistics::{jackknife_variance, median};

/// The largest number of moments at which speeds are compared in the first search.
const MOST_MOMENTS: f64 = 2000.0;
/// A finer search has steps that are shorter by this.
const FINER: f64 = 8.0;
/// The largest number of moments in the finest search.
const MOST_CLOSE_MOMENTS: f64 = 2e5;
/// Shifts are searched up to this share of the shorter duration, in both directions.
const REACH: f64 = 0.5;
/// The fewest moments from which an offset is estimated.
const FEWEST_MOMENTS: usize = 24;
/// The number of lengths of window that are tried, each twice as long as the one before: noise asks for long windows, detail for
/// short ones.
const WINDOWS: i32 = 7;
/// The smallest correlation of speeds that shows an offset.
const CORRELATED: f64 = 0.5;
/// Of shifts whose correlation is less than this below the best, the one nearest to no shift counts: a gait repeats itself.
const EQUALLY_GOOD: f64 = 0.01;
/// Two tops of the correlation are different ones if it falls by this between them.
const VALLEY: f64 = 0.2;
/// A top is the part in which the correlation falls by this …
const LEAST_DROP: f64 = 0.02;
/// … or by this share of what is missing to 1, which is due to noise, but never by more than a valley.
const NOISE_IN_DROP: f64 = 1.0;
/// A top that another window found is sought again within this many steps.
const AROUND: f64 = 16.0;
/// Number of blocks of the recording that are left out in turn to estimate the uncertainty.
const BLOCKS: usize = 20;
/// Interpolation between samples shifts an estimate by up to this share of their interval.
const INTERPOLATION: f64 = 0.02;

/// An offset between two clocks, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockOffset {
    /// How much later the other trajectory's stamps are than the reference's for the same moment, seconds.
    pub offset_s: f64,
    /// Standard deviation of `offset_s`, from leaving out blocks of the recordings, seconds.
    pub deviation_s: f64,
    /// Correlation of the speeds at this offset, mean over moving and turning.
    pub correlation: f64,
}

/// The offset of the other trajectory's clock that makes speeds agree best, among offsets near `about_s`; `None` where speeds do not
/// show one.
///
/// Both trajectories are turned into speeds of moving and, where both have orientations, of turning, over windows of several lengths; the
/// window with the smallest uncertainty counts. Shifts of up to half of the shorter duration are searched, in both directions.
pub fn clock_offset(
    reference: &Trajectory,
    other: &Trajectory,
    about_s: f64,
) -> Option<ClockOffset> {
    let interval_s = longer_interval_s(reference, other);
    let shorter_s = reference.duration_s().min(other.duration_s());
    let longer_s = reference.duration_s().max(other.duration_s());
    // Times are counted from the reference's start, because epochs have few digits to spare.
    let other_start_s = (other.times_s()[0] - reference.times_s()[0]) - about_s;
    let search = Search {
        reference,
        other,
        other_start_s,
    };
    let first_step_s = interval_s.max(longer_s / MOST_MOMENTS);
    let finest_s = interval_s.max(longer_s / MOST_CLOSE_MOMENTS);
    let coarse = windows(first_step_s)
        .filter_map(|step_s| search.at_step(step_s, 0.0, REACH * shorter_s))
        .map(|found| search.closer(found, first_step_s, finest_s));
    let mut tops: Vec<Found> = coarse.collect();
    // No shift at all is a candidate, too: a coarse search may have passed over it.
    let none = Found {
        offset_s: 0.0,
        deviation_s: 0.0,
        correlation: 0.0,
        step_s: first_step_s,
    };
    tops.extend((first_step_s > finest_s).then(|| search.closer(none, first_step_s, finest_s)));
    let sure = tops.iter().filter(|top| top.correlation >= CORRELATED);
    let surest = *sure.min_by(|a, b| a.deviation_s.total_cmp(&b.deviation_s))?;
    // Tops of different windows are compared at one window.
    let others = tops.iter().filter_map(|top| {
        let reach_s = AROUND * surest.step_s + 4.0 * top.deviation_s;
        search.at_step(surest.step_s, top.offset_s, reach_s)
    });
    let at_one: Vec<Found> = std::iter::once(surest).chain(others).collect();
    let highest = at_one.iter().map(|top| top.correlation).fold(0.0, f64::max);
    let good = at_one
        .iter()
        .filter(|top| top.correlation >= highest - EQUALLY_GOOD);
    let found = good.min_by(|a, b| a.offset_s.abs().total_cmp(&b.offset_s.abs()))?;
    Some(ClockOffset {
        offset_s: about_s + found.offset_s,
        deviation_s: found.deviation_s.hypot(INTERPOLATION * interval_s),
        correlation: found.correlation,
    })
}

/// The steps that are tried; each window is two steps long.
fn windows(first_step_s: f64) -> impl Iterator<Item = f64> {
    (0..WINDOWS).map(move |power| first_step_s * 2f64.powi(power))
}

/// The longer of the usual intervals of samples of two trajectories, seconds.
pub(super) fn longer_interval_s(reference: &Trajectory, other: &Trajectory) -> f64 {
    usual_interval_s(reference).max(usual_interval_s(other))
}

/// The median time between samples, seconds.
fn usual_interval_s(trajectory: &Trajectory) -> f64 {
    let pairs = trajectory.times_s().windows(2);
    median(&pairs.map(|pair| pair[1] - pair[0]).collect::<Vec<_>>())
}

/// Two trajectories whose speeds are compared.
#[derive(Debug, Clone, Copy)]
struct Search<'a> {
    reference: &'a Trajectory,
    other: &'a Trajectory,
    /// Time of the other's first sample after that of the reference, seconds.
    other_start_s: f64,
}

/// The best shift on one grid.
#[derive(Debug, Clone, Copy)]
struct Found {
    offset_s: f64,
    deviation_s: f64,
    correlation: f64,
    step_s: f64,
}

/// The channels of two profiles.
type Channels<'a> = [(&'a [f64], &'a [f64])];

impl Search<'_> {
    /// The best shift of `middle_s` ± `reach_s`, with speeds at multiples of `step_s` over windows of two steps.
    fn at_step(self, step_s: f64, middle_s: f64, reach_s: f64) -> Option<Found> {
        let window_s = 2.0 * step_s;
        let profile = |of, start_s| SpeedProfile::new(of, start_s, step_s, window_s);
        let a = profile(self.reference, 0.0);
        let b = profile(self.other, self.other_start_s);
        let channels = a.channels(&b);
        let shortest = a.linear_m_s.len().min(b.linear_m_s.len());
        if shortest < FEWEST_MOMENTS {
            return None;
        }
        // Every shift keeps at least half of what the shorter one has.
        let enough = FEWEST_MOMENTS.max(shortest / 2);
        let lag_of = |shift_s: f64| (shift_s / step_s).round() as i64;
        let lags = lag_of(middle_s - reach_s) - 1..=lag_of(middle_s + reach_s) + 1;
        // Sample i of the reference meets sample i + lag + between of the other.
        let between = a.first - b.first;
        let all: Vec<(i64, f64)> = lags
            .filter(|lag| overlap(&channels, lag + between).1 >= enough)
            // A body that rests throughout the common part shows nothing.
            .map(|lag| {
                (
                    lag,
                    correlation(&sums_at(&channels, lag + between, 1)).unwrap_or(0.0),
                )
            })
            .collect();
        let (lag, correlation, half_width) = nearest_top(&all, lag_of(middle_s))?;
        if correlation < CORRELATED {
            return None;
        }
        let around = -half_width..=half_width;
        let around: Vec<_> = around
            .map(|by| sums_at(&channels, lag + between + by, BLOCKS))
            .collect();
        let top = peak(&around, None)?;
        let left_out: Vec<f64> = (0..BLOCKS)
            .map(|block| peak(&around, Some(block)))
            .collect::<Option<_>>()?;
        Some(Found {
            offset_s: (lag as f64 + top) * step_s,
            deviation_s: jackknife_variance(&left_out).sqrt() * step_s,
            correlation,
            step_s,
        })
    }

    /// A top of a search with steps of `first_step_s`, looked at with finer and finer ones.
    fn closer(self, top: Found, first_step_s: f64, finest_s: f64) -> Found {
        let (mut found, mut step_s) = (top, first_step_s);
        while step_s > finest_s {
            let near_s = 2.0 * step_s + 4.0 * found.deviation_s;
            step_s = (step_s / FINER).max(finest_s);
            let tops = windows(step_s).filter_map(|step_s| {
                self.at_step(step_s, found.offset_s, near_s.max(2.0 * step_s))
            });
            let surest = tops.min_by(|a, b| a.deviation_s.total_cmp(&b.deviation_s));
            found = surest.unwrap_or(found);
        }
        found
    }
}

/// The first moment of the reference that has a partner at this lag, and the number of such moments.
fn overlap(channels: &Channels<'_>, lag: i64) -> (usize, usize) {
    let (a, b) = channels[0];
    let from = (-lag).max(0);
    let to = (a.len() as i64).min(b.len() as i64 - lag);
    let count = usize::try_from(to - from).unwrap_or(0);
    (usize::try_from(from).unwrap_or(0), count)
}

/// Sums from which a correlation is computed.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    n: f64,
    a: f64,
    b: f64,
    aa: f64,
    bb: f64,
    ab: f64,
}

impl Sums {
    fn of(a: &[f64], b: &[f64]) -> Self {
        let mut sums = Self {
            n: a.len() as f64,
            ..Self::default()
        };
        for (a, b) in a.iter().zip(b) {
            sums.a += a;
            sums.b += b;
            sums.aa += a * a;
            sums.bb += b * b;
            sums.ab += a * b;
        }
        sums
    }

    fn plus(self, other: Self, sign: f64) -> Self {
        Self {
            n: self.n + sign * other.n,
            a: self.a + sign * other.a,
            b: self.b + sign * other.b,
            aa: self.aa + sign * other.aa,
            bb: self.bb + sign * other.bb,
            ab: self.ab + sign * other.ab,
        }
    }

    /// The correlation; `None` where one of the two is constant.
    fn correlation(self) -> Option<f64> {
        let covariance = self.ab - self.a * self.b / self.n;
        let (of_a, of_b) = (
            self.aa - self.a * self.a / self.n,
            self.bb - self.b * self.b / self.n,
        );
        // Below this share of its square a variance is rounding.
        let varies = of_a > 1e-9 * self.aa && of_b > 1e-9 * self.bb;
        varies.then(|| (covariance / (of_a * of_b).sqrt()).clamp(-1.0, 1.0))
    }
}

/// The sums of every channel at a lag, in this number of blocks of equal length.
fn sums_at(channels: &Channels<'_>, lag: i64, blocks: usize) -> Vec<Vec<Sums>> {
    let (first, count) = overlap(channels, lag);
    let partner = usize::try_from(first as i64 + lag).unwrap_or(0);
    let of_channel = |(a, b): &(&[f64], &[f64])| {
        let (a, b) = (&a[first..first + count], &b[partner..partner + count]);
        let end = |block: usize| block * count / blocks;
        let parts = (0..blocks).map(|block| end(block)..end(block + 1));
        parts
            .map(|part| Sums::of(&a[part.clone()], &b[part]))
            .collect()
    };
    channels.iter().map(of_channel).collect()
}

/// The mean correlation over the channels that vary; `None` where none does.
fn correlation(sums: &[Vec<Sums>]) -> Option<f64> {
    correlation_without(sums, None)
}

fn correlation_without(sums: &[Vec<Sums>], left_out: Option<usize>) -> Option<f64> {
    let of_channel = |blocks: &Vec<Sums>| {
        let all = blocks
            .iter()
            .fold(Sums::default(), |sum, block| sum.plus(*block, 1.0));
        let rest = left_out.map_or(all, |block| all.plus(blocks[block], -1.0));
        rest.correlation()
    };
    let varying: Vec<f64> = sums.iter().filter_map(of_channel).collect();
    let count = varying.len() as f64;
    (count > 0.0).then(|| varying.iter().sum::<f64>() / count)
}

/// The top nearest to the lag `middle` among tops that are about as high as the highest: its lag, its correlation, and how many lags to
/// either side belong to it. Tops are different ones if the correlation falls between them.
fn nearest_top(all: &[(i64, f64)], middle: i64) -> Option<(i64, f64, i64)> {
    let highest = |mut range: std::ops::Range<usize>| {
        let first = range.next()?;
        Some(range.fold(first, |top, index| {
            if all[index].1 > all[top].1 {
                index
            } else {
                top
            }
        }))
    };
    // The part around an index in which the correlation stays above a level.
    let above = |index: usize, level: f64| {
        let low = |index: &usize| all[*index].1 < level;
        let from = (0..index).rev().find(low).map_or(0, |index| index + 1);
        let to = (index..all.len()).find(low).unwrap_or(all.len());
        from..to
    };
    let best = highest(0..all.len())?;
    let (mut top, mut lowest) = (best, f64::INFINITY);
    // From the best towards the middle: after every valley there may be another top.
    let towards: Vec<usize> = match all[best].0 > middle {
        true => (0..best).rev().collect(),
        false => (best + 1..all.len()).collect(),
    };
    let nearer =
        |index: usize, than: usize| (all[index].0 - middle).abs() < (all[than].0 - middle).abs();
    for index in towards {
        let here = all[index].1;
        lowest = lowest.min(here);
        if lowest < here - VALLEY && here >= all[best].1 - EQUALLY_GOOD && nearer(index, top) {
            top = highest(above(index, here - VALLEY))?;
        }
    }
    let correlation = all[top].1;
    let drop = (NOISE_IN_DROP * (1.0 - correlation)).clamp(LEAST_DROP, VALLEY);
    let belongs = above(top, correlation - drop);
    // A symmetric part that lies in the search; a top at its end is none.
    let width = (top - belongs.start).min(belongs.end - 1 - top).max(1);
    let inside = top >= width && top + width < all.len();
    inside.then_some((all[top].0, correlation, width as i64))
}

/// The place of the top of the parabola that fits correlations at neighbouring lags best, in steps from the middle one.
fn peak(around: &[Vec<Vec<Sums>>], left_out: Option<usize>) -> Option<f64> {
    let half = (around.len() / 2) as f64;
    let (mut sums, mut n) = ([0.0; 5], 0.0);
    for (index, sums_here) in around.iter().enumerate() {
        let (k, r) = (
            index as f64 - half,
            correlation_without(sums_here, left_out)?,
        );
        let terms = [k * k, k * k * k * k, r, k * r, k * k * r];
        sums.iter_mut()
            .zip(terms)
            .for_each(|(sum, term)| *sum += term);
        n += 1.0;
    }
    let [k2, k4, r, kr, k2r] = sums;
    let (slope, bend) = (kr / k2, (n * k2r - k2 * r) / (n * k4 - k2 * k2));
    (bend < 0.0).then(|| (-0.5 * slope / bend).clamp(-half, half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    /// Numbers of mean 0 and variance 1: sums of twelve numbers of a linear congruential generator.
    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut uniform = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    /// A wandering body, sampled at `rate_hz` from `from_s` to `to_s`, with noise in its positions.
    fn wandering(rate_hz: f64, [from_s, to_s]: [f64; 2], noise_m: f64, seed: u64) -> Trajectory {
        let mut noise = noise(seed);
        let count = ((to_s - from_s) * rate_hz) as usize;
        let times_s: Vec<f64> = (0..count).map(|i| from_s + i as f64 / rate_hz).collect();
        let at = |time_s: f64| {
            let t = time_s.rem_euclid(1000.0);
            let along = 0.3 * t + 0.1 * (1.3 * t).sin() + 0.05 * (0.37 * t * t / 10.0).sin();
            Vector3::new(along, 0.2 * (0.8 * t).sin(), 0.02 * (2.1 * t).cos())
        };
        let positions: Vec<Vector3<f64>> = times_s
            .iter()
            .map(|t| at(*t) + noise_m * Vector3::from_fn(|_, _| noise()))
            .collect();
        Trajectory::new(times_s, positions).unwrap()
    }

    fn moved(path: &Trajectory) -> Trajectory {
        let turn = UnitQuaternion::from_euler_angles(0.4, -1.2, 2.0);
        let all = path.positions_world_m().iter();
        path.clone()
            .with_positions(
                all.map(|p| turn * p + Vector3::new(5.0, 1.0, -2.0))
                    .collect(),
            )
            .unwrap()
    }

    #[test]
    fn an_offset_is_found_with_its_sign_in_other_frames_and_at_other_rates() {
        let reference = wandering(50.0, [1000.0, 1040.0], 0.0, 1);
        for (offset_s, rate_hz, noise_m) in [
            (0.5, 50.0, 0.0),
            (-1.7, 30.0, 0.0),
            (0.0, 20.0, 0.0),
            (0.137, 30.0, 0.002),
            (-0.021, 100.0, 0.005),
            (4.0, 10.0, 0.002),
        ] {
            let other = moved(&wandering(rate_hz, [1003.0, 1036.0], noise_m, 2));
            let found = clock_offset(&reference, &other.later(offset_s).unwrap(), 0.0).unwrap();
            let error_s = (found.offset_s - offset_s).abs();
            assert!(
                error_s < 4.0 * found.deviation_s && found.deviation_s < 0.05,
                "{offset_s} {rate_hz} {noise_m}: {found:?}"
            );
        }
    }

    #[test]
    fn the_stated_uncertainty_is_that_of_repeats() {
        let mut within = 0;
        let runs = 40;
        for seed in 0..runs {
            let reference = wandering(50.0, [0.0, 30.0], 0.004, 2 * seed);
            let other = wandering(40.0, [0.0, 30.0], 0.004, 2 * seed + 1)
                .later(0.25)
                .unwrap();
            let found = clock_offset(&reference, &other, 0.0).unwrap();
            within += u64::from((found.offset_s - 0.25).abs() < 2.0 * found.deviation_s);
        }
        // Two standard deviations hold 95 %; 32 of 40 or fewer would be seen by chance in one of a thousand trials.
        assert!(within > 32, "{within} of {runs}");
    }

    #[test]
    fn a_clock_of_another_epoch_is_found_about_a_given_offset() {
        let reference = wandering(50.0, [1.7e9, 1.7e9 + 30.0], 0.0, 1);
        let epoch_s = reference.times_s()[0];
        let other = reference.later(12.4 - epoch_s).unwrap();
        let found = clock_offset(&reference, &other, 12.4 - epoch_s + 0.3).unwrap();
        assert!(
            (found.offset_s - (12.4 - epoch_s)).abs() < 0.002,
            "{found:?}"
        );
    }

    #[test]
    fn steady_motion_and_rest_show_no_offset() {
        let times_s: Vec<f64> = (0..500).map(|i| 0.02 * f64::from(i)).collect();
        for speed_m_s in [0.0, 0.4] {
            let steady = times_s
                .iter()
                .map(|t| Vector3::new(speed_m_s * t, 0.0, 0.0));
            let steady = Trajectory::new(times_s.clone(), steady.collect()).unwrap();
            assert_eq!(clock_offset(&steady, &steady, 0.0), None);
        }
        // Years between samples, and two samples only.
        let jump = Trajectory::new(
            vec![0.0, 1.0, 1.7e9],
            vec![Vector3::zeros(), Vector3::x(), Vector3::y()],
        )
        .unwrap();
        assert_eq!(clock_offset(&jump, &jump, 0.0), None);
    }

    #[test]
    fn a_motion_that_repeats_itself_is_not_shifted_by_a_period() {
        let times_s: Vec<f64> = (0..60_000).map(|i| 0.01 * f64::from(i)).collect();
        let at = |t: &f64| {
            let along = 0.3 * t + 0.1 * (1.3 * t + 3.0 * (0.1 * t).sin()).sin();
            Vector3::new(along, 0.2 * (0.8 * t).sin() * (0.003 * t).cos(), 0.0)
        };
        let path = Trajectory::new(times_s.clone(), times_s.iter().map(at).collect()).unwrap();
        for offset_s in [0.0, 0.3, -7.0] {
            let found = clock_offset(&path, &path.later(offset_s).unwrap(), 0.0).unwrap();
            assert!(
                (found.offset_s - offset_s).abs() < 0.002,
                "{offset_s}: {found:?}"
            );
        }
    }
}
