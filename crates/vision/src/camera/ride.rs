//! A camera that rides on a body: its place follows a motion, simulated or recorded, and what moves while it exposes is smeared.

use nalgebra::Vector3;

use super::super::picture::Picture;
use super::body::{Body, Company, Entry};
use super::lens::Pose;
use super::scene::{Camera, Light, Mount, Scene, View};
use super::smear::Exposure;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};

/// A motion through a scene with a camera on it.
#[derive(Debug, Clone)]
pub struct Ride<'a> {
    mount: &'a Mount,
    motion: &'a Trajectory,
    company: Company<'a>,
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
            mount,
            motion,
            company: Company {
                scene,
                entry: Entry::new(mount, motion),
                bodies: &[],
                carrier: None,
                duration_s: motion.duration_s(),
            },
        })
    }

    /// Bodies in the world of the same motion are in the room, too. The one called `carrier` carries the camera: while the camera is in
    /// one of its boxes it sees nothing of that body, else of all of it what is before it.
    #[must_use]
    pub fn with_bodies(mut self, bodies: &'a [Body], carrier: &'a str) -> Self {
        self.company.bodies = bodies;
        self.company.carrier = Some(carrier);
        self
    }

    /// Seconds that the motion lasts.
    pub fn duration_s(&self) -> f64 {
        self.company.duration_s
    }

    /// Where the camera is so many seconds after the first sample.
    fn pose(&self, since_start_s: f64) -> Pose {
        let mut at = Interpolator::new(self.motion);
        let body_m = at.position_world_m(since_start_s);
        let turn = at
            .orientation_world_from_body(since_start_s)
            .unwrap_or_default();
        let ahead = Vector3::from(self.mount.ahead_body);
        // To the right of who looks ahead on an upright body.
        let right = ahead.cross(&Vector3::z()).normalize();
        let entry = &self.company.entry;
        Pose {
            place_m: entry.place_m(body_m + turn * Vector3::from(self.mount.place_body_m)),
            ahead: entry.direction(turn * ahead),
            right: entry.direction(turn * right),
        }
    }

    /// The pose in the middle of an exposure at this time.
    ///
    /// # Errors
    /// A time that is not within the motion, a place outside of the room or in a box of it, another body outside of the room.
    pub fn pose_at(&self, since_start_s: f64) -> Result<Pose> {
        self.company.check(since_start_s)?;
        let scene = self.company.scene;
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

    /// The room with the bodies in it, as the camera sees it at a time.
    pub fn room_at(&self, since_start_s: f64) -> Scene {
        let pose = self.pose(since_start_s);
        self.company
            .room_at(since_start_s, pose.place_m)
            .into_owned()
    }

    /// Takes a picture whose exposure lies around a time, as [`take`](super::take) does at a fixed place. Light of several places on
    /// the way is added, so that turning, rolling and driving all smear it, and bodies that move are smeared by their own motion. The
    /// second value is where the camera was in the middle.
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
        let exposure = Exposure {
            company: &self.company,
            camera,
            light,
            middle_s: since_start_s,
        };
        let picture = exposure.picture(|time_s| self.pose(time_s), seed, number)?;
        let name = format!("t_{since_start_s:07.3}");
        Ok((picture, View { name, pose }))
    }
}
