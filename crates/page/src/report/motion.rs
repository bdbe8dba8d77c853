//! A run in motion as numbers: shapes of the robot and of other bodies, and where they are over time.

use nalgebra::Isometry3;
use serde_json::{Value, json};

use super::block::Block;
use super::stage::{Kind, continuous, picks};
use realgap_engine::{Film, SceneBody, SceneMotion, part_from_solid};
use realgap_robot::morphology::{Drive, DriveAxis, Morphology, Role, Shape};

/// Steps that numbers in the page are rounded to; also said on the page.
const LENGTH_STEP_M: f64 = 2e-5;
const TURN_STEP: f64 = 1e-4;
const TIME_STEP_S: f64 = 1e-4;
/// Time, length, turn.
pub(super) const STEPS: [f64; 3] = [TIME_STEP_S, LENGTH_STEP_M, TURN_STEP];
/// Corners of surfaces are whole multiples of this, as `scene.js` knows.
const CORNER_STEP_M: f64 = 1e-5;

/// A pose as seven numbers: place, then orientation with its real part first.
fn pose_json(pose: &Isometry3<f64>) -> Value {
    let (t, q) = (pose.translation.vector, pose.rotation);
    json!([t.x, t.y, t.z, q.w, q.i, q.j, q.k])
}

/// A solid of a robot.
pub(super) struct RobotSolid<'a> {
    pub(super) part: usize,
    pub(super) shape: Shape,
    pub(super) part_from_solid: Isometry3<f64>,
    pub(super) kind: Kind,
    /// Of the first cube of a module: its name.
    name: &'a str,
    drive: Option<Drive>,
    is_tracked: bool,
}

/// The solids of a robot that have a surface, in the frames of their parts.
pub(super) fn robot_solids(robot: &Morphology) -> Vec<RobotSolid<'_>> {
    let assembly = robot.assemble();
    let mut all = Vec::new();
    for (part, cluster) in assembly.parts.iter().enumerate() {
        // A plate with a module glued onto it is inside of that module.
        for solid in cluster.solids.iter().filter(|solid| solid.has_surface()) {
            let module = &robot.modules()[solid.module];
            let is_first = solid.number == 0 && solid.role == Role::Cube;
            let drive = module.drive.filter(|_| is_first);
            all.push(RobotSolid {
                part,
                shape: solid.shape.clone(),
                part_from_solid: part_from_solid(&assembly, part, solid),
                kind: match solid.role {
                    Role::Plate => Kind::Plate,
                    Role::Cube if drive.is_some() || assembly.drives(part) => Kind::Active,
                    Role::Cube => Kind::Passive,
                },
                name: if is_first { &module.name } else { "" },
                drive,
                is_tracked: solid.module == robot.track() && solid.role == Role::Cube,
            });
        }
    }
    all
}

/// The same as the page has them.
pub(super) fn boxes(robot: &Morphology) -> Vec<Value> {
    let solids = robot_solids(robot).into_iter();
    solids
        .map(|one| {
            let mut shown = json!({
                "part": one.part,
                "half": one.shape.half_extents_m().as_slice(),
                "pose": pose_json(&one.part_from_solid),
                "name": one.name,
                "kind": match one.kind {
                    Kind::Plate => "plate",
                    Kind::Active => "active",
                    _ => "passive",
                },
                "tracked": one.is_tracked,
                "normal": one.drive.map(|drive| drive.face.normal().as_slice().to_vec()),
                "spins": one.drive.map(|drive| matches!(drive.axis, DriveAxis::Normal { .. })),
            });
            if let Some(surface) = one.shape.surface().filter(|_| !one.shape.is_box()) {
                let corners = surface.corners_m.iter().flatten();
                let triangles = surface.triangles().flat_map(|(_, corners)| corners);
                shown["corners"] = corners.map(|m| (m / CORNER_STEP_M).round()).collect();
                shown["triangles"] = triangles.collect();
            }
            shown
        })
        .collect()
}

/// The boxes of a body that stands still, in the world.
pub(super) fn fixed_boxes(body: &SceneBody) -> Vec<Value> {
    let SceneMotion::Fixed { world_from_body } = &body.motion else {
        return Vec::new();
    };
    let boxes = body.boxes.iter();
    boxes
        .map(|one| {
            let half = 0.5 * one.sides_m;
            json!({ "half": half.as_slice(), "pose": pose_json(&(world_from_body * one.body_from_box)) })
        })
        .collect()
}

/// Other bodies that move in a film, by index.
fn moving<'a>(scene: &'a [SceneBody], film: &'a Film) -> impl Iterator<Item = usize> + 'a {
    let bodies = scene.iter().zip(&film.scene).enumerate();
    bodies
        .filter(|(_, (body, _))| !matches!(body.motion, SceneMotion::Fixed { .. }))
        .map(|(index, _)| index)
}

/// What is known of a film, as parts: those of the robot, then other bodies that move.
pub(super) fn known_parts(scene: &[SceneBody], film: &Film) -> Vec<usize> {
    let parts = film.parts.iter().enumerate();
    let parts = parts
        .filter(|(_, poses)| poses.is_some())
        .map(|(part, _)| part);
    let bodies = moving(scene, film).map(|body| film.parts.len() + body);
    parts.chain(bodies).collect()
}

/// Boxes of the bodies that move, as those of parts behind the robot's.
pub(super) fn moving_boxes(scene: &[SceneBody], run: &Film) -> Vec<Value> {
    let of_body = |body: usize| {
        let boxes = scene[body].boxes.iter();
        boxes.map(move |one| {
            json!({
                "part": run.parts.len() + body,
                "half": (0.5 * one.sides_m).as_slice(),
                "pose": pose_json(&one.body_from_box),
                "name": "",
                "kind": "scene",
            })
        })
    };
    moving(scene, run).flat_map(of_body).collect()
}

/// Adds a film's columns: times, the tracked point, then of each known part and each moving body its place and orientation, at most
/// so many numbers. Returns every how manyth sample is in there.
pub(super) fn push_film(block: &mut Block, film: &Film, scene: &[SceneBody], most: usize) -> usize {
    let samples = film.track.len();
    let bodies = moving(scene, film).map(|body| &film.scene[body]);
    let known: Vec<_> = film.parts.iter().flatten().chain(bodies).collect();
    let columns = 4 + 7 * known.len();
    let every = (samples * columns).div_ceil(most).max(1);
    let picks = picks(samples, every);
    let (times_s, places) = (film.track.times_s(), film.track.positions_world_m());
    block.push(picks.iter().map(|k| times_s[*k] - times_s[0]), TIME_STEP_S);
    let place = |sample: usize, axis: usize| places[sample][axis];
    for axis in 0..3 {
        block.push(picks.iter().map(|k| place(*k, axis)), LENGTH_STEP_M);
    }
    for poses in known {
        for axis in 0..3 {
            let along = picks.iter().map(|k| poses[*k].translation.vector[axis]);
            block.push(along, LENGTH_STEP_M);
        }
        let turns = continuous(picks.iter().map(|k| poses[*k].rotation));
        let turns: Vec<[f64; 4]> = turns.map(|q| [q.w, q.i, q.j, q.k]).collect();
        for axis in 0..4 {
            block.push(turns.iter().map(|turn| turn[axis]), TURN_STEP);
        }
    }
    every
}
