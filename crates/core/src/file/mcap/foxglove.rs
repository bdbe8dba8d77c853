//! JSON schemas of the message types that the viewer Foxglove can show.

use serde::Serialize;
use serde_json::{Value, json};

/// The name of a topic, by the kind of its messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Topic {
    /// One pose over time.
    Pose(String),
    /// Transforms of moving frames.
    Transforms(String),
    /// Boxes, balls and lines in frames.
    Scene(String),
}

/// A timestamp as messages contain it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Stamp {
    /// Whole seconds.
    pub sec: u64,
    /// The remainder, nanoseconds.
    pub nsec: u64,
}

/// Converts a time in nanoseconds into the timestamp of a message.
pub fn stamp(time_ns: u64) -> Stamp {
    Stamp {
        sec: time_ns / 1_000_000_000,
        nsec: time_ns % 1_000_000_000,
    }
}

/// The schema of an object whose fields of these names are numbers.
fn numbers(names: &[&str]) -> Value {
    let number = |name: &&str| ((*name).to_owned(), json!({ "type": "number" }));
    let properties: serde_json::Map<_, _> = names.iter().map(number).collect();
    json!({ "type": "object", "properties": properties })
}

fn time_schema() -> Value {
    let whole = json!({ "type": "integer", "minimum": 0 });
    json!({ "type": "object", "title": "time", "properties": { "sec": whole, "nsec": whole } })
}

fn vector_schema() -> Value {
    numbers(&["x", "y", "z"])
}

fn turn_schema() -> Value {
    numbers(&["x", "y", "z", "w"])
}

fn object(title: &str, properties: Value) -> Value {
    json!({ "type": "object", "title": title, "properties": properties })
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn pose_schema() -> Value {
    let properties = json!({ "position": vector_schema(), "orientation": turn_schema() });
    object("foxglove.Pose", properties)
}

/// The schema of a scene with the primitives that realgap writes; the lists of other primitives are empty in every message.
fn scene_schema() -> Value {
    let text = json!({ "type": "string" });
    let colour = numbers(&["r", "g", "b", "a"]);
    let solid = |title: &str| {
        let size = vector_schema();
        object(
            title,
            json!({ "pose": pose_schema(), "size": size, "color": colour }),
        )
    };
    let line = object(
        "foxglove.LinePrimitive",
        json!({
            "type": { "type": "integer" },
            "pose": pose_schema(),
            "thickness": { "type": "number" },
            "scale_invariant": { "type": "boolean" },
            "points": list(vector_schema()),
            "color": colour,
            "colors": list(colour.clone()),
            "indices": list(json!({ "type": "integer", "minimum": 0 })),
        }),
    );
    let triangles = object(
        "foxglove.TriangleListPrimitive",
        json!({
            "pose": pose_schema(),
            "points": list(vector_schema()),
            "color": colour,
            "colors": list(colour.clone()),
            "indices": list(json!({ "type": "integer", "minimum": 0 })),
        }),
    );
    let nothing = || list(json!({ "type": "object" }));
    let entity = object(
        "foxglove.SceneEntity",
        json!({
            "timestamp": time_schema(),
            "frame_id": text,
            "id": text,
            "lifetime": time_schema(),
            "frame_locked": { "type": "boolean" },
            "metadata": nothing(),
            "arrows": nothing(),
            "cubes": list(solid("foxglove.CubePrimitive")),
            "spheres": list(solid("foxglove.SpherePrimitive")),
            "cylinders": nothing(),
            "lines": list(line),
            "triangles": list(triangles),
            "texts": nothing(),
            "models": nothing(),
        }),
    );
    json!({ "deletions": nothing(), "entities": list(entity) })
}

impl Topic {
    /// The name of the topic.
    pub fn name(&self) -> &str {
        match self {
            Self::Pose(name) | Self::Transforms(name) | Self::Scene(name) => name,
        }
    }

    pub(super) fn schema_name(&self) -> &'static str {
        match self {
            Self::Pose(_) => "foxglove.PoseInFrame",
            Self::Transforms(_) => "foxglove.FrameTransforms",
            Self::Scene(_) => "foxglove.SceneUpdate",
        }
    }

    pub(super) fn schema(&self) -> Value {
        let text = json!({ "type": "string" });
        let properties = match self {
            Self::Pose(_) => json!({
                "timestamp": time_schema(), "frame_id": text, "pose": pose_schema(),
            }),
            Self::Transforms(_) => {
                json!({ "transforms": list(object("foxglove.FrameTransform", json!({
                    "timestamp": time_schema(),
                    "parent_frame_id": text,
                    "child_frame_id": text,
                    "translation": vector_schema(),
                    "rotation": turn_schema(),
                })))})
            }
            Self::Scene(_) => scene_schema(),
        };
        json!({ "title": self.schema_name(), "type": "object", "properties": properties })
    }
}
