//! With which quality a picture was compressed before: it changes less when it is compressed with that one again (Farid 2009,
//! "Exposing digital forgeries from JPEG ghosts").

use rayon::prelude::*;

use super::shot::Shot;
use super::{Known, TunedSetting};
use crate::Picture;
use crate::camera::Camera;
use realgap_core::error::Result;

/// The part of a picture that is compressed again, at most, pixels: whole blocks of two times eight.
const PART: (usize, usize) = (320, 240);
/// Qualities that are tried.
const QUALITIES: std::ops::RangeInclusive<u8> = 5..=99;
/// Neighbours on either side that a quality is held against, and the share of their change below which it stands out.
const NEIGHBOURS: usize = 2;
const STANDS_OUT: f64 = 0.75;
/// The same for all pictures together, in which chance counts less.
const STANDS_OUT_TOGETHER: f64 = 0.9;

/// How much less than its neighbours each quality changes a picture: 1 for alike, 0 for not at all.
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
            let apart = grey.values().iter().zip(again.values());
            let squares: f64 = apart.map(|(a, b)| f64::from(a - b).powi(2)).sum();
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

/// The quality; `None` where none stands out.
fn quality(shares: &[f64], stands_out: f64) -> Option<u8> {
    let best = (0..shares.len()).min_by(|a, b| shares[*a].total_cmp(&shares[*b]))?;
    let first = usize::from(*QUALITIES.start()) + NEIGHBOURS;
    (shares[best] < stands_out).then_some((first + best) as u8)
}

/// The quality that all pictures together say: that of the geometric mean of their shares. `None` unless it stays the same whichever
/// picture is left out.
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

/// The quality of compression: from the lowest to the highest that most pictures have, or the one that all have together. Where
/// neither is found it stays as it was.
pub(super) fn compression(start: &Camera, shots: &[&Shot]) -> Result<(TunedSetting, Option<u8>)> {
    let shares: Vec<Vec<f64>> = shots
        .par_iter()
        .map(|shot| shares(&shot.picture))
        .collect::<Result<_>>()?;
    let each = shares.iter().filter_map(|own| quality(own, STANDS_OUT));
    let mut found: Vec<u8> = each.collect();
    // A few pictures without anything fine in them do not tell.
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

    /// Six small pictures of the shipped room.
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
    fn a_quality_is_found_in_all_pictures_together_and_none_in_pictures_that_were_never_compressed()
    {
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
