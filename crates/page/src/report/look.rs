//! What robots look like in every picture: boxes and colours, for who takes pictures of them.

use nalgebra::{Isometry3, Vector3};

use super::motion::robot_boxes;
use super::stage::Kind;
use realgap_engine::SceneBody;
use realgap_robot::morphology::Morphology;

/// A box as it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownBox {
    /// Half of its sides, metres.
    pub half_m: Vector3<f64>,
    /// Its pose in the frame of what carries it.
    pub pose: Isometry3<f64>,
    /// Share of the light that comes back, for red, green and blue.
    pub colour: [f64; 3],
}

/// The boxes of every part of a robot in the part's own frame, as replays show them.
pub fn shown_parts(robot: &Morphology) -> Vec<Vec<ShownBox>> {
    let mut parts = vec![Vec::new(); robot.assemble().parts.len()];
    for one in robot_boxes(robot) {
        parts[one.part].push(ShownBox {
            half_m: one.half_m,
            pose: one.part_from_box,
            colour: one.kind.light(),
        });
    }
    parts
}

/// The boxes of a body beside the robot in its own frame, as replays show them.
pub fn shown_body(body: &SceneBody) -> Vec<ShownBox> {
    let boxes = body.boxes.iter().map(|one| ShownBox {
        half_m: 0.5 * one.sides_m,
        pose: one.body_from_box,
        colour: Kind::Other.light(),
    });
    boxes.collect()
}
