//! The real pictures, and where they were taken.

use std::path::PathBuf;

use rayon::prelude::*;

use super::CameraOptions;
use super::correspondence::correspondences;
use super::extrinsics::{Extrinsics, Prior, resect};
use super::look::{Parts, look};
use super::room::Room;
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

/// Fewest views that are fitted: intervals are by how much these differ.
const FEWEST_VIEWS: usize = 3;
/// From so many on, every third is left out to judge.
const MANY_VIEWS: usize = 6;
/// Smallest picture, pixels.
const SMALLEST: (usize, usize) = (64, 48);
/// Fewest corners in a picture that say where it was taken.
const FEWEST_CORNERS: usize = 12;
/// Sizes in which corners are sought, and how far, pixels of that size.
const SEARCHES: [(usize, i64); 5] = [(4, 7), (2, 5), (1, 5), (1, 3), (1, 3)];
/// Sides below this are not made smaller, pixels.
const SMALL_PX: usize = 60;
/// Noise of simulated pictures begins here, far from the numbers of `realgap sense picture`.
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
                return error("one camera takes pictures of one size", allowed);
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

/// Views that are fitted and views that only judge.
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
                    Error::invalid("no pictures of a view that is to be held out")
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
            .hint("intervals are by how much views differ"));
    }
    if held.is_empty() {
        warnings.push(Code::FewRecordings.warning(format!(
            "{}: nothing is held out to judge the camera",
            counted(fitted.len(), "view")
        )));
    }
    Ok((fitted, held))
}

/// Where pictures were taken, and with what lens, if that is asked for: from small pictures to large ones.
pub(super) fn extrinsics_of(
    room: Room<'_>,
    start: &Camera,
    shots: &[&Shot],
    prior: &Prior,
) -> Result<(Camera, Vec<Extrinsics>)> {
    let mut camera = start.clone();
    let mut extrinsics: Vec<Extrinsics> = shots
        .iter()
        .map(|shot| Extrinsics {
            meant: room.scene.views[shot.view].pose,
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
                    room,
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
                    .allowed(format!("{FEWEST_CORNERS} or more that look as in the scene"))
                    .hint("the view's place, the light and the scene have to be about right; `realgap sense picture` shows them"));
            }
            its.correspondences = seen;
        }
        camera.lens = resect(&camera.lens, &mut extrinsics, prior);
    }
    Ok((camera, extrinsics))
}

pub(super) fn reals_of(
    room: Room<'_>,
    camera: &Camera,
    shots: &[&Shot],
    extrinsics: &[Extrinsics],
) -> Result<Vec<Real>> {
    shots
        .par_iter()
        .zip(extrinsics)
        .enumerate()
        .map(|(index, (shot, its))| {
            let light = luminance(room.scene, camera, &its.pose(), room.light);
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
