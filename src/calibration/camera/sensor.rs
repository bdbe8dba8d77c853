//! Exposure, gain, noise and blur from what pictures look like: simulated moments.
//!
//! The numbers of [`look`] are means over many pixels. Those of the simulated pictures are brought to those of the real ones, each
//! counted in what it differs by from view to view (McFadden 1989, "A method of simulated moments"). Simulated pictures keep their
//! noise from point to point, so that the score is smooth.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::look::{Parts, kind, look};
use crate::error::Result;
use crate::optimization::{Brief, minimise, optimizer_by_name};
use crate::sensing::vision::Grey;
use crate::sensing::vision::camera::{Camera, expose};
use crate::statistics::{mean, standard_deviation};

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
    /// Between these,
    pub range: (f64, f64),
    /// by factors instead of differences.
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
            |c, v| {
                c.sensor.exposure_s = v;
            },
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
            |c, v| {
                c.lens.blur_px = v;
            },
        ),
    ]
}

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
}

/// Settings with their covariance, in shares of their ranges.
pub(super) struct Found {
    pub start: Vec<f64>,
    pub shares: Vec<f64>,
    pub sd: Vec<f64>,
    /// By how much each number differs from view to view.
    pub scale: Vec<f64>,
}

/// Before anything is seen a setting is as likely as within this share of its range about the start (one standard deviation).
const BEFORE: f64 = 0.5;
/// No number is known better than this, however alike all views are.
const LEAST: f64 = 0.01;
/// Steps of differences, as shares of ranges: wide enough for values that are rounded and compressed.
const STEP: f64 = 0.1;
/// Simulated pictures of each real one: compression makes single ones jump from value to value.
const DRAWS: u64 = 4;
/// Numbers of further simulated pictures lie this far apart.
const APART: u64 = 1 << 20;
/// Steps of Gauss and Newton after the search, and what each must gain at least.
const ROUNDS: usize = 8;
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
    fn apart(&self, camera: &Camera) -> Result<Vec<Vec<f64>>> {
        apart(camera, self.pictures, self.seed)
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

    /// Finds the settings.
    pub(super) fn run(&self) -> Result<Found> {
        let start: Vec<f64> = self
            .settings
            .iter()
            .zip(starts(&self.camera))
            .map(|(setting, value)| setting.share(value))
            .collect();
        let scale = spread(&self.apart(&self.camera_at(&start))?);
        let brief = Brief {
            points: vec![2; start.len()],
            budget: self.budget,
            seed: self.seed,
        };
        let score = |shares: &Vec<f64>| {
            let rows = self.apart(&self.camera_at(shares)).ok()?;
            Some(self.score(&rows, &scale, shares, &start))
        };
        let told = minimise(optimizer_by_name("cma-es")?, &brief, score)?;
        let best = told.iter().filter_map(|t| Some((t.score?, &t.point)));
        let best = best.min_by(|a, b| a.0.total_cmp(&b.0));
        let mut shares = best.map_or_else(|| start.clone(), |(_, point)| point.clone());
        for _ in 0..ROUNDS {
            let Some(next) = self.step(&shares, &start)? else {
                break;
            };
            shares = next;
        }
        let near = self.near(&shares)?;
        Ok(Found {
            sd: near.sd(),
            scale: near.scale,
            start,
            shares,
        })
    }

    /// A step of Gauss and Newton; `None` where none makes the score smaller.
    fn step(&self, shares: &[f64], start: &[f64]) -> Result<Option<Vec<f64>>> {
        let near = self.near(shares)?;
        let before = DVector::from_fn(shares.len(), |k, _| {
            (start[k] - shares[k]) * BEFORE.powi(-2)
        });
        let right = near.slope.transpose() * &near.means * -near.views + before;
        let Some(way) = near.flat().try_inverse().map(|inverse| inverse * right) else {
            return Ok(None);
        };
        let now = self.score(&near.rows, &near.scale, shares, start);
        for part in [1.0, 0.5, 0.25, 0.1] {
            let next = shares.iter().zip(way.iter());
            let next: Vec<f64> = next.map(|(s, w)| (s + part * w).clamp(0.0, 1.0)).collect();
            let rows = self.apart(&self.camera_at(&next))?;
            if self.score(&rows, &near.scale, &next, start) < now - ENOUGH {
                return Ok(Some(next));
            }
        }
        Ok(None)
    }

    /// How the numbers change with the settings about here.
    fn near(&self, shares: &[f64]) -> Result<Near> {
        let rows = self.apart(&self.camera_at(shares))?;
        let scale = spread(&rows);
        let views = rows.len() as f64;
        let mean = |rows: &[Vec<f64>], j: usize| rows.iter().map(|r| r[j]).sum::<f64>() / views;
        let mut slope = DMatrix::zeros(scale.len(), shares.len());
        for k in 0..shares.len() {
            let ends = [STEP, -STEP].map(|step| {
                let mut ends = shares.to_vec();
                ends[k] = (ends[k] + step).clamp(0.0, 1.0);
                ends
            });
            let up = self.apart(&self.camera_at(&ends[0]))?;
            let down = self.apart(&self.camera_at(&ends[1]))?;
            for j in 0..scale.len() {
                let change = mean(&up, j) - mean(&down, j);
                slope[(j, k)] = change / (ends[0][k] - ends[1][k]) / scale[j];
            }
        }
        Ok(Near {
            means: DVector::from_fn(scale.len(), |j, _| mean(&rows, j) / scale[j]),
            rows,
            scale,
            slope,
            views,
        })
    }
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

/// Real less simulated numbers of some pictures, a row a view.
pub(super) fn apart(camera: &Camera, pictures: &[Real], seed: u64) -> Result<Vec<Vec<f64>>> {
    let of = |real: &Real| -> Result<(usize, Vec<f64>)> {
        let mut apart = real.found.clone();
        for draw in 0..DRAWS {
            let picture = expose(camera, &real.light, seed, real.number + draw * APART)?;
            for (apart, said) in apart.iter_mut().zip(look(&picture, &real.parts)) {
                *apart -= said / DRAWS as f64;
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
