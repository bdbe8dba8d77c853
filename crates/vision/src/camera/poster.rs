//! The pictures that posters show.

use std::sync::Arc;

use super::super::lettering::print_text;
use super::super::picture::Grey;
use realgap_core::error::{Error, Result};

/// The picture of a poster.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Motif {
    /// A logo of three bars, a ring and a corner, which differs from everything else and from itself after any rotation.
    Logo,
    /// A dark disc.
    Disc,
    /// The outline of a bottle, filled.
    Bottle,
    /// Printed text.
    Text(String),
}

/// Side of a drawn motif and size of letters, pixels; additional space between letters, in multiples of their size.
const SIDE: usize = 384;
const LETTER_PX: f64 = 72.0;
const TRACKING_EM: f64 = 0.1;

/// The picture of a poster in several sizes, each half of the one before, because distant posters need less resolution.
#[derive(Debug, Clone)]
pub(super) struct Texture {
    levels: Arc<Vec<Grey>>,
}

impl Texture {
    pub(super) fn new(motif: &Motif) -> Result<Self> {
        let mut levels = vec![motif.picture()?];
        while let Some(last) = levels.last().filter(|l| l.width().min(l.height()) > 8) {
            levels.push(last.resized(last.width().div_ceil(2), last.height().div_ceil(2)));
        }
        Ok(Self {
            levels: Arc::new(levels),
        })
    }

    /// Ratio of width to height.
    pub(super) fn shape(&self) -> f64 {
        self.levels[0].width() as f64 / self.levels[0].height() as f64
    }

    /// The value at a position (−1 to 1 to the right and down), for samples with this spacing (in the same unit).
    pub(super) fn at(&self, u: f64, v: f64, spacing: f64) -> f64 {
        let pixels = 0.5 * spacing * self.levels[0].width() as f64;
        let level = (pixels.max(1.0).log2().round() as usize).min(self.levels.len() - 1);
        let grey = &self.levels[level];
        let place = |share: f64, side: usize| 0.5 * (share + 1.0) * side as f64 - 0.5;
        f64::from(grey.between(place(u, grey.width()), place(v, grey.height())))
    }
}

/// Half the width of the bottle at a height (−1 at the top, 1 at the bottom of the poster); `None` above and below the bottle.
fn bottle(v: f64) -> Option<f64> {
    let smooth = |from: f64, to: f64, share: f64| {
        let s = share.clamp(0.0, 1.0);
        from + (to - from) * s * s * (3.0 - 2.0 * s)
    };
    match v {
        v if !(-0.8..=0.8).contains(&v) => None,
        v if v < -0.35 => Some(smooth(0.11, 0.13, (v + 0.8) / 0.45)),
        v if v < 0.0 => Some(smooth(0.13, 0.32, (v + 0.35) / 0.35)),
        v if v > 0.7 => Some(0.32 - 0.1 * ((v - 0.7) / 0.1).powi(2)),
        _ => Some(0.32),
    }
}

/// Radius of the disc.
const DISC: f64 = 0.55;

impl Motif {
    /// Name of the motif in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Logo => "logo",
            Self::Disc => "disc",
            Self::Bottle => "bottle",
            Self::Text(_) => "text",
        }
    }

    /// The picture of the motif; white paper is 1.
    ///
    /// # Errors
    /// Text that is too long for a picture.
    pub fn picture(&self) -> Result<Grey> {
        if let Self::Text(text) = self {
            if text.trim().is_empty() {
                return Err(Error::invalid("a poster of text needs text").field("motif"));
            }
            return print_text(text, LETTER_PX, TRACKING_EM);
        }
        // Each pixel is the mean of 4 x 4 samples, so that borders are smooth.
        Ok(Grey::from_fn(SIDE, SIDE, |x, y| {
            let mut sum = 0.0;
            for part in 0..16 {
                let place = |pixel: usize, sub: usize| {
                    2.0 * (pixel as f64 + (sub as f64 + 0.5) / 4.0) / SIDE as f64 - 1.0
                };
                sum += self.tone(place(x, part % 4), place(y, part / 4));
            }
            (sum / 16.0) as f32
        }))
    }

    fn tone(&self, u: f64, v: f64) -> f64 {
        let paper = 0.95;
        match self {
            Self::Disc if u.hypot(v) <= DISC => 0.12,
            Self::Bottle if bottle(v).is_some_and(|half| u.abs() <= half) => 0.15,
            Self::Logo => {
                let ring = ((u + 0.25).hypot(v + 0.2) - 0.42).abs() < 0.1;
                let bar = u > 0.35
                    && u < 0.85
                    && [-0.7, -0.3, 0.1]
                        .iter()
                        .any(|top| (*top..*top + 0.22).contains(&v));
                let corner = v > 0.45 && v < 0.85 && u > -0.85 && u - v < -0.1;
                match (ring, bar, corner) {
                    (true, _, _) => 0.1,
                    (_, true, _) => 0.4,
                    (_, _, true) => 0.2,
                    _ => paper,
                }
            }
            _ => paper,
        }
    }

    /// Points on the outline of a disc or bottle, −1 to 1 to the right and down, clockwise; empty for other motifs.
    pub(super) fn outline(&self, points: usize) -> Vec<[f64; 2]> {
        match self {
            Self::Disc => (0..points)
                .map(|k| {
                    let (sin, cos) = (k as f64 / points as f64 * std::f64::consts::TAU).sin_cos();
                    [DISC * cos, DISC * sin]
                })
                .collect(),
            Self::Bottle => {
                let half = points.div_ceil(2).max(2);
                let right = (0..half).filter_map(|k| {
                    let v = -0.8 + 1.6 * k as f64 / (half - 1) as f64;
                    bottle(v.min(0.8)).map(|u| [u, v.min(0.8)])
                });
                let right: Vec<[f64; 2]> = right.collect();
                let left = right.iter().rev().map(|p| [-p[0], p[1]]);
                right.iter().copied().chain(left).collect()
            }
            _ => Vec::new(),
        }
    }
}
