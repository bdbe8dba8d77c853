//! Positions or angles over the samples of a recording, and how far they usually go from one sample to the next.

use std::ops::Range;

use nalgebra::Vector3;

use crate::trajectory::{COMMAND, JointTrack, Trajectory};

/// Values over the samples of a recording that have distances from each other.
pub(super) trait Series {
    /// The number of samples.
    fn count(&self) -> usize;
    /// The distance between the values of two samples.
    fn distance(&self, a: usize, b: usize) -> f64;
    /// How far a sample is from a straight line through its neighbours, times two.
    fn bend(&self, sample: usize) -> f64;
    /// True if the value of a sample is exactly 0.
    fn is_zero(&self, sample: usize) -> bool;
}

impl Series for [Vector3<f64>] {
    fn count(&self) -> usize {
        self.len()
    }
    fn distance(&self, a: usize, b: usize) -> f64 {
        (self[a] - self[b]).norm()
    }
    fn bend(&self, sample: usize) -> f64 {
        (self[sample - 1] - 2.0 * self[sample] + self[sample + 1]).norm()
    }
    fn is_zero(&self, sample: usize) -> bool {
        self[sample] == Vector3::zeros()
    }
}

impl Series for [f64] {
    fn count(&self) -> usize {
        self.len()
    }
    fn distance(&self, a: usize, b: usize) -> f64 {
        (self[a] - self[b]).abs()
    }
    fn bend(&self, sample: usize) -> f64 {
        (self[sample - 1] - 2.0 * self[sample] + self[sample + 1]).abs()
    }
    fn is_zero(&self, sample: usize) -> bool {
        self[sample] == 0.0
    }
}

/// The number of steps on each side of a place that say how large steps are there.
const AROUND: usize = 12;
/// The largest steps around a place that do not count, because another fault may be near: both steps of a spike.
const IGNORED: usize = 2;
/// The share of steps that are smaller than a fast one.
const FAST: f64 = 0.9;

/// The distances between consecutive samples of a series.
pub(super) struct Steps {
    /// `lengths[k]` leads from sample `k` to sample `k + 1`.
    pub lengths: Vec<f64>,
    /// A large step among those that go anywhere, where the largest few do not count; 0 if there are no others.
    pub fast: f64,
}

impl Steps {
    pub fn of(series: &(impl Series + ?Sized)) -> Self {
        let lengths: Vec<f64> = (1..series.count())
            .map(|k| series.distance(k - 1, k))
            .collect();
        let moving = lengths.iter().copied().filter(|length| *length > 0.0);
        let moving: Vec<f64> = moving.collect();
        let others = moving.len().saturating_sub(2 * IGNORED) as f64;
        let share = FAST.min(others / moving.len().max(1) as f64);
        let fast = if others > 0.0 {
            quantile(moving, share)
        } else {
            None
        };
        let fast = fast.unwrap_or(0.0);
        Self { lengths, fast }
    }

    /// A large step shortly before and after the samples of `apart`, steps at these samples left out.
    pub fn around(&self, apart: &Range<usize>) -> f64 {
        let before_end = apart.start.saturating_sub(1);
        let before = &self.lengths[before_end.saturating_sub(AROUND)..before_end];
        let after_start = apart.end.min(self.lengths.len());
        let after = &self.lengths[after_start..(after_start + AROUND).min(self.lengths.len())];
        large(before.iter().chain(after).copied().collect())
    }
}

/// A large bend of the path shortly before and after the samples of `apart`, bends at these samples left out.
pub(super) fn bend_around(series: &(impl Series + ?Sized), apart: &Range<usize>) -> f64 {
    let before_end = apart.start.saturating_sub(1).max(1);
    let before = before_end.saturating_sub(AROUND).max(1)..before_end;
    let last = series.count() - 1;
    let after = (apart.end + 1).min(last)..(apart.end + 1 + AROUND).min(last);
    large(
        before
            .chain(after)
            .map(|sample| series.bend(sample))
            .collect(),
    )
}

/// The largest value but for a few.
fn large(mut all: Vec<f64>) -> f64 {
    all.sort_by(|a, b| b.total_cmp(a));
    // Of few values, none is left out.
    let ignored = if all.len() > 3 * IGNORED { IGNORED } else { 0 };
    all.get(ignored).copied().unwrap_or(f64::INFINITY)
}

/// The value below which this share of the values lies; `None` without values.
pub(super) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    let index = (share * values.len() as f64) as usize;
    let index = index.min(values.len().checked_sub(1)?);
    Some(*values.select_nth_unstable_by(index, f64::total_cmp).1)
}

/// Runs of samples for which `holds`.
pub(super) fn runs(count: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for sample in (0..count).filter(|sample| holds(*sample)) {
        match all.last_mut() {
            Some(last) if last.end == sample => last.end += 1,
            _ => all.push(sample..sample + 1),
        }
    }
    all
}

/// The joints whose angles were measured, commands left out.
pub(super) fn measured(trajectory: &Trajectory) -> impl Iterator<Item = &JointTrack> {
    let joints = trajectory.joints().iter();
    joints.filter(|joint| !joint.name.ends_with(COMMAND))
}
