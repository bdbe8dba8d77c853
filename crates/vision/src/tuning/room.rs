//! Where pictures were taken.

use crate::camera::{Light, Scene};

/// The room of the pictures, and how it was lit.
#[derive(Clone, Copy)]
pub(super) struct Room<'a> {
    pub scene: &'a Scene,
    pub light: &'a Light,
}
