//! Motion blur: averages the light at several moments of an exposure, for motions of the camera and of bodies.

use super::super::picture::{Grey, Picture};
use super::body::MovingScene;
use super::cast::{Caster, Thing};
use super::lens::Pose;
use super::render::{expose, luminance, met_m};
use super::scene::{Camera, Light};
use super::vector::{Vector, add, times};
use realgap_core::error::Result;

/// Largest number of moments within one exposure; between two of them the picture moves by at most one pixel if fewer suffice.
const MOST_PLACES: usize = 24;
/// Columns and rows of the grid of pixels at which the motion of bodies is measured.
const GRID: [usize; 2] = [16, 12];

/// An exposure: the scene, the camera, the light, and the time of its middle.
pub(super) struct Exposure<'a> {
    pub(super) moving_scene: &'a MovingScene<'a>,
    pub(super) camera: &'a Camera,
    pub(super) light: &'a Light,
    pub(super) middle_s: f64,
}

impl Exposure<'_> {
    /// Takes the picture of a camera whose pose is a function of time.
    ///
    /// # Errors
    /// The errors of [`expose`].
    pub(super) fn picture(
        &self,
        pose_at: impl Fn(f64) -> Pose,
        seed: u64,
        number: u64,
    ) -> Result<Picture> {
        let camera = self.camera;
        let time_s = |share: f64| self.middle_s + (share - 0.5) * camera.sensor.exposure_s;
        let ends_s = [time_s(0.0), time_s(1.0)];
        let smear_px = self.smear_px(ends_s, ends_s.map(&pose_at));
        let places = (smear_px.ceil().max(1.0) as usize).min(MOST_PLACES);
        let mut sum =
            [0, 1, 2].map(|_| vec![0.0_f32; camera.lens.width_px * camera.lens.height_px]);
        for place in 0..places {
            let now_s = time_s((place as f64 + 0.5) / places as f64);
            let there = pose_at(now_s);
            let room = self.moving_scene.room_at(now_s, there.place_m);
            let planes = luminance(&room, camera, &there, self.light);
            for (sum, plane) in sum.iter_mut().zip(&planes) {
                for (sum, value) in sum.iter_mut().zip(plane.values()) {
                    *sum += value / places as f32;
                }
            }
        }
        let size = (camera.lens.width_px, camera.lens.height_px);
        let planes = sum.map(|values| Grey::from_fn(size.0, size.1, |x, y| values[y * size.0 + x]));
        expose(camera, &planes, seed, number)
    }

    /// Largest motion of anything in the picture during the exposure, pixels.
    fn smear_px(&self, ends_s: [f64; 2], poses: [Pose; 2]) -> f64 {
        self.room_px(&poses).max(self.bodies_px(ends_s, &poses))
    }

    /// Largest motion of the room in the picture, which is due to the camera only: at the corners and the middle of the picture, pixels.
    fn room_px(&self, [from, to]: &[Pose; 2]) -> f64 {
        let lens = &self.camera.lens;
        let (right, low) = (lens.width_px as f64 - 1.0, lens.height_px as f64 - 1.0);
        let places = [
            [0.0, 0.0],
            [right, 0.0],
            [0.0, low],
            [right, low],
            [0.5 * right, 0.5 * low],
        ];
        let met = met_m(self.moving_scene.scene, self.camera, from, &places);
        let moved = met.iter().zip(places).filter_map(|(point, [x, y])| {
            let [to_x, to_y] = lens.project_px(to, *point)?;
            Some((to_x - x).hypot(to_y - y))
        });
        moved.fold(0.0, f64::max)
    }

    /// Largest motion of bodies in the picture: of their corners, and of points that are seen on a grid of pixels.
    fn bodies_px(&self, ends_s: [f64; 2], poses: &[Pose; 2]) -> f64 {
        if self.moving_scene.bodies.is_empty() {
            return 0.0;
        }
        let lens = &self.camera.lens;
        let (width, height) = (lens.width_px as f64, lens.height_px as f64);
        let rooms = [0, 1].map(|end| self.moving_scene.room_at(ends_s[end], poses[end].place_m));
        let own = self.moving_scene.scene.blocks.len();
        let is_within = |[x, y]: [f64; 2]| (0.0..width).contains(&x) && (0.0..height).contains(&y);
        let distance_px = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let mut most_px = 0.0_f64;
        for (before, after) in rooms[0].blocks[own..].iter().zip(&rooms[1].blocks[own..]) {
            if !before.is_seen {
                continue;
            }
            for (from_m, to_m) in before.corners_m().into_iter().zip(after.corners_m()) {
                let seen = [(0, from_m), (1, to_m)]
                    .map(|(end, corner_m)| lens.project_px(&poses[end], corner_m));
                if let [Some(from), Some(to)] = seen
                    && (is_within(from) || is_within(to))
                {
                    most_px = most_px.max(distance_px(from, to));
                }
            }
        }
        let caster = Caster::new(&rooms[0]);
        for cell in 0..GRID[0] * GRID[1] {
            let share = |k: usize, of: usize| (k as f64 + 0.5) / of as f64;
            let at = [
                share(cell % GRID[0], GRID[0]) * width - 0.5,
                share(cell / GRID[0], GRID[1]) * height - 0.5,
            ];
            let direction = poses[0].direction(lens.slope(at[0], at[1]));
            let hit = caster.first(poses[0].place_m, direction);
            let Thing::Block(index, ..) = hit.thing else {
                continue;
            };
            if index < own {
                continue;
            }
            let met_m: Vector = add(poses[0].place_m, times(direction, hit.distance_m));
            let later_m = rooms[1].blocks[index].point_m(rooms[0].blocks[index].own_m(met_m));
            if let Some(to) = lens.project_px(&poses[1], later_m) {
                most_px = most_px.max(distance_px(at, to));
            }
        }
        most_px
    }
}
