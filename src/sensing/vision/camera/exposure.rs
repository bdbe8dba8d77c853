//! From light to bytes: photons are counted, read with noise, amplified, cut off, rounded and compressed.

use rand_distr::{Distribution, StandardNormal};

use super::super::picture::{Grey, Picture};
use crate::error::Result;
use crate::random::Numbered;

/// A sensor and how it is exposed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Time of exposure, seconds.
    pub exposure_s: f64,
    /// Electrons in a second for one candela per square metre, each colour.
    pub electrons_per_cd_s: f64,
    /// Electrons that a pixel holds; more is white.
    pub full_well_e: f64,
    /// Standard deviation of what reading adds, electrons.
    pub read_noise_e: f64,
    /// Amplification: with 1, a full pixel is white.
    pub gain: f64,
    /// The camera raises the gain up to this where the picture would be dark; `gain` or less for never.
    pub most_gain: f64,
    /// Quality of the JPEG compression, 1 to 100; `None` for none.
    pub jpeg_quality: Option<u8>,
}

/// Share of white that automatic gain makes the mean of a picture.
const AIM: f64 = 0.3;

/// sRGB: half of the light is more than half of the value.
fn encoded(share: f64) -> u8 {
    let share = share.clamp(0.0, 1.0);
    let value = if share <= 0.003_130_8 {
        12.92 * share
    } else {
        1.055 * share.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * value).round() as u8
}

impl Sensor {
    /// The picture of this light (candela per square metre: red, green, blue). Photons are drawn normally, which differs from
    /// Poisson's below about twenty of them. Every row has its own stream, so that threads do not matter.
    pub(super) fn picture(&self, light: &[Grey; 3], seed: u64, number: u64) -> Result<Picture> {
        let (width, height) = (light[0].width(), light[0].height());
        let per_light = self.exposure_s * self.electrons_per_cd_s;
        let sum: f64 = light
            .iter()
            .flat_map(|plane| plane.values())
            .map(|v| f64::from(*v))
            .sum();
        let mean_e = per_light * sum / (3 * width * height) as f64;
        let wanted = AIM * self.full_well_e / mean_e.max(1e-9);
        let gain = wanted.min(self.most_gain).max(self.gain);
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            let mut rng = Numbered::PictureNoise.generator(seed, (number << 32) + y as u64);
            for x in 0..width {
                for plane in light {
                    let electrons = per_light * f64::from(plane.values()[y * width + x]);
                    let noise: f64 = StandardNormal.sample(&mut rng);
                    let sd = (electrons + self.read_noise_e * self.read_noise_e).sqrt();
                    rgb.push(encoded((electrons + sd * noise) * gain / self.full_well_e));
                }
            }
        }
        let picture = Picture::new(width, height, rgb)?;
        match self.jpeg_quality {
            None => Ok(picture),
            Some(quality) => Picture::decode(&picture.to_jpeg(quality)?),
        }
    }
}
