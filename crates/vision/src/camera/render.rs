//! Renders a scene to a picture.
//!
//! One ray is cast through every pixel. If neighbouring pixels show different objects or differ in illuminance, the pixel is
//! divided. On posters only their texture is sampled several times within a pixel, because the illuminance hardly changes within it.

use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::super::filter::gauss;
use super::super::picture::{Grey, Picture};
use super::cast::{BEFORE_M, Caster, Hit, Thing, meet_poster};
use super::face::tone;
use super::lens::Pose;
use super::scene::{Camera, Faces, Light, Scene, View};
use super::vector::{Vector, add, dot, less, times};
use realgap_core::error::Result;
use realgap_core::random::Numbered;

/// Number of rays of a divided pixel along each side.
const PARTS: usize = 3;
/// Number of samples of a poster's texture within a pixel along each side.
const PLACES: usize = 2;
/// A pixel is divided if its illuminance differs from that of a neighbour by this share.
const CONTRAST: f64 = 0.1;
/// Smallest distance of a displaced camera from walls, metres.
const FROM_WALLS_M: f64 = 0.02;

/// Lower limit of the cosine of the angle of incidence for the spacing of rays on a face.
const LEAST_SLOPE: f64 = 0.2;

/// The result of the ray through a pixel.
#[derive(Clone, Copy)]
struct Seen {
    thing: Thing,
    /// Illuminance, lux.
    lux: f64,
    /// Reflectance for red, green and blue.
    colour: Vector,
}

/// A camera at a pose in a scene with a light.
struct Renderer<'a> {
    scene: &'a Scene,
    caster: Caster<'a>,
    light: &'a Light,
    camera: &'a Camera,
    pose: Pose,
}

/// Takes a picture. `number` is the number of the picture: with the same seed, every number has its own noise and its own random
/// displacement of the camera. The second value is the pose of the camera.
///
/// # Errors
/// None for scenes that could be read.
pub fn take(
    scene: &Scene,
    camera: &Camera,
    view: &View,
    light: &Light,
    seed: u64,
    number: u64,
) -> Result<(Picture, Pose)> {
    let pose = placed(scene, camera, view, seed, number);
    let planes = luminance(scene, camera, &pose, light);
    Ok((expose(camera, &planes, seed, number)?, pose))
}

/// The luminance of every pixel from a pose, candela per square metre: red, green, blue; without blur and motion blur.
pub fn luminance(scene: &Scene, camera: &Camera, pose: &Pose, light: &Light) -> [Grey; 3] {
    let renderer = Renderer {
        scene,
        caster: Caster::new(scene),
        light,
        camera,
        pose: *pose,
    };
    renderer.light()
}

/// The picture that a camera takes of this light: blur, motion blur, noise, and conversion to bytes. `number` is the number of the
/// picture, as in [`take`].
///
/// # Errors
/// None for planes of one size.
pub fn expose(camera: &Camera, light: &[Grey; 3], seed: u64, number: u64) -> Result<Picture> {
    camera.sensor.picture(&focused(camera, light), seed, number)
}

/// The light on the sensor: blurred by the lens, and by the turning of the camera.
pub fn focused(camera: &Camera, light: &[Grey; 3]) -> [Grey; 3] {
    let shift = camera
        .turning_rad_s
        .map(|speed| speed * camera.sensor.exposure_s * camera.lens.focal_px());
    [0, 1, 2].map(|i| moved(&gauss(&light[i], camera.lens.blur_px), shift))
}

/// The points of the scene that the rays through some positions of a picture hit, metres.
pub fn met_m(scene: &Scene, camera: &Camera, pose: &Pose, places_px: &[[f64; 2]]) -> Vec<Vector> {
    let caster = Caster::new(scene);
    let met = |[x, y]: &[f64; 2]| {
        let direction = pose.direction(camera.lens.slope(*x, *y));
        let hit = caster.first(pose.place_m, direction);
        add(pose.place_m, times(direction, hit.distance_m))
    };
    places_px.iter().map(met).collect()
}

/// The pose of the camera after its random displacement.
pub(super) fn placed(scene: &Scene, camera: &Camera, view: &View, seed: u64, number: u64) -> Pose {
    let mut rng = Numbered::CameraPlace.generator(seed, number);
    let mut normal = |sd: f64| -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut rng);
        sd * drawn
    };
    let by_m = [0; 3].map(|_| normal(camera.place_sd_m));
    let turn_rad = [0; 3].map(|_| normal(camera.angle_sd_rad));
    let mut pose = view.pose.moved(by_m, turn_rad);
    for axis in 0..3 {
        let last = scene.room_m[axis] - FROM_WALLS_M;
        pose.place_m[axis] = pose.place_m[axis].clamp(FROM_WALLS_M, last);
    }
    pose
}

/// Motion blur along a straight line, for a camera that turns during the exposure.
fn moved(plane: &Grey, [dx, dy]: [f64; 2]) -> Grey {
    let steps = dx.hypot(dy).ceil() as usize;
    if steps == 0 {
        return plane.clone();
    }
    Grey::from_fn(plane.width(), plane.height(), |x, y| {
        let sum: f32 = (0..=steps)
            .map(|k| {
                let share = k as f64 / steps as f64 - 0.5;
                plane.between(x as f64 + share * dx, y as f64 + share * dy)
            })
            .sum();
        sum / (steps + 1) as f32
    })
}

impl Renderer<'_> {
    /// Luminance of every pixel, candela per square metre: red, green, blue.
    fn light(&self) -> [Grey; 3] {
        let lens = &self.camera.lens;
        let (width, height) = (lens.width_px, lens.height_px);
        let seen: Vec<Seen> = (0..height)
            .into_par_iter()
            .flat_map_iter(|y| (0..width).map(move |x| self.see(x as f64, y as f64)))
            .collect();
        let colours: Vec<Vector> = (0..width * height)
            .into_par_iter()
            .map(|index| {
                let (x, y) = (index % width, index / width);
                let here = &seen[index];
                let differs = |other: usize| {
                    let there = &seen[other];
                    there.thing != here.thing
                        || (there.lux - here.lux).abs() > CONTRAST * here.lux.max(there.lux)
                };
                let is_border = (x > 0 && differs(index - 1))
                    || (x + 1 < width && differs(index + 1))
                    || (y > 0 && differs(index - width))
                    || (y + 1 < height && differs(index + width));
                let colour = if is_border {
                    return self.divided(x as f64, y as f64);
                } else if let Thing::Poster(poster) = here.thing {
                    self.on_poster(poster, x as f64, y as f64)
                        .unwrap_or(here.colour)
                } else {
                    here.colour
                };
                times(colour, here.lux / std::f64::consts::PI)
            })
            .collect();
        [0, 1, 2].map(|channel| {
            Grey::from_fn(width, height, |x, y| colours[y * width + x][channel] as f32)
        })
    }

    fn direction(&self, x: f64, y: f64) -> Vector {
        self.pose.direction(self.camera.lens.slope(x, y))
    }

    fn see(&self, x: f64, y: f64) -> Seen {
        let direction = self.direction(x, y);
        let hit = self.caster.first(self.pose.place_m, direction);
        let point = add(self.pose.place_m, times(direction, hit.distance_m));
        Seen {
            thing: hit.thing,
            lux: self.lux(point, hit.normal),
            colour: self.colour(&hit, point, direction),
        }
    }

    /// The mean over several rays within a pixel.
    fn divided(&self, x: f64, y: f64) -> Vector {
        let mut sum = [0.0; 3];
        for part in 0..PARTS * PARTS {
            let off = |k: usize| (k as f64 + 0.5) / PARTS as f64 - 0.5;
            let seen = self.see(x + off(part % PARTS), y + off(part / PARTS));
            sum = add(sum, times(seen.colour, seen.lux / std::f64::consts::PI));
        }
        times(sum, 1.0 / (PARTS * PARTS) as f64)
    }

    /// The mean colour of a poster over a pixel that shows nothing else.
    fn on_poster(&self, index: usize, x: f64, y: f64) -> Option<Vector> {
        let poster = &self.scene.posters[index];
        let mut tone = 0.0;
        for part in 0..PLACES * PLACES {
            let off = |k: usize| (k as f64 + 0.5) / PLACES as f64 - 0.5;
            let direction = self.direction(x + off(part % PLACES), y + off(part / PLACES));
            let (distance, u, v) = meet_poster(poster, self.pose.place_m, direction)?;
            tone += poster
                .texture
                .at(u, v, self.spacing(distance, index) / PLACES as f64);
        }
        Some([tone / (PLACES * PLACES) as f64; 3])
    }

    /// Spacing of the rays of two pixels on a poster, as a share of half its width.
    fn spacing(&self, distance_m: f64, poster: usize) -> f64 {
        let right = self.scene.posters[poster].right_m;
        distance_m / self.camera.lens.focal_px() / dot(right, right).sqrt()
    }

    /// Illuminance of a point, lux.
    fn lux(&self, point: Vector, normal: Vector) -> f64 {
        let from = add(point, times(normal, 2.0 * BEFORE_M));
        let mut lux = self.light.ambient_lux;
        for lamp in &self.light.lamps {
            let to = less(lamp.place_m, from);
            let squared = dot(to, to);
            let slope = dot(to, normal) / squared.sqrt();
            if slope > 0.0 && self.caster.sees(from, lamp.place_m) {
                lux += lamp.intensity_cd * slope / squared;
            }
        }
        lux
    }

    fn colour(&self, hit: &Hit, point: Vector, direction: Vector) -> Vector {
        match hit.thing {
            Thing::Side(2, false) => {
                let tile = self.scene.tile_m;
                let is_dark = tile > 0.0
                    && ((point[0] / tile).floor() + (point[1] / tile).floor()).rem_euclid(2.0)
                        > 0.5;
                times(self.scene.floor, if is_dark { 0.6 } else { 1.0 })
            }
            Thing::Side(2, true) => self.scene.ceiling,
            Thing::Side(..) => self.scene.wall,
            Thing::Block(index, axis, is_far) => {
                let block = &self.scene.blocks[index];
                if block.faces == Faces::Plain {
                    return block.colour;
                }
                // The spacing of rays on a face is larger at an oblique angle of incidence.
                let slope = dot(direction, hit.normal).abs().max(LEAST_SLOPE);
                let spacing_m = hit.distance_m / self.camera.lens.focal_px() / slope;
                times(block.colour, tone(block, (axis, is_far), point, spacing_m))
            }
            Thing::Poster(index) => {
                let poster = &self.scene.posters[index];
                let met = meet_poster(poster, self.pose.place_m, direction);
                let tone = met.map_or(0.0, |(distance, u, v)| {
                    poster
                        .texture
                        .at(u, v, self.spacing(distance, index) / PARTS as f64)
                });
                [tone; 3]
            }
        }
    }
}
