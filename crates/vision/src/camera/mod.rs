//! Simulates a camera in a room: pictures by ray casting, with the errors of a real camera.
//!
//! A [`Scene`] is a closed room with boxes, posters, lights, cameras and viewpoints (`scenes/*.ron`). A [`Camera`] is a pinhole with
//! a distorting lens, an exposure during which it may turn, and a sensor that counts photons. The positions of things in a picture are
//! known and are written to a `views.ron`. [`Body`]s move through the room: the camera is mounted on one of them ([`Ride`]) or stands
//! still and observes them ([`Watch`]).
//!
//! Light is diffuse (Lambert): every surface is lit by the ambient light and by the lamps that are visible from it, and its luminance
//! is the same from all directions. There are no mirrors and no light from other surfaces; ambient light approximates it.

mod body;
mod camera_file;
mod cast;
mod exposure;
mod face;
mod lens;
mod poster;
mod reader;
mod render;
mod ride;
mod scene;
mod scene_file;
mod smear;
mod truth;
mod vector;
mod watch;

pub use body::{Body, BodyBox};
#[cfg(feature = "schema")]
pub use camera_file::CameraFile;
pub use exposure::Sensor;
pub use lens::{Lens, Pose};
pub use poster::Motif;
pub use render::focused;
pub use render::{expose, luminance, met_m, take};
pub use ride::Ride;
pub use scene::{Block, Camera, Faces, Lamp, Light, Mount, Plane, Poster, Scene, View};
#[cfg(feature = "schema")]
pub use scene_file::SceneFile;
pub use truth::{ALPHABET_TEXT, alphabet_picture, known};
pub use watch::Watch;
