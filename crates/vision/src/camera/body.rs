//! Bodies that move through a room while pictures are taken: those of a robot, and what else is in its motion.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};

use super::scene::Faces;
use super::scene::{Block, Mount, Plane, Scene};
use super::vector::Vector;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};

/// A box of a body, or what planes leave of it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyBox {
    /// Half of its sides, metres.
    pub half_m: Vector3<f64>,
    /// Its own axes in the body's frame, from its centre.
    pub body_from_box: Isometry3<f64>,
    /// Share of the light that comes back, for red, green and blue.
    pub colour: [f64; 3],
    /// What is beyond these is cut off; none for a box.
    pub planes: Arc<[Plane]>,
}

/// A rigid body in the world of a motion. Its whole boxes show the dots of a die.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    name: String,
    boxes: Vec<BodyBox>,
    way: Way,
}

/// Where a body is.
#[derive(Debug, Clone, PartialEq)]
enum Way {
    Still(Isometry3<f64>),
    Moving(Trajectory),
}

impl Body {
    /// A body that moves.
    ///
    /// # Errors
    /// A motion without orientations.
    pub fn moving(name: &str, boxes: Vec<BodyBox>, motion: Trajectory) -> Result<Self> {
        if motion.orientations_world_from_body().is_none() {
            return Err(Error::invalid("nobody knows how this body is turned")
                .field(name)
                .found("a motion without orientations")
                .allowed("columns qw, qx, qy and qz of it"));
        }
        Ok(Self {
            name: name.to_owned(),
            boxes,
            way: Way::Moving(motion),
        })
    }

    /// A body that stands where it is.
    pub fn still(name: &str, boxes: Vec<BodyBox>, world_from_body: Isometry3<f64>) -> Self {
        Self {
            name: name.to_owned(),
            boxes,
            way: Way::Still(world_from_body),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn pose(&self, since_start_s: f64) -> Isometry3<f64> {
        match &self.way {
            Way::Still(pose) => *pose,
            Way::Moving(motion) => {
                let mut at = Interpolator::new(motion);
                let place_m = at.position_world_m(since_start_s);
                let turn = at.orientation_world_from_body(since_start_s);
                Isometry3::from_parts(place_m.into(), turn.unwrap_or_default())
            }
        }
    }

    fn blocks(&self, entry: &Entry, since_start_s: f64) -> Vec<Block> {
        let world_from_body = self.pose(since_start_s);
        let blocks = self.boxes.iter().map(|one| {
            let world_from_box = world_from_body * one.body_from_box;
            let turn = world_from_box.rotation;
            Block {
                centre_m: entry.place_m(world_from_box.translation.vector),
                half_m: one.half_m.into(),
                axes: [Vector3::x(), Vector3::y(), Vector3::z()]
                    .map(|axis| entry.direction(turn * axis)),
                colour: one.colour,
                planes: Arc::clone(&one.planes),
                faces: match one.planes.is_empty() {
                    true => Faces::Die,
                    false => Faces::Plain,
                },
                is_seen: true,
            }
        });
        blocks.collect()
    }
}

/// Where the world of a motion is in a room.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    first_m: [f64; 2],
    start_m: [f64; 2],
    /// Cosine and sine.
    facing: [f64; 2],
}

impl Entry {
    /// The motion's first place stands where the mount says, at its own height, and its x axis points as the mount says.
    pub(super) fn new(mount: &Mount, motion: &Trajectory) -> Self {
        let first_m = motion.positions_world_m()[0];
        let (sin, cos) = mount.facing_rad.sin_cos();
        Self {
            first_m: [first_m.x, first_m.y],
            start_m: mount.start_m,
            facing: [cos, sin],
        }
    }

    pub(super) fn direction(&self, v: Vector3<f64>) -> Vector {
        let [cos, sin] = self.facing;
        [cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z]
    }

    pub(super) fn place_m(&self, mut world_m: Vector3<f64>) -> Vector {
        world_m.x -= self.first_m[0];
        world_m.y -= self.first_m[1];
        let [x, y, z] = self.direction(world_m);
        [self.start_m[0] + x, self.start_m[1] + y, z]
    }
}

/// A room with the bodies of one motion in it.
#[derive(Debug, Clone)]
pub(super) struct Company<'a> {
    pub(super) scene: &'a Scene,
    pub(super) entry: Entry,
    pub(super) bodies: &'a [Body],
    /// The body that carries the camera, by its name.
    pub(super) carrier: Option<&'a str>,
    pub(super) duration_s: f64,
}

impl<'a> Company<'a> {
    /// The room and all in it at a time, for a camera at this place: it does not see the body that carries it while it is in one of
    /// that body's boxes.
    pub(super) fn room_at(&self, since_start_s: f64, camera_m: Vector) -> Cow<'a, Scene> {
        if self.bodies.is_empty() {
            return Cow::Borrowed(self.scene);
        }
        let mut scene = self.scene.clone();
        for body in self.bodies {
            let mut blocks = body.blocks(&self.entry, since_start_s);
            let carries = self.carrier == Some(body.name());
            if carries && blocks.iter().any(|block| block.holds(camera_m)) {
                for block in &mut blocks {
                    block.is_seen = false;
                }
            }
            scene.blocks.extend(blocks);
        }
        Cow::Owned(scene)
    }

    /// Checks that this is a time of the motion, and that what moves is inside of the room then.
    ///
    /// # Errors
    /// If not: what, where and when.
    pub(super) fn check(&self, since_start_s: f64) -> Result<()> {
        if !(0.0..=self.duration_s).contains(&since_start_s) {
            return Err(Error::invalid("not a time of the motion")
                .found(format!("{since_start_s} s"))
                .allowed(format!("0 to {} s after its first sample", self.duration_s)));
        }
        let room_m = self.scene.room_m;
        for body in self.bodies {
            if matches!(body.way, Way::Still(_)) {
                continue;
            }
            for block in body.blocks(&self.entry, since_start_s) {
                let [x, y, z] = block.centre_m;
                let is_inside =
                    (0..3).all(|i| block.centre_m[i] > 0.0 && block.centre_m[i] < room_m[i]);
                if !is_inside {
                    let name = body.name();
                    return Err(Error::invalid("the robot leaves the room")
                        .found(format!(
                            "`{name}` at ({x:.3}, {y:.3}, {z:.3}) m after {since_start_s} s"
                        ))
                        .allowed(format!("between (0, 0, 0) and {room_m:?} m"))
                        .hint("`start_m` and `facing_deg` of the mount say where the motion begins; its lengths may be in another unit, its heights from another floor"));
                }
            }
        }
        Ok(())
    }
}
