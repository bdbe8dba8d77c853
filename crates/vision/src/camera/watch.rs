//! A robot in motion, watched from a room's viewpoints.

use super::super::picture::Picture;
use super::body::{Body, Company, Entry};
use super::render::placed;
use super::scene::{Camera, Light, Mount, Scene, View};
use super::smear::Exposure;
use realgap_core::error::Result;
use realgap_path::trajectory::Trajectory;

/// Bodies that move through a scene before cameras that stand.
#[derive(Debug, Clone)]
pub struct Watch<'a> {
    company: Company<'a>,
}

impl<'a> Watch<'a> {
    /// Bodies in the world of one motion, which begins where the mount says; its camera is not used.
    pub fn new(scene: &'a Scene, mount: &Mount, motion: &Trajectory, bodies: &'a [Body]) -> Self {
        Self {
            company: Company {
                scene,
                entry: Entry::new(mount, motion),
                bodies,
                carrier: None,
                duration_s: motion.duration_s(),
            },
        }
    }

    /// Seconds that the motion lasts.
    pub fn duration_s(&self) -> f64 {
        self.company.duration_s
    }

    /// Checks that a picture can be taken at a time.
    ///
    /// # Errors
    /// A time that is not within the motion, a body outside of the room.
    pub fn check(&self, since_start_s: f64) -> Result<()> {
        self.company.check(since_start_s)
    }

    /// The room with the bodies in it, at a time.
    pub fn room_at(&self, since_start_s: f64) -> Scene {
        let nowhere = [f64::NAN; 3];
        self.company.room_at(since_start_s, nowhere).into_owned()
    }

    /// Takes a picture whose exposure lies around a time; bodies that move meanwhile are smeared. `place` numbers where the camera
    /// was put down, `number` the picture, as in [`take`](super::take). The second value is from where it was taken.
    ///
    /// # Errors
    /// As [`Watch::check`].
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
        let pose = placed(self.company.scene, camera, view, seed, place);
        let exposure = Exposure {
            company: &self.company,
            camera,
            light,
            middle_s: since_start_s,
        };
        let picture = exposure.picture(|_| pose, seed, number)?;
        let name = format!("{}_t_{since_start_s:07.3}", view.name);
        Ok((picture, View { name, pose }))
    }
}
