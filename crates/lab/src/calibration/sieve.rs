//! Places that may be, however narrow the valley that holds them.

use realgap_core::statistics::ends_of;
use realgap_inference::Emulator;
use realgap_optimization::{Grid, space_filling};

/// What lies between two possible places is possible up to so many of their mean spacings.
const SPACINGS: f64 = 3.0;
/// Finds places by what the emulator expects there.
pub(super) struct Sieve<'a> {
    pub emulator: &'a Emulator,
    pub grid: &'a Grid,
    pub seed: u64,
}

/// So many times as many places are looked at for those that may be.
const SIEVED: usize = 20;

impl Sieve<'_> {
    /// Places where parameters have values, spread evenly over the parts of each axis, a multiple of what is wanted.
    fn places(&self, parts: &[Parts], count: usize) -> Vec<Vec<f64>> {
        let seed = self.seed.wrapping_add(1);
        let even = space_filling(parts.len(), 0, SIEVED * count, seed);
        let place = |shares: &Vec<f64>| {
            let axes = shares.iter().zip(parts);
            let place: Vec<f64> = axes.map(|(share, parts)| within(parts, *share)).collect();
            self.grid.place_of(&self.grid.values_at(&place))
        };
        even.iter().map(place).collect()
    }

    /// At most `count` of those where the emulator expects no more than a level.
    pub fn spread(&self, parts: &[Parts], level: f64, count: usize) -> Vec<Vec<f64>> {
        let low =
            |place: &Vec<f64>| level.is_infinite() || self.emulator.standardised(place) <= level;
        let kept: Vec<Vec<f64>> = self
            .places(parts, count)
            .into_iter()
            .filter(low)
            .take(count)
            .collect();
        match kept.is_empty() {
            true => vec![parts.iter().map(|parts| within(parts, 0.5)).collect()],
            false => kept,
        }
    }

    /// What of each axis holds these places, with as much around each as `count` places, or these few, are apart.
    pub fn around(&self, kept: &[&Vec<f64>], parts: &[Parts], count: usize) -> Vec<Parts> {
        let apart = libm::pow(count as f64, -1.0 / parts.len() as f64);
        let active = self.emulator.active();
        let axes = parts.iter().zip(&active).enumerate();
        axes.map(|(axis, (parts, active))| {
            let mut all: Vec<f64> = kept.iter().map(|place| place[axis]).collect();
            if !active || all.is_empty() {
                return parts.clone();
            }
            let (least, most) = ends_of(all.iter().copied());
            let margin = apart * length(parts) + SPACINGS * (most - least) / all.len() as f64;
            all.sort_by(f64::total_cmp);
            let mut around: Parts = Vec::new();
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

    /// The `count` where it expects the least.
    pub fn lowest(&self, parts: &[Parts], count: usize) -> Vec<Vec<f64>> {
        let places = self.places(parts, count).into_iter();
        let mut all: Vec<(f64, Vec<f64>)> = places
            .map(|place| (self.emulator.standardised(&place), place))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(count);
        all.into_iter().map(|(_, place)| place).collect()
    }
}

/// Parts of an axis, increasing.
pub(super) type Parts = Vec<(f64, f64)>;

/// The coordinate at a share of all parts together.
fn within(parts: &Parts, share: f64) -> f64 {
    let mut left = share * length(parts);
    for (from, to) in parts {
        if left <= to - from {
            return from + left;
        }
        left -= to - from;
    }
    parts.last().map_or(share, |(_, to)| *to)
}

fn length(parts: &Parts) -> f64 {
    parts.iter().map(|(from, to)| to - from).sum()
}
