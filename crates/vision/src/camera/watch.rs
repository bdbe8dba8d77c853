//! Takes pictures of a moving robot from the fixed viewpoints of a scene.

use super::super::picture::Picture;
use super::body::{Body, MotionFrame, MovingScene};
use super::render::placed;
use super::scene::{Camera, Light, Mount, Scene, View};
use super::smear::Exposure;
use realgap_core::error::Result;
use realgap_path::trajectory::Trajectory;

/// Bodies that move through a scene with fixed cameras.
#[derive(Debug, Clone)]
pub struct Watch<'a> {
    moving_scene: MovingScene<'a>,
}

impl<'a> Watch<'a> {
    /// Bodies in the world frame of one motion, which begins at the start of the mount; the camera of the mount is not used.
    pub fn new(scene: &'a Scene, mount: &Mount, motion: &Trajectory, bodies: &'a [Body]) -> Self {
        Self {
            moving_scene: MovingScene {
                scene,
                frame: MotionFrame::new(mount, motion),
                bodies,
                carrier: None,
                duration_s: motion.duration_s(),
            },
        }
    }

    /// Duration of the motion, seconds.
    pub fn duration_s(&self) -> f64 {
        self.moving_scene.duration_s
    }

    /// Checks that a picture can be taken at a time.
    ///
    /// # Errors
    /// A time outside of the motion, a body outside of the room.
    pub fn check(&self, since_start_s: f64) -> Result<()> {
        self.moving_scene.check(since_start_s)
    }

    /// The scene with the bodies in it at a time.
    pub fn room_at(&self, since_start_s: f64) -> Scene {
        let nowhere = [f64::NAN; 3];
        self.moving_scene
            .room_at(since_start_s, nowhere)
            .into_owned()
    }

    /// Takes a picture whose exposure is centred at a time, with motion blur of bodies. `place` numbers the random displacements of the
    /// camera and `number` the pictures, as in [`take`](super::take). The second value is the view from which the picture was taken.
    ///
    /// # Errors
    /// The errors of [`Watch::check`].
    pub fn take(
        &self,
        camera: &Camera,
        view: &View,
        light: &Light,
        since_start_s: f64,
        seed: u64,
        [place, number]: [u64; 2],
    ) -> Result<(Picture, View)> {
        self.check(since_start_s)?;
        let pose = placed(self.moving_scene.scene, camera, view, seed, place);
        let exposure = Exposure {
            moving_scene: &self.moving_scene,
            camera,
            light,
            middle_s: since_start_s,
        };
        let picture = exposure.picture(|_| pose, seed, number)?;
        let name = format!("{}_t_{since_start_s:07.3}", view.name);
        Ok((picture, View { name, pose }))
    }
}
