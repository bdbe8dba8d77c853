//! Samples points that the emulator has not ruled out, also where these are a narrow part of the search space.

use crate::emulator::Emulator;
use realgap_core::statistics::ends_of;
use realgap_optimization::{Grid, space_filling};

/// A gap between two points that are not ruled out is searched, too, where it is shorter than so many of their mean spacings.
const SPACINGS: f64 = 3.0;
/// Points that are drawn per point that is wanted; those that are ruled out are dropped.
const OVERSAMPLING: usize = 20;

/// Parts of an axis of the search space, as increasing intervals of the coordinate.
pub(crate) type Intervals = Vec<(f64, f64)>;

/// Samples points of the search space by the score that the emulator expects there.
pub(crate) struct CandidateSampler<'a> {
    pub emulator: &'a Emulator,
    /// The variants in which scores are looked at.
    pub variants: Vec<f64>,
    pub grid: &'a Grid,
    pub seed: u64,
}

impl CandidateSampler<'_> {
    /// Points at which parameters have allowed values, spread evenly over the given parts of each axis: `OVERSAMPLING` times `count`.
    fn points(&self, axes: &[Intervals], count: usize) -> Vec<Vec<f64>> {
        let seed = self.seed.wrapping_add(1);
        let even = space_filling(axes.len(), 0, OVERSAMPLING * count, seed);
        let point = |shares: &Vec<f64>| {
            let axes = shares.iter().zip(axes);
            let point: Vec<f64> = axes
                .map(|(share, intervals)| within(intervals, *share))
                .collect();
            self.grid.place_of(&self.grid.values_at(&point))
        };
        even.iter().map(point).collect()
    }

    /// At most `count` evenly spread points where the emulator expects a standardised score of at most `level` in some variant; there
    /// is one level a variant.
    pub fn spread(&self, axes: &[Intervals], levels: &[f64], count: usize) -> Vec<Vec<f64>> {
        let low = |point: &Vec<f64>| {
            levels.contains(&f64::INFINITY) || {
                let expected = self.expected(point);
                expected
                    .iter()
                    .zip(levels)
                    .any(|(score, level)| score <= level)
            }
        };
        let mut all = self.points(axes, count);
        let kept: Vec<Vec<f64>> = all
            .iter()
            .filter(|point| low(point))
            .take(count)
            .cloned()
            .collect();
        match kept.is_empty() {
            // No level is reached anywhere: nothing is known, and every point stays.
            true => {
                all.truncate(count);
                all
            }
            false => kept,
        }
    }

    /// The parts of each axis around these points, with a margin on both sides that is as wide as the mean spacing of `count` points in
    /// the given parts of the axes that act, and of these points. An axis that the scores do not depend on is not narrowed.
    pub fn around(&self, kept: &[&Vec<f64>], axes: &[Intervals], count: usize) -> Vec<Intervals> {
        let active = self.emulator.active();
        let acting = active.iter().filter(|active| **active).count().max(1);
        let spacing = libm::pow(count as f64, -1.0 / acting as f64);
        let axes = axes.iter().zip(&active).enumerate();
        axes.map(|(axis, (intervals, active))| {
            let mut all: Vec<f64> = kept.iter().map(|point| point[axis]).collect();
            if !active || all.is_empty() {
                return intervals.clone();
            }
            let (least, most) = ends_of(all.iter().copied());
            let margin = spacing * length(intervals) + SPACINGS * (most - least) / all.len() as f64;
            all.sort_by(f64::total_cmp);
            let mut around: Intervals = Vec::new();
            for at in all {
                let (low, high) = ((at - margin).max(0.0), (at + margin).min(1.0));
                match around.last_mut() {
                    Some((_, last)) if low <= *last => *last = high,
                    _ => around.push((low, high)),
                }
            }
            around
        })
        .collect()
    }

    /// About `count` points at which the emulator expects the lowest scores, as many of each variant.
    pub fn lowest(&self, axes: &[Intervals], count: usize) -> Vec<Vec<f64>> {
        let points = self.points(axes, count);
        let expected: Vec<Vec<f64>> = points.iter().map(|point| self.expected(point)).collect();
        let share = (count / self.variants.len()).min(points.len());
        let mut is_low = vec![false; points.len()];
        for variant in (0..).take(self.variants.len()) {
            let score = |point: &usize| expected[*point][variant];
            let mut ranked: Vec<usize> = (0..points.len()).collect();
            ranked.sort_by(|a, b| score(a).total_cmp(&score(b)));
            for point in &ranked[..share] {
                is_low[*point] = true;
            }
        }
        let points = points.into_iter().zip(is_low);
        points
            .filter(|(_, is_low)| *is_low)
            .map(|(point, _)| point)
            .collect()
    }

    /// Expected standardised score at a point in each variant.
    fn expected(&self, point: &[f64]) -> Vec<f64> {
        self.emulator.standardised_in(point, &self.variants)
    }
}

/// The coordinate at a share of the length of all intervals together.
fn within(intervals: &Intervals, share: f64) -> f64 {
    let mut left = share * length(intervals);
    for (from, to) in intervals {
        if left <= to - from {
            return from + left;
        }
        left -= to - from;
    }
    intervals.last().map_or(share, |(_, to)| *to)
}

fn length(intervals: &Intervals) -> f64 {
    intervals.iter().map(|(from, to)| to - from).sum()
}
