//! The image sensor: converts light to bytes with photon noise, read noise, gain, saturation, rounding and compression.

use std::sync::LazyLock;

use rand_distr::{Distribution, StandardNormal};

use super::super::picture::{Grey, Picture};
use realgap_core::error::Result;
use realgap_core::random::Numbered;

/// An image sensor with its exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Exposure time, seconds.
    pub exposure_s: f64,
    /// Electrons per second for a luminance of one candela per square metre, for each colour.
    pub electrons_per_cd_s: f64,
    /// Full-well capacity: electrons at which a pixel is white with gain 1.
    pub full_well_e: f64,
    /// Standard deviation of the read noise, electrons.
    pub read_noise_e: f64,
    /// Gain; with 1, a full pixel is white.
    pub gain: f64,
    /// Largest gain of the automatic gain control, which the camera uses for dark pictures; 0, or a value up to `gain`, turns it off.
    pub most_gain: f64,
    /// Quality of the JPEG compression, 1 to 100; `None` for no compression.
    pub jpeg_quality: Option<u8>,
}

/// Mean of a picture, as a share of white, at which automatic gain control aims.
const AIM: f64 = 0.3;

/// The transfer function of sRGB.
fn curve(share: f64) -> f64 {
    if share <= 0.003_130_8 {
        12.92 * share
    } else {
        1.055 * share.powf(1.0 / 2.4) - 0.055
    }
}

fn encoded(share: f64) -> u8 {
    (255.0 * curve(share)).round() as u8
}

/// Number of intervals into which [`Encoding`] divides the light from black to white.
const PIECES: usize = 4096;

/// A lookup table for [`encoded`]: the light at which each value begins, and the value at the beginning of each interval.
struct Encoding {
    begins: [f64; 257],
    of_piece: Vec<u8>,
}

impl Encoding {
    fn new() -> Self {
        let mut begins = [f64::INFINITY; 257];
        for (value, begin) in begins.iter_mut().enumerate().take(256) {
            // The bits of neighbouring positive floats are consecutive integers, so a bisection over bits is exact.
            let (mut low, mut high) = (0.0_f64.to_bits(), 1.0_f64.to_bits());
            while low < high {
                let middle = low + (high - low) / 2;
                if usize::from(encoded(f64::from_bits(middle))) >= value {
                    high = middle;
                } else {
                    low = middle + 1;
                }
            }
            *begin = f64::from_bits(low);
        }
        let of_piece = (0..=PIECES).map(|piece| encoded(piece as f64 / PIECES as f64));
        Self {
            begins,
            of_piece: of_piece.collect(),
        }
    }

    fn of(&self, share: f64) -> u8 {
        let share = share.clamp(0.0, 1.0);
        let mut value = self.of_piece[(share * PIECES as f64) as usize];
        while share >= self.begins[usize::from(value) + 1] {
            value += 1;
        }
        value
    }
}

static ENCODING: LazyLock<Encoding> = LazyLock::new(Encoding::new);

impl Sensor {
    /// The gain for this light, including automatic gain control.
    fn gain_for(&self, light: &[Grey; 3]) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for value in light.iter().flat_map(|plane| plane.values()) {
            sum += f64::from(*value);
            count += 1;
        }
        let mean_e = self.exposure_s * self.electrons_per_cd_s * sum / count as f64;
        let wanted = AIM * self.full_well_e / mean_e.max(1e-9);
        wanted.min(self.most_gain).max(self.gain)
    }

    /// The picture of this light without noise, rounding and compression. It is about the mean of many pictures; the difference is due
    /// to the nonlinearity of the transfer function and to saturation.
    pub fn calm(&self, light: &[Grey; 3]) -> [Grey; 3] {
        let factor =
            self.exposure_s * self.electrons_per_cd_s * self.gain_for(light) / self.full_well_e;
        light.each_ref().map(|plane| {
            plane.map(|value| curve((f64::from(value) * factor).clamp(0.0, 1.0)) as f32)
        })
    }

    /// The picture of this light (candela per square metre: red, green, blue). Photon noise is drawn from a normal distribution, which
    /// differs from a Poisson distribution below about twenty photons. Every row has its own stream of random numbers, so that the
    /// result does not depend on threads.
    pub fn picture(&self, light: &[Grey; 3], seed: u64, number: u64) -> Result<Picture> {
        let (width, height) = (light[0].width(), light[0].height());
        let per_light = self.exposure_s * self.electrons_per_cd_s;
        let gain = self.gain_for(light);
        let encoding = &*ENCODING;
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            let mut rng = Numbered::PictureNoise.generator(seed, (number << 32) + y as u64);
            for x in 0..width {
                for plane in light {
                    let electrons = per_light * f64::from(plane.values()[y * width + x]);
                    let noise: f64 = StandardNormal.sample(&mut rng);
                    let sd = (electrons + self.read_noise_e * self.read_noise_e).sqrt();
                    rgb.push(encoding.of((electrons + sd * noise) * gain / self.full_well_e));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lookup_table_agrees_with_the_formula() {
        let encoding = Encoding::new();
        for k in 0..=1_000_000 {
            let share = f64::from(k) / 1e6;
            assert_eq!(encoding.of(share), encoded(share), "{share}");
        }
        // Test the smallest light of each value, and the float just below it.
        for value in 1..=255_u8 {
            let begin = encoding.begins[usize::from(value)];
            assert_eq!(encoding.of(begin), value);
            assert_eq!(encoding.of(begin.next_down()), value - 1);
        }
        assert_eq!((encoding.of(-1.0), encoding.of(7.0)), (0, 255));
        assert_eq!(encoding.of(f64::NAN), 0);
    }
}
