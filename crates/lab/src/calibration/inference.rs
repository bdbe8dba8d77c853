//! Which parameter values the recordings leave possible: history matching of the score, with a discrepancy.
//!
//! A point is *implausible* as far as some other point scores better than everything that is unknown about the two explains,
//! I(θ) = max over θ′ of (S(θ) − S(θ′)) / sd(S(θ) − S(θ′)), with variances of emulator, numerics, recordings and model discrepancy
//! (Craig et al. 1997; Kennedy & O'Hagan 2001; Vernon, Goldstein & Bower 2010). Near the bottom of a valley I is Rao's score
//! statistic with the sandwich variance (Rao 1948; Huber 1967), so that quantiles of the density exp(−I²/2) over the parameters are
//! confidence limits, and what a parameter that does nothing leaves is its whole range: no score speaks against any value.

use rand::RngExt;

use super::emulator::{Emulator, Field};
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{
    chi_squared_quantile, mean, percentile_interval, standard_deviation,
};
use realgap_optimize::{Grid, space_filling};

/// Confidence level of the interval of each parameter.
pub const INTERVAL_LEVEL: f64 = 0.90;
/// Confidence level of the set of points that are not implausible.
pub const LEVEL: f64 = 0.95;
/// Recordings that the pooled variance of all recordings is worth beside what each pair of points shows itself.
const POOLED: f64 = 4.0;
/// Variance of a single recording in those of a run: a kernel that is smooth everywhere understates what a deviation moves at the
/// bottom of a valley, and with 4 the intervals of the worlds of the test below hold what they promise.
const ALONE: f64 = 4.0;
/// Points that are more implausible than the set's by this have no part in anything.
const BEYOND: f64 = 1.0;
/// How often places are spread anew over what is not implausible, and by how much more than it.
const NARROWINGS: usize = 3;
const MARGIN: f64 = 0.25;
/// Realities drawn.
const DRAWS: usize = 1000;
/// Bins along a parameter part two intervals where they hold so many places at least, and all of these have no part in anything.
const BINS: usize = 16;
const PLACES_A_BIN: usize = 10;

/// What keeps scores apart beside the emulator and numerics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubt {
    /// Recordings that are fitted.
    pub recordings: usize,
    /// Variance of the model's discrepancy, in those of a recording; 0 where the model fits.
    pub discrepancy: f64,
}

/// What may be, at places spread evenly over it.
#[derive(Debug)]
pub(super) struct Inference {
    /// Coordinates, 0 to 1.
    pub places: Vec<Vec<f64>>,
    /// How implausible each is.
    pub implausibility: Vec<f64>,
    /// The same of the points that were asked for.
    pub visited: Vec<f64>,
    /// Share of the emulator in the variance between the likeliest place and others that are not implausible.
    pub emulator_share: f64,
    /// Implausibility up to which a point is one of the set.
    pub limit: f64,
}

impl Inference {
    /// At `count` places, and at `visited`, which are coordinates of points that were simulated.
    pub fn new(
        emulator: &Emulator,
        grid: &Grid,
        visited: &[Vec<f64>],
        doubt: Doubt,
        count: usize,
        seed: u64,
    ) -> Self {
        let dimensions = grid.ranges().len();
        let limit = chi_squared_quantile(LEVEL, dimensions as f64).sqrt();
        let look = |places: Vec<Vec<f64>>| {
            let all: Vec<Vec<f64>> = places.iter().chain(visited).cloned().collect();
            let field = emulator.field(&all);
            let implausibility = implausibility(&field, doubt);
            (places.len(), all, field, implausibility)
        };
        let sieve = Sieve {
            emulator,
            grid,
            seed,
        };
        // Anywhere, and in the lowest valleys however narrow; then in what of it may be.
        let mut ends = vec![(0.0, 1.0); dimensions];
        let mut places = sieve.spread(&ends, f64::INFINITY, count / 4);
        places.extend(sieve.lowest(count / 4));
        for _ in 0..NARROWINGS {
            let (_, all, field, implausibility) = look(places);
            let near = (0..all.len()).filter(|place| implausibility[*place] <= limit + BEYOND);
            let near: Vec<usize> = near.collect();
            let expected = || near.iter().map(|place| field.means[*place]);
            let lowest = expected().fold(f64::INFINITY, f64::min);
            let highest = expected().fold(f64::NEG_INFINITY, f64::max);
            let level = highest + MARGIN * (highest - lowest);
            let near: Vec<&Vec<f64>> = near.iter().map(|place| &all[*place]).collect();
            ends = around(&near, &ends, count);
            places = sieve.spread(&ends, level, count);
        }
        let (count, mut places, field, mut implausibility) = look(places);
        let emulator_share = emulator_share(&field, doubt, &implausibility, limit);
        let visited = implausibility.split_off(count);
        places.truncate(count);
        Self {
            places,
            implausibility,
            visited,
            emulator_share,
            limit,
        }
    }

    /// The likelihood of each place.
    fn weights(&self) -> Vec<f64> {
        let squares = self.implausibility.iter().map(|i| i * i);
        squares.map(|square| libm::exp(-0.5 * square)).collect()
    }

    /// Places for the next runs: one half as probable as they are likely, the others anywhere that is not implausible.
    pub fn wave(&self, count: usize, rng: &mut Generator) -> Vec<&[f64]> {
        let mut likely = self.weights();
        let mut possible: Vec<f64> = (self.implausibility.iter())
            .map(|i| f64::from(u8::from(*i <= self.limit + BEYOND)))
            .collect();
        let mut chosen = Vec::new();
        for _ in 0..count.min(self.places.len()) {
            // At random: settings come in turn, and must not come with one kind of place.
            let weights = match rng.random() {
                true => &likely,
                false => &possible,
            };
            let Some(place) = pick(weights, rng.random()) else {
                break;
            };
            (likely[place], possible[place]) = (0.0, 0.0);
            chosen.push(self.places[place].as_slice());
        }
        chosen
    }

    /// Values of as many realities as are drawn, as often as they are likely.
    pub fn draws(&self, grid: &Grid, seed: u64) -> BestDraws {
        let weights = self.weights();
        let total: f64 = weights.iter().sum();
        let mut rng = Once::BestPoint.generator(seed);
        // Systematic: one random number, then equal steps through the weights.
        let first: f64 = rng.random();
        let (mut draws, mut sum) = (Vec::with_capacity(DRAWS), 0.0);
        for (place, weight) in self.places.iter().zip(&weights) {
            sum += weight / total * DRAWS as f64;
            while (draws.len() as f64 + first) < sum {
                draws.push(grid.values_at(place));
            }
        }
        if draws.is_empty() {
            draws.push(grid.values_at(&self.places[0]));
        }
        let gaps = (0..grid.ranges().len()).map(|axis| self.gaps(axis, grid));
        BestDraws {
            gaps: gaps.collect(),
            draws,
        }
    }

    /// Values in the middle of what is implausible along a parameter, between what is not.
    fn gaps(&self, axis: usize, grid: &Grid) -> Vec<f64> {
        let along = || self.places.iter().map(|place| place[axis]);
        let low = along().fold(f64::INFINITY, f64::min);
        let high = along().fold(f64::NEG_INFINITY, f64::max);
        let (mut counts, mut open) = ([0; BINS], [false; BINS]);
        for (at, implausibility) in along().zip(&self.implausibility) {
            let share = (at - low) / (high - low).max(f64::MIN_POSITIVE);
            let bin = ((share * BINS as f64) as usize).min(BINS - 1);
            counts[bin] += 1;
            open[bin] |= *implausibility <= self.limit + BEYOND;
        }
        let (mut gaps, mut last_open) = (Vec::new(), None);
        for bin in (0..BINS).filter(|bin| open[*bin]) {
            let closed = last_open.map_or(bin..bin, |last: usize| last + 1..bin);
            last_open = Some(bin);
            if !closed.is_empty() && closed.clone().all(|bin| counts[bin] >= PLACES_A_BIN) {
                let middle = 0.5 * (closed.start + closed.end) as f64 / BINS as f64;
                gaps.push(grid.ranges()[axis].at(low + middle * (high - low)));
            }
        }
        gaps
    }
}

/// Finds places by what the emulator expects there.
struct Sieve<'a> {
    emulator: &'a Emulator,
    grid: &'a Grid,
    seed: u64,
}

/// So many times as many places are looked at for those that may be.
const SIEVED: usize = 20;

impl Sieve<'_> {
    /// Places where parameters have values, spread evenly between the ends of each axis, a multiple of what is wanted.
    fn places(&self, ends: &[(f64, f64)], count: usize) -> Vec<Vec<f64>> {
        let seed = self.seed.wrapping_add(1);
        let even = space_filling(ends.len(), 0, SIEVED * count, seed);
        let place = |shares: &Vec<f64>| {
            let axes = shares.iter().zip(ends);
            let place: Vec<f64> = axes.map(|(share, (a, b))| a + share * (b - a)).collect();
            self.grid.place_of(&self.grid.values_at(&place))
        };
        even.iter().map(place).collect()
    }

    /// At most `count` of those where the emulator expects no more than a level.
    fn spread(&self, ends: &[(f64, f64)], level: f64, count: usize) -> Vec<Vec<f64>> {
        let low =
            |place: &Vec<f64>| level.is_infinite() || self.emulator.standardised(place) <= level;
        let kept: Vec<Vec<f64>> = self
            .places(ends, count)
            .into_iter()
            .filter(low)
            .take(count)
            .collect();
        match kept.is_empty() {
            true => vec![ends.iter().map(|(a, b)| 0.5 * (a + b)).collect()],
            false => kept,
        }
    }

    /// The `count` where it expects the least.
    fn lowest(&self, count: usize) -> Vec<Vec<f64>> {
        let ends = vec![(0.0, 1.0); self.grid.ranges().len()];
        let places = self.places(&ends, count).into_iter();
        let mut all: Vec<(f64, Vec<f64>)> = places
            .map(|place| (self.emulator.standardised(&place), place))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(count);
        all.into_iter().map(|(_, place)| place).collect()
    }
}

/// The ends of what holds these places, with as much around it as `count` places are apart.
fn around(kept: &[&Vec<f64>], ends: &[(f64, f64)], count: usize) -> Vec<(f64, f64)> {
    let apart = libm::pow(count as f64, -1.0 / ends.len() as f64);
    let axes = ends.iter().enumerate();
    axes.map(|(axis, (from, to))| {
        let all = || kept.iter().map(|place| place[axis]);
        let margin = apart * (to - from);
        let low = all().fold(f64::INFINITY, f64::min) - margin;
        let high = all().fold(f64::NEG_INFINITY, f64::max) + margin;
        (low.max(0.0), high.min(1.0))
    })
    .collect()
}

/// The first whose cumulated share exceeds `share` of all; `None` where all are 0.
fn pick(weights: &[f64], share: f64) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let mut left = share * total;
    weights.iter().position(|weight| {
        left -= weight;
        *weight > 0.0 && left <= 0.0
    })
}

/// Variances between places: of everything, and of the recordings with the discrepancy alone.
struct Variance {
    all: nalgebra::DMatrix<f64>,
    recordings: nalgebra::DMatrix<f64>,
    /// Degrees of freedom of the second.
    freedom: f64,
}

impl Variance {
    /// The covariance of recordings is what they show at each pair of places, drawn towards one that is alike everywhere, as far
    /// as few recordings cannot tell (as a prior of [`POOLED`] recordings would; Ledoit & Wolf 2004). A single recording shows
    /// none: it is taken to vary [`ALONE`] times as a single run does.
    fn new(field: &Field, doubt: Doubt) -> Self {
        let n = field.means.len() as f64;
        let recordings = field.parts.ncols();
        let pairs = |matrix: &nalgebra::DMatrix<f64>| n * matrix.trace() - matrix.sum();
        let more = recordings.saturating_sub(1) as f64;
        let own = &field.parts * field.parts.transpose();
        let pooled = if more > 0.0 {
            pairs(&own) / more / pairs(&field.alike).max(1e-9)
        } else {
            ALONE * (field.noise + field.setting)
        };
        let freedom = POOLED + more;
        let one = (&field.alike * (POOLED * pooled) + own) / freedom;
        // Distances do not tell whether a recording or a simulation deviates, so that reality's own setting, which nobody knows,
        // moves the score as one recording more would, only as much as settings part runs where recordings part them.
        let setting = match recordings > 1 {
            true => field.setting / field.recording.max(1e-12),
            false => 0.0,
        };
        let one_over = 1.0 / doubt.recordings.max(1) as f64;
        let recordings = one * (one_over + setting + doubt.discrepancy);
        Self {
            all: &field.emulator + &field.numerics + &recordings,
            recordings,
            freedom,
        }
    }

    fn between(matrix: &nalgebra::DMatrix<f64>, a: usize, b: usize) -> f64 {
        matrix[(a, a)] + matrix[(b, b)] - 2.0 * matrix[(a, b)]
    }
}

/// Rounding: smaller variances between two places are none.
const ROUNDING: f64 = 1e-8;

fn implausibility(field: &Field, doubt: Doubt) -> Vec<f64> {
    let variance = Variance::new(field, doubt);
    let n = field.means.len();
    let worse_by = |place: usize, other: usize| {
        let difference = field.means[place] - field.means[other];
        if difference <= 0.0 {
            return 0.0;
        }
        let all = Variance::between(&variance.all, place, other).max(ROUNDING);
        let recordings = Variance::between(&variance.recordings, place, other);
        // What is known of the sum when one part of it is estimated (Welch 1947; Satterthwaite 1946).
        let share = (recordings / all).clamp(1e-3, 1.0);
        as_normal(difference / all.sqrt(), variance.freedom / (share * share))
    };
    (0..n)
        .map(|place| (0..n).fold(0.0, |most: f64, other| most.max(worse_by(place, other))))
        .collect()
}

/// The normal number as improbable as `t` of Student's distribution (Wallace 1959, section 3).
fn as_normal(t: f64, freedom: f64) -> f64 {
    let correction = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    correction * (freedom * libm::log1p(t * t / freedom)).sqrt()
}

fn emulator_share(field: &Field, doubt: Doubt, implausibility: &[f64], limit: f64) -> f64 {
    let variance = Variance::new(field, doubt);
    let best = field.means.imin();
    let inside = (0..implausibility.len()).filter(|i| *i != best && implausibility[*i] <= limit);
    let shares = inside.map(|place| {
        let all = Variance::between(&variance.all, place, best).max(ROUNDING);
        Variance::between(&field.emulator, place, best) / all
    });
    let shares: Vec<f64> = shares.collect();
    if shares.is_empty() {
        0.0
    } else {
        mean(&shares)
    }
}

/// Parameter values as likely as the recordings and runs make them.
#[derive(Debug, Clone, PartialEq)]
pub struct BestDraws {
    /// One row a draw, one value a parameter.
    draws: Vec<Vec<f64>>,
    /// By parameter, values in the middle of what is rejected between what is not.
    gaps: Vec<Vec<f64>>,
}

impl BestDraws {
    /// The draws, one row each, one value a parameter.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.draws
    }

    /// Central interval of one parameter at `level`, e.g. 0.9, whatever is rejected within.
    pub fn interval(&self, parameter: usize, level: f64) -> (f64, f64) {
        // There is at least one draw.
        let values = self.values(parameter);
        percentile_interval(&values, 0.5 * (1.0 - level)).unwrap_or((f64::NAN, f64::NAN))
    }

    /// The same in as many intervals as rejected parts leave, increasing; none bridges a part that is rejected.
    pub fn intervals(&self, parameter: usize, level: f64) -> Vec<(f64, f64)> {
        let values = self.values(parameter);
        let mut intervals = Vec::new();
        let mut from = f64::NEG_INFINITY;
        for to in self.gaps[parameter].iter().copied().chain([f64::INFINITY]) {
            let within = values.iter().copied().filter(|v| (from..to).contains(v));
            let within: Vec<f64> = within.collect();
            // Less than a tail of the whole is left out of it.
            if within.len() as f64 > 0.5 * (1.0 - level) * values.len() as f64 {
                intervals.extend(percentile_interval(&within, 0.5 * (1.0 - level)));
            }
            from = to;
        }
        intervals
    }

    /// Pearson's correlation of two parameters over the draws; 0 where one of them does not vary.
    pub fn correlation(&self, first: usize, second: usize) -> f64 {
        let (a, b) = (self.values(first), self.values(second));
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        let spread = standard_deviation(&a) * standard_deviation(&b);
        if spread == 0.0 {
            return 0.0;
        }
        let products = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b));
        products.sum::<f64>() / (a.len() - 1) as f64 / spread
    }

    fn values(&self, parameter: usize) -> Vec<f64> {
        self.draws.iter().map(|draw| draw[parameter]).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::print_stdout, reason = "a table is printed")]

    use super::*;
    use crate::calibration::emulator::ScoredRun;
    use crate::calibration::setting::Setting;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_engine::parameter::by_name;
    use realgap_optimize::Range;

    /// Numbers that a path is made of.
    const PATH: usize = 12;
    const SETTINGS: usize = 16;

    /// A robot whose path is known in closed form: the first parameter bends it, the second as much as `second` says.
    struct World {
        second: f64,
        /// Standard deviation of what a setting, a run and a recording have of their own, as shares of the path.
        setting: f64,
        run: f64,
        recording: f64,
    }

    type Path = [f64; PATH];

    fn normal(rng: &mut Generator) -> f64 {
        StandardNormal.sample(rng)
    }

    fn noise(rng: &mut Generator, size: f64) -> Path {
        std::array::from_fn(|k| size * normal(rng) / (k + 1) as f64)
    }

    impl World {
        fn path(&self, at: &[f64]) -> Path {
            std::array::from_fn(|k| {
                let bend = libm::sin(3.0 * at[0] * (1.0 + 0.2 * k as f64) + 0.3 * k as f64);
                let other = libm::cos(2.0 * at[1] + k as f64);
                (bend + self.second * other) / (1.0 + 0.3 * k as f64)
            })
        }

        /// A deviation that a setting has, which changes smoothly with the parameters.
        fn setting(&self, number: u64, at: &[f64]) -> Path {
            let mut rng = Generator::seed_from_u64(number);
            let (a, b) = (noise(&mut rng, self.setting), noise(&mut rng, self.setting));
            std::array::from_fn(|k| a[k] + b[k] * libm::sin(2.0 * at[0]))
        }

        fn run(&self, at: &[f64], setting: u64, rng: &mut Generator, size: f64) -> Path {
            let (path, own, rest) = (self.path(at), self.setting(setting, at), noise(rng, size));
            std::array::from_fn(|k| path[k] + own[k] + rest[k])
        }
    }

    fn grid(points: usize) -> Grid {
        let range = |name: &str| Range::new(by_name(name).unwrap(), 0.0, 1.0, points).unwrap();
        Grid::new(vec![range("floor.friction"), range("floor.restitution")]).unwrap()
    }

    struct Found {
        intervals: [bool; 2],
        set: [bool; 2],
        open: [bool; 2],
        widths: [f64; 2],
    }

    /// A sweep of a world whose truth is hidden, with waves.
    fn study(world: &World, points: usize, recordings: usize, seed: u64) -> Found {
        let grid = grid(points);
        let mut rng = Generator::seed_from_u64(1_000 + seed);
        let truth = [
            0.1 + 0.8 * rng.random::<f64>(),
            0.1 + 0.8 * rng.random::<f64>(),
        ];
        let hidden = 1_000_000 + seed;
        let real: Vec<Path> = (0..recordings)
            .map(|_| world.run(&truth, hidden, &mut rng, world.recording))
            .collect();
        let mut runs: Vec<ScoredRun> = Vec::new();
        let simulate = |runs: &mut Vec<ScoredRun>, at: Vec<f64>, rng: &mut Generator| {
            let setting = runs.len() % SETTINGS;
            // A single recording's noise is that of the runs, which are simulated with as much.
            let own = if recordings == 1 {
                world.recording
            } else {
                world.run
            };
            let path = world.run(&at, setting as u64 + 77, rng, own);
            let distance = |real: &Path| {
                let squares = real.iter().zip(&path).map(|(a, b)| (a - b).powi(2));
                squares.sum::<f64>().sqrt()
            };
            runs.push(ScoredRun {
                at,
                setting: Setting::new(setting),
                recordings: real.iter().map(distance).collect(),
            });
        };
        for index in 0..grid.len() {
            simulate(&mut runs, grid.place_of(&grid.values(index)), &mut rng);
        }
        let doubt = Doubt {
            recordings,
            discrepancy: 0.0,
        };
        let mut known = None;
        for wave in 0..=3 {
            let emulator = Emulator::new(&runs).unwrap().unwrap();
            let inference =
                Inference::new(&emulator, &grid, &[], doubt, 200 + 100 * (wave / 3), seed);
            if wave < 3 {
                let chosen = inference.wave(16, &mut rng);
                let chosen: Vec<Vec<f64>> = chosen.iter().map(|place| place.to_vec()).collect();
                for at in chosen {
                    simulate(&mut runs, at, &mut rng);
                }
            } else {
                known = Some(inference);
            }
        }
        let known = known.unwrap();
        let draws = known.draws(&grid, seed);
        let set: Vec<&Vec<f64>> = known
            .places
            .iter()
            .zip(&known.implausibility)
            .filter(|(_, i)| **i <= known.limit)
            .map(|(p, _)| p)
            .collect();
        let ends = [0, 1].map(|axis| {
            let all = || set.iter().map(|place| place[axis]);
            (all().fold(1.0, f64::min), all().fold(0.0, f64::max))
        });
        let parts = [0, 1].map(|axis| draws.intervals(axis, INTERVAL_LEVEL));
        let axes = [0, 1];
        Found {
            intervals: axes.map(|a| parts[a].iter().any(|(l, h)| (*l..=*h).contains(&truth[a]))),
            set: axes.map(|a| (ends[a].0..=ends[a].1).contains(&truth[a])),
            open: axes.map(|a| ends[a].0 <= 0.05 && ends[a].1 >= 0.95),
            widths: axes.map(|a| parts[a].iter().map(|(l, h)| h - l).sum()),
        }
    }

    fn row(what: &str, world: &World, points: usize, recordings: usize, studies: u64) -> [f64; 4] {
        let all: Vec<Found> = (0..studies)
            .map(|seed| study(world, points, recordings, seed))
            .collect();
        let share = |of: &dyn Fn(&Found) -> bool| {
            100.0 * all.iter().filter(|found| of(found)).count() as f64 / studies as f64
        };
        let width = |axis: usize| {
            let mut widths: Vec<f64> = all.iter().map(|found| found.widths[axis]).collect();
            widths.sort_by(f64::total_cmp);
            widths[widths.len() / 2]
        };
        let [a, b, set, open] = [
            share(&|f| f.intervals[0]),
            share(&|f| f.intervals[1]),
            0.5 * (share(&|f| f.set[0]) + share(&|f| f.set[1])),
            share(&|f| f.open[1]),
        ];
        println!(
            "{what:<10} {points:>2} {recordings:>2} | {a:.0} {b:.0} | set {set:.0} | second open {open:.0} | widths {:.3} {:.3}",
            width(0),
            width(1)
        );
        [a, b, set, open]
    }

    /// 20 studies with a true coverage of 0.90: fewer than 14 hold in 0.2 % of cases.
    #[test]
    fn intervals_hold_and_what_does_nothing_stays_open() {
        let world = World {
            second: 0.0,
            setting: 0.02,
            run: 0.005,
            recording: 0.05,
        };
        let [first, _, set, open] = row("inert", &world, 7, 3, 20);
        assert!(first >= 70.0 && set >= 85.0, "{first} {set}");
        assert!(open >= 75.0, "{open}");
    }

    #[test]
    #[ignore = "minutes: the table"]
    fn the_table_of_worlds() {
        let studies = std::env::var("REALGAP_STUDIES").map_or(100, |n| n.parse().unwrap());
        let quiet = World {
            second: 0.0,
            setting: 0.02,
            run: 0.005,
            recording: 0.05,
        };
        let both = World {
            second: 0.5,
            ..quiet
        };
        let loud = World {
            second: 0.5,
            setting: 0.1,
            run: 0.2,
            recording: 0.2,
        };
        let moved = World {
            setting: 0.15,
            recording: 0.02,
            ..quiet
        };
        for recordings in [1, 3, 5, 10] {
            for points in [7, 10] {
                row("moved", &moved, points, recordings, studies);
                row("inert", &quiet, points, recordings, studies);
                row("both", &both, points, recordings, studies);
                row("loud", &loud, points, recordings, studies);
            }
        }
    }
}
