//! Portraits: a robot as [`plot`](crate::plot) draws it.

use std::path::Path;

use crate::plot::{
    Block, BlockKind, Caption, Command, DrivenFace, Gallery, GalleryRobot, ModuleName, Motion,
    draw_gallery, number,
};
use realgap_core::Result;
use realgap_core::unit::counted;
use realgap_robot::morphology::{DriveAxis, Morphology, Role, Solid, Surface};

/// Time over which a gait is drawn, seconds, and its points.
pub(super) const GAIT_S: f64 = 2.0;
const GAIT_POINTS: usize = 120;
/// The largest number of names in a picture: more would hide the robot.
const NAMES_AT_MOST: usize = 12;

/// The commanded angles of each servo, in the order of the hinges.
fn commands(robot: &Morphology) -> Vec<Command> {
    let time_s = |k: usize| GAIT_S * k as f64 / (GAIT_POINTS - 1) as f64;
    let hinges = robot.assemble().hinges.into_iter();
    let told = hinges.filter_map(|hinge| Some((hinge.name, hinge.actuator?.gait)));
    let told = told.map(|(servo, gait)| {
        let angles_rad = (0..GAIT_POINTS).map(|k| gait.angle_rad(time_s(k)));
        let angles_rad = angles_rad.collect();
        Command { servo, angles_rad }
    });
    told.collect()
}

/// The surface of a solid; `None` for a box along the axes of the robot, which a block is already.
fn surface(solid: &Solid) -> Option<Surface> {
    let turn = solid.robot_from_solid.rotation.to_rotation_matrix();
    let is_along = |v: &f64| v.abs() < 1e-9 || v.abs() > 1.0 - 1e-9;
    let is_block = solid.shape.is_box() && turn.matrix().iter().all(is_along);
    let own = (!is_block).then(|| solid.shape.surface()).flatten()?;
    Some(own.placed(&solid.robot_from_solid))
}

/// The names of its modules, if there are not too many.
fn names(robot: &Morphology) -> Vec<ModuleName> {
    let modules = robot.modules();
    if modules.len() > NAMES_AT_MOST {
        return Vec::new();
    }
    let assembly = robot.assemble();
    let solids = assembly.parts.iter().flat_map(|part| &part.solids);
    let first = solids.filter(|solid| solid.role == Role::Cube && solid.number == 0);
    let names = first.map(|solid| {
        let (lower_m, upper_m) = solid.bounds_robot_m();
        ModuleName {
            text: modules[solid.module].name.clone(),
            lower_m: lower_m.into(),
            upper_m: upper_m.into(),
            is_tracked: solid.module == robot.track(),
        }
    });
    names.collect()
}

/// The shapes of a robot at zero servo angles, robot frame, and its gait, with a title and a note to stand above them.
pub fn portrait(robot: &Morphology, note: impl Into<String>) -> GalleryRobot {
    let modules = robot.modules();
    let mut blocks = Vec::new();
    let assembly = robot.assemble();
    let parts = assembly.parts.iter().enumerate();
    let solids = parts.flat_map(|(part, cluster)| cluster.solids.iter().map(move |s| (part, s)));
    // A plate with a module glued onto it is inside of that module; the band on its cube shows the plate.
    for (part, solid) in solids.filter(|(_, solid)| solid.has_surface()) {
        let turn = solid.robot_from_solid.rotation;
        let (lower_m, upper_m) = solid.bounds_robot_m();
        let drive = modules[solid.module].drive.filter(|_| solid.number == 0);
        let driven = drive.map(|drive| {
            let normal = turn * drive.face.normal();
            DrivenFace {
                axis: normal.iamax(),
                positive: normal[normal.iamax()] > 0.0,
                motion: match drive.axis {
                    DriveAxis::Normal { .. } => Motion::Spin,
                    DriveAxis::Tangent { .. } => Motion::Bend,
                },
            }
        });
        blocks.push(Block {
            lower_m: lower_m.into(),
            upper_m: upper_m.into(),
            kind: match (solid.role, driven) {
                _ if assembly.drives(part) => BlockKind::DrivenBody,
                _ if !assembly.is_modular => BlockKind::Body,
                (Role::Plate, _) => BlockKind::Plate,
                (Role::Cube, Some(_)) => BlockKind::Active,
                (Role::Cube, None) => BlockKind::Passive,
            },
            driven,
            surface: surface(solid),
        });
    }
    GalleryRobot {
        title: robot.name().to_owned(),
        note: note.into(),
        blocks,
        names: Vec::new(),
        commands: commands(robot),
    }
}

/// Draws one robot into a PNG or SVG file, with its size and mass.
///
/// # Errors
/// As [`draw_gallery`].
pub fn draw(robot: &Morphology, path: impl AsRef<Path>) -> Result<()> {
    let summary = robot.summary();
    let size_m = summary.size_m();
    let pieces = match robot.assemble().is_modular {
        true => counted(summary.modules, "module"),
        false => format!("{} bodies", summary.modules),
    };
    let note = format!(
        "{pieces}, {}, {} g, {} × {} × {} cm, at zero servo angles",
        counted(summary.servos, "servo"),
        number(1e3 * summary.mass_kg),
        number(1e2 * size_m.x),
        number(1e2 * size_m.y),
        number(1e2 * size_m.z),
    );
    let gallery = Gallery {
        caption: Caption::new(robot.name(), robot.description()),
        columns: 1,
        robots: vec![GalleryRobot {
            title: note,
            names: names(robot),
            ..portrait(robot, "")
        }],
        gait_s: GAIT_S,
    };
    draw_gallery(&gallery, path)
}
