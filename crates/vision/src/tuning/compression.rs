//! Estimates the JPEG quality with which pictures were compressed.
//!
//! A picture changes less if it is compressed again with the same quality as before (Farid 2009, "Exposing digital forgeries from JPEG
//! ghosts").

use rayon::prelude::*;

use super::shot::Shot;
use super::{Known, TunedSetting};
use crate::Picture;
use crate::camera::Camera;
use realgap_core::error::Result;

/// Largest part of a picture that is compressed again, pixels; it consists of whole blocks of two times eight pixels.
const PART: (usize, usize) = (320, 240);
/// The qualities that are tried.
const QUALITIES: std::ops::RangeInclusive<u8> = 5..=99;
/// Number of neighbouring qualities on either side with which a quality is compared, and the share of their change below which a
/// quality counts as found in one picture.
const NEIGHBOURS: usize = 2;
const STANDS_OUT: f64 = 0.75;
/// The same limit for the mean over all pictures, which has less random variation.
const STANDS_OUT_TOGETHER: f64 = 0.9;

/// For each quality, the change of a picture divided by the smallest change with neighbouring qualities: 1 if the changes are equal, 0
/// if this quality does not change the picture.
fn shares(picture: &Picture) -> Result<Vec<f64>> {
    let whole = |side: usize, most: usize| match side.min(most) / 16 * 16 {
        0 => side,
        blocks => blocks,
    };
    let width = whole(picture.width(), PART.0);
    let height = whole(picture.height(), PART.1);
    let rows = picture.rgb().chunks_exact(3 * picture.width()).take(height);
    let part: Vec<u8> = rows
        .flat_map(|row| row[..3 * width].iter().copied())
        .collect();
    let part = Picture::new(width, height, part)?;
    let grey = part.grey();
    let changes: Vec<f64> = QUALITIES
        .map(|quality| {
            let again = Picture::decode(&part.to_jpeg(quality)?)?.grey();
            let pairs = grey.values().iter().zip(again.values());
            let squares: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
            Ok((squares / (width * height) as f64).sqrt())
        })
        .collect::<Result<_>>()?;
    let share = |index: usize| {
        let beside: Vec<f64> = (index - NEIGHBOURS..=index + NEIGHBOURS)
            .filter(|other| *other != index)
            .map(|other| changes[other])
            .collect();
        changes[index]
            / beside
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min)
                .max(1e-9)
    };
    Ok((NEIGHBOURS..changes.len() - NEIGHBOURS)
        .map(share)
        .collect())
}

/// The quality with the smallest change; `None` if its change is not below the limit.
fn quality(shares: &[f64], stands_out: f64) -> Option<u8> {
    let best = (0..shares.len()).min_by(|a, b| shares[*a].total_cmp(&shares[*b]))?;
    let first = usize::from(*QUALITIES.start()) + NEIGHBOURS;
    (shares[best] < stands_out).then_some((first + best) as u8)
}

/// The quality from the geometric mean of the changes of all pictures. `None` unless it stays the same if any one picture is left
/// out.
fn together(all: &[Vec<f64>]) -> Option<u8> {
    let without = |left_out: Option<usize>| {
        let own = || {
            let own = all.iter().enumerate();
            own.filter(move |(index, _)| Some(*index) != left_out)
        };
        let places = 0..all.first().map_or(0, Vec::len);
        let logs = places.map(|k| {
            own()
                .map(|(_, own)| libm::log(own[k].max(1e-9)))
                .sum::<f64>()
        });
        let count = own().count().max(1) as f64;
        let shares: Vec<f64> = logs.map(|log| libm::exp(log / count)).collect();
        quality(&shares, STANDS_OUT_TOGETHER)
    };
    let best = without(None)?;
    let is_same = (0..all.len()).all(|index| without(Some(index)) == Some(best));
    is_same.then_some(best)
}

/// The quality of compression with its interval: from the qualities found in single pictures if most of them have one, otherwise from
/// all pictures together. If neither is found, the setting of the start is kept.
pub(super) fn compression(start: &Camera, shots: &[&Shot]) -> Result<(TunedSetting, Option<u8>)> {
    let shares: Vec<Vec<f64>> = shots
        .par_iter()
        .map(|shot| shares(&shot.picture))
        .collect::<Result<_>>()?;
    let each = shares.iter().filter_map(|own| quality(own, STANDS_OUT));
    let mut found: Vec<u8> = each.collect();
    // If a quality is found in half of the pictures or fewer, all pictures are evaluated together.
    if 2 * found.len() <= shares.len() {
        found = together(&shares).into_iter().collect();
    }
    found.sort_unstable();
    let before = start.sensor.jpeg_quality;
    let mut setting = TunedSetting {
        name: "jpeg_quality",
        unit: "",
        start: before.map_or(100.0, f64::from),
        value: before.map_or(100.0, f64::from),
        low: 1.0,
        high: 100.0,
        searched: (1.0, 100.0),
        known: Known::Undetermined,
    };
    if found.is_empty() {
        return Ok((setting, before));
    }
    let middle = found[found.len() / 2];
    let tail = |share: f64| f64::from(found[(share * (found.len() - 1) as f64).round() as usize]);
    setting.value = f64::from(middle);
    (setting.low, setting.high) = (tail(0.05) - 0.5, tail(0.95) + 0.5);
    setting.known = Known::Determined;
    Ok((setting, Some(middle)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::take;

    /// Six small pictures of the shipped scene of a room.
    fn pictures(jpeg_quality: Option<u8>, read_noise_e: f64, seed: u64) -> Vec<Picture> {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/room.ron");
        let scene = crate::camera::Scene::read(path).unwrap();
        let mut camera = scene.camera("model").unwrap().clone();
        (camera.lens.width_px, camera.lens.height_px) = (160, 120);
        camera.sensor.read_noise_e = read_noise_e;
        camera.sensor.jpeg_quality = jpeg_quality;
        let views = scene.views.iter().take(6).zip(0..);
        views
            .map(|(view, number)| {
                let light = &scene.lights[1];
                let (picture, _) = take(&scene, &camera, view, light, seed, 1000 * number).unwrap();
                picture
            })
            .collect()
    }

    fn found(pictures: &[Picture]) -> (usize, Option<u8>) {
        let all: Vec<Vec<f64>> = pictures.iter().map(|p| shares(p).unwrap()).collect();
        let each = all.iter().filter(|own| quality(own, STANDS_OUT).is_some());
        (each.count(), together(&all))
    }

    #[test]
    fn the_quality_is_found_in_compressed_pictures_and_none_in_pictures_without_compression() {
        for (seed, read_noise_e) in [(1, 2.0), (2, 15.0), (3, 40.0)] {
            let never = found(&pictures(None, read_noise_e, seed));
            assert_eq!(never, (0, None), "{read_noise_e}");
            for quality in [60, 74, 95] {
                let (_, together) = found(&pictures(Some(quality), read_noise_e, seed));
                assert_eq!(together, Some(quality), "{read_noise_e}");
            }
        }
    }
}
