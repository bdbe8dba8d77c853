//! A camera's settings from its pictures of a known room: lens, exposure, gain, noise, blur and compression.
//!
//! First where each picture was really taken and through which lens, from corners of the scene found in it; then the sensor, from what
//! pictures look like where they were taken. Views that were left out judge the result.

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
use room::Room;
use sensor::{Search, apart, draws, mismatch, settings};
use shot::{Shot, extrinsics_of, read, reals_of, split};

/// How a camera is tuned.
#[derive(Debug, Clone)]
pub struct CameraOptions {
    /// Views that only judge; `None` for every third where there are six or more.
    pub held_out: Option<Vec<String>>,
    /// Standard deviation of where the camera was put down, each axis, metres.
    pub place_sd_m: f64,
    /// How often all pictures may be simulated in the search, about; it ends by itself where nothing gets better.
    pub budget: usize,
    /// Seed of simulated noise and of the search.
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

/// What pictures say of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Known {
    /// Its interval lies within what was searched.
    Determined,
    /// Nothing below a value is excluded.
    AtMost,
    /// Nothing above a value is excluded.
    AtLeast,
    /// Its interval is (nearly) all that was searched.
    Undetermined,
}

/// A setting that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TunedSetting {
    /// Its name, as in a scene's camera.
    pub name: &'static str,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// What it was before.
    pub start: f64,
    /// What it is now.
    pub value: f64,
    /// Where its 90 % interval begins.
    pub low: f64,
    /// Where that interval ends.
    pub high: f64,
    /// What was searched.
    pub searched: (f64, f64),
    /// Whether the pictures say what it is.
    pub known: Known,
}

/// How far simulated pictures are from real ones, before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Mismatch {
    /// What pictures look like before: 1 is as far as views differ from each other after the fit.
    pub look_start: f64,
    /// What pictures look like after.
    pub look_tuned: f64,
    /// Reprojection error before: how far corners of the scene are from where they should be seen, root mean square without
    /// outliers, pixels.
    pub corners_start_px: f64,
    /// Reprojection error after, pixels.
    pub corners_tuned_px: f64,
}

/// A camera that was tuned.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TunedCamera {
    /// The camera.
    #[serde(skip)]
    pub camera: Camera,
    /// The camera that the tuning began with.
    pub start: String,
    /// Where the "real" pictures come from.
    pub real: PictureSource,
    /// The settings.
    pub settings: Vec<TunedSetting>,
    /// Views that it was fitted to.
    pub fitted_views: Vec<String>,
    /// How far pictures of the fitted views are from the real ones.
    pub fitted: Mismatch,
    /// Views that only judged.
    pub held_out_views: Vec<String>,
    /// How far pictures of the views that only judged are from the real ones.
    pub held_out: Option<Mismatch>,
    /// How far cameras stood from where they should, mean, metres.
    pub misplaced_m: f64,
    /// How far they were turned, mean, radians.
    pub turned_rad: f64,
    /// What a reader should know.
    pub warnings: Vec<Warning>,
}

/// Standard deviation of both numbers of distortion, before anything is seen.
const DISTORTION_SD: f64 = 0.2;
/// Standard deviation of where cameras look, before anything is seen, radians.
const ANGLE_SD_RAD: f64 = 0.1;
/// Level of all intervals.
const LEVEL: f64 = 0.9;
/// An interval of this share of what was searched says nothing.
const WIDE: f64 = 0.8;

/// Finds the settings of the camera that took the pictures of a folder, starting from a camera of the scene. Pictures are paired with
/// the scene's views by name.
///
/// # Errors
/// No pictures of the scene's views, pictures of different sizes or that are too small, fewer than three views to fit, a held-out view
/// that does not exist, pictures in which the scene is not to be found.
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

    let room = Room { scene, light };
    let prior = Prior {
        place_sd_m: options.place_sd_m,
        angle_sd_rad: ANGLE_SD_RAD,
        distortion_sd: DISTORTION_SD,
        lens: true,
        sensor: false,
    };
    let (mut camera, extrinsics) = extrinsics_of(room, &start, &fitted, &prior)?;
    let (compression, quality) = compression(&start, &fitted)?;
    camera.sensor.jpeg_quality = quality;
    warnings.extend(unknown_compression(&compression, quality));
    let search = Search {
        settings: settings(&start),
        pictures: &reals_of(room, &camera, &fitted, &extrinsics)?,
        camera,
        seed: options.seed,
        budget: options.budget,
        tried: Cell::new(0),
        progress,
    };
    let found = search.run()?;
    // Now that brightness and blur are known, corners are found better, and then brightness and blur.
    let known = Prior {
        sensor: true,
        ..prior
    };
    let tuned = search.camera_at(&found.shares);
    let (tuned, extrinsics) = extrinsics_of(room, &tuned, &fitted, &known)?;
    let search = Search {
        pictures: &reals_of(room, &tuned, &fitted, &extrinsics)?,
        camera: tuned,
        ..search
    };
    let found = search.again(&found)?;
    let tuned = search.camera_at(&found.shares);
    warnings.extend(unfinished(&found, options.budget));
    tell_of_the_lens(progress, search.tried.get());
    let pictures = (&fitted[..], &extrinsics[..]);
    let bias = lens_bias(room, &tuned, pictures, &known, (options.seed, LEVEL))?;
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
    let judge =
        |own: &[&Shot]| judged(room, [&start, &camera], own, &prior, (&found, options.seed));
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

/// What is done after the search.
fn tell_of_the_lens(progress: Option<&(dyn Fn(Progress) + Sync)>, tried: usize) {
    if let Some(progress) = progress {
        progress(Progress {
            done: tried,
            total: tried,
            best: None,
            finishing: Some("looking for what is wrong of the lens"),
        });
    }
}

/// Says what was assumed where nobody can tell how pictures were compressed.
fn unknown_compression(compression: &TunedSetting, quality: Option<u8>) -> Option<Warning> {
    let as_if = match quality {
        _ if compression.known != Known::Undetermined => return None,
        Some(quality) => format!("had quality {quality}"),
        None => "were not compressed".to_owned(),
    };
    let what = format!("exposure, gain and read noise are found as if pictures {as_if}");
    Some(Code::CompressionUnknown.warning(what))
}

/// Says that a search ended by its budget.
fn unfinished(found: &sensor::Found, budget: usize) -> Option<Warning> {
    let what = format!("the search had more to try when its budget of {budget} was spent");
    (!found.is_ended).then(|| Code::Incomplete.warning(what))
}

/// How far simulated pictures are from some real ones, with the camera of before and with the tuned one; both look for where these
/// pictures were taken.
fn judged(
    room: Room<'_>,
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
        let (camera, extrinsics) = extrinsics_of(room, camera, shots, &fixed)?;
        let reals = reals_of(room, &camera, shots, &extrinsics)?;
        let rows = apart(&camera, &reals, seed, draws(&reals))?;
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

/// The verdict on an interval in shares of what was searched.
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
            "look {:.2}, now {:.2} (1: as views differ from each other); corners {:.2} px, now {:.2} px",
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
            "cameras stood {:.1} mm and looked {:.2} degrees from where they should, on average",
            1e3 * self.misplaced_m,
            self.turned_rad.to_degrees()
        )
    }
}
