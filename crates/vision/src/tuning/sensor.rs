//! Estimates exposure, gain, noise and blur from statistics of pictures, by the method of simulated moments.
//!
//! The statistics of [`look`] are means over many pixels. The settings are chosen such that the statistics of simulated pictures agree
//! with those of the real ones; each difference is divided by its standard deviation between views (McFadden 1989, "A method of
//! simulated moments"). All settings are simulated with the same random numbers, so that the score is a smooth function of them.

use std::cell::Cell;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::look::{Parts, kind, look};
use crate::Grey;
use crate::camera::{Camera, focused};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, standard_deviation};
use realgap_optimization::Progress;

/// One real picture: the simulated light at its pose, its statistics, and its view.
pub(super) struct Real {
    pub light: [Grey; 3],
    pub parts: Parts,
    pub found: Vec<f64>,
    pub view: usize,
    /// Number of the random stream of its simulated noise.
    pub number: u64,
}

/// A setting that is estimated.
pub(super) struct Setting {
    pub name: &'static str,
    pub unit: &'static str,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Whether the search is on a logarithmic scale.
    pub by_factor: bool,
    set: fn(&mut Camera, f64),
}

impl Setting {
    pub(super) fn value(&self, share: f64) -> f64 {
        let (low, high) = self.range;
        let share = share.clamp(0.0, 1.0);
        if self.by_factor {
            low * libm::pow(high / low, share)
        } else {
            low + (high - low) * share
        }
    }

    fn share(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        let share = if self.by_factor {
            libm::log(value / low) / libm::log(high / low)
        } else {
            (value - low) / (high - low)
        };
        share.clamp(0.0, 1.0)
    }
}

/// Exposure and gain are searched up to this factor below and above their start.
const FACTOR: f64 = 8.0;

pub(super) fn settings(start: &Camera) -> Vec<Setting> {
    let sensor = &start.sensor;
    let around = |value: f64| (value / FACTOR, value * FACTOR);
    let setting = |name, unit, range, by_factor, set| Setting {
        name,
        unit,
        range,
        by_factor,
        set,
    };
    vec![
        setting(
            "exposure_s",
            "s",
            around(sensor.exposure_s),
            true,
            |c, v| c.sensor.exposure_s = v,
        ),
        setting("gain", "", around(sensor.gain), true, |c, v| {
            c.sensor.gain = v
        }),
        setting(
            "read_noise_e",
            "electrons",
            (0.0, (4.0 * sensor.read_noise_e).max(60.0)),
            false,
            |c, v| c.sensor.read_noise_e = v,
        ),
        setting(
            "blur_px",
            "px",
            (0.0, (3.0 * start.lens.blur_px).max(3.0)),
            false,
            |c, v| c.lens.blur_px = v,
        ),
    ]
}

/// Index of the blur among the settings.
const BLUR: usize = 3;

fn starts(start: &Camera) -> [f64; 4] {
    [
        start.sensor.exposure_s,
        start.sensor.gain,
        start.sensor.read_noise_e,
        start.lens.blur_px,
    ]
}

/// The search for the settings of a sensor: the start, the pictures, the settings and the budget.
pub(super) struct Search<'a> {
    pub camera: Camera,
    pub pictures: &'a [Real],
    pub settings: Vec<Setting>,
    pub seed: u64,
    pub budget: usize,
    /// Number of times that all pictures have been simulated so far.
    pub tried: Cell<usize>,
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
}

/// The estimated settings with their standard deviations, as shares of their ranges.
pub(super) struct Found {
    pub start: Vec<f64>,
    pub shares: Vec<f64>,
    pub sd: Vec<f64>,
    /// Standard deviation of each statistic between views.
    pub scale: Vec<f64>,
    /// Whether the search converged before its budget was spent.
    pub is_ended: bool,
}

/// Prior standard deviation of a setting about its start, as a share of its range.
const BEFORE: f64 = 0.5;
/// Lower limit of the standard deviation of a statistic between views.
const LEAST: f64 = 0.01;
/// Search directions, as shares of the ranges of exposure, gain, read noise and blur: brightness, ratio of exposure to gain, noise,
/// blur. Brightness is determined well and the others are not. Each direction therefore has its own step of finite differences, which is
/// large enough for pictures that are rounded and compressed.
const WAYS: [[f64; 4]; 4] = [
    [0.03, 0.03, 0.0, 0.0],
    [0.1, -0.1, 0.0, 0.0],
    [0.0, 0.0, 0.1, 0.0],
    [0.0, 0.0, 0.0, 0.05],
];
/// Order of the initial line searches along the directions, number of points on either side, and length.
const WALKS: [usize; 5] = [0, 3, 1, 2, 0];
const PLACES: i32 = 8;
const REACH: f64 = 0.4;
/// A blur below this share does not change a picture, so that the derivative with respect to it is 0.
const LEAST_BLUR: f64 = 0.1;
/// Largest number of simulated pictures for each real one, in the first and in the last descent. Several are averaged because
/// compression makes the statistics of a single picture jump, at which a search would get stuck.
const FEW: u64 = 4;
const DRAWS: u64 = 16;
/// Number of simulated pixels, over all pictures, with which the jumps of single pictures are negligible.
const PIXELS: usize = 16 * 6 * 160 * 120;
/// Difference of the numbers of the random streams of two simulated pictures of the same real picture.
const STRIDE: u64 = 1 << 20;
/// Damped Gauss-Newton: initial damping, how often it is increased before the search ends, and smallest decrease of the score.
const DAMPING: f64 = 0.01;
const RAISED: usize = 3;
const ENOUGH: f64 = 0.1;

impl Search<'_> {
    pub(super) fn camera_at(&self, shares: &[f64]) -> Camera {
        let mut camera = self.camera.clone();
        for (setting, share) in self.settings.iter().zip(shares) {
            (setting.set)(&mut camera, setting.value(*share));
        }
        camera
    }

    /// Real minus simulated statistics, one row for each view.
    fn residuals(&self, shares: &[f64], draws: u64) -> Result<Vec<Vec<f64>>> {
        self.tried.set(self.tried.get() + 1);
        if let Some(progress) = self.progress {
            progress(Progress {
                done: self.tried.get().min(self.budget),
                total: self.budget,
                best: None,
                finishing: None,
            });
        }
        residuals(&self.camera_at(shares), self.pictures, self.seed, draws)
    }

    fn is_spent(&self) -> bool {
        self.tried.get() >= self.budget
    }

    fn score(&self, rows: &[Vec<f64>], scale: &[f64], shares: &[f64], start: &[f64]) -> f64 {
        let views = rows.len() as f64;
        let numbers = (0..scale.len()).map(|j| {
            let mean = rows.iter().map(|row| row[j]).sum::<f64>() / views;
            views * (mean / scale[j]).powi(2)
        });
        let before = shares.iter().zip(start);
        numbers.sum::<f64>() + before.map(|(s, b)| ((s - b) / BEFORE).powi(2)).sum::<f64>()
    }

    /// Estimates the settings: line searches along one direction after the other, then damped Gauss-Newton (Levenberg 1944, Marquardt
    /// 1963).
    pub(super) fn run(&self) -> Result<Found> {
        let start: Vec<f64> = self
            .settings
            .iter()
            .zip(starts(&self.camera))
            .map(|(setting, value)| setting.share(value))
            .collect();
        let mut shares = start.clone();
        for way in WALKS {
            shares = self.walk(&shares, &start, way)?;
        }
        shares[BLUR] = shares[BLUR].max(LEAST_BLUR);
        let (shares, _) = self.descend(shares, &start, FEW.min(draws(self.pictures)))?;
        self.end(shares, start)
    }

    /// Estimates the settings again with other pictures, starting from earlier estimates.
    pub(super) fn again(&self, found: &Found) -> Result<Found> {
        self.end(found.shares.clone(), found.start.clone())
    }

    fn end(&self, from: Vec<f64>, start: Vec<f64>) -> Result<Found> {
        let (shares, near) = self.descend(from, &start, draws(self.pictures))?;
        Ok(Found {
            sd: near.sd(),
            scale: near.scale,
            start,
            shares,
            is_ended: !self.is_spent(),
        })
    }

    /// Damped Gauss-Newton steps until none decreases the score.
    fn descend(&self, from: Vec<f64>, start: &[f64], draws: u64) -> Result<(Vec<f64>, Near)> {
        let (mut shares, mut damping) = (from, DAMPING);
        let mut near = self.near(&shares, draws)?;
        while let Some(next) = self.step(&near, &shares, start, &mut damping, draws)? {
            shares = next;
            near = self.near(&shares, draws)?;
        }
        Ok((shares, near))
    }

    /// The best of some points along a direction, so that Gauss-Newton starts where derivatives are informative.
    fn walk(&self, shares: &[f64], start: &[f64], way: usize) -> Result<Vec<f64>> {
        let scale = spread(&self.residuals(shares, 1)?);
        let far = WAYS[way].iter().copied().fold(0.0, f64::max);
        let mut best = (f64::INFINITY, shares.to_vec());
        for place in -PLACES..=PLACES {
            let by = REACH * f64::from(place) / f64::from(PLACES) / far;
            let there = shares.iter().zip(WAYS[way]);
            let there: Vec<f64> = there.map(|(share, step)| share + by * step).collect();
            if self.is_spent() || there.iter().any(|s| !(0.0..=1.0).contains(s)) {
                continue;
            }
            let score = self.score(&self.residuals(&there, 1)?, &scale, &there, start);
            if score < best.0 {
                best = (score, there);
            }
        }
        Ok(best.1)
    }

    /// A damped Gauss-Newton step; `None` if no step decreases the score.
    fn step(
        &self,
        near: &Near,
        shares: &[f64],
        start: &[f64],
        damping: &mut f64,
        draws: u64,
    ) -> Result<Option<Vec<f64>>> {
        let before = DVector::from_fn(shares.len(), |k, _| {
            (start[k] - shares[k]) * BEFORE.powi(-2)
        });
        let right = near.slope.transpose() * &near.means * -near.views + before;
        let flat = near.flat();
        let now = self.score(&near.rows, &near.scale, shares, start);
        for _ in 0..=RAISED {
            if self.is_spent() {
                break;
            }
            let mut damped = flat.clone();
            for k in 0..shares.len() {
                damped[(k, k)] *= 1.0 + *damping;
            }
            let Some(way) = damped.try_inverse().map(|inverse| inverse * &right) else {
                break;
            };
            let next = shares.iter().zip(way.iter());
            let next: Vec<f64> = next.map(|(s, w)| (s + w).clamp(0.0, 1.0)).collect();
            let rows = self.residuals(&next, draws)?;
            if self.score(&rows, &near.scale, &next, start) < now - ENOUGH {
                *damping *= 0.1;
                return Ok(Some(next));
            }
            *damping *= 10.0;
        }
        Ok(None)
    }

    /// The linearisation of the statistics about these settings.
    fn near(&self, shares: &[f64], draws: u64) -> Result<Near> {
        let rows = self.residuals(shares, draws)?;
        let scale = spread(&rows);
        let views = rows.len() as f64;
        let mean = |rows: &[Vec<f64>], j: usize| rows.iter().map(|r| r[j]).sum::<f64>() / views;
        let ways = DMatrix::from_fn(shares.len(), shares.len(), |k, way| WAYS[way][k]);
        let mut along = DMatrix::zeros(scale.len(), shares.len());
        for (k, way) in WAYS.iter().enumerate() {
            let ends = [1.0, -1.0].map(|sign| end(shares, &way.map(|step| sign * step)));
            let [(up_by, up), (down_by, down)] = &ends;
            let (up, down) = (self.residuals(up, draws)?, self.residuals(down, draws)?);
            for j in 0..scale.len() {
                let change = mean(&up, j) - mean(&down, j);
                along[(j, k)] = change / (up_by + down_by) / scale[j];
            }
        }
        let across = ways.try_inverse();
        Ok(Near {
            means: DVector::from_fn(scale.len(), |j, _| mean(&rows, j) / scale[j]),
            rows,
            scale,
            slope: across.map_or(along.clone(), |across| along * across),
            views,
        })
    }
}

/// A step from some shares, shortened so that none of them leaves its range: the factor of the shortening, and the end of the step.
fn end(shares: &[f64], step: &[f64]) -> (f64, Vec<f64>) {
    let factors = shares.iter().zip(step).map(|(share, step)| match *step {
        step if step > 0.0 => (1.0 - share) / step,
        step if step < 0.0 => -share / step,
        _ => 1.0,
    });
    let part = factors.fold(1.0, f64::min).max(0.0);
    let ends = shares.iter().zip(step);
    let ends = ends.map(|(share, step)| (share + part * step).clamp(0.0, 1.0));
    (part, ends.collect())
}

/// The linearisation about some settings: real minus simulated statistics (one row for each view), their standard deviations between
/// views, their means, and their derivatives with respect to each setting.
struct Near {
    rows: Vec<Vec<f64>>,
    scale: Vec<f64>,
    means: DVector<f64>,
    slope: DMatrix<f64>,
    views: f64,
}

impl Near {
    /// Half of the approximate Hessian of the score.
    fn flat(&self) -> DMatrix<f64> {
        let settings = self.slope.ncols();
        let before = DMatrix::identity(settings, settings) * BEFORE.powi(-2);
        self.slope.transpose() * &self.slope * self.views + before
    }

    /// Standard deviations of the settings, by the sandwich estimator with the covariance of the statistics between views.
    fn sd(&self) -> Vec<f64> {
        let (numbers, settings) = self.slope.shape();
        let mut inner = DMatrix::zeros(numbers, numbers);
        for row in &self.rows {
            let off = DVector::from_fn(numbers, |j, _| row[j] / self.scale[j]) - &self.means;
            inner.ger(1.0 / (self.views - 1.0).max(1.0), &off, &off, 1.0);
        }
        let before = DMatrix::identity(settings, settings) * BEFORE.powi(-2);
        let meat = self.slope.transpose() * inner * &self.slope * self.views + before;
        match self.flat().try_inverse() {
            None => vec![f64::INFINITY; settings],
            Some(inverse) => {
                let covariance = &inverse * meat * &inverse;
                let variances = (0..settings).map(|k| covariance[(k, k)]);
                variances.map(|v| v.max(0.0).sqrt()).collect()
            }
        }
    }
}

/// The number of simulated pictures for each real one.
pub(super) fn draws(pictures: &[Real]) -> u64 {
    let pixels = |real: &Real| real.light[0].values().len();
    let all: usize = pictures.iter().map(pixels).sum();
    (PIXELS.div_ceil(all.max(1)) as u64).min(DRAWS)
}

/// Real minus simulated statistics of some pictures, one row for each view.
pub(super) fn residuals(
    camera: &Camera,
    pictures: &[Real],
    seed: u64,
    draws: u64,
) -> Result<Vec<Vec<f64>>> {
    let of = |real: &Real| -> Result<(usize, Vec<f64>)> {
        let light = focused(camera, &real.light);
        let mut residuals = real.found.clone();
        for draw in 0..draws {
            let number = real.number + draw * STRIDE;
            let picture = camera.sensor.picture(&light, seed, number)?;
            for (residual, simulated) in residuals.iter_mut().zip(look(&picture, &real.parts)) {
                *residual -= simulated / draws as f64;
            }
        }
        Ok((real.view, residuals))
    };
    let all: Vec<(usize, Vec<f64>)> = pictures.par_iter().map(of).collect::<Result<_>>()?;
    let mut views: Vec<usize> = all.iter().map(|(view, _)| *view).collect();
    views.dedup();
    Ok(views
        .into_iter()
        .map(|view| {
            let own: Vec<&Vec<f64>> = all.iter().filter(|a| a.0 == view).map(|a| &a.1).collect();
            let columns = own.first().map_or(0, |row| row.len());
            (0..columns)
                .map(|j| mean(&own.iter().map(|row| row[j]).collect::<Vec<_>>()))
                .collect()
        })
        .collect())
}

/// Standard deviation of each statistic between views, pooled over statistics of one kind, because with few views a single statistic
/// may agree by chance.
fn spread(rows: &[Vec<f64>]) -> Vec<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    let variances: Vec<f64> = (0..columns)
        .map(|j| {
            let own: Vec<f64> = rows.iter().map(|row| row[j]).collect();
            standard_deviation(&own).powi(2)
        })
        .collect();
    (0..columns)
        .map(|j| {
            let same: Vec<f64> = (0..columns)
                .filter(|other| kind(*other) == kind(j))
                .map(|other| variances[other])
                .collect();
            mean(&same).sqrt().hypot(LEAST)
        })
        .collect()
}

/// Root mean square of real minus simulated statistics; 1 means that the difference is as large as the variation between views.
pub(super) fn mismatch(rows: &[Vec<f64>], scale: &[f64]) -> f64 {
    let squares = rows.iter().flat_map(|row| row.iter().zip(scale));
    mean(
        &squares
            .map(|(residual, s)| (residual / s).powi(2))
            .collect::<Vec<_>>(),
    )
    .sqrt()
}
