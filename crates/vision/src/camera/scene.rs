//! What a scene holds.

use std::sync::Arc;

use super::exposure::Sensor;
use super::lens::{Lens, Pose};
use super::poster::{Motif, Texture};
use super::vector::{Vector, add, cross, dot, less, times, unit};

/// A room with what stands in it, its lights, and cameras.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// From the corner (0, 0, 0) to here, metres.
    pub room_m: [f64; 3],
    /// Share of the light that comes back, for red, green and blue: walls, floor, ceiling.
    pub wall: [f64; 3],
    /// The floor.
    pub floor: [f64; 3],
    /// The ceiling.
    pub ceiling: [f64; 3],
    /// Side of the floor's tiles, of which every other is darker; 0 for none.
    pub tile_m: f64,
    /// Boxes and cubes.
    pub blocks: Vec<Block>,
    /// Posters.
    pub posters: Vec<Poster>,
    /// Lights by name.
    pub lights: Vec<Light>,
    /// Cameras by name.
    pub cameras: Vec<Camera>,
    /// Where pictures are taken.
    pub views: Vec<View>,
    /// How cameras ride on bodies, by name.
    pub mounts: Vec<Mount>,
}

/// What the faces of a box show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Faces {
    /// Plain faces, without a rim or dots.
    #[default]
    Plain,
    /// A dark rim and the dots of a die: one where its x axis points, two for y, three for z, six, five and four on the other sides.
    Die,
}

/// A plane: its normal, and how far along that it is from the origin, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Of length one.
    pub normal: [f64; 3],
    /// Distance from the origin, metres.
    pub level_m: f64,
}

/// A box, or what planes leave of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Centre, metres.
    pub centre_m: [f64; 3],
    /// Half of its sides, metres.
    pub half_m: [f64; 3],
    /// Directions of its own axes in the room, of length one and at right angles.
    pub axes: [[f64; 3]; 3],
    /// Share of the light that comes back, for red, green and blue.
    pub colour: [f64; 3],
    /// What is beyond these is cut off; along its own axes, from its centre.
    pub planes: Arc<[Plane]>,
    /// What its faces show.
    pub faces: Faces,
    /// Whether cameras see it; what they do not see throws its shadow all the same.
    pub is_seen: bool,
}

impl Block {
    /// A direction of the room along its own axes.
    pub(super) fn own(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes;
        // Most boxes stand upright, and every ray asks.
        if z[2] == 1.0 {
            return [
                x[0] * direction[0] + x[1] * direction[1],
                y[0] * direction[0] + y[1] * direction[1],
                direction[2],
            ];
        }
        [x, y, z].map(|axis| dot(axis, direction))
    }

    /// A point of the room as seen from its centre, metres along its own axes.
    pub(super) fn own_m(&self, point_m: Vector) -> Vector {
        self.own(less(point_m, self.centre_m))
    }

    /// The point of the room that is so many metres along its own axes from its centre.
    pub(super) fn point_m(&self, own_m: Vector) -> Vector {
        (0..3).fold(self.centre_m, |sum, axis| {
            add(sum, times(self.axes[axis], own_m[axis]))
        })
    }

    /// Its corners, metres.
    pub(super) fn corners_m(&self) -> [Vector; 8] {
        std::array::from_fn(|corner| {
            self.point_m([0, 1, 2].map(|axis| {
                let sign = if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
                sign * self.half_m[axis]
            }))
        })
    }

    pub(super) fn holds(&self, point_m: Vector) -> bool {
        let own_m = self.own_m(point_m);
        (0..3).all(|axis| own_m[axis].abs() < self.half_m[axis])
            && (self.planes.iter()).all(|plane| dot(plane.normal, own_m) < plane.level_m)
    }
}

/// A rectangle with a picture, upright.
#[derive(Debug, Clone)]
pub struct Poster {
    /// Centre, metres.
    pub centre_m: [f64; 3],
    /// Half of its width, along which its picture goes to the right, metres.
    pub right_m: [f64; 3],
    /// Half of its height, downwards, metres.
    pub down_m: [f64; 3],
    /// What it shows.
    pub motif: Motif,
    pub(super) texture: Texture,
}

impl Poster {
    /// Where it faces.
    pub(super) fn normal(&self) -> Vector {
        unit(cross(self.down_m, self.right_m))
    }

    /// A point of it: −1 to 1 to the right and down.
    pub(super) fn point_m(&self, u: f64, v: f64) -> Vector {
        add(
            self.centre_m,
            add(times(self.right_m, u), times(self.down_m, v)),
        )
    }
}

/// A lamp that shines alike in all directions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// Where it hangs, metres.
    pub place_m: [f64; 3],
    /// Luminous intensity, candela.
    pub intensity_cd: f64,
}

/// A way the room is lit.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Its name.
    pub name: String,
    /// Illuminance from everywhere, lux.
    pub ambient_lux: f64,
    /// Lamps.
    pub lamps: Vec<Lamp>,
}

/// A camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Its name.
    pub name: String,
    /// Whether it takes the place of a real one.
    pub is_stand_in: bool,
    /// Lens and resolution.
    pub lens: Lens,
    /// Sensor and exposure.
    pub sensor: Sensor,
    /// Standard deviation of where it stands, each axis, metres: nobody puts a camera down twice at the same place.
    pub place_sd_m: f64,
    /// Standard deviation of where it looks, each axis, radians.
    pub angle_sd_rad: f64,
    /// Speed at which it turns while exposing, to the right and down, radians per second.
    pub turning_rad_s: [f64; 2],
}

/// A viewpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Its name.
    pub name: String,
    /// From where, and where to.
    pub pose: Pose,
}

/// How a camera rides on a body, and where the body's motion begins in the room.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// Its name.
    pub name: String,
    /// The body: a name of the motion's file; `None` for the tracked one.
    pub body: Option<String>,
    /// Where the camera is on the body, metres, in the body's axes.
    pub place_body_m: [f64; 3],
    /// Where it looks, in the body's axes.
    pub ahead_body: [f64; 3],
    /// Where the motion begins, metres.
    pub start_m: [f64; 2],
    /// Where the motion's x axis points in the room, anticlockwise from the room's.
    pub facing_rad: f64,
}
