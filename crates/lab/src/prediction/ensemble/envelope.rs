//! Central regions of the repeats' positions in the prepared frame, at each time and for whole paths.

use serde::{Deserialize, Serialize};

use realgap_core::{Error, Result};
use realgap_path::trajectory::{POINTS, Prepared};

/// Levels of the central regions.
pub const LEVELS: [f64; 3] = [0.5, 0.8, 0.9];
/// Least paths for a band that holds 90 % of whole paths.
pub const LEAST_PATHS: usize = 18;
/// Standard deviation that is added to that of the repeats, as a share of the body length. At the start all repeats are at the
/// origin and at the end all are on the x axis, but the position of no real run is known better than this.
const FLOOR: f64 = 1e-3;

/// The rank, from 1, of the sorted value that bounds a further one with probability `level`.
fn rank(n: usize, level: f64) -> usize {
    // In binary, 0.9 times 30 is a little more than 27, so a rounding error is subtracted.
    let rank = ((n as f64 + 1.0) * level - 1e-9).ceil() as usize;
    rank.clamp(1, n)
}

/// How many of `paths` calibrate the band, about half: one less than a multiple of ten.
fn scored(paths: usize) -> usize {
    (10 * ((paths / 2 + 6) / 10)).max(10) - 1
}

/// Central regions of position at one time: concentric ellipses whose centre and axes are those of the repeats' covariance.
///
/// The region of level p holds the points whose Mahalanobis distance is at most the ⌈(n + 1) p⌉-th smallest of the n repeats' own
/// distances. As in conformal prediction (Vovk et al. 2005), it holds a new draw from the same distribution with a probability of
/// about p, whatever the distribution is. The ellipse only gives the shape: for two separate groups of paths it includes the
/// space between them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Region {
    /// Mean position, prepared frame, metres.
    pub centre_m: [f64; 2],
    /// Covariance (xx, xy, yy), m², floor included.
    pub covariance_m2: [f64; 3],
    /// Mahalanobis distance that bounds each of [`LEVELS`].
    pub radii: [f64; 3],
}

impl Region {
    /// Regions of the positions of a body of this length; at least one position.
    pub(crate) fn of_places(places_m: &[[f64; 2]], body_length_m: f64) -> Self {
        Self::of(places_m, FLOOR * body_length_m)
    }

    fn of(points_m: &[[f64; 2]], floor_m: f64) -> Self {
        let n = points_m.len() as f64;
        let sum = points_m
            .iter()
            .fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        let centre_m = sum.map(|v| v / n);
        let mut covariance_m2 = [floor_m * floor_m, 0.0, floor_m * floor_m];
        for point in points_m {
            let d = [point[0] - centre_m[0], point[1] - centre_m[1]];
            covariance_m2[0] += d[0] * d[0] / n;
            covariance_m2[1] += d[0] * d[1] / n;
            covariance_m2[2] += d[1] * d[1] / n;
        }
        let mut region = Self {
            centre_m,
            covariance_m2,
            radii: [0.0; 3],
        };
        let mut distances: Vec<f64> = points_m.iter().map(|p| region.distance(*p)).collect();
        distances.sort_by(f64::total_cmp);
        region.radii = LEVELS.map(|level| distances[rank(distances.len(), level) - 1]);
        region
    }

    /// Mahalanobis distance of a point from the centre, dimensionless.
    pub fn distance(&self, point_m: [f64; 2]) -> f64 {
        let [xx, xy, yy] = self.covariance_m2;
        let d = [point_m[0] - self.centre_m[0], point_m[1] - self.centre_m[1]];
        let determinant = xx * yy - xy * xy;
        let squared = (yy * d[0] * d[0] - 2.0 * xy * d[0] * d[1] + xx * d[1] * d[1]) / determinant;
        squared.max(0.0).sqrt()
    }

    /// Whether a point lies in the region of `LEVELS[level]`.
    pub fn contains(&self, level: usize, point_m: [f64; 2]) -> bool {
        // A point on the edge belongs to the region, rounding errors included.
        self.distance(point_m) <= self.radii[level] * (1.0 + 1e-12) + 1e-12
    }

    /// Largest distance of the region's edge from its centre along x and along y, metres.
    pub fn half_widths_m(&self, level: usize) -> [f64; 2] {
        [
            self.radii[level] * self.covariance_m2[0].sqrt(),
            self.radii[level] * self.covariance_m2[2].sqrt(),
        ]
    }

    /// `count` points around the edge of a region, metres.
    pub fn outline_m(&self, level: usize, count: usize) -> Vec<[f64; 2]> {
        let [xx, xy, yy] = self.covariance_m2;
        // Cholesky factor of the covariance.
        let a = xx.sqrt();
        let b = xy / a;
        let c = (yy - b * b).max(0.0).sqrt();
        (0..count)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                let r = self.radii[level];
                [
                    self.centre_m[0] + r * a * cos,
                    self.centre_m[1] + r * (b * cos + c * sin),
                ]
            })
            .collect()
    }
}

/// Central regions over time, one for each prepared point. Each holds its share at its own time ([`Envelope::new`]), or all
/// together hold their share of whole paths ([`Envelope::of_whole_paths`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Envelope {
    /// Times, seconds from the start.
    pub times_s: Vec<f64>,
    /// Regions at those times.
    pub regions: Vec<Region>,
}

impl Envelope {
    /// The envelope of some prepared paths of the same duration.
    ///
    /// # Errors
    /// No paths, or a duration or body length that is not positive.
    pub fn new(paths: &[&Prepared], duration_s: f64, body_length_m: f64) -> Result<Self> {
        if paths.is_empty() {
            return Err(Error::invalid("an envelope needs paths")
                .found("none: every repeat diverged")
                .hint("try a shorter timestep or more substeps"));
        }
        if !(duration_s > 0.0 && body_length_m > 0.0) {
            return Err(Error::invalid("duration and body length must be positive"));
        }
        let regions = (0..POINTS)
            .map(|index| {
                let points_m: Vec<[f64; 2]> = paths.iter().map(|p| p.xy_m()[index]).collect();
                Region::of(&points_m, FLOOR * body_length_m)
            })
            .collect();
        let times_s = (0..POINTS)
            .map(|index| duration_s * index as f64 / (POINTS - 1) as f64)
            .collect();
        Ok(Self { times_s, regions })
    }

    /// The band in which a further path stays from start to end, with the probability of each of [`LEVELS`], for any distribution
    /// and number of repeats. `None` for fewer than [`LEAST_PATHS`].
    ///
    /// Split conformal prediction (Lei et al. 2018; for curves Diquigiovanni, Fontana & Vantini 2022): some paths give the centre
    /// and the covariance at each time, the score of a path is its largest Mahalanobis distance from these, and the band of level
    /// p is as wide as the ⌈(n + 1) p⌉-th smallest score of the n others. Their number is chosen so that (n + 1) p is whole, and
    /// the probability is exactly p.
    ///
    /// # Errors
    /// As [`Envelope::new`].
    pub fn of_whole_paths(
        paths: &[&Prepared],
        duration_s: f64,
        body_length_m: f64,
    ) -> Result<Option<Self>> {
        if paths.len() < LEAST_PATHS {
            return Ok(None);
        }
        let (shape, others) = paths.split_at(paths.len() - scored(paths.len()));
        let mut band = Self::new(shape, duration_s, body_length_m)?;
        let mut scores: Vec<f64> = others.iter().map(|path| band.score(path)).collect();
        scores.sort_by(f64::total_cmp);
        let radii = LEVELS.map(|level| scores[rank(scores.len(), level) - 1]);
        for region in &mut band.regions {
            region.radii = radii;
        }
        Ok(Some(band))
    }

    /// Largest Mahalanobis distance of a path from the centre, over time.
    fn score(&self, path: &Prepared) -> f64 {
        let regions = self.regions.iter().zip(path.xy_m());
        regions.fold(0.0, |largest, (region, point)| {
            region.distance(*point).max(largest)
        })
    }

    /// Whether a path lies in the regions of `LEVELS[level]` at all times.
    pub fn holds(&self, level: usize, path: &Prepared) -> bool {
        let mut regions = self.regions.iter().zip(path.xy_m());
        regions.all(|(region, point)| region.contains(level, *point))
    }

    /// At each time, how many of `paths` lie in the region of `LEVELS[level]`.
    pub fn inside(&self, level: usize, paths: &[&Prepared]) -> Vec<usize> {
        let count = |(index, region): (usize, &Region)| {
            let places_m = paths.iter().map(|path| path.xy_m()[index]);
            places_m.filter(|m| region.contains(level, *m)).count()
        };
        self.regions.iter().enumerate().map(count).collect()
    }
}
