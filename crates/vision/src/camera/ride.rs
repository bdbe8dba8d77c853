//! A camera that is mounted on a body and follows its simulated or recorded motion, with motion blur.

use nalgebra::Vector3;

use super::super::picture::Picture;
use super::body::{Body, MotionFrame, MovingScene};
use super::lens::Pose;
use super::scene::{Camera, Light, Mount, Scene, View};
use super::smear::Exposure;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};

/// A camera that is mounted on a moving body in a scene.
#[derive(Debug, Clone)]
pub struct Ride<'a> {
    mount: &'a Mount,
    motion: &'a Trajectory,
    moving_scene: MovingScene<'a>,
}

impl<'a> Ride<'a> {
    /// A camera on the body with this motion. The motion begins at the start of the mount, whatever its own first position is. Heights
    /// above the floor are those of the motion, and directions are turned about the vertical according to the mount.
    ///
    /// # Errors
    /// A motion without orientations.
    pub fn new(scene: &'a Scene, mount: &'a Mount, motion: &'a Trajectory) -> Result<Self> {
        if motion.orientations_world_from_body().is_none() {
            return Err(Error::invalid(
                "the orientation of the body that carries the camera is unknown",
            )
            .found("a motion without orientations")
            .allowed("columns qw, qx, qy and qz")
            .hint("`realgap simulate` writes them"));
        }
        Ok(Self {
            mount,
            motion,
            moving_scene: MovingScene {
                scene,
                frame: MotionFrame::new(mount, motion),
                bodies: &[],
                carrier: None,
                duration_s: motion.duration_s(),
            },
        })
    }

    /// Adds bodies in the world frame of the same motion. The body named `carrier` carries the camera. It is invisible to the camera while
    /// the camera is inside of one of its boxes; otherwise the camera sees it like any other body.
    #[must_use]
    pub fn with_bodies(mut self, bodies: &'a [Body], carrier: &'a str) -> Self {
        self.moving_scene.bodies = bodies;
        self.moving_scene.carrier = Some(carrier);
        self
    }

    /// Duration of the motion, seconds.
    pub fn duration_s(&self) -> f64 {
        self.moving_scene.duration_s
    }

    /// The pose of the camera at a time after the first sample.
    fn pose(&self, since_start_s: f64) -> Pose {
        let mut at = Interpolator::new(self.motion);
        let body_m = at.position_world_m(since_start_s);
        let turn = at
            .orientation_world_from_body(since_start_s)
            .unwrap_or_default();
        let ahead = Vector3::from(self.mount.ahead_body);
        // On an upright body, the picture is level.
        let right = ahead.cross(&Vector3::z()).normalize();
        let frame = &self.moving_scene.frame;
        Pose {
            place_m: frame.place_m(body_m + turn * Vector3::from(self.mount.place_body_m)),
            ahead: frame.direction(turn * ahead),
            right: frame.direction(turn * right),
        }
    }

    /// The pose in the middle of an exposure at this time.
    ///
    /// # Errors
    /// A time outside of the motion, a camera outside of the room or inside of a box of the scene, another body outside of the room.
    pub fn pose_at(&self, since_start_s: f64) -> Result<Pose> {
        self.moving_scene.check(since_start_s)?;
        let scene = self.moving_scene.scene;
        let pose = self.pose(since_start_s);
        let place = pose.place_m;
        let is_inside = (0..3).all(|i| place[i] > 0.0 && place[i] < scene.room_m[i]);
        if !is_inside || scene.blocks.iter().any(|block| block.holds(place)) {
            return Err(
                Error::invalid("the camera on the body leaves the room, or is in a box")
                    .found(format!(
                        "({:.3}, {:.3}, {:.3}) m after {since_start_s} s",
                        place[0], place[1], place[2]
                    ))
                    .allowed(format!("free places of {:?} m", scene.room_m))
                    .hint("choose another `start_m` or `facing_deg` of the mount"),
            );
        }
        Ok(pose)
    }

    /// The scene with the bodies in it, as the camera sees it at a time.
    pub fn room_at(&self, since_start_s: f64) -> Scene {
        let pose = self.pose(since_start_s);
        self.moving_scene
            .room_at(since_start_s, pose.place_m)
            .into_owned()
    }

    /// Takes a picture whose exposure is centred at a time, as [`take`](super::take) does with a fixed pose. The light at several moments
    /// of the exposure is averaged, which gives motion blur for all motions of the camera and of bodies. The second value is the view in
    /// the middle of the exposure.
    ///
    /// # Errors
    /// The errors of [`Ride::pose_at`].
    pub fn take(
        &self,
        camera: &Camera,
        light: &Light,
        since_start_s: f64,
        seed: u64,
        number: u64,
    ) -> Result<(Picture, View)> {
        let pose = self.pose_at(since_start_s)?;
        let exposure = Exposure {
            moving_scene: &self.moving_scene,
            camera,
            light,
            middle_s: since_start_s,
        };
        let picture = exposure.picture(|time_s| self.pose(time_s), seed, number)?;
        let name = format!("t_{since_start_s:07.3}");
        Ok((picture, View { name, pose }))
    }
}
