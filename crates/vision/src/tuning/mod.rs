//! Estimates the settings of a camera from its pictures of a known scene: lens, exposure, gain, noise, blur and compression.
//!
//! First the pose of each picture and the lens are estimated from corners of the scene that are found in the pictures. Then the
//! settings of the sensor are estimated from statistics of the pictures. Views that were held out test the result.

mod bias;
mod compression;
mod correspondence;
mod extrinsics;
mod lens;
mod look;
mod room;
mod sensor;
mod shot;

use std::cell::Cell;
use std::fmt;
use std::path::Path;

use serde::Serialize;

use crate::camera::{Camera, Light, Scene};
use crate::{PictureSource, Shots};
use realgap_core::error::Result;
use realgap_core::statistics::{mean, student_quantile};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};
use realgap_optimization::Progress;

use bias::lens_bias;
use compression::compression;
use extrinsics::{Prior, reprojection_error_px};
use lens::{corrected, lens_settings};
use room::LitScene;
use sensor::{Search, draws, mismatch, residuals, settings};
use shot::{Shot, extrinsics_of, read, reals_of, split};

/// Options of tuning a camera.
#[derive(Debug, Clone)]
pub struct CameraOptions {
    /// Views that are held out to test the result; with `None`, every third view if there are six or more.
    pub held_out: Option<Vec<String>>,
    /// Standard deviation of the position of the camera, for each axis, metres.
    pub place_sd_m: f64,
    /// Approximate upper limit of how often all pictures are simulated in the search, which ends earlier if it converges.
    pub budget: usize,
    /// Seed of the simulated noise.
    pub seed: u64,
}

impl Default for CameraOptions {
    fn default() -> Self {
        Self {
            held_out: None,
            place_sd_m: 0.02,
            budget: 400,
            seed: 1,
        }
    }
}

/// Whether the pictures determine a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Known {
    /// The interval of the setting is inside of the search range.
    Determined,
    /// The interval has an upper end only; smaller values are not excluded.
    AtMost,
    /// The interval has a lower end only; larger values are not excluded.
    AtLeast,
    /// The interval covers (nearly) the whole search range.
    Undetermined,
}

/// An estimated setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TunedSetting {
    /// Name of the setting, as in the camera of a scene.
    pub name: &'static str,
    /// Unit of the setting; empty for a setting without unit.
    pub unit: &'static str,
    /// Value at the start of the search.
    pub start: f64,
    /// Estimated value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Search range.
    pub searched: (f64, f64),
    /// Whether the pictures determine the setting.
    pub known: Known,
}

/// Difference between simulated and real pictures, before and after tuning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Mismatch {
    /// Difference of the statistics of pictures before tuning; 1 means as large as the variation between views after the fit.
    pub look_start: f64,
    /// Difference of the statistics of pictures after tuning.
    pub look_tuned: f64,
    /// Reprojection error before tuning: robust root mean square distance of corners of the scene from their predicted positions,
    /// pixels.
    pub corners_start_px: f64,
    /// Reprojection error after tuning, pixels.
    pub corners_tuned_px: f64,
}

/// A camera whose settings were estimated, with the tests of the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TunedCamera {
    /// The camera.
    #[serde(skip)]
    pub camera: Camera,
    /// Name of the camera from which the search started.
    pub start: String,
    /// Source of the "real" pictures.
    pub real: PictureSource,
    /// The estimated settings.
    pub settings: Vec<TunedSetting>,
    /// Names of the fitted views.
    pub fitted_views: Vec<String>,
    /// Difference between simulated and real pictures of the fitted views.
    pub fitted: Mismatch,
    /// Names of the held-out views.
    pub held_out_views: Vec<String>,
    /// Difference between simulated and real pictures of the held-out views.
    pub held_out: Option<Mismatch>,
    /// Mean distance of the cameras from their intended positions, metres.
    pub misplaced_m: f64,
    /// Mean rotation of the cameras from their intended orientations, radians.
    pub turned_rad: f64,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// Prior standard deviation of both coefficients of distortion.
const DISTORTION_SD: f64 = 0.2;
/// Prior standard deviation of the direction of cameras, radians.
const ANGLE_SD_RAD: f64 = 0.1;
/// Level of all intervals.
const LEVEL: f64 = 0.9;
/// A setting is undetermined if its interval is wider than this share of the search range.
const WIDE: f64 = 0.8;

/// Estimates the settings of the camera that took the pictures of a folder, starting from a camera of the scene. Pictures are assigned to
/// the scene's views by name.
///
/// # Errors
/// No pictures of the scene's views, pictures that differ in size or are too small, fewer than three views to fit, a held-out view
/// that does not exist, pictures in which the scene is not found.
pub fn tune_camera(
    scene: &Scene,
    start: &Camera,
    light: &Light,
    folder: impl AsRef<Path>,
    options: &CameraOptions,
    progress: Option<&(dyn Fn(Progress) + Sync)>,
) -> Result<TunedCamera> {
    let names: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
    let shots = Shots::read(folder.as_ref(), &names)?;
    let pictures = read(&shots)?;
    let mut warnings = Vec::new();
    let (fitted_views, held_views) =
        split(&names, &shots, options, &mut warnings).map_err(|e| e.at_file(folder.as_ref()))?;
    let mut start = start.clone();
    start.lens.width_px = pictures[0].grey.width();
    start.lens.height_px = pictures[0].grey.height();
    let of = |views: &[usize]| -> Vec<&Shot> {
        pictures
            .iter()
            .filter(|p| views.contains(&p.view))
            .collect()
    };
    let (fitted, held) = (of(&fitted_views), of(&held_views));

    let lit_scene = LitScene { scene, light };
    let prior = Prior {
        place_sd_m: options.place_sd_m,
        angle_sd_rad: ANGLE_SD_RAD,
        distortion_sd: DISTORTION_SD,
        lens: true,
        sensor: false,
    };
    let (mut camera, extrinsics) = extrinsics_of(lit_scene, &start, &fitted, &prior)?;
    let (compression, quality) = compression(&start, &fitted)?;
    camera.sensor.jpeg_quality = quality;
    warnings.extend(unknown_compression(&compression, quality));
    let search = Search {
        settings: settings(&start),
        pictures: &reals_of(lit_scene, &camera, &fitted, &extrinsics)?,
        camera,
        seed: options.seed,
        budget: options.budget,
        tried: Cell::new(0),
        progress,
    };
    let found = search.run()?;
    // With the estimated brightness and blur, corners are found more accurately; then brightness and blur are estimated again.
    let known = Prior {
        sensor: true,
        ..prior
    };
    let tuned = search.camera_at(&found.shares);
    let (tuned, extrinsics) = extrinsics_of(lit_scene, &tuned, &fitted, &known)?;
    let search = Search {
        pictures: &reals_of(lit_scene, &tuned, &fitted, &extrinsics)?,
        camera: tuned,
        ..search
    };
    let found = search.again(&found)?;
    let tuned = search.camera_at(&found.shares);
    warnings.extend(unfinished(&found, options.budget));
    report_last_step(progress);
    let pictures = (&fitted[..], &extrinsics[..]);
    let bias = lens_bias(lit_scene, &tuned, pictures, &known, (options.seed, LEVEL))?;
    let camera = Camera {
        name: "tuned".to_owned(),
        is_stand_in: false,
        lens: corrected(&tuned.lens, &bias),
        ..tuned.clone()
    };
    let mut all = lens_settings(&start.lens, &tuned.lens, pictures, &known, &bias);
    all.extend(sensor_settings(&search, &found, fitted_views.len()));
    all.push(compression);
    warnings.extend(shots.source.warning());
    let judge = |own: &[&Shot]| {
        judged(
            lit_scene,
            [&start, &camera],
            own,
            &prior,
            (&found, options.seed),
        )
    };
    let named = |views: &[usize]| views.iter().map(|v| names[*v].to_owned()).collect();
    let length = |off: &[f64]| off.iter().map(|v| v * v).sum::<f64>().sqrt();
    let offs = |from: usize| -> f64 {
        let own = extrinsics.iter().map(|p| length(&p.off[from..from + 3]));
        mean(&own.collect::<Vec<_>>())
    };
    Ok(TunedCamera {
        start: start.name.clone(),
        real: shots.source,
        settings: all,
        fitted: judge(&fitted)?,
        held_out: match held.is_empty() {
            true => None,
            false => Some(judge(&held)?),
        },
        fitted_views: named(&fitted_views),
        held_out_views: named(&held_views),
        misplaced_m: offs(0),
        turned_rad: offs(3),
        warnings,
        camera: camera.clone(),
    })
}

/// Reports to the progress callback that the search is finished and that the bias of the lens is estimated now.
fn report_last_step(progress: Option<&(dyn Fn(Progress) + Sync)>) {
    if let Some(progress) = progress {
        progress(Progress {
            done: 0,
            total: 0,
            best: None,
            finishing: Some("estimating the bias of the lens"),
        });
    }
}

/// A warning that states the assumed compression if the pictures do not determine it.
fn unknown_compression(compression: &TunedSetting, quality: Option<u8>) -> Option<Warning> {
    let as_if = match quality {
        _ if compression.known != Known::Undetermined => return None,
        Some(quality) => format!("had quality {quality}"),
        None => "were not compressed".to_owned(),
    };
    let what = format!("exposure, gain and read noise are estimated as if the pictures {as_if}");
    Some(Code::CompressionUnknown.warning(what))
}

/// A warning if the search did not converge within its budget.
fn unfinished(found: &sensor::Found, budget: usize) -> Option<Warning> {
    let what = format!("the search had not converged when its budget of {budget} was spent");
    (!found.is_ended).then(|| Code::Incomplete.warning(what))
}

/// Difference between simulated and real pictures for the start camera and the tuned camera. The poses of the pictures are estimated for
/// each of the two cameras.
fn judged(
    lit_scene: LitScene<'_>,
    cameras: [&Camera; 2],
    shots: &[&Shot],
    prior: &Prior,
    (found, seed): (&sensor::Found, u64),
) -> Result<Mismatch> {
    let of = |camera: &Camera, sensor: bool| -> Result<(f64, f64)> {
        let fixed = Prior {
            lens: false,
            sensor,
            ..*prior
        };
        let (camera, extrinsics) = extrinsics_of(lit_scene, camera, shots, &fixed)?;
        let reals = reals_of(lit_scene, &camera, shots, &extrinsics)?;
        let rows = residuals(&camera, &reals, seed, draws(&reals))?;
        Ok((
            mismatch(&rows, &found.scale),
            reprojection_error_px(&camera.lens, &extrinsics),
        ))
    };
    let (look_start, corners_start_px) = of(cameras[0], false)?;
    let (look_tuned, corners_tuned_px) = of(cameras[1], true)?;
    Ok(Mismatch {
        look_start,
        look_tuned,
        corners_start_px,
        corners_tuned_px,
    })
}

/// Whether an interval, given in shares of the search range, determines a setting.
fn known(low: f64, high: f64) -> Known {
    let (low, high) = (low.max(0.0), high.min(1.0));
    match (low <= 0.0, high >= 1.0) {
        _ if high - low > WIDE => Known::Undetermined,
        (true, false) => Known::AtMost,
        (false, true) => Known::AtLeast,
        (true, true) => Known::Undetermined,
        (false, false) => Known::Determined,
    }
}

fn sensor_settings(search: &Search<'_>, found: &sensor::Found, views: usize) -> Vec<TunedSetting> {
    let t = student_quantile(0.5 + 0.5 * LEVEL, (views - 1) as f64);
    let of = |(k, setting): (usize, &sensor::Setting)| {
        let (share, half) = (found.shares[k], t * found.sd[k]);
        let (low, high) = (share - half, share + half);
        TunedSetting {
            name: setting.name,
            unit: setting.unit,
            start: setting.value(found.start[k]),
            value: setting.value(share),
            low: setting.value(low),
            high: setting.value(high),
            searched: setting.range,
            known: known(low, high),
        }
    };
    search.settings.iter().enumerate().map(of).collect()
}

fn shown(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 0.01 => format!("{value:.5}"),
        size if size < 1.0 => format!("{value:.4}"),
        size if size < 100.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "appearance {:.2}, now {:.2} (1: as large as the variation between views); corners {:.2} px, now {:.2} px",
            self.look_start, self.look_tuned, self.corners_start_px, self.corners_tuned_px
        )
    }
}

impl fmt::Display for TunedCamera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let real = self.real.words();
        writeln!(
            f,
            "camera {} tuned to {real} of {}; 90 % intervals\n",
            self.start,
            counted(self.fitted_views.len(), "view")
        )?;
        let table = TextTable::of(
            &self.settings,
            &[
                ("setting", Left, &|s| {
                    format!("{} {}", s.name, s.unit).trim_end().to_owned()
                }),
                ("before", Right, &|s| shown(s.start)),
                ("now", Right, &|s| shown(s.value)),
                ("from", Right, &|s| shown(s.low)),
                ("to", Right, &|s| shown(s.high)),
                ("", Left, &|s| {
                    match s.known {
                        Known::Determined => "determined",
                        Known::AtMost => "at most; less is not excluded",
                        Known::AtLeast => "at least; more is not excluded",
                        Known::Undetermined => "not determined by these pictures",
                    }
                    .to_owned()
                }),
            ],
        );
        writeln!(f, "{}", table.render(false))?;
        writeln!(f, "fitted views: {}", self.fitted)?;
        match &self.held_out {
            Some(held_out) => {
                writeln!(
                    f,
                    "held out ({}): {held_out}",
                    self.held_out_views.join(", ")
                )?;
            }
            None => writeln!(f, "held out: none")?,
        }
        write!(
            f,
            "cameras deviated from their intended poses by {:.1} mm and {:.2} degrees on average",
            1e3 * self.misplaced_m,
            self.turned_rad.to_degrees()
        )
    }
}
