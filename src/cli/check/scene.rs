//! What the file of a scene holds.

use realgap::file::Source;
use realgap::text::shown;
use realgap::vision::camera::Scene;

use super::super::kit::*;
use super::{Contents, Kind, SHOWN, report};

pub(super) fn describe(source: &Source) -> Result<Contents> {
    let scene = Scene::parse(source)?;
    let [x, y, z] = scene.room_m;
    let counts = [
        counted(scene.blocks.len(), "block"),
        counted(scene.posters.len(), "poster"),
        counted(scene.lights.len(), "light"),
        counted(scene.cameras.len(), "camera"),
        counted(scene.views.len(), "view"),
    ];
    Ok(Contents {
        kind: Kind::Scene,
        lines: vec![format!(
            "  scene \"{}\": {x} x {y} x {z} m, {}",
            shown(&scene.name, SHOWN),
            counts.join(", ")
        )],
        details: report::Contents::Scene {
            room_m: scene.room_m,
            lights: scene.lights.len(),
            cameras: scene.cameras.len(),
            views: scene.views.len(),
            name: scene.name,
        },
        warnings: Vec::new(),
    })
}
