//! A camera that rides on a body: its place follows a motion, simulated or recorded, and what moves while it exposes is smeared.

use nalgebra::Vector3;

use super::super::picture::{Grey, Picture};
use super::lens::Pose;
use super::render::{expose, luminance};
use super::scene::{Camera, Light, Mount, Scene, View};
use crate::error::{Error, Result};
use crate::trajectory::{Interpolator, Trajectory};

/// Places of a moving camera within one exposure: at most one pixel apart, and at most so many.
const MOST_PLACES: usize = 24;

/// A motion through a scene with a camera on it.
#[derive(Debug, Clone)]
pub struct Ride<'a> {
    scene: &'a Scene,
    mount: &'a Mount,
    motion: &'a Trajectory,
}

impl<'a> Ride<'a> {
    /// The motion of the body that carries the camera. It begins where the mount says, whatever its own first place is; heights above
    /// the floor and directions are those of the motion, turned about the vertical as the mount says.
    ///
    /// # Errors
    /// A motion without orientations.
    pub fn new(scene: &'a Scene, mount: &'a Mount, motion: &'a Trajectory) -> Result<Self> {
        if motion.orientations_world_from_body().is_none() {
            return Err(
                Error::invalid("nobody knows where a camera on this body looks")
                    .found("a motion without orientations")
                    .allowed("columns qw, qx, qy and qz")
                    .hint("`realgap simulate` writes them"),
            );
        }
        Ok(Self {
            scene,
            mount,
            motion,
        })
    }

    /// Seconds that the motion lasts.
    pub fn duration_s(&self) -> f64 {
        self.motion.duration_s()
    }

    /// Where the camera is so many seconds after the first sample.
    fn pose(&self, since_start_s: f64) -> Pose {
        let mut at = Interpolator::new(self.motion);
        let body_m = at.position_world_m(since_start_s);
        let turn = at
            .orientation_world_from_body(since_start_s)
            .unwrap_or_default();
        let first_m = self.motion.positions_world_m()[0];
        let (sin, cos) = self.mount.facing_rad.sin_cos();
        let room = |v: Vector3<f64>| [cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z];
        let on_body = |v: [f64; 3]| turn * Vector3::from(v);
        let mut off_m = body_m + on_body(self.mount.place_body_m);
        off_m.x -= first_m.x;
        off_m.y -= first_m.y;
        let [x, y, z] = room(off_m);
        let [start_x, start_y] = self.mount.start_m;
        let ahead = Vector3::from(self.mount.ahead_body);
        // To the right of who looks ahead on an upright body.
        let right = ahead.cross(&Vector3::z()).normalize();
        Pose {
            place_m: [start_x + x, start_y + y, z],
            ahead: room(turn * ahead),
            right: room(turn * right),
        }
    }

    /// The pose in the middle of an exposure at this time.
    ///
    /// # Errors
    /// A time that is not within the motion, a place outside of the room or in a box.
    pub fn pose_at(&self, since_start_s: f64) -> Result<Pose> {
        if !(0.0..=self.duration_s()).contains(&since_start_s) {
            return Err(Error::invalid("not a time of the motion")
                .found(format!("{since_start_s} s"))
                .allowed(format!(
                    "0 to {} s after its first sample",
                    self.duration_s()
                )));
        }
        let pose = self.pose(since_start_s);
        let place = pose.place_m;
        let is_inside = (0..3).all(|i| place[i] > 0.0 && place[i] < self.scene.room_m[i]);
        if !is_inside || self.scene.blocks.iter().any(|block| block.holds(place)) {
            return Err(
                Error::invalid("the camera on the body leaves the room, or is in a box")
                    .found(format!(
                        "({:.3}, {:.3}, {:.3}) m after {since_start_s} s",
                        place[0], place[1], place[2]
                    ))
                    .allowed(format!("free places of {:?} m", self.scene.room_m))
                    .hint("choose another `start_m` or `facing_deg` of the mount"),
            );
        }
        Ok(pose)
    }

    /// Takes a picture whose exposure lies around a time, as [`take`](super::take) does at a fixed place. Light of several places on
    /// the way is added, so that turning, rolling and driving all smear it. The second value is where the camera was in the middle.
    ///
    /// # Errors
    /// As [`Ride::pose_at`].
    pub fn take(
        &self,
        camera: &Camera,
        light: &Light,
        since_start_s: f64,
        seed: u64,
        number: u64,
    ) -> Result<(Picture, View)> {
        let pose = self.pose_at(since_start_s)?;
        let exposure_s = camera.sensor.exposure_s;
        let within = |share: f64| self.pose(since_start_s + (share - 0.5) * exposure_s);
        let smear_px = smear_px(self.scene, camera, &within(0.0), &within(1.0));
        let places = (smear_px.ceil().max(1.0) as usize).min(MOST_PLACES);
        let mut sum =
            [0, 1, 2].map(|_| vec![0.0_f32; camera.lens.width_px * camera.lens.height_px]);
        for place in 0..places {
            let there = within((place as f64 + 0.5) / places as f64);
            let planes = luminance(self.scene, camera, &there, light);
            for (sum, plane) in sum.iter_mut().zip(&planes) {
                for (sum, value) in sum.iter_mut().zip(plane.values()) {
                    *sum += value / places as f32;
                }
            }
        }
        let size = (camera.lens.width_px, camera.lens.height_px);
        let planes = sum.map(|values| Grey::from_fn(size.0, size.1, |x, y| values[y * size.0 + x]));
        let picture = expose(camera, &planes, seed, number)?;
        let name = format!("t_{since_start_s:07.3}");
        Ok((picture, View { name, pose }))
    }
}

/// How far corners and the middle of a picture move from one pose to another, at most, pixels.
fn smear_px(scene: &Scene, camera: &Camera, from: &Pose, to: &Pose) -> f64 {
    let (right, low) = (
        camera.lens.width_px as f64 - 1.0,
        camera.lens.height_px as f64 - 1.0,
    );
    let places = [
        [0.0, 0.0],
        [right, 0.0],
        [0.0, low],
        [right, low],
        [0.5 * right, 0.5 * low],
    ];
    let met = super::render::met_m(scene, camera, from, &places);
    let moved = met.iter().zip(places).filter_map(|(point, [x, y])| {
        let [to_x, to_y] = camera.lens.project_px(to, *point)?;
        Some((to_x - x).hypot(to_y - y))
    });
    moved.fold(0.0, f64::max)
}
