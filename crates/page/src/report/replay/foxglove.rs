//! A replay as an MCAP file that Foxglove shows: shapes in frames that move, paths, and poses to plot.

use nalgebra::{Isometry3, Vector3};
use serde_json::{Value, json};

use crate::report::replay::page::Replay;
use crate::report::replay::solid::{Kind, Solid};
use crate::report::replay::stage::{Actor, Mover, Stage};
use realgap_core::error::Result;
use realgap_core::file::{McapWriter, Topic, stamp};

/// Most samples of one run in a file.
const MOST_SAMPLES: usize = 20_000;
/// Frame of the world.
const WORLD: &str = "world";
/// How thick paths are, metres; a point is as wide as three of them.
const PATH_M: f64 = 0.008;

/// Name of the frame of a run of which only a path is known.
const POINT: &str = "point";

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
        file.message(floor, 0, &scene(vec![fixed]));
        for (index, actor) in stage.actors.iter().enumerate() {
            file.message(first + 2 * index, 0, &scene(entities(actor)));
        }
        for (time_ns, index, sample) in in_order(&stage) {
            let actor = &stage.actors[index];
            let transforms = transforms(actor, sample, time_ns);
            file.message(tf, time_ns, &json!({ "transforms": transforms }));
            let turns = actor.turns.as_ref();
            let turn = turns.map_or_else(Default::default, |turns| turns[sample]);
            let pose = pose(&Isometry3::from_parts(actor.places_m[sample].into(), turn));
            let message = json!({ "timestamp": stamp(time_ns), "frame_id": WORLD, "pose": pose });
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

fn transforms(actor: &Actor, sample: usize, time_ns: u64) -> Vec<Value> {
    let one = |name: &str, pose: &Isometry3<f64>| {
        json!({
            "timestamp": stamp(time_ns),
            "parent_frame_id": WORLD,
            "child_frame_id": frame(actor, name),
            "translation": vector(&pose.translation.vector),
            "rotation": turn(pose),
        })
    };
    if actor.movers.is_empty() {
        let place = actor.places_m[sample];
        return vec![one(
            POINT,
            &Isometry3::from_parts(place.into(), Default::default()),
        )];
    }
    let movers = actor.movers.iter();
    movers
        .map(|mover| one(&mover.name, &mover.poses[sample]))
        .collect()
}

fn entities(actor: &Actor) -> Vec<Value> {
    let own = |mover: &Mover| {
        let solids = mover.solids.iter().map(|solid| (solid, actor.alpha()));
        solid_entity(&mover.name, &frame(actor, &mover.name), solids)
    };
    let mut all: Vec<Value> = actor.movers.iter().map(own).collect();
    let (here, colour) = (pose(&Isometry3::identity()), colour(actor.kind(), 1.0));
    if actor.movers.is_empty() {
        let size = vector(&Vector3::repeat(3.0 * PATH_M));
        let ball = json!([{ "pose": here, "size": size, "color": colour }]);
        all.push(entity(POINT, &frame(actor, POINT), ("spheres", ball)));
    }
    let path = json!([{
        // A strip.
        "type": 0,
        "pose": here,
        "thickness": PATH_M,
        "scale_invariant": false,
        "points": actor.places_m.iter().map(vector).collect::<Vec<_>>(),
        "color": colour,
        "colors": [],
        "indices": [],
    }]);
    all.push(entity("path", WORLD, ("lines", path)));
    all
}

/// An entity of boxes, and of triangles for what is no box.
fn solid_entity<'a>(
    id: &str,
    frame: &str,
    solids: impl Iterator<Item = (&'a Solid, f64)>,
) -> Value {
    let (mut cubes, mut others) = (Vec::new(), Vec::new());
    for (solid, alpha) in solids {
        match solid.shape.is_box() {
            true => cubes.push(cube(solid, alpha)),
            false => others.extend(triangles(solid, alpha)),
        }
    }
    let mut entity = entity(id, frame, ("cubes", json!(cubes)));
    entity["triangles"] = json!(others);
    entity
}

fn triangles(solid: &Solid, alpha: f64) -> Option<Value> {
    let surface = solid.shape.surface()?;
    let corners = surface.triangles().flat_map(|(_, corners)| corners);
    Some(json!({
        "pose": pose(&solid.pose),
        "points": surface.corners_m.iter().map(vector).collect::<Vec<_>>(),
        "color": colour(solid.kind, alpha),
        "colors": [],
        "indices": corners.collect::<Vec<_>>(),
    }))
}

fn cube(solid: &Solid, alpha: f64) -> Value {
    let is_floor = solid.kind == Kind::Floor;
    let alpha = if is_floor { 0.6 } else { alpha };
    let size = vector(&(2.0 * solid.shape.half_extents_m()));
    json!({ "pose": pose(&solid.pose), "size": size, "color": colour(solid.kind, alpha) })
}

// Messages, with the fields that their schemas name.

fn scene(entities: Vec<Value>) -> Value {
    json!({ "deletions": [], "entities": entities })
}

/// An entity with these things, and nothing else.
fn entity(id: &str, frame: &str, (name, things): (&str, Value)) -> Value {
    let mut entity = json!({
        "timestamp": stamp(0),
        "frame_id": frame,
        "id": id,
        // Until it is replaced.
        "lifetime": stamp(0),
        "frame_locked": true,
    });
    for list in [
        "metadata",
        "arrows",
        "cubes",
        "spheres",
        "cylinders",
        "lines",
        "triangles",
        "texts",
        "models",
    ] {
        entity[list] = json!([]);
    }
    entity[name] = things;
    entity
}

fn colour(kind: Kind, alpha: f64) -> Value {
    let [r, g, b] = kind.colour().map(|channel| f64::from(channel) / 255.0);
    json!({ "r": r, "g": g, "b": b, "a": alpha })
}

fn vector(v: &Vector3<f64>) -> Value {
    json!({ "x": v.x, "y": v.y, "z": v.z })
}

fn turn(pose: &Isometry3<f64>) -> Value {
    let [x, y, z, w]: [f64; 4] = pose.rotation.coords.into();
    json!({ "x": x, "y": y, "z": z, "w": w })
}

fn pose(pose: &Isometry3<f64>) -> Value {
    json!({ "position": vector(&pose.translation.vector), "orientation": turn(pose) })
}
