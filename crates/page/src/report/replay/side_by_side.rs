//! Several robots in motion side by side: each on a lane of its own, all with their net displacement along +x.

use nalgebra::{Isometry3, Vector3};

use crate::report::folder::page_data::ReplayData;
use crate::report::replay::page::{Replay, SIMULATION};
use realgap_core::error::Result;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Film, Floor, SceneBody, SceneBox, SceneMotion, part_from_solid};

/// Free ground between two lanes, in lengths of the larger robot.
const APART: f64 = 1.5;

/// The runs of these robots side by side, the camera on the first; `None` for no robot.
///
/// # Errors
/// Paths too long to be moved.
pub fn side_by_side(runs: &[(&Morphology, Film)], floor: Floor) -> Result<Option<ReplayData>> {
    let Some(((first, film), others)) = runs.split_first() else {
        return Ok(None);
    };
    let mut seen = on_lane(film, 0.0)?;
    let mut bodies = Vec::new();
    let mut lane_m = 0.0;
    let mut before_m = size_m(first);
    for (robot, film) in others {
        let here_m = size_m(robot);
        lane_m += APART * before_m.max(here_m);
        before_m = here_m;
        let film = on_lane(film, lane_m)?;
        let assembly = robot.assemble();
        for (part, poses) in film.parts.into_iter().enumerate() {
            let Some(poses) = poses else { continue };
            let solids = assembly.parts[part].solids.iter();
            let boxes = solids
                .filter(|solid| solid.has_surface())
                .map(|solid| SceneBox {
                    sides_m: 2.0 * solid.shape.half_extents_m(),
                    body_from_box: part_from_solid(&assembly, part, solid),
                });
            bodies.push(SceneBody {
                name: format!("{}.{part}", robot.name()),
                boxes: boxes.collect(),
                friction: floor.friction,
                motion: SceneMotion::Driven { track: None },
            });
            seen.scene.push(at_times_of(poses, seen.track.len()));
        }
    }
    let replay = Replay {
        robot: Some(first),
        run: &seen,
        run_name: SIMULATION,
        recordings: &[],
        align: false,
        floor,
        scene: &bodies,
        warnings: &[],
        provenance: &[],
    };
    replay.data().map(Some)
}

/// The run turned so that it ends in the direction of +x, from the start of a lane.
fn on_lane(film: &Film, lane_m: f64) -> Result<Film> {
    let places = film.track.positions_world_m();
    let (start, end) = (places[0], places[places.len() - 1]);
    let way = end - start;
    let turn_rad = -libm::atan2(way.y, way.x);
    let turned = film.moved(turn_rad, Vector3::zeros())?;
    let start = turned.track.positions_world_m()[0];
    turned.moved(0.0, Vector3::new(-start.x, lane_m - start.y, 0.0))
}

/// As many poses as the first robot has; runs of one search are equally long.
fn at_times_of(mut poses: Vec<Isometry3<f64>>, samples: usize) -> Vec<Isometry3<f64>> {
    let last = poses.last().copied().unwrap_or_else(Isometry3::identity);
    poses.resize(samples, last);
    poses
}

fn size_m(robot: &Morphology) -> f64 {
    robot.summary().size_m().norm()
}
