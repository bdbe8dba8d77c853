//! The types of a scene: the room with its blocks, posters, lights, cameras, views and mounts.

use std::sync::Arc;

use super::exposure::Sensor;
use super::lens::{Lens, Pose};
use super::poster::{Motif, Texture};
use super::vector::{Vector, add, cross, dot, less, times, unit};

/// A room with blocks and posters, its lights, and cameras.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// Size of the room, which begins at the corner (0, 0, 0), metres.
    pub room_m: [f64; 3],
    /// Reflectance of the walls for red, green and blue, 0 to 1.
    pub wall: [f64; 3],
    /// Reflectance of the floor for red, green and blue, 0 to 1.
    pub floor: [f64; 3],
    /// Reflectance of the ceiling for red, green and blue, 0 to 1.
    pub ceiling: [f64; 3],
    /// Side of the floor's tiles, of which every second is darker, metres; 0 for a floor without tiles.
    pub tile_m: f64,
    /// Boxes and cubes.
    pub blocks: Vec<Block>,
    /// Posters.
    pub posters: Vec<Poster>,
    /// Lights by name.
    pub lights: Vec<Light>,
    /// Cameras by name.
    pub cameras: Vec<Camera>,
    /// Viewpoints from which pictures are taken.
    pub views: Vec<View>,
    /// Mounts of cameras on bodies, by name.
    pub mounts: Vec<Mount>,
}

/// The pattern of the faces of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Faces {
    /// Plain faces, without a rim or dots.
    #[default]
    Plain,
    /// A dark rim and the dots of a die: one dot on the side of its x axis, two for y, three for z; six, five and four on the opposite
    /// sides.
    Die,
}

/// A plane, by its normal and its distance from the origin along the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Normal of length one.
    pub normal: [f64; 3],
    /// Distance from the origin along the normal, metres.
    pub level_m: f64,
}

/// A box, which may be cut by planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Centre, metres.
    pub centre_m: [f64; 3],
    /// Half of its sides, metres.
    pub half_m: [f64; 3],
    /// Axes of the box in the frame of the room: unit vectors at right angles.
    pub axes: [[f64; 3]; 3],
    /// Reflectance for red, green and blue, 0 to 1.
    pub colour: [f64; 3],
    /// Planes that cut off parts of the box, in the frame of the box.
    pub planes: Arc<[Plane]>,
    /// Pattern of the faces.
    pub faces: Faces,
    /// Whether cameras see the box; an invisible box still casts a shadow.
    pub is_seen: bool,
}

impl Block {
    /// A direction of the room in the frame of the box.
    pub(super) fn own(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes;
        // A short cut for upright boxes, which are most, because this function is called for every ray.
        if z[2] == 1.0 {
            return [
                x[0] * direction[0] + x[1] * direction[1],
                y[0] * direction[0] + y[1] * direction[1],
                direction[2],
            ];
        }
        [x, y, z].map(|axis| dot(axis, direction))
    }

    /// A point of the room in the frame of the box, metres.
    pub(super) fn own_m(&self, point_m: Vector) -> Vector {
        self.own(less(point_m, self.centre_m))
    }

    /// A point in the frame of the box in the frame of the room, metres.
    pub(super) fn point_m(&self, own_m: Vector) -> Vector {
        (0..3).fold(self.centre_m, |sum, axis| {
            add(sum, times(self.axes[axis], own_m[axis]))
        })
    }

    /// The corners of the box in the frame of the room, metres.
    pub(super) fn corners_m(&self) -> [Vector; 8] {
        std::array::from_fn(|corner| {
            self.point_m([0, 1, 2].map(|axis| {
                let sign = if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
                sign * self.half_m[axis]
            }))
        })
    }

    /// Whether a point of the room is inside of the box.
    pub(super) fn holds(&self, point_m: Vector) -> bool {
        let own_m = self.own_m(point_m);
        (0..3).all(|axis| own_m[axis].abs() < self.half_m[axis])
            && (self.planes.iter()).all(|plane| dot(plane.normal, own_m) < plane.level_m)
    }
}

/// A poster: an upright rectangle with a picture.
#[derive(Debug, Clone)]
pub struct Poster {
    /// Centre, metres.
    pub centre_m: [f64; 3],
    /// Vector of half its width, in the direction to the right of its picture, metres.
    pub right_m: [f64; 3],
    /// Vector of half its height, downwards, metres.
    pub down_m: [f64; 3],
    /// Motif of the poster.
    pub motif: Motif,
    pub(super) texture: Texture,
}

impl Poster {
    /// The direction that the poster faces.
    pub(super) fn normal(&self) -> Vector {
        unit(cross(self.down_m, self.right_m))
    }

    /// A point of the poster, by coordinates from −1 to 1 to the right and down.
    pub(super) fn point_m(&self, u: f64, v: f64) -> Vector {
        add(
            self.centre_m,
            add(times(self.right_m, u), times(self.down_m, v)),
        )
    }
}

/// A lamp with the same intensity in all directions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// Position, metres.
    pub place_m: [f64; 3],
    /// Luminous intensity, candela.
    pub intensity_cd: f64,
}

/// The lighting of a room.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Name of the light.
    pub name: String,
    /// Ambient illuminance, lux.
    pub ambient_lux: f64,
    /// Lamps.
    pub lamps: Vec<Lamp>,
}

/// A camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Name of the camera.
    pub name: String,
    /// Whether the camera stands in for a real one.
    pub is_stand_in: bool,
    /// Lens and resolution.
    pub lens: Lens,
    /// Sensor and exposure.
    pub sensor: Sensor,
    /// Standard deviation of the camera's position between pictures, for each axis, metres.
    pub place_sd_m: f64,
    /// Standard deviation of the camera's orientation between pictures, for each axis, radians.
    pub angle_sd_rad: f64,
    /// Speed at which the camera turns during the exposure, to the right and down, radians per second.
    pub turning_rad_s: [f64; 2],
}

/// A viewpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Name of the view.
    pub name: String,
    /// Pose of the camera.
    pub pose: Pose,
}

/// The mount of a camera on a body, with the start of the body's motion in the room.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// Name of the mount.
    pub name: String,
    /// Name of the body in the file of the motion; `None` for the tracked body.
    pub body: Option<String>,
    /// Position of the camera on the body, in the body's frame, metres.
    pub place_body_m: [f64; 3],
    /// Direction in which the camera looks, in the body's frame.
    pub ahead_body: [f64; 3],
    /// Position in the room at which the motion begins, metres.
    pub start_m: [f64; 2],
    /// Direction of the motion's x axis in the room, counter-clockwise from the room's x axis, radians.
    pub facing_rad: f64,
}
