//! Where every cube and plate is at zero servo angles, and whether two are in the same place.

use nalgebra::{Isometry3, Translation3, Vector3};

use super::assembly::Role;
use super::face::CubeRotation;
use super::flaw::{Checked, Flaw};
use super::glue::Glue;
use super::module::Module;
use super::tree::{Tree, is_glued};
use crate::Error;

/// Boxes may share this much depth, m: rounding, not design.
pub(super) const OVERLAP_TOLERANCE_M: f64 = 1e-6;

/// Pose of a module's cube in the robot frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub(super) robot_from_module: CubeRotation,
    pub(super) centre_robot_m: Vector3<f64>,
}

impl Placement {
    pub(super) fn pose_of(&self, centre_module_m: Vector3<f64>) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::from(self.point(centre_module_m)),
            self.robot_from_module.quaternion(),
        )
    }

    pub(super) fn point(&self, module_m: Vector3<f64>) -> Vector3<f64> {
        self.centre_robot_m + self.robot_from_module.apply(module_m)
    }
}

/// Places every module, root at the origin.
pub(super) fn place(modules: &[Module], glue: &[Glue], tree: &Tree) -> Vec<Placement> {
    let origin = Placement {
        robot_from_module: CubeRotation::identity(),
        centre_robot_m: Vector3::zeros(),
    };
    let mut placements = vec![origin; modules.len()];
    for &module in &tree.order {
        if let Some(index) = tree.parent_glue[module] {
            let joint = &glue[index];
            let parent = placements[joint.parent];
            let centre = joint.child_centre_m(modules[joint.parent].side_m, modules[module].side_m);
            placements[module] = Placement {
                robot_from_module: joint.parent_from_child().then(parent.robot_from_module),
                centre_robot_m: parent.point(centre),
            };
        }
    }
    placements
}

/// A box along the axes of the robot frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block {
    pub(super) module: usize,
    pub(super) role: Role,
    pub(super) centre_robot_m: Vector3<f64>,
    pub(super) half_robot_m: Vector3<f64>,
}

impl Block {
    fn overlaps(&self, other: &Self) -> bool {
        let distance = (self.centre_robot_m - other.centre_robot_m).abs();
        let depth = self.half_robot_m + other.half_robot_m - distance;
        depth.min() > OVERLAP_TOLERANCE_M
    }

    fn describe(&self, modules: &[Module]) -> String {
        let name = &modules[self.module].name;
        match self.role {
            Role::Cube => format!("`{name}`"),
            Role::Plate => format!("the face plate of `{name}`"),
        }
    }
}

/// Every box that can touch something: all cubes, and the plates with nothing glued on them.
pub(super) fn blocks(modules: &[Module], glue: &[Glue], placements: &[Placement]) -> Vec<Block> {
    let mut blocks = Vec::with_capacity(modules.len());
    for (index, (module, placement)) in modules.iter().zip(placements).enumerate() {
        blocks.push(Block {
            module: index,
            role: Role::Cube,
            centre_robot_m: placement.centre_robot_m,
            half_robot_m: Vector3::repeat(module.side_m / 2.0),
        });
        if let Some((centre, half)) = plate_box(module)
            && module
                .driven_face()
                .is_some_and(|face| !is_glued(glue, index, face))
        {
            blocks.push(Block {
                module: index,
                role: Role::Plate,
                centre_robot_m: placement.point(centre),
                half_robot_m: placement.robot_from_module.apply_to_extents(half),
            });
        }
    }
    blocks
}

/// Centre and half extents of a module's plate in the module's frame, m.
pub(super) fn plate_box(module: &Module) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let plate = module.plate()?;
    let face = module.driven_face()?;
    let mut half = Vector3::repeat(plate.side_m / 2.0);
    half[face.axis_index()] = plate.thickness_m / 2.0;
    Some((
        face.normal() * ((module.side_m + plate.thickness_m) / 2.0),
        half,
    ))
}

/// Refuses robots in which two boxes are in the same place at zero angles. Touching is fine.
pub(super) fn check_overlap(modules: &[Module], tree: &Tree, blocks: &[Block]) -> Checked<()> {
    for (index, block) in blocks.iter().enumerate() {
        let Some(other) = blocks[..index].iter().find(|other| other.overlaps(block)) else {
            continue;
        };
        let rank = |module: usize| tree.order.iter().position(|&m| m == module);
        // The one further from the root is the likelier slip.
        let (first, second) = if rank(other.module) <= rank(block.module) {
            (other, block)
        } else {
            (block, other)
        };
        let path = match (second.role, tree.parent_glue[second.module]) {
            (Role::Cube, Some(index)) => format!("glue[{index}]"),
            _ => format!("modules[{}]", second.module),
        };
        let [x, y, z] = second.centre_robot_m.into();
        return Err(Flaw::new(
            path,
            Error::invalid(format!(
                "{} and {} are in the same place",
                first.describe(modules),
                second.describe(modules)
            ))
            .found(format!(
                "{} centred at ({x:.4}, {y:.4}, {z:.4}) m in the frame of the root",
                second.describe(modules)
            ))
            .allowed("boxes that touch, or lie apart, when all servos are at 0 rad"),
        ));
    }
    Ok(())
}
