//! Reads the real pictures, splits them into fitted and held-out views, and estimates where they were taken.

use std::path::PathBuf;

use rayon::prelude::*;

use super::CameraOptions;
use super::correspondence::correspondences;
use super::extrinsics::{Extrinsics, Prior, resect};
use super::look::{Parts, look};
use super::room::LitScene;
use super::sensor::Real;
use crate::camera::{Camera, luminance};
use crate::{Grey, Picture, Shots};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// A real picture.
pub(super) struct Shot {
    pub view: usize,
    pub path: PathBuf,
    pub picture: Picture,
    pub grey: Grey,
}

/// Smallest number of fitted views; intervals are computed from the variation between them.
const FEWEST_VIEWS: usize = 3;
/// With this many views or more, every third is held out to test the result.
const MANY_VIEWS: usize = 6;
/// Smallest size of a picture, pixels.
const SMALLEST: (usize, usize) = (64, 48);
/// Smallest number of corners from which the pose of a picture is estimated.
const FEWEST_CORNERS: usize = 12;
/// Reduction factors at which corners are searched for, and range of the search in reduced pixels.
const SEARCHES: [(usize, i64); 5] = [(4, 7), (2, 5), (1, 5), (1, 3), (1, 3)];
/// Pictures are not reduced if their shorter side would be below this, pixels.
const SMALL_PX: usize = 60;
/// First number of the random streams of simulated pictures, which differs from the numbers of `realgap sense picture`.
const FIRST_NUMBER: u64 = 1 << 24;

pub(super) fn read(shots: &Shots) -> Result<Vec<Shot>> {
    let mut pictures: Vec<Shot> = Vec::new();
    for (view, paths) in shots.of_view.iter().enumerate() {
        for path in paths {
            let picture = Picture::read(path)?;
            let (width, height) = (picture.width(), picture.height());
            let size = |w: usize, h: usize| format!("{w} x {h} px");
            let error = |message: &str, allowed: String| {
                let error = Error::invalid(message.to_owned()).at_file(path);
                Err(error.found(size(width, height)).allowed(allowed))
            };
            if width < SMALLEST.0 || height < SMALLEST.1 {
                let allowed = format!("at least {}", size(SMALLEST.0, SMALLEST.1));
                return error("the picture is too small to tune a camera", allowed);
            }
            if let Some(first) = pictures.first()
                && (first.grey.width(), first.grey.height()) != (width, height)
            {
                let allowed = size(first.grey.width(), first.grey.height());
                return error("the pictures of a camera must have the same size", allowed);
            }
            pictures.push(Shot {
                view,
                path: path.clone(),
                grey: picture.grey(),
                picture,
            });
        }
    }
    Ok(pictures)
}

/// The views that are fitted, and the views that are held out to test the result.
pub(super) fn split(
    names: &[&str],
    shots: &Shots,
    options: &CameraOptions,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<usize>, Vec<usize>)> {
    let there: Vec<usize> = (0..names.len())
        .filter(|v| !shots.of_view[*v].is_empty())
        .collect();
    let held: Vec<usize> = match &options.held_out {
        Some(wanted) => wanted
            .iter()
            .map(|name| {
                let found = there.iter().find(|v| names[**v] == name);
                found.copied().ok_or_else(|| {
                    let known: Vec<&str> = there.iter().map(|v| names[*v]).collect();
                    Error::invalid("there are no pictures of a view that is to be held out")
                        .field("held_out")
                        .found(name)
                        .allowed(known.join(", "))
                })
            })
            .collect::<Result<_>>()?,
        None if there.len() >= MANY_VIEWS => there.iter().copied().skip(2).step_by(3).collect(),
        None => Vec::new(),
    };
    let fitted: Vec<usize> = there
        .iter()
        .copied()
        .filter(|v| !held.contains(v))
        .collect();
    if fitted.len() < FEWEST_VIEWS {
        return Err(Error::invalid("too few views to tune a camera")
            .found(counted(fitted.len(), "view"))
            .allowed(format!("{FEWEST_VIEWS} or more, held-out ones not counted"))
            .hint("intervals are computed from the variation between views"));
    }
    if held.is_empty() {
        warnings.push(Code::FewRecordings.warning(format!(
            "{}: no view is held out to test the camera",
            counted(fitted.len(), "view")
        )));
    }
    Ok((fitted, held))
}

/// Estimates the poses of the pictures, and the lens if the prior asks for it, from reduced pictures to full size.
pub(super) fn extrinsics_of(
    lit_scene: LitScene<'_>,
    start: &Camera,
    shots: &[&Shot],
    prior: &Prior,
) -> Result<(Camera, Vec<Extrinsics>)> {
    let mut camera = start.clone();
    let mut extrinsics: Vec<Extrinsics> = shots
        .iter()
        .map(|shot| Extrinsics {
            meant: lit_scene.scene.views[shot.view].pose,
            off: [0.0; 6],
            correspondences: Vec::new(),
        })
        .collect();
    for (factor, reach) in SEARCHES {
        if factor > 1 && start.lens.height_px.min(start.lens.width_px) / factor < SMALL_PX {
            continue;
        }
        let seen: Vec<_> = shots
            .par_iter()
            .zip(&extrinsics)
            .map(|(shot, its)| {
                let sensor = prior.sensor;
                correspondences(
                    lit_scene,
                    (&camera, sensor),
                    &its.pose(),
                    &shot.grey,
                    (factor, reach),
                )
            })
            .collect::<Result<_>>()?;
        for ((its, seen), shot) in extrinsics.iter_mut().zip(seen).zip(shots) {
            if seen.len() < FEWEST_CORNERS {
                return Err(Error::invalid("the scene is not found in the picture")
                    .at_file(&shot.path)
                    .found(counted(seen.len(), "corner"))
                    .allowed(format!("{FEWEST_CORNERS} or more that agree with the scene"))
                    .hint("the position of the view, the light and the scene must be approximately right; `realgap sense picture` shows them"));
            }
            its.correspondences = seen;
        }
        camera.lens = resect(&camera.lens, &mut extrinsics, prior);
    }
    Ok((camera, extrinsics))
}

/// The real pictures with their statistics, and the simulated light at their poses.
pub(super) fn reals_of(
    lit_scene: LitScene<'_>,
    camera: &Camera,
    shots: &[&Shot],
    extrinsics: &[Extrinsics],
) -> Result<Vec<Real>> {
    shots
        .par_iter()
        .zip(extrinsics)
        .enumerate()
        .map(|(index, (shot, its))| {
            let light = luminance(lit_scene.scene, camera, &its.pose(), lit_scene.light);
            let parts = Parts::new(&light)?;
            Ok(Real {
                found: look(&shot.picture, &parts),
                light,
                parts,
                view: shot.view,
                number: FIRST_NUMBER + index as u64,
            })
        })
        .collect()
}
