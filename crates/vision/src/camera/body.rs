//! Bodies that move through the room of a scene while pictures are taken, for example the parts of a robot.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};

use super::scene::Faces;
use super::scene::{Block, Mount, Plane, Scene};
use super::vector::Vector;
use realgap_core::error::{Error, Result};
use realgap_path::trajectory::{Interpolator, Trajectory};

/// A box of a body, which may be cut by planes.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyBox {
    /// Half of its sides, metres.
    pub half_m: Vector3<f64>,
    /// Pose of the box in the body's frame.
    pub body_from_box: Isometry3<f64>,
    /// Reflectance for red, green and blue, 0 to 1.
    pub colour: [f64; 3],
    /// Planes that cut off parts of the box; empty for a whole box.
    pub planes: Arc<[Plane]>,
}

/// A rigid body in the world frame of a motion. Boxes that are not cut show the dots of a die.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    name: String,
    boxes: Vec<BodyBox>,
    motion: BodyMotion,
}

/// The pose of a body over time.
#[derive(Debug, Clone, PartialEq)]
enum BodyMotion {
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
            return Err(Error::invalid("the orientation of this body is unknown")
                .field(name)
                .found("a motion without orientations")
                .allowed("a motion with the columns qw, qx, qy and qz"));
        }
        Ok(Self {
            name: name.to_owned(),
            boxes,
            motion: BodyMotion::Moving(motion),
        })
    }

    /// A body that does not move.
    pub fn still(name: &str, boxes: Vec<BodyBox>, world_from_body: Isometry3<f64>) -> Self {
        Self {
            name: name.to_owned(),
            boxes,
            motion: BodyMotion::Still(world_from_body),
        }
    }

    /// Name of the body.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn pose(&self, since_start_s: f64) -> Isometry3<f64> {
        match &self.motion {
            BodyMotion::Still(pose) => *pose,
            BodyMotion::Moving(motion) => {
                let mut at = Interpolator::new(motion);
                let place_m = at.position_world_m(since_start_s);
                let turn = at.orientation_world_from_body(since_start_s);
                Isometry3::from_parts(place_m.into(), turn.unwrap_or_default())
            }
        }
    }

    fn blocks(&self, frame: &MotionFrame, since_start_s: f64) -> Vec<Block> {
        let world_from_body = self.pose(since_start_s);
        let blocks = self.boxes.iter().map(|one| {
            let world_from_box = world_from_body * one.body_from_box;
            let turn = world_from_box.rotation;
            Block {
                centre_m: frame.place_m(world_from_box.translation.vector),
                half_m: one.half_m.into(),
                axes: [Vector3::x(), Vector3::y(), Vector3::z()]
                    .map(|axis| frame.direction(turn * axis)),
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

/// The transformation from the world frame of a motion to the frame of the room.
#[derive(Debug, Clone, Copy)]
pub(super) struct MotionFrame {
    first_m: [f64; 2],
    start_m: [f64; 2],
    /// Cosine and sine of the rotation about the vertical.
    facing: [f64; 2],
}

impl MotionFrame {
    /// The transformation that moves the first position of the motion to the start of the mount, keeps heights, and turns the x axis of
    /// the motion to the direction of the mount.
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

/// A scene with the bodies of one motion in it.
#[derive(Debug, Clone)]
pub(super) struct MovingScene<'a> {
    pub(super) scene: &'a Scene,
    pub(super) frame: MotionFrame,
    pub(super) bodies: &'a [Body],
    /// Name of the body that carries the camera.
    pub(super) carrier: Option<&'a str>,
    pub(super) duration_s: f64,
}

impl<'a> MovingScene<'a> {
    /// The scene with all bodies at a time, for a camera at this position. The body that carries the camera is invisible while the camera
    /// is inside of one of its boxes.
    pub(super) fn room_at(&self, since_start_s: f64, camera_m: Vector) -> Cow<'a, Scene> {
        if self.bodies.is_empty() {
            return Cow::Borrowed(self.scene);
        }
        let mut scene = self.scene.clone();
        for body in self.bodies {
            let mut blocks = body.blocks(&self.frame, since_start_s);
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

    /// Checks that this is a time of the motion, and that all moving bodies are inside of the room at that time.
    ///
    /// # Errors
    /// A time outside of the motion; a body outside of the room, with its name, position and the time.
    pub(super) fn check(&self, since_start_s: f64) -> Result<()> {
        if !(0.0..=self.duration_s).contains(&since_start_s) {
            return Err(Error::invalid("not a time of the motion")
                .found(format!("{since_start_s} s"))
                .allowed(format!("0 to {} s after its first sample", self.duration_s)));
        }
        let room_m = self.scene.room_m;
        for body in self.bodies {
            if matches!(body.motion, BodyMotion::Still(_)) {
                continue;
            }
            for block in body.blocks(&self.frame, since_start_s) {
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
                        .hint("`start_m` and `facing_deg` of the mount state where the motion begins; its lengths may be in another unit, or its heights relative to another floor"));
                }
            }
        }
        Ok(())
    }
}
