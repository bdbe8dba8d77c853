//! Reads and writes cameras as RON, inside of a scene file or as a separate file.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::exposure::Sensor;
use super::lens::Lens;
use super::reader::Reader;
use super::scene::Camera;
use realgap_core::error::Result;
use realgap_core::file::{Source, parse_ron, write_ron};

/// A camera as its file states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Camera")]
pub struct CameraFile {
    /// Whether the camera stands in for a real one; its pictures are labelled as such.
    #[serde(default)]
    stand_in: bool,
    /// Number of columns and rows.
    #[serde(default = "resolution")]
    resolution_px: (usize, usize),
    /// Horizontal field of view of the pinhole, degrees.
    #[serde(default = "field_of_view")]
    field_of_view_deg: f64,
    /// First and second coefficient of radial distortion.
    #[serde(default)]
    distortion: [f64; 2],
    /// Standard deviation of the blur of the lens, pixels.
    #[serde(default)]
    blur_px: f64,
    /// Exposure time, seconds.
    exposure_s: f64,
    /// Electrons per second for a luminance of one candela per square metre, for each colour.
    electrons_per_cd_s: f64,
    /// Full-well capacity: electrons at which a pixel is white with gain 1.
    #[serde(default = "full_well")]
    full_well_e: f64,
    /// Standard deviation of the read noise, electrons.
    #[serde(default)]
    read_noise_e: f64,
    /// Gain; with 1, a full pixel is white.
    #[serde(default = "one")]
    gain: f64,
    /// Largest gain of the automatic gain control, which the camera uses for dark pictures; 0, or a value up to `gain`, turns it off.
    #[serde(default)]
    most_gain: f64,
    /// Quality of the JPEG compression, 1 to 100; optional, without it there is no compression.
    #[serde(default)]
    jpeg_quality: Option<u8>,
    /// Standard deviation of the camera's position, for each axis, metres.
    #[serde(default)]
    place_sd_m: f64,
    /// Standard deviation of the camera's orientation, for each axis, degrees.
    #[serde(default)]
    angle_sd_deg: f64,
    /// Speed at which the camera turns during the exposure, to the right and down, degrees per second.
    #[serde(default)]
    turning_deg_s: [f64; 2],
}

fn resolution() -> (usize, usize) {
    (640, 480)
}

fn field_of_view() -> f64 {
    60.0
}

fn full_well() -> f64 {
    10_000.0
}

fn one() -> f64 {
    1.0
}

/// Largest number of pixels of a camera.
const MOST_PIXELS: usize = 16_000_000;

impl CameraFile {
    pub(super) fn camera(&self, reader: &Reader<'_>, before: &str, name: String) -> Result<Camera> {
        let at = |field: &str| format!("{before}{field}");
        let (width_px, height_px) = self.resolution_px;
        let pixels = width_px.saturating_mul(height_px);
        if !(1..=MOST_PIXELS).contains(&pixels) {
            let found = format!("{width_px} x {height_px}");
            return Err(reader.wrong(
                &at("resolution_px"),
                "not a resolution",
                found,
                "one pixel to 16 megapixels",
            ));
        }
        if self.jpeg_quality.is_some_and(|q| !(1..=100).contains(&q)) {
            let found = self.jpeg_quality.unwrap_or_default();
            return Err(reader.wrong(&at("jpeg_quality"), "not a quality", found, "1 to 100"));
        }
        let [[k1, k2], [right, down]] = [self.distortion, self.turning_deg_s];
        let rate = "degrees per second";
        for (field, value, low, high, unit) in [
            (
                "field_of_view_deg",
                self.field_of_view_deg,
                1.0,
                150.0,
                "degrees",
            ),
            ("distortion", k1, -0.5, 0.5, ""),
            ("distortion", k2, -0.5, 0.5, ""),
            ("turning_deg_s", right, -720.0, 720.0, rate),
            ("turning_deg_s", down, -720.0, 720.0, rate),
            ("blur_px", self.blur_px, 0.0, 20.0, "px"),
            ("exposure_s", self.exposure_s, 1e-6, 10.0, "s"),
            ("electrons_per_cd_s", self.electrons_per_cd_s, 1e-3, 1e9, ""),
            ("full_well_e", self.full_well_e, 1.0, 1e9, "electrons"),
            ("read_noise_e", self.read_noise_e, 0.0, 1e6, "electrons"),
            ("gain", self.gain, 1e-3, 1e4, ""),
            ("most_gain", self.most_gain, 0.0, 1e4, ""),
            ("place_sd_m", self.place_sd_m, 0.0, 1.0, "m"),
            ("angle_sd_deg", self.angle_sd_deg, 0.0, 20.0, "degrees"),
        ] {
            reader.within(&at(field), value, low, high, unit)?;
        }
        Ok(Camera {
            is_stand_in: self.stand_in,
            lens: Lens {
                width_px,
                height_px,
                field_of_view_rad: self.field_of_view_deg.to_radians(),
                distortion: self.distortion,
                blur_px: self.blur_px,
            },
            sensor: Sensor {
                exposure_s: self.exposure_s,
                electrons_per_cd_s: self.electrons_per_cd_s,
                full_well_e: self.full_well_e,
                read_noise_e: self.read_noise_e,
                gain: self.gain,
                most_gain: self.most_gain,
                jpeg_quality: self.jpeg_quality,
            },
            place_sd_m: self.place_sd_m,
            angle_sd_rad: self.angle_sd_deg.to_radians(),
            turning_rad_s: self.turning_deg_s.map(f64::to_radians),
            name,
        })
    }
}

impl Camera {
    /// Reads a camera from a separate file; the name of the camera is that of the file.
    ///
    /// # Errors
    /// A missing file, anything that is not a camera, values out of range.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let source = Source::read(path, "camera")?;
        let file: CameraFile = parse_ron(&source)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        file.camera(&Reader(&source), "", name.into_owned())
    }

    /// The text of a camera file.
    ///
    /// # Errors
    /// None.
    pub fn to_ron(&self) -> Result<String> {
        write_ron(&CameraFile {
            stand_in: self.is_stand_in,
            resolution_px: (self.lens.width_px, self.lens.height_px),
            field_of_view_deg: self.lens.field_of_view_rad.to_degrees(),
            distortion: self.lens.distortion,
            blur_px: self.lens.blur_px,
            exposure_s: self.sensor.exposure_s,
            electrons_per_cd_s: self.sensor.electrons_per_cd_s,
            full_well_e: self.sensor.full_well_e,
            read_noise_e: self.sensor.read_noise_e,
            gain: self.sensor.gain,
            most_gain: self.sensor.most_gain,
            jpeg_quality: self.sensor.jpeg_quality,
            place_sd_m: self.place_sd_m,
            angle_sd_deg: self.angle_sd_rad.to_degrees(),
            turning_deg_s: self.turning_rad_s.map(f64::to_degrees),
        })
    }
}
