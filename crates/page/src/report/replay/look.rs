//! The appearance of robots, shared by all renderers: shapes and colours.

use nalgebra::Isometry3;

use crate::report::replay::solid::{Kind, Solid, robot_solids};
use realgap_robot::morphology::{Morphology, Shape};
use realgap_simulation::SceneBody;

/// A shape as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownSolid {
    /// Its shape.
    pub shape: Shape,
    /// Its pose in the frame of the body that carries it.
    pub pose: Isometry3<f64>,
    /// Share of the light that is reflected, for red, green and blue.
    pub colour: [f64; 3],
}

/// The shapes of every part of a robot in the part's own frame, as replays show them.
pub fn shown_parts(robot: &Morphology) -> Vec<Vec<ShownSolid>> {
    let mut parts = vec![Vec::new(); robot.assemble().parts.len()];
    for one in robot_solids(robot) {
        let Solid { shape, pose, kind } = one.solid;
        let colour = kind.light();
        parts[one.part].push(ShownSolid {
            shape,
            pose,
            colour,
        });
    }
    parts
}

/// The shapes of a body beside the robot in its own frame, as replays show them.
pub fn shown_body(body: &SceneBody) -> Vec<ShownSolid> {
    let boxes = body.boxes.iter().map(|one| ShownSolid {
        shape: Shape::cuboid(0.5 * one.sides_m),
        pose: one.body_from_box,
        colour: Kind::Other.light(),
    });
    boxes.collect()
}
