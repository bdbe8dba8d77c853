//! Exposure, gain, noise and blur from what pictures look like: simulated moments.
//!
//! The numbers of [`look`] are means over many pixels. Those of the simulated pictures are brought to those of the real ones, each
//! counted in what it differs by from view to view (McFadden 1989, "A method of simulated moments"). Simulated pictures keep their
//! noise from point to point, so that the score is smooth.

use std::cell::Cell;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::look::{Parts, kind, look};
use crate::Grey;
use crate::camera::{Camera, focused};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, standard_deviation};
use realgap_optimization::Progress;

/// One real picture: the light where it was taken, its numbers, and its view.
pub(super) struct Real {
    pub light: [Grey; 3],
    pub parts: Parts,
    pub found: Vec<f64>,
    pub view: usize,
    /// Number of its simulated noise.
    pub number: u64,
}

/// A setting that is sought.
pub(super) struct Setting {
    pub name: &'static str,
    pub unit: &'static str,
    /// The value is between these.
    pub range: (f64, f64),
    /// Whether it is sought by factors instead of differences.
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

/// Exposure and gain are sought this far about where they start, by factors.
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

/// Where the blur is among the settings.
const BLUR: usize = 3;

fn starts(start: &Camera) -> [f64; 4] {
    [
        start.sensor.exposure_s,
        start.sensor.gain,
        start.sensor.read_noise_e,
        start.lens.blur_px,
    ]
}

/// What is sought, from where, and in which pictures.
pub(super) struct Search<'a> {
    pub camera: Camera,
    pub pictures: &'a [Real],
    pub settings: Vec<Setting>,
    pub seed: u64,
    pub budget: usize,
    /// How often all pictures were simulated so far.
    pub tried: Cell<usize>,
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
}

/// Settings with their covariance, in shares of their ranges.
pub(super) struct Found {
    pub start: Vec<f64>,
    pub shares: Vec<f64>,
    pub sd: Vec<f64>,
    /// By how much each number differs from view to view.
    pub scale: Vec<f64>,
    /// Whether the search ended by itself.
    pub is_ended: bool,
}

/// Prior anything is seen a setting is as likely as within this share of its range about the start (one standard deviation).
const BEFORE: f64 = 0.5;
/// No number is known better than this, however alike all views are.
const LEAST: f64 = 0.01;
/// Ways along which the search goes, as shares of the ranges of exposure, gain, read noise and blur: brightness, how it is shared,
/// noise, blur. Brightness is known well and the others are not, so that each has its own length for differences: wide enough for
/// values that are rounded and compressed.
const WAYS: [[f64; 4]; 4] = [
    [0.03, 0.03, 0.0, 0.0],
    [0.1, -0.1, 0.0, 0.0],
    [0.0, 0.0, 0.1, 0.0],
    [0.0, 0.0, 0.0, 0.05],
];
/// In which order ways are looked along at first, at how many places on either side, and how far.
const WALKS: [usize; 5] = [0, 3, 1, 2, 0];
const PLACES: i32 = 8;
const REACH: f64 = 0.4;
/// A blur below this share changes nothing in a picture, so that its slope says nothing.
const LEAST_BLUR: f64 = 0.1;
/// Most simulated pictures of each real one, at first and at last: compression makes single ones jump from value to value, which holds
/// a search where it is.
const FEW: u64 = 4;
const DRAWS: u64 = 16;
/// In so many pixels of all pictures together single jumps do not matter any more.
const PIXELS: usize = 16 * 6 * 160 * 120;
/// Numbers of further simulated pictures lie this far apart.
const APART: u64 = 1 << 20;
/// Steps of Gauss and Newton: damping at first, how often it is raised before the search ends, and what a step must gain at least.
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

    /// Real less simulated numbers, a row a view.
    fn apart(&self, shares: &[f64], draws: u64) -> Result<Vec<Vec<f64>>> {
        self.tried.set(self.tried.get() + 1);
        if let Some(progress) = self.progress {
            progress(Progress {
                done: self.tried.get().min(self.budget),
                total: self.budget,
                best: None,
                finishing: None,
            });
        }
        apart(&self.camera_at(shares), self.pictures, self.seed, draws)
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

    /// Finds the settings: walks along one way after the other, then damped steps of Gauss and Newton (Levenberg 1944, Marquardt 1963).
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

    /// Finds the settings again from where they were found, with other pictures.
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

    /// Steps until none makes the score smaller.
    fn descend(&self, from: Vec<f64>, start: &[f64], draws: u64) -> Result<(Vec<f64>, Near)> {
        let (mut shares, mut damping) = (from, DAMPING);
        let mut near = self.near(&shares, draws)?;
        while let Some(next) = self.step(&near, &shares, start, &mut damping, draws)? {
            shares = next;
            near = self.near(&shares, draws)?;
        }
        Ok((shares, near))
    }

    /// The best of some places along a way, so that steps begin where slopes mean something.
    fn walk(&self, shares: &[f64], start: &[f64], way: usize) -> Result<Vec<f64>> {
        let scale = spread(&self.apart(shares, 1)?);
        let far = WAYS[way].iter().copied().fold(0.0, f64::max);
        let mut best = (f64::INFINITY, shares.to_vec());
        for place in -PLACES..=PLACES {
            let by = REACH * f64::from(place) / f64::from(PLACES) / far;
            let there = shares.iter().zip(WAYS[way]);
            let there: Vec<f64> = there.map(|(share, step)| share + by * step).collect();
            if self.is_spent() || there.iter().any(|s| !(0.0..=1.0).contains(s)) {
                continue;
            }
            let score = self.score(&self.apart(&there, 1)?, &scale, &there, start);
            if score < best.0 {
                best = (score, there);
            }
        }
        Ok(best.1)
    }

    /// A step; `None` where none makes the score smaller.
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
            let rows = self.apart(&next, draws)?;
            if self.score(&rows, &near.scale, &next, start) < now - ENOUGH {
                *damping *= 0.1;
                return Ok(Some(next));
            }
            *damping *= 10.0;
        }
        Ok(None)
    }

    /// How the numbers change with the settings about here.
    fn near(&self, shares: &[f64], draws: u64) -> Result<Near> {
        let rows = self.apart(shares, draws)?;
        let scale = spread(&rows);
        let views = rows.len() as f64;
        let mean = |rows: &[Vec<f64>], j: usize| rows.iter().map(|r| r[j]).sum::<f64>() / views;
        let ways = DMatrix::from_fn(shares.len(), shares.len(), |k, way| WAYS[way][k]);
        let mut along = DMatrix::zeros(scale.len(), shares.len());
        for (k, way) in WAYS.iter().enumerate() {
            let ends = [1.0, -1.0].map(|sign| end(shares, &way.map(|step| sign * step)));
            let [(up_by, up), (down_by, down)] = &ends;
            let (up, down) = (self.apart(up, draws)?, self.apart(down, draws)?);
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

/// A step from some shares, shortened where one of them would leave its range: the part of it that is left, and its end.
fn end(shares: &[f64], step: &[f64]) -> (f64, Vec<f64>) {
    let room = shares.iter().zip(step).map(|(share, step)| match *step {
        step if step > 0.0 => (1.0 - share) / step,
        step if step < 0.0 => -share / step,
        _ => 1.0,
    });
    let part = room.fold(1.0, f64::min).max(0.0);
    let ends = shares.iter().zip(step);
    let ends = ends.map(|(share, step)| (share + part * step).clamp(0.0, 1.0));
    (part, ends.collect())
}

/// The numbers about some settings: real less simulated, a row a view; how far views differ; how they change with each setting.
struct Near {
    rows: Vec<Vec<f64>>,
    scale: Vec<f64>,
    means: DVector<f64>,
    slope: DMatrix<f64>,
    views: f64,
}

impl Near {
    /// How fast the score rises about its smallest value.
    fn flat(&self) -> DMatrix<f64> {
        let settings = self.slope.ncols();
        let before = DMatrix::identity(settings, settings) * BEFORE.powi(-2);
        self.slope.transpose() * &self.slope * self.views + before
    }

    /// Standard deviations of the settings: by how the numbers change with them, and how these differ from view to view (the
    /// "sandwich").
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

/// How many simulated pictures of each real one are enough.
pub(super) fn draws(pictures: &[Real]) -> u64 {
    let pixels = |real: &Real| real.light[0].values().len();
    let all: usize = pictures.iter().map(pixels).sum();
    (PIXELS.div_ceil(all.max(1)) as u64).min(DRAWS)
}

/// Real less simulated numbers of some pictures, a row a view.
pub(super) fn apart(
    camera: &Camera,
    pictures: &[Real],
    seed: u64,
    draws: u64,
) -> Result<Vec<Vec<f64>>> {
    let of = |real: &Real| -> Result<(usize, Vec<f64>)> {
        let light = focused(camera, &real.light);
        let mut apart = real.found.clone();
        for draw in 0..draws {
            let number = real.number + draw * APART;
            let picture = camera.sensor.picture(&light, seed, number)?;
            for (apart, said) in apart.iter_mut().zip(look(&picture, &real.parts)) {
                *apart -= said / draws as f64;
            }
        }
        Ok((real.view, apart))
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

/// How far views differ in each number, pooled over numbers of one kind: of few views, one number may be alike by chance.
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

/// How far the numbers of some views are from the real ones: 1 is as far as views differ from each other.
pub(super) fn mismatch(rows: &[Vec<f64>], scale: &[f64]) -> f64 {
    let squares = rows.iter().flat_map(|row| row.iter().zip(scale));
    mean(
        &squares
            .map(|(apart, s)| (apart / s).powi(2))
            .collect::<Vec<_>>(),
    )
    .sqrt()
}
