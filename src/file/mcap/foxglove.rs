//! Messages that Foxglove knows, as JSON with their schemas.

use serde_json::{Value, json};

/// A topic that a file has, by the kind of its messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Topic {
    /// One pose over time.
    Pose(String),
}

/// A time as messages have it.
pub(crate) fn stamp(time_ns: u64) -> Value {
    json!({ "sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000 })
}

/// The schema of an object with these numbers.
fn numbers(names: &[&str]) -> Value {
    let number = |name: &&str| ((*name).to_owned(), json!({ "type": "number" }));
    let properties: serde_json::Map<_, _> = names.iter().map(number).collect();
    json!({ "type": "object", "properties": properties })
}

fn time_schema() -> Value {
    let whole = json!({ "type": "integer", "minimum": 0 });
    json!({ "type": "object", "title": "time", "properties": { "sec": whole, "nsec": whole } })
}

fn pose_schema() -> Value {
    json!({ "type": "object", "title": "foxglove.Pose", "properties": {
        "position": numbers(&["x", "y", "z"]),
        "orientation": numbers(&["x", "y", "z", "w"]),
    }})
}

impl Topic {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Pose(name) => name,
        }
    }

    pub(super) fn schema_name(&self) -> &'static str {
        match self {
            Self::Pose(_) => "foxglove.PoseInFrame",
        }
    }

    pub(super) fn schema(&self) -> Value {
        let text = json!({ "type": "string" });
        let properties = match self {
            Self::Pose(_) => json!({
                "timestamp": time_schema(), "frame_id": text, "pose": pose_schema(),
            }),
        };
        json!({ "title": self.schema_name(), "type": "object", "properties": properties })
    }
}
