//! Check for plates that hit another module of their own robot when they turn.

use nalgebra::{Rotation2, Vector2};

use super::Morphology;
use super::assembly::Role;
use super::layout::{Block, OVERLAP_TOLERANCE_M, blocks};

/// Number of angle steps over the range of a gait at which a plate is checked.
const ANGLES: u32 = 64;

/// Pairs (module with the plate, module that the plate hits), without duplicates, in the order of the modules.
pub(super) fn blocked_plates(morphology: &Morphology) -> Vec<(usize, usize)> {
    let all = blocks(
        morphology.modules(),
        morphology.attachments(),
        &morphology.placements,
    );
    let mut blocked = Vec::new();
    for plate in all.iter().filter(|block| block.role == Role::Plate) {
        for other in all.iter().filter(|other| other.module != plate.module) {
            let pair = (plate.module, other.module);
            let is_excluded = morphology.is_collision_excluded(pair.0, pair.1);
            if !is_excluded && !blocked.contains(&pair) && hits(morphology, plate, other) {
                blocked.push(pair);
            }
        }
    }
    blocked
}

/// Whether a plate overlaps a fixed box at some angle of the gait.
fn hits(morphology: &Morphology, plate: &Block, other: &Block) -> bool {
    let Some(drive) = morphology.modules()[plate.module].drive else {
        return false;
    };
    let rotation = morphology.placements[plate.module].robot_from_module;
    let normal = rotation.apply(drive.face.normal());
    let axis = normal.iamax();
    // Right-handed about the outward normal; the plane's own axes are right-handed about the positive axis.
    let sense = normal[axis].signum();
    let offset = other.centre_robot_m - plate.centre_robot_m;
    let depth = plate.half_robot_m[axis] + other.half_robot_m[axis] - offset[axis].abs();
    if depth <= OVERLAP_TOLERANCE_M {
        return false;
    }
    let flat = |v: nalgebra::Vector3<f64>| Vector2::new(v[(axis + 1) % 3], v[(axis + 2) % 3]);
    let (offset, half, other_half) = (
        flat(offset),
        flat(plate.half_robot_m),
        flat(other.half_robot_m),
    );
    let gait = drive.actuator.gait;
    (0..=ANGLES).any(|step| {
        let share = 2.0 * f64::from(step) / f64::from(ANGLES) - 1.0;
        let angle_rad = gait.offset_rad + gait.amplitude_rad * share;
        overlap(Rotation2::new(sense * angle_rad), half, other_half, offset)
    })
}

/// Separating-axis test of a rotated and an axis-aligned rectangle; `offset` is the vector between their centres.
fn overlap(
    turn: Rotation2<f64>,
    half: Vector2<f64>,
    other_half: Vector2<f64>,
    offset: Vector2<f64>,
) -> bool {
    let matrix = turn.matrix();
    let own = [matrix.column(0).into_owned(), matrix.column(1).into_owned()];
    [Vector2::x(), Vector2::y(), own[0], own[1]]
        .iter()
        .all(|axis| {
            let reach = half.x * axis.dot(&own[0]).abs()
                + half.y * axis.dot(&own[1]).abs()
                + other_half.dot(&axis.abs());
            reach - axis.dot(&offset).abs() > OVERLAP_TOLERANCE_M
        })
}
