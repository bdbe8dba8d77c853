//! A replay as an MCAP file that Foxglove shows: shapes in frames that move, paths, and poses to plot.

use nalgebra::{Isometry3, Vector3};
use serde_json::{Value, json};

use super::replay::Replay;
use super::stage::{Actor, Kind, Solid, Stage};
use realgap_core::error::Result;
use realgap_core::file::{McapWriter, Topic, stamp};

/// Most samples of one run in a file.
const MOST_SAMPLES: usize = 20_000;
/// Frame of the world.
const WORLD: &str = "world";
/// How thick paths are, metres; a point is as wide as three of them.
const PATH_M: f64 = 0.008;

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
            let turn = actor
                .turns
                .as_ref()
                .map_or_else(Default::default, |turns| turns[sample]);
            let pose = Isometry3::from_parts(actor.places_m[sample].into(), turn);
            let message =
                json!({ "timestamp": stamp(time_ns), "frame_id": WORLD, "pose": pose_json(&pose) });
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
    let movers = actor.movers.iter();
    let mut all: Vec<Value> = movers
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

fn entities(actor: &Actor) -> Vec<Value> {
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
        let wide = Vector3::repeat(3.0 * PATH_M);
        let ball = json!({
            "pose": pose_json(&Isometry3::identity()),
            "size": vector(&wide),
            "color": colour_json(colour, 1.0),
        });
        all.push(entity(POINT, &frame(actor, POINT), ("spheres", vec![ball])));
    }
    let points: Vec<Value> = actor.places_m.iter().map(vector).collect();
    let path = json!({
        // A strip.
        "type": 0,
        "pose": pose_json(&Isometry3::identity()),
        "thickness": PATH_M,
        "scale_invariant": false,
        "points": points,
        "color": colour_json(colour, 1.0),
        "colors": [],
        "indices": [],
    });
    all.push(entity("path", WORLD, ("lines", vec![path])));
    all
}

fn scene(entities: Vec<Value>) -> Value {
    json!({ "deletions": [], "entities": entities })
}

/// An entity of one kind of things, named as its schema does.
fn entity(id: &str, frame: &str, (kind, things): (&str, Vec<Value>)) -> Value {
    let mut entity = json!({
        "timestamp": stamp(0),
        "frame_id": frame,
        "id": id,
        // Until it is replaced.
        "lifetime": stamp(0),
        "frame_locked": true,
        "metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": [],
        "lines": [], "triangles": [], "texts": [], "models": [],
    });
    entity[kind] = things.into();
    entity
}

/// An entity of boxes, and of triangles for what is no box.
fn solid_entity<'a>(
    id: &str,
    frame: &str,
    solids: impl Iterator<Item = (&'a Solid, f64)>,
) -> Value {
    let (boxes, others): (Vec<_>, Vec<_>) = solids.partition(|(solid, _)| solid.shape.is_box());
    let boxes = boxes.into_iter().map(|(solid, alpha)| cube(solid, alpha));
    let mut entity = entity(id, frame, ("cubes", boxes.collect()));
    let others = others.into_iter();
    entity["triangles"] = others
        .filter_map(|(solid, alpha)| triangles(solid, alpha))
        .collect();
    entity
}

fn triangles(solid: &Solid, alpha: f64) -> Option<Value> {
    let surface = solid.shape.surface()?;
    let corners = surface.triangles().flat_map(|(_, corners)| corners);
    let indices: Vec<usize> = corners.collect();
    Some(json!({
        "pose": pose_json(&solid.pose),
        "points": surface.corners_m.iter().map(vector).collect::<Vec<_>>(),
        "color": colour_json(solid.kind, alpha),
        "colors": [],
        "indices": indices,
    }))
}

fn cube(solid: &Solid, alpha: f64) -> Value {
    let is_floor = solid.kind == Kind::Floor;
    let alpha = if is_floor { 0.6 } else { alpha };
    json!({
        "pose": pose_json(&solid.pose),
        "size": vector(&(2.0 * solid.shape.half_extents_m())),
        "color": colour_json(solid.kind, alpha),
    })
}

fn colour_json(kind: Kind, alpha: f64) -> Value {
    let [r, g, b] = kind.colour();
    let share = |channel: u8| f64::from(channel) / 255.0;
    json!({ "r": share(r), "g": share(g), "b": share(b), "a": alpha })
}

fn vector(v: &Vector3<f64>) -> Value {
    json!({ "x": v.x, "y": v.y, "z": v.z })
}

fn turn(pose: &Isometry3<f64>) -> Value {
    let q = pose.rotation;
    json!({ "x": q.i, "y": q.j, "z": q.k, "w": q.w })
}

fn pose_json(pose: &Isometry3<f64>) -> Value {
    json!({ "position": vector(&pose.translation.vector), "orientation": turn(pose) })
}
