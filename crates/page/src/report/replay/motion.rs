//! A run in motion as numbers: shapes of the robot and of other bodies, and where they are over time.

use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

use crate::report::document::packed::PackedColumns;
use crate::report::replay::solid::{Kind, RobotSolid, Solid, robot_solids};
use crate::report::replay::stage::{continuous, picks};
use realgap_robot::morphology::{DriveAxis, Morphology};
use realgap_simulation::{Film, Floor, SceneBody, SceneMotion};

/// Steps to which numbers in the page are rounded; the data of the page name them, too.
const LENGTH_STEP_M: f64 = 2e-5;
const TURN_STEP: f64 = 1e-4;
const TIME_STEP_S: f64 = 1e-4;
/// Time, length, turn.
const STEPS: [f64; 3] = [TIME_STEP_S, LENGTH_STEP_M, TURN_STEP];
/// Corners of surfaces are whole multiples of this, as `scene.js` knows.
const CORNER_STEP_M: f64 = 1e-5;

/// What scripts show of a replay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShownScene {
    /// What numbers of the motion are whole multiples of: time in seconds, length in metres, turn.
    steps: [f64; 3],
    /// The runs: first the simulated one, then the recorded ones.
    pub(in crate::report) tracks: Vec<ShownTrack>,
    /// Number of the robot's parts.
    parts: usize,
    /// Shapes that move.
    boxes: Vec<ShownBox>,
    /// The ground.
    floor: ShownFloor,
    /// Boxes that stand still, in the world.
    scene: Vec<FixedBox>,
    /// Whether the robot's root is held in the world: then it differs from its recordings by its joints, and not by where it is.
    #[serde(default)]
    is_held: bool,
}

/// A run of a replay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(in crate::report) struct ShownTrack {
    /// Its name.
    pub(in crate::report) name: String,
    /// Whether it was recorded.
    recorded: bool,
    /// The parts whose motion is known.
    parts: Vec<usize>,
}

/// The ground of a replay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ShownFloor {
    /// Height at the origin, metres.
    height_m: f64,
    /// How far it falls along x, radians.
    slope_rad: f64,
}

/// Where a box lies: half its edges in metres, its place in metres and its orientation, real part first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FixedBox {
    /// Half its edges, metres.
    half: [f64; 3],
    /// Its place in metres, then its orientation with the real part first.
    pose: [f64; 7],
}

/// A shape of a part that moves, in the frame of the part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ShownBox {
    /// Number of its part; other bodies come behind the robot's.
    part: usize,
    /// Half the edges of the box around it, metres.
    half: [f64; 3],
    /// Its place in metres, then its orientation with the real part first.
    pose: [f64; 7],
    /// Name of its module, where it is the first of it.
    name: String,
    /// What it is: `plate`, `active`, `passive` or `scene`.
    kind: String,
    /// Whether it is the one that is tracked.
    #[serde(default)]
    tracked: bool,
    /// Which way its driven face points.
    normal: Option<[f64; 3]>,
    /// Whether that face spins; otherwise it bends.
    spins: Option<bool>,
    /// Corners of what is no box, in steps of 0.01 mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    corners: Vec<f64>,
    /// Its triangles: numbers of corners.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    triangles: Vec<usize>,
}

impl ShownScene {
    /// The runs, the first of them simulated, with the robot and what stands beside it.
    pub(in crate::report) fn new<'a>(
        robot: Option<&Morphology>,
        runs: impl Iterator<Item = (&'a str, &'a Film)>,
        run: &Film,
        floor: Floor,
        scene: &[SceneBody],
    ) -> Self {
        let tracks = runs.enumerate().map(|(index, (name, film))| ShownTrack {
            name: name.to_owned(),
            recorded: index > 0,
            parts: known_parts(scene, film),
        });
        let mut boxes = robot.map(robot_boxes).unwrap_or_default();
        boxes.extend(moving_boxes(scene, run));
        Self {
            steps: STEPS,
            tracks: tracks.collect(),
            parts: run.parts.len(),
            boxes,
            floor: ShownFloor {
                height_m: floor.height_m,
                slope_rad: floor.slope_rad,
            },
            scene: scene.iter().flat_map(fixed_boxes).collect(),
            is_held: robot.is_some_and(|robot| robot.assemble().world_from_mount.is_some()),
        }
    }
}

/// A pose as seven numbers: place, then orientation with its real part first.
fn numbers(pose: &Isometry3<f64>) -> [f64; 7] {
    let (t, q) = (pose.translation.vector, pose.rotation);
    [t.x, t.y, t.z, q.w, q.i, q.j, q.k]
}

/// The solids of a robot as the page has them.
fn robot_boxes(robot: &Morphology) -> Vec<ShownBox> {
    let shown = |one: RobotSolid<'_>| {
        let Solid { shape, pose, kind } = &one.solid;
        let kind = match kind {
            Kind::Plate => "plate",
            Kind::Active => "active",
            _ => "passive",
        };
        let surface = shape.surface().filter(|_| !shape.is_box());
        let (corners, triangles) = surface.map_or_else(Default::default, |surface| {
            let corners = surface.corners_m.iter().flatten();
            let triangles = surface.triangles().flat_map(|(_, corners)| corners);
            let in_steps = corners.map(|m| (m / CORNER_STEP_M).round());
            (in_steps.collect(), triangles.collect())
        });
        ShownBox {
            part: one.part,
            half: shape.half_extents_m().into(),
            pose: numbers(pose),
            name: one.name.to_owned(),
            kind: kind.to_owned(),
            tracked: one.is_tracked,
            normal: one.drive.map(|drive| drive.face.normal().into()),
            spins: (one.drive).map(|drive| matches!(drive.axis, DriveAxis::Normal { .. })),
            corners,
            triangles,
        }
    };
    robot_solids(robot).into_iter().map(shown).collect()
}

/// The boxes of a body that stands still, in the world.
fn fixed_boxes(body: &SceneBody) -> Vec<FixedBox> {
    let SceneMotion::Fixed { world_from_body } = &body.motion else {
        return Vec::new();
    };
    let boxes = body.boxes.iter().map(|one| FixedBox {
        half: (0.5 * one.sides_m).into(),
        pose: numbers(&(world_from_body * one.body_from_box)),
    });
    boxes.collect()
}

/// Other bodies that move in a film, by index.
fn moving<'a>(scene: &'a [SceneBody], film: &'a Film) -> impl Iterator<Item = usize> + 'a {
    let bodies = scene.iter().take(film.scene.len()).enumerate();
    let moving = |body: &SceneBody| !matches!(body.motion, SceneMotion::Fixed { .. });
    bodies.filter_map(move |(index, body)| moving(body).then_some(index))
}

/// What is known of a film, as parts: those of the robot, then other bodies that move.
fn known_parts(scene: &[SceneBody], film: &Film) -> Vec<usize> {
    let parts = (0..film.parts.len()).filter(|part| film.parts[*part].is_some());
    let bodies = moving(scene, film).map(|body| film.parts.len() + body);
    parts.chain(bodies).collect()
}

/// Boxes of the bodies that move, as those of parts behind the robot's.
fn moving_boxes(scene: &[SceneBody], run: &Film) -> Vec<ShownBox> {
    let of_body = |body: usize| {
        let boxes = scene[body].boxes.iter();
        boxes.map(move |one| ShownBox {
            part: run.parts.len() + body,
            half: (0.5 * one.sides_m).into(),
            pose: numbers(&one.body_from_box),
            kind: "scene".to_owned(),
            ..ShownBox::default()
        })
    };
    moving(scene, run).flat_map(of_body).collect()
}

/// Adds a film's columns: times, the tracked point, then of each known part and each moving body its place and orientation, at most
/// so many numbers. Returns every how manyth sample is in there.
pub(in crate::report) fn push_film(
    packed: &mut PackedColumns,
    film: &Film,
    scene: &[SceneBody],
    most: usize,
) -> usize {
    let samples = film.track.len();
    let bodies = moving(scene, film).map(|body| &film.scene[body]);
    let known: Vec<_> = film.parts.iter().flatten().chain(bodies).collect();
    let columns = 4 + 7 * known.len();
    let every = (samples * columns).div_ceil(most).max(1);
    let picks = picks(samples, every);
    let (times_s, places) = (film.track.times_s(), film.track.positions_world_m());
    packed.push(picks.iter().map(|k| times_s[*k] - times_s[0]), TIME_STEP_S);
    let place = |sample: usize, axis: usize| places[sample][axis];
    for axis in 0..3 {
        packed.push(picks.iter().map(|k| place(*k, axis)), LENGTH_STEP_M);
    }
    for poses in known {
        for axis in 0..3 {
            let along = picks.iter().map(|k| poses[*k].translation.vector[axis]);
            packed.push(along, LENGTH_STEP_M);
        }
        let turns = continuous(picks.iter().map(|k| poses[*k].rotation));
        let turns: Vec<[f64; 4]> = turns.map(|q| [q.w, q.i, q.j, q.k]).collect();
        for axis in 0..4 {
            packed.push(turns.iter().map(|turn| turn[axis]), TURN_STEP);
        }
    }
    every
}
