//! The RON form of an arena.

use std::path::Path;

use serde::Deserialize;

use super::{Anchor, Arena, Boundary, Object, Shape};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, parse_ron};

/// An arena as its file states it.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Arena")]
pub struct ArenaFile {
    /// Its name.
    name: String,
    /// Width and depth of the field, from (0, 0), metres.
    size_m: (f64, f64),
    /// Whether there are walls around the field.
    boundary: Boundary,
    /// Corners of a closed wall around rooms, the last the first again.
    #[serde(default)]
    outline_m: Vec<(f64, f64)>,
    /// Thickness of that wall, metres.
    #[serde(default = "thin")]
    outline_thickness_m: f64,
    /// Straight walls.
    #[serde(default)]
    walls: Vec<WallFile>,
    /// Boxes.
    #[serde(default)]
    boxes: Vec<BoxFile>,
    /// Round things.
    #[serde(default)]
    circles: Vec<CircleFile>,
    /// Radio stations.
    #[serde(default)]
    anchors: Vec<AnchorFile>,
    /// Where robots start; else nowhere in particular.
    start: Option<StartFile>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Wall")]
struct WallFile {
    /// One end, metres.
    from_m: (f64, f64),
    /// The other end, metres.
    to_m: (f64, f64),
    /// Thickness, metres.
    #[serde(default = "thin")]
    thickness_m: f64,
    /// What it is made of; radio models may have a loss for each material.
    #[serde(default)]
    material: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Box")]
struct BoxFile {
    /// Centre, metres.
    centre_m: (f64, f64),
    /// Half of its sides, metres.
    half_m: (f64, f64),
    /// Turn to the left, degrees.
    #[serde(default)]
    turn_deg: f64,
    /// What it is made of.
    #[serde(default)]
    material: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Circle")]
struct CircleFile {
    /// Centre, metres.
    centre_m: (f64, f64),
    /// Radius, metres.
    radius_m: f64,
    /// What it is made of.
    #[serde(default)]
    material: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Anchor")]
struct AnchorFile {
    /// Its name, as in radio logs.
    name: String,
    /// Its place: x, y and height, metres.
    position_m: (f64, f64, f64),
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Start")]
struct StartFile {
    /// Place to the right, metres.
    x_m: f64,
    /// Place up, metres.
    y_m: f64,
    /// Heading from the x axis to the left, degrees.
    #[serde(default)]
    heading_deg: f64,
}

fn thin() -> f64 {
    0.01
}

/// Largest field, metres, and most objects.
const LARGEST_M: f64 = 1e4;
const MOST: usize = 10_000;
/// An outline is closed where it ends this near to where it began, metres.
const CLOSED_M: f64 = 1e-6;

impl Arena {
    /// Reads an arena.
    ///
    /// # Errors
    /// A missing file, anything that is not an arena, sizes that are not positive, walls that do not close, a start in a wall.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "arena")?)
    }

    /// The arena in a text.
    ///
    /// # Errors
    /// As [`Arena::read`].
    pub fn parse(source: &Source) -> Result<Self> {
        let file: ArenaFile = parse_ron(source)?;
        let size_m = [file.size_m.0, file.size_m.1];
        let wrong = |field: &str, message: &str, found: String, allowed: &str| {
            source.at(
                field,
                Error::invalid(message.to_owned())
                    .field(field)
                    .found(found)
                    .allowed(allowed),
            )
        };
        if !size_m.iter().all(|side| *side > 0.0 && *side <= LARGEST_M) {
            return Err(wrong(
                "size_m",
                "not a size of a field",
                format!("{size_m:?}"),
                "above 0 m, at most 10 km",
            ));
        }
        let mut objects = Vec::new();
        if file.boundary == Boundary::Solid {
            objects.extend(around(size_m));
        }
        for (index, pair) in file.outline_m.windows(2).enumerate() {
            let wall = wall(pair[0], pair[1], file.outline_thickness_m, "");
            objects.push(wall.ok_or_else(|| {
                wrong(
                    &format!("outline_m[{index}]"),
                    "not a wall",
                    format!("{pair:?}"),
                    "two different corners and a thickness above 0",
                )
            })?);
        }
        if let (Some(first), Some(last)) = (file.outline_m.first(), file.outline_m.last())
            && (file.outline_m.len() < 4 || (first.0 - last.0).hypot(first.1 - last.1) > CLOSED_M)
        {
            return Err(wrong(
                "outline_m",
                "the walls do not close",
                format!("from {first:?} to {last:?}"),
                "three or more corners, the last entry the first again",
            ));
        }
        for (index, w) in file.walls.iter().enumerate() {
            let built = wall(w.from_m, w.to_m, w.thickness_m, &w.material);
            objects.push(built.ok_or_else(|| {
                wrong(
                    &format!("walls[{index}]"),
                    "not a wall",
                    format!("{:?} to {:?}", w.from_m, w.to_m),
                    "two different ends and a thickness above 0",
                )
            })?);
        }
        let positive = |v: f64| v > 0.0 && v.is_finite();
        for (index, b) in file.boxes.iter().enumerate() {
            let is_sound = positive(b.half_m.0)
                && positive(b.half_m.1)
                && [b.centre_m.0, b.centre_m.1, b.turn_deg]
                    .iter()
                    .all(|v| v.is_finite());
            if !is_sound {
                return Err(wrong(
                    &format!("boxes[{index}]"),
                    "not a box",
                    format!("half {:?} m at {:?} m", b.half_m, b.centre_m),
                    "halves above 0 m at a finite place",
                ));
            }
            let (sin, cos) = b.turn_deg.to_radians().sin_cos();
            objects.push(Object {
                centre_m: [b.centre_m.0, b.centre_m.1],
                shape: Shape::Box {
                    half_m: [b.half_m.0, b.half_m.1],
                    turn: [cos, sin],
                },
                material: b.material.clone(),
            });
        }
        for (index, c) in file.circles.iter().enumerate() {
            if !(positive(c.radius_m) && c.centre_m.0.is_finite() && c.centre_m.1.is_finite()) {
                return Err(wrong(
                    &format!("circles[{index}]"),
                    "not a circle",
                    format!("radius {} m at {:?} m", c.radius_m, c.centre_m),
                    "a radius above 0 m at a finite place",
                ));
            }
            objects.push(Object {
                centre_m: [c.centre_m.0, c.centre_m.1],
                shape: Shape::Circle {
                    radius_m: c.radius_m,
                },
                material: c.material.clone(),
            });
        }
        if objects.len() > MOST {
            return Err(Error::invalid("too many objects")
                .at_file(source.path())
                .found(objects.len())
                .allowed(format!("at most {MOST}")));
        }
        let mut anchors: Vec<Anchor> = Vec::new();
        for (index, a) in file.anchors.into_iter().enumerate() {
            let anchor = Anchor {
                name: a.name,
                position_m: [a.position_m.0, a.position_m.1, a.position_m.2],
            };
            anchor
                .check(&anchors)
                .map_err(|e| source.at(&format!("anchors[{index}]"), e))?;
            anchors.push(anchor);
        }
        let start = file
            .start
            .map(|s| [s.x_m, s.y_m, s.heading_deg.to_radians()]);
        let arena = Self {
            name: file.name,
            size_m,
            boundary: file.boundary,
            objects,
            anchors,
            start,
        };
        if let Some([x, y, heading]) = arena.start {
            if !heading.is_finite() {
                return Err(wrong(
                    "start",
                    "not a heading",
                    heading.to_string(),
                    "a finite number",
                ));
            }
            arena
                .check_place([x, y], 0.0)
                .map_err(|e| source.at("start", e))?;
        }
        Ok(arena)
    }
}

/// A straight wall as a turned box.
fn wall(from: (f64, f64), to: (f64, f64), thickness_m: f64, material: &str) -> Option<Object> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let is_sound = length > 0.0
        && length.is_finite()
        && thickness_m > 0.0
        && thickness_m.is_finite()
        && from.0.is_finite()
        && from.1.is_finite();
    is_sound.then(|| Object {
        centre_m: [0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1)],
        shape: Shape::Box {
            half_m: [0.5 * length, 0.5 * thickness_m],
            turn: [dx / length, dy / length],
        },
        material: material.to_owned(),
    })
}

/// Four walls just outside of the field.
fn around([x, y]: [f64; 2]) -> Vec<Object> {
    let t = thin();
    let solid = |centre_m: [f64; 2], half_m: [f64; 2]| Object {
        centre_m,
        shape: Shape::Box {
            half_m,
            turn: [1.0, 0.0],
        },
        material: String::new(),
    };
    vec![
        solid([0.5 * x, -0.5 * t], [0.5 * x + t, 0.5 * t]),
        solid([0.5 * x, y + 0.5 * t], [0.5 * x + t, 0.5 * t]),
        solid([-0.5 * t, 0.5 * y], [0.5 * t, 0.5 * y + t]),
        solid([x + 0.5 * t, 0.5 * y], [0.5 * t, 0.5 * y + t]),
    ]
}
