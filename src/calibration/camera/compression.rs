//! With which quality a picture was compressed before: it changes less when it is compressed with that one again (Farid 2009,
//! "Exposing digital forgeries from JPEG ghosts").

use crate::error::Result;
use crate::sensing::vision::Picture;

/// The part of a picture that is compressed again, at most, pixels: whole blocks of two times eight.
const PART: (usize, usize) = (320, 240);
/// Qualities that are tried.
const QUALITIES: std::ops::RangeInclusive<u8> = 5..=99;
/// Neighbours on either side that a quality is held against, and the share of their change below which it stands out.
const NEIGHBOURS: usize = 2;
const STANDS_OUT: f64 = 0.75;

/// The quality; `None` where none stands out.
pub(super) fn quality(picture: &Picture) -> Result<Option<u8>> {
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
    let inner = NEIGHBOURS..changes.len() - NEIGHBOURS;
    let best = inner.min_by(|a, b| share(*a).total_cmp(&share(*b)));
    Ok(best
        .filter(|index| share(*index) < STANDS_OUT)
        .map(|index| QUALITIES.start() + index as u8))
}
