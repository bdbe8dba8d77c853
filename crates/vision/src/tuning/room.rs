//! The scene in which pictures were taken, together with its light.

use crate::camera::{Light, Scene};

/// The scene in which pictures were taken, and the light that was used.
#[derive(Clone, Copy)]
pub(super) struct LitScene<'a> {
    pub scene: &'a Scene,
    pub light: &'a Light,
}
