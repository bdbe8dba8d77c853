//! Positions of all cubes and plates at zero servo angles, and the check that none of them overlap.

use nalgebra::{Isometry3, Translation3, Vector3};

use super::assembly::Role;
use super::attachment::Attachment;
use super::face::CubeRotation;
use super::flaw::{Checked, Flaw};
use super::module::Module;
use super::tree::{Edge, Links, Tree, is_attached};
use realgap_core::Error;

/// Boxes may overlap by this depth, m: a tolerance for rounding errors.
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
pub(super) fn place(modules: &[Module], links: Links<'_>, tree: &Tree) -> Vec<Placement> {
    let origin = Placement {
        robot_from_module: CubeRotation::identity(),
        centre_robot_m: Vector3::zeros(),
    };
    let mut placements = vec![origin; modules.len()];
    for &module in &tree.order {
        let Some(edge) = tree.parent[module] else {
            continue;
        };
        let (parent, turn, centre_m) = match edge {
            Edge::Attachment(index) => {
                let attachment = &links.attachments[index];
                let centre_m = attachment.child_centre_m(
                    &modules[attachment.parent].sides_m,
                    &modules[module].sides_m,
                );
                (attachment.parent, attachment.parent_from_child(), centre_m)
            }
            Edge::Pivot(index) => {
                let pivot = &links.pivots[index];
                (
                    pivot.parent,
                    CubeRotation::identity(),
                    pivot.child_centre_m(),
                )
            }
        };
        let parent = placements[parent];
        placements[module] = Placement {
            robot_from_module: turn.then(parent.robot_from_module),
            centre_robot_m: parent.point(centre_m),
        };
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

/// All boxes that take part in contacts: those of all modules, and the plates without an attached module.
pub(super) fn blocks(
    modules: &[Module],
    attachments: &[Attachment],
    placements: &[Placement],
) -> Vec<Block> {
    let mut blocks = Vec::with_capacity(modules.len());
    for (index, (module, placement)) in modules.iter().zip(placements).enumerate() {
        blocks.extend(module.solid_boxes().iter().map(|part| {
            Block {
                module: index,
                role: Role::Cube,
                centre_robot_m: placement.point(part.centre_m),
                half_robot_m: placement
                    .robot_from_module
                    .apply_to_extents(part.sides_m / 2.0),
            }
        }));
        if let Some((centre, half)) = plate_box(module)
            && module
                .driven_face()
                .is_some_and(|face| !is_attached(attachments, index, face))
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
        face.normal() * ((module.sides_m[face.axis_index()] + plate.thickness_m) / 2.0),
        half,
    ))
}

/// Refuses robots in which two boxes overlap at zero angles. Boxes may touch, and pairs for which `is_excluded` is true may
/// overlap.
pub(super) fn check_overlap(
    modules: &[Module],
    tree: &Tree,
    blocks: &[Block],
    is_excluded: impl Fn(usize, usize) -> bool,
) -> Checked<()> {
    for (index, block) in blocks.iter().enumerate() {
        let collides = |other: &&Block| {
            let is_own = other.module == block.module
                && other.role == Role::Cube
                && block.role == Role::Cube;
            other.overlaps(block) && !is_own && !is_excluded(other.module, block.module)
        };
        let Some(other) = blocks[..index].iter().find(collides) else {
            continue;
        };
        let rank = |module: usize| tree.order.iter().position(|&m| m == module);
        // The error names the module further from the root, because that module is more likely to be misplaced.
        let (first, second) = if rank(other.module) <= rank(block.module) {
            (other, block)
        } else {
            (block, other)
        };
        let path = match (second.role, tree.parent[second.module]) {
            (Role::Cube, Some(edge)) => edge.path(),
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
            .allowed("boxes that touch or are separate when all servos are at 0 rad"),
        ));
    }
    Ok(())
}
