//! A replay as an MCAP file that Foxglove shows: shapes in frames that move, paths, and poses to plot.

use nalgebra::{Isometry3, Vector3};
use serde::Serialize;

use super::replay::Replay;
use super::stage::{Actor, Kind, Solid, Stage};
use realgap_core::error::Result;
use realgap_core::file::{McapWriter, Stamp, Topic, stamp};

/// Most samples of one run in a file.
const MOST_SAMPLES: usize = 20_000;
/// Frame of the world.
const WORLD: &str = "world";
/// How thick paths are, metres; a point is as wide as three of them.
const PATH_M: f64 = 0.008;

// Messages, with the names of their schemas.

#[derive(Serialize)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize)]
struct Turn {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Serialize)]
struct Pose {
    position: Vector,
    orientation: Turn,
}

#[derive(Serialize)]
struct PoseInFrame {
    timestamp: Stamp,
    frame_id: &'static str,
    pose: Pose,
}

#[derive(Serialize)]
struct FrameTransform {
    timestamp: Stamp,
    parent_frame_id: &'static str,
    child_frame_id: String,
    translation: Vector,
    rotation: Turn,
}

#[derive(Serialize)]
struct FrameTransforms {
    transforms: Vec<FrameTransform>,
}

#[derive(Serialize)]
struct Colour {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

/// A box or a ball.
#[derive(Serialize)]
struct Primitive {
    pose: Pose,
    size: Vector,
    color: Colour,
}

#[derive(Serialize)]
struct Line {
    r#type: u8,
    pose: Pose,
    thickness: f64,
    scale_invariant: bool,
    points: Vec<Vector>,
    color: Colour,
    colors: Nothing,
    indices: Nothing,
}

#[derive(Serialize)]
struct Triangles {
    pose: Pose,
    points: Vec<Vector>,
    color: Colour,
    colors: Nothing,
    indices: Vec<usize>,
}

#[derive(Serialize)]
struct Entity {
    timestamp: Stamp,
    frame_id: String,
    id: String,
    lifetime: Stamp,
    frame_locked: bool,
    metadata: Nothing,
    arrows: Nothing,
    cubes: Vec<Primitive>,
    spheres: Vec<Primitive>,
    cylinders: Nothing,
    lines: Vec<Line>,
    triangles: Vec<Triangles>,
    texts: Nothing,
    models: Nothing,
}

#[derive(Serialize)]
struct SceneUpdate {
    deletions: Nothing,
    entities: Vec<Entity>,
}

/// A list of what is never written.
type Nothing = [u8; 0];

impl Replay<'_> {
    /// The replay as an MCAP file for Foxglove, with its schemas in JSON: `/tf` (`FrameTransforms`) moves the frames `RUN/part0` and
    /// so on, `/floor` and `/RUN/scene` (`SceneUpdate`) have the shapes in them and the whole path, `/RUN/pose` (`PoseInFrame`) is the
    /// tracked module. Times count from the start of each run. Of a run of more than 20 000 samples every second, third, … is in the
    /// file.
    ///
    /// # Errors
    /// Paths too long to be compared.
    pub fn mcap(&self) -> Result<Vec<u8>> {
        let stage = self.stage(MOST_SAMPLES)?;
        let mut topics = vec![
            Topic::Transforms("/tf".to_owned()),
            Topic::Scene("/floor".to_owned()),
        ];
        for actor in &stage.actors {
            topics.push(Topic::Scene(format!("/{}/scene", actor.name)));
            topics.push(Topic::Pose(format!("/{}/pose", actor.name)));
        }
        let mut file = McapWriter::new(topics);
        let [tf, floor, first] = [0, 1, 2];
        let fixed = stage.fixed.iter().map(|solid| (solid, 1.0));
        let fixed = solid_entity("fixed", WORLD, fixed);
        file.message(floor, 0, &SceneUpdate::of(vec![fixed]));
        for (index, actor) in stage.actors.iter().enumerate() {
            file.message(first + 2 * index, 0, &SceneUpdate::of(entities(actor)));
        }
        for (time_ns, index, sample) in in_order(&stage) {
            let actor = &stage.actors[index];
            let transforms = transforms(actor, sample, time_ns);
            file.message(tf, time_ns, &FrameTransforms { transforms });
            let turn = actor
                .turns
                .as_ref()
                .map_or_else(Default::default, |turns| turns[sample]);
            let pose = Isometry3::from_parts(actor.places_m[sample].into(), turn);
            let message = PoseInFrame {
                timestamp: stamp(time_ns),
                frame_id: WORLD,
                pose: Pose::of(&pose),
            };
            file.message(first + 2 * index + 1, time_ns, &message);
        }
        Ok(file.finish())
    }
}

/// All samples by time: time, run and number.
fn in_order(stage: &Stage) -> Vec<(u64, usize, usize)> {
    let mut all = Vec::new();
    for (index, actor) in stage.actors.iter().enumerate() {
        let times = actor.times_s.iter().enumerate();
        all.extend(times.map(|(sample, time_s)| ((time_s * 1e9).round() as u64, index, sample)));
    }
    all.sort_unstable();
    all
}

fn frame(actor: &Actor, part: &str) -> String {
    format!("{}/{part}", actor.name)
}

fn transforms(actor: &Actor, sample: usize, time_ns: u64) -> Vec<FrameTransform> {
    let one = |name: &str, pose: &Isometry3<f64>| {
        let Pose {
            position,
            orientation,
        } = Pose::of(pose);
        FrameTransform {
            timestamp: stamp(time_ns),
            parent_frame_id: WORLD,
            child_frame_id: frame(actor, name),
            translation: position,
            rotation: orientation,
        }
    };
    let movers = actor.movers.iter();
    let mut all: Vec<FrameTransform> = movers
        .map(|mover| one(&mover.name, &mover.poses[sample]))
        .collect();
    if all.is_empty() {
        let place = actor.places_m[sample];
        all.push(one(
            POINT,
            &Isometry3::from_parts(place.into(), Default::default()),
        ));
    }
    all
}

/// Name of the frame of a run of which only a path is known.
const POINT: &str = "point";

fn entities(actor: &Actor) -> Vec<Entity> {
    let mut all = Vec::new();
    for mover in &actor.movers {
        let solids = mover.solids.iter().map(|solid| (solid, actor.alpha()));
        all.push(solid_entity(
            &mover.name,
            &frame(actor, &mover.name),
            solids,
        ));
    }
    let colour = actor.kind();
    if actor.movers.is_empty() {
        let ball = Primitive {
            pose: Pose::of(&Isometry3::identity()),
            size: Vector::of(&Vector3::repeat(3.0 * PATH_M)),
            color: Colour::of(colour, 1.0),
        };
        all.push(Entity {
            spheres: vec![ball],
            ..Entity::of(POINT, &frame(actor, POINT))
        });
    }
    let path = Line {
        // A strip.
        r#type: 0,
        pose: Pose::of(&Isometry3::identity()),
        thickness: PATH_M,
        scale_invariant: false,
        points: actor.places_m.iter().map(Vector::of).collect(),
        color: Colour::of(colour, 1.0),
        colors: [],
        indices: [],
    };
    all.push(Entity {
        lines: vec![path],
        ..Entity::of("path", WORLD)
    });
    all
}

/// An entity of boxes, and of triangles for what is no box.
fn solid_entity<'a>(
    id: &str,
    frame: &str,
    solids: impl Iterator<Item = (&'a Solid, f64)>,
) -> Entity {
    let mut entity = Entity::of(id, frame);
    for (solid, alpha) in solids {
        if solid.shape.is_box() {
            entity.cubes.push(cube(solid, alpha));
        } else {
            entity.triangles.extend(triangles(solid, alpha));
        }
    }
    entity
}

fn triangles(solid: &Solid, alpha: f64) -> Option<Triangles> {
    let surface = solid.shape.surface()?;
    let corners = surface.triangles().flat_map(|(_, corners)| corners);
    Some(Triangles {
        pose: Pose::of(&solid.pose),
        points: surface.corners_m.iter().map(Vector::of).collect(),
        color: Colour::of(solid.kind, alpha),
        colors: [],
        indices: corners.collect(),
    })
}

fn cube(solid: &Solid, alpha: f64) -> Primitive {
    let is_floor = solid.kind == Kind::Floor;
    let alpha = if is_floor { 0.6 } else { alpha };
    Primitive {
        pose: Pose::of(&solid.pose),
        size: Vector::of(&(2.0 * solid.shape.half_extents_m())),
        color: Colour::of(solid.kind, alpha),
    }
}

impl SceneUpdate {
    fn of(entities: Vec<Entity>) -> Self {
        Self {
            deletions: [],
            entities,
        }
    }
}

impl Entity {
    /// An entity of nothing so far.
    fn of(id: &str, frame: &str) -> Self {
        Self {
            timestamp: stamp(0),
            frame_id: frame.to_owned(),
            id: id.to_owned(),
            // Until it is replaced.
            lifetime: stamp(0),
            frame_locked: true,
            metadata: [],
            arrows: [],
            cubes: Vec::new(),
            spheres: Vec::new(),
            cylinders: [],
            lines: Vec::new(),
            triangles: Vec::new(),
            texts: [],
            models: [],
        }
    }
}

impl Colour {
    fn of(kind: Kind, alpha: f64) -> Self {
        let [r, g, b] = kind.colour().map(|channel| f64::from(channel) / 255.0);
        Self { r, g, b, a: alpha }
    }
}

impl Vector {
    fn of(v: &Vector3<f64>) -> Self {
        let [x, y, z] = (*v).into();
        Self { x, y, z }
    }
}

impl Pose {
    fn of(pose: &Isometry3<f64>) -> Self {
        let [x, y, z, w] = pose.rotation.coords.into();
        Self {
            position: Vector::of(&pose.translation.vector),
            orientation: Turn { x, y, z, w },
        }
    }
}
