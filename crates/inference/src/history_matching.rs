//! Which parameter values the observations do not rule out: history matching of the score, with a model discrepancy.
//!
//! A point is *implausible* by the largest standardised amount by which another point scores better, I(θ) = max over θ′ of
//! (S(θ) − S(θ′)) / sd(S(θ) − S(θ′)). The standard deviation contains the emulator, the settings, the observations and the model's
//! discrepancy (Craig et al. 1997; Kennedy & O'Hagan 2001; Vernon, Goldstein & Bower 2010). Near the bottom of a valley of the score,
//! I is Rao's score statistic with the sandwich variance (Rao 1948; Huber 1967). So the quantiles of the density exp(−I²/2) over the
//! parameters are confidence limits. A parameter without effect keeps its whole range, because no score speaks against any value.
//!
//! Where the black box has two variants, which of them reality is like is a hypothesis with two values. A point in a variant is compared
//! with the points in that variant, and the density of a point is the sum over the variants: a mixture of the variants' posterior
//! distributions (Bayesian model averaging; Hoeting et al. 1999). The weight of a variant is its probability
//! ([`variant_probabilities`](crate::variant_probabilities)). Where the observations speak against one variant, its weight vanishes.
//! Where both explain them, the draws come from both. A mean of both scores would instead prefer points that neither variant prefers.

use rand::RngExt;

use crate::candidate_sampler::CandidateSampler;
use crate::emulator::{Emulator, ScoreField};
use crate::implausibility::{
    ObservationUncertainty, ScoreCovariance, emulator_share, implausibility_beside,
};
use crate::posterior::PosteriorDraws;
use crate::resample::systematic;
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{chi_squared_quantile, ends_of};
use realgap_optimization::{Grid, space_filling};

/// Confidence level of the confidence set: the points that are not implausible.
pub const LEVEL: f64 = 0.95;
/// Points whose implausibility exceeds the limit of the confidence set by more than this are left out of every result.
const BEYOND: f64 = 1.0;
/// How often points are sampled anew around those that are not implausible, and the margin around these: a share of the range of
/// their expected scores.
const NARROWINGS: usize = 6;
const MARGIN: f64 = 0.25;
/// An emulator knows little where its variance is more than this share of that before any run: there the overview is asked, too.
const FORGOTTEN: f64 = 0.1;
/// Rounding error of standardised scores.
const ROUNDING: f64 = 1e-6;
/// Narrowing ends when more than one in so many points is not implausible.
const ENOUGH: usize = 4;
/// Points that are drawn from the posterior density.
const DRAWS: usize = 1000;
/// Two parts of a parameter's range are separate where no open point lies between them over more than this share of the range of all
/// open points, and where so many more points of each kind that are looked at between them are implausible, too.
const GAP: f64 = 0.1;
const PROBES: usize = 16;
/// Open points of the highest density that further points are compared with, and how many of these are looked at at a time.
const COMPARED: usize = 50;
const CHUNK: usize = 100;
/// Evaluated points, of those that the caller asked about, that the sampled points are compared with.
const BESIDE: usize = 200;

/// A point of the search space where the black box was not evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Unvisited {
    /// Parameter values.
    pub values: Vec<f64>,
    /// Whether the point belongs to the confidence set.
    pub indistinguishable: bool,
}

/// The points that history matching does not rule out, and the implausibility of those that it was asked about.
#[derive(Debug)]
pub struct HistoryMatching {
    /// Coordinates, 0 to 1, of points that are spread evenly over the part of the search space that is not implausible.
    points: Vec<Vec<f64>>,
    /// Implausibility of each of these points, in the variant in which it is least implausible.
    implausibility: Vec<f64>,
    /// Posterior density of each of these points without its constant: the sum over the variants.
    densities: Vec<f64>,
    /// Implausibility of the points that the caller asked about, each compared with the least implausible sampled points.
    visited: Vec<f64>,
    /// By parameter: coordinates in the middle of each implausible part of its range that lies between two parts that are not.
    gaps: Vec<Vec<f64>>,
    emulator_share: f64,
    limit: f64,
}

/// What the emulator says about some points in each variant.
struct Look {
    points: Vec<Vec<f64>>,
    variants: Vec<VariantLook>,
}

/// What the emulator says about these points in one variant.
struct VariantLook {
    weight: f64,
    field: ScoreField,
    covariance: ScoreCovariance,
    /// As [`ScoreCovariance::pooled`], of the overview.
    pooled_of_overview: f64,
    implausibility: Vec<f64>,
}

impl Look {
    /// Variants without weight are left out. Points are compared with those from number `first` on; `earlier` are those of a look that
    /// these were a part of.
    fn new(
        (emulator, weights): (&Emulator, &[f64]),
        (points, first): (Vec<Vec<f64>>, usize),
        earlier: Option<&Self>,
        uncertainty: ObservationUncertainty,
        limit: f64,
    ) -> Self {
        let of = |emulator: &Emulator, variant: f64, pooled: Option<f64>| {
            let field = emulator.field_in(&points, variant);
            let covariance = ScoreCovariance::new(&field, uncertainty, pooled);
            let implausibility = implausibility_beside(&field, &covariance, first);
            (field, covariance, implausibility)
        };
        let variants = emulator.variants().iter().zip(weights);
        let variants = variants.filter(|(_, weight)| **weight > 0.0);
        let variants = variants.enumerate().map(|(number, (variant, weight))| {
            let known = earlier.map(|look| &look.variants[number]);
            let pooled = known.map(|known| known.covariance.pooled);
            let (field, covariance, mut implausibility) = of(emulator, *variant, pooled);
            let mut pooled_of_overview = 0.0;
            if let Some(overview) = emulator.overview() {
                let pooled = known.map(|known| known.pooled_of_overview);
                let (_, of_overview, of_all) = of(overview, *variant, pooled);
                pooled_of_overview = of_overview.pooled;
                for (point, (here, of_all)) in implausibility.iter_mut().zip(of_all).enumerate() {
                    // Where runs are near, they know more than the overview, which beside a cliff of the score may be wrong.
                    let is_forgotten = field.emulator[(point, point)] > FORGOTTEN * field.variance;
                    if of_all > limit + BEYOND && is_forgotten {
                        *here = here.max(of_all);
                    }
                }
            }
            VariantLook {
                weight: *weight,
                field,
                covariance,
                pooled_of_overview,
                implausibility,
            }
        });
        let variants = variants.collect();
        Self { points, variants }
    }

    /// Implausibility of a point in the variant in which it is least implausible.
    fn least(&self, point: usize) -> f64 {
        let variants = self.variants.iter();
        let all = variants.map(|variant| variant.implausibility[point]);
        all.fold(f64::INFINITY, f64::min)
    }

    /// Posterior density of each of the first `count` points, without a constant.
    fn densities(&self, count: usize) -> Vec<f64> {
        let mut densities = vec![0.0; count];
        for variant in &self.variants {
            let squares = variant.implausibility[..count].iter().map(|i| i * i);
            let own: Vec<f64> = squares.map(|square| libm::exp(-0.5 * square)).collect();
            let total: f64 = own.iter().sum();
            // Densities are too small to be numbers where every sampled point is far from the best run.
            if total > 0.0 {
                for (density, own) in densities.iter_mut().zip(own) {
                    *density += variant.weight * own / total;
                }
            }
        }
        densities
    }
}

impl VariantLook {
    /// The standardised score up to which points are worth another look: somewhat more than of all that are not implausible.
    fn level(&self, limit: f64) -> f64 {
        let places = 0..self.implausibility.len();
        let near = places.filter(|place| self.implausibility[*place] <= limit + BEYOND);
        let (lowest, highest) = ends_of(near.map(|place| self.field.means[place]));
        // Where the expected score is the same everywhere, rounding errors must not separate one point from the others.
        highest + MARGIN * (highest - lowest).max(0.0) + ROUNDING
    }

    fn emulator_share(&self, limit: f64) -> f64 {
        emulator_share(&self.field, &self.covariance, &self.implausibility, limit)
    }
}

impl HistoryMatching {
    /// Samples `count` points, and computes the implausibility of these and of `visited`: coordinates of evaluated points, those with
    /// the lowest expected scores first.
    /// `weights` are the probabilities of the emulator's variants, in the order of [`Emulator::variants`].
    pub fn new(
        (emulator, weights): (&Emulator, &[f64]),
        grid: &Grid,
        visited: &[Vec<f64>],
        uncertainty: ObservationUncertainty,
        count: usize,
        seed: u64,
    ) -> Self {
        let dimensions = grid.ranges().len();
        let limit = chi_squared_quantile(LEVEL, dimensions as f64).sqrt();
        // The sampled points are compared with some of the points that were evaluated, too, which lie at the bottom of valleys.
        let beside = &visited[..visited.len().min(BESIDE)];
        let look = |points: Vec<Vec<f64>>| {
            let all = points.into_iter().chain(beside.iter().cloned()).collect();
            Look::new((emulator, weights), (all, 0), None, uncertainty, limit)
        };
        let variants = emulator.variants().iter().zip(weights);
        let variants = variants.filter(|(_, weight)| **weight > 0.0);
        let sampler = CandidateSampler {
            emulator,
            variants: variants.map(|(variant, _)| *variant).collect(),
            grid,
            seed,
        };
        // First points anywhere and in the lowest valleys, however narrow these are; then points around those that are not implausible.
        let mut axes = vec![vec![(0.0, 1.0)]; dimensions];
        let few = count / 2;
        let mut points = sampler.spread(&axes, &[f64::INFINITY], few / 2);
        points.extend(sampler.lowest(&axes, few / 2));
        for narrowing in 0..NARROWINGS {
            let there = look(points);
            let all = 0..there.points.len();
            let near = all.filter(|point| there.least(*point) <= limit + BEYOND);
            let near: Vec<&Vec<f64>> = near.map(|point| &there.points[point]).collect();
            axes = sampler.around(&near, &axes, few);
            let last = narrowing + 1 == NARROWINGS || near.len() * ENOUGH > there.points.len();
            let levels = there.variants.iter().map(|variant| variant.level(limit));
            let levels: Vec<f64> = levels.collect();
            points = sampler.spread(&axes, &levels, if last { count } else { few });
            if last {
                break;
            }
        }
        let count = points.len();
        let there = look(points);
        let least: Vec<f64> = (0..there.points.len())
            .map(|point| there.least(point))
            .collect();
        let densities = there.densities(count);
        let shares = there.variants.iter();
        let emulator_share = shares
            .map(|variant| variant.weight * variant.emulator_share(limit))
            .sum();
        let open = (0..least.len()).filter(|point| least[*point] <= limit + BEYOND);
        let mut open: Vec<(f64, &Vec<f64>)> = open.map(|p| (least[p], &there.points[p])).collect();
        open.sort_by(|a, b| a.0.total_cmp(&b.0));
        let open: Vec<&Vec<f64>> = open.into_iter().map(|(_, point)| point).collect();
        // Whatever else is asked, each answer is the same.
        let of = |asked: &[Vec<f64>]| -> Vec<f64> {
            let best = open.iter().take(COMPARED).map(|point| (*point).clone());
            let all: Vec<Vec<f64>> = asked.iter().cloned().chain(best).collect();
            let (all, earlier) = ((all, asked.len()), Some(&there));
            let here = Look::new((emulator, weights), all, earlier, uncertainty, limit);
            (0..asked.len()).map(|point| here.least(point)).collect()
        };
        let is_implausible =
            |probes: Vec<Vec<f64>>| of(&probes).iter().all(|one| *one > limit + BEYOND);
        let of_visited = visited.chunks(CHUNK).flat_map(of).collect();
        let gaps = (0..dimensions).map(|axis| gaps(axis, &open, seed, is_implausible));
        let gaps: Vec<Vec<f64>> = gaps.collect();
        Self {
            gaps,
            densities,
            visited: of_visited,
            implausibility: least[..count].to_vec(),
            points: there.points.into_iter().take(count).collect(),
            emulator_share,
            limit,
        }
    }

    /// Share of the emulator in the variance of the difference between the best point and others of the confidence set: the share that
    /// more runs would remove, 0 to 1.
    pub fn emulator_share(&self) -> f64 {
        self.emulator_share
    }

    /// Largest implausibility of a point of the confidence set.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Whether each of the points that the caller asked about belongs to the confidence set.
    pub fn visited_in_set(&self) -> impl Iterator<Item = bool> {
        self.visited.iter().map(|i| *i <= self.limit)
    }

    /// The sampled points, where the black box was not evaluated.
    pub fn unvisited(&self, grid: &Grid) -> Vec<Unvisited> {
        let points = self.points.iter().zip(&self.implausibility);
        points
            .map(|(point, implausibility)| Unvisited {
                values: grid.values_at(point),
                indistinguishable: *implausibility <= self.limit,
            })
            .collect()
    }

    /// Points for the next runs: about half of them drawn from the posterior density, the others evenly from all that is not
    /// implausible.
    pub fn wave(&self, count: usize, rng: &mut Generator) -> Vec<&[f64]> {
        let mut likely = self.densities.clone();
        let mut possible: Vec<f64> = (self.implausibility.iter())
            .map(|i| f64::from(u8::from(*i <= self.limit + BEYOND)))
            .collect();
        let mut chosen = Vec::new();
        for _ in 0..count.min(self.points.len()) {
            // The kind of point is chosen at random: settings come in turn, and must not coincide with one kind.
            let weights = match rng.random() {
                true => &likely,
                false => &possible,
            };
            let Some(point) = pick(weights, rng.random()) else {
                break;
            };
            (likely[point], possible[point]) = (0.0, 0.0);
            chosen.push(self.points[point].as_slice());
        }
        chosen
    }

    /// Parameter values drawn from the posterior density.
    pub fn draws(&self, grid: &Grid, seed: u64) -> PosteriorDraws {
        let first: f64 = Once::BestPoint.generator(seed).random();
        let drawn = systematic(&self.densities, DRAWS, first).into_iter();
        let draws = drawn
            .map(|index| grid.values_at(&self.points[index]))
            .collect();
        let gaps = self.gaps.iter().zip(grid.ranges());
        let gaps = gaps.map(|(gaps, range)| gaps.iter().map(|at| range.at(*at)).collect());
        PosteriorDraws::new(draws, gaps.collect())
    }
}

/// Coordinates in the middle of each part of an axis between open points in which `is_implausible` finds no open one either. The open
/// points are ordered, the least implausible first.
fn gaps(
    axis: usize,
    open: &[&Vec<f64>],
    seed: u64,
    is_implausible: impl Fn(Vec<Vec<f64>>) -> bool,
) -> Vec<f64> {
    let mut along: Vec<&Vec<f64>> = open.to_vec();
    along.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let (low, high) = ends_of(along.iter().map(|point| point[axis]));
    let even = space_filling(along.first().map_or(1, |p| p.len()), 0, PROBES, seed);
    let pairs = along.windows(2).map(|pair| (pair[0], pair[1]));
    let wide = pairs.filter(|(a, b)| b[axis] - a[axis] > GAP * (high - low));
    // Between the two points on both sides, as on a ridge; beside the best points; and anywhere.
    let between = |(from, to): &(&Vec<f64>, &Vec<f64>)| {
        let probes = (0..PROBES).flat_map(|number| {
            let share = (number as f64 + 0.5) / PROBES as f64;
            let on_line = from.iter().zip(*to).map(|(a, b)| a + share * (b - a));
            let on_line: Vec<f64> = on_line.collect();
            let here = on_line[axis];
            let moved = |mut point: Vec<f64>| {
                point[axis] = here;
                point
            };
            let best = open[number % open.len()].clone();
            [moved(best), moved(even[number].to_vec()), on_line]
        });
        probes.collect::<Vec<_>>()
    };
    wide.filter(|pair| is_implausible(between(pair)))
        .map(|(from, to)| 0.5 * (from[axis] + to[axis]))
        .collect()
}

/// The first index whose cumulated weight exceeds `share` of the total; `None` where all weights are 0.
fn pick(weights: &[f64], share: f64) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let mut left = share * total;
    weights.iter().position(|weight| {
        left -= weight;
        *weight > 0.0 && left <= 0.0
    })
}
