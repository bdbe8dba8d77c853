//! Reads arenas from RON files.

use std::path::Path;

use serde::Deserialize;

use super::ground::GroundFile;
use super::{Anchor, Arena, Boundary, Ground, Object, Region, Shape, Step};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, parse_ron};

/// An arena as its file states it.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Arena")]
pub struct ArenaFile {
    /// Name of the arena.
    name: String,
    /// Width and depth of the field, from (0, 0), metres.
    size_m: [f64; 2],
    /// Whether there are walls around the field.
    boundary: Boundary,
    /// Corners of a closed wall, metres; the last entry repeats the first.
    #[serde(default)]
    outline_m: Vec<[f64; 2]>,
    /// Thickness of the closed wall, metres.
    #[serde(default = "thin")]
    outline_thickness_m: f64,
    /// Straight walls.
    #[serde(default)]
    walls: Vec<WallFile>,
    /// Boxes.
    #[serde(default)]
    boxes: Vec<BoxFile>,
    /// Circular obstacles.
    #[serde(default)]
    circles: Vec<CircleFile>,
    /// Radio stations.
    #[serde(default)]
    anchors: Vec<Anchor>,
    /// Start pose of robots; optional.
    start: Option<StartFile>,
    /// Regions of the floor with friction of their own. Where regions overlap, the later one lies on top.
    #[serde(default)]
    regions: Vec<Region>,
    /// Steps: boxes that stand on the floor and that robots may climb. Sensors do not see them.
    #[serde(default)]
    steps: Vec<Step>,
    /// What the ground is.
    #[serde(default)]
    ground: GroundFile,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Wall")]
struct WallFile {
    /// One end, metres.
    from_m: [f64; 2],
    /// The other end, metres.
    to_m: [f64; 2],
    /// Thickness, metres.
    #[serde(default = "thin")]
    thickness_m: f64,
    /// Material of the wall; radio models may have a loss for each material.
    #[serde(default)]
    material: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Box")]
struct BoxFile {
    /// Centre, metres.
    centre_m: [f64; 2],
    /// Half of its sides, metres.
    half_m: [f64; 2],
    /// Rotation of the box counter-clockwise, degrees.
    #[serde(default)]
    turn_deg: f64,
    /// Material of the box.
    #[serde(default)]
    material: String,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Circle")]
struct CircleFile {
    /// Centre, metres.
    centre_m: [f64; 2],
    /// Radius, metres.
    radius_m: f64,
    /// Material of the circle.
    #[serde(default)]
    material: String,
}

/// A start pose in an arena.
#[derive(Debug, Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Start")]
pub struct StartFile {
    /// Coordinate x of the start, metres.
    x_m: f64,
    /// Coordinate y of the start, metres.
    y_m: f64,
    /// Heading counter-clockwise from the x axis, degrees.
    #[serde(default)]
    heading_deg: f64,
}

impl StartFile {
    /// The position x and y, metres, and the heading, radians.
    pub fn pose(self) -> [f64; 3] {
        [self.x_m, self.y_m, self.heading_deg.to_radians()]
    }
}

fn thin() -> f64 {
    0.01
}

/// Largest size of a field, metres, and largest number of objects.
const LARGEST_M: f64 = 1e4;
const MOST: usize = 10_000;
/// An outline is closed if its last corner is within this distance of its first corner, metres.
const CLOSED_M: f64 = 1e-6;

impl Arena {
    /// Reads an arena.
    ///
    /// # Errors
    /// A missing file, anything that is not an arena, sizes that are not positive, walls that do not close, a start in a wall.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "arena")?)
    }

    /// Parses an arena from a text.
    ///
    /// # Errors
    /// As [`Arena::read`].
    pub fn parse(source: &Source) -> Result<Self> {
        let file: ArenaFile = parse_ron(source)?;
        let folder = source.path().parent().unwrap_or(Path::new(""));
        // An error in the file of the heights names that file itself.
        let heights = file.ground.read(folder).map_err(|e| match e.file() {
            Some(_) => e,
            None => source.at_field(e.within("ground")),
        })?;
        let arena = Self {
            objects: file.objects().map_err(|e| source.at_field(e))?,
            ground: Ground {
                regions: file.regions,
                steps: file.steps,
                heights,
            },
            name: file.name,
            size_m: file.size_m,
            boundary: file.boundary,
            anchors: file.anchors,
            start: file.start.map(StartFile::pose),
        };
        arena.ground.check().map_err(|e| source.at_field(e))?;
        for (index, anchor) in arena.anchors.iter().enumerate() {
            anchor
                .check(&arena.anchors[..index])
                .map_err(|e| source.at(&format!("anchors[{index}]"), e))?;
        }
        if let Some([x, y, heading]) = arena.start {
            if !heading.is_finite() {
                let error = wrong("start", "not a heading", heading, "a finite number");
                return Err(source.at_field(error));
            }
            arena
                .check_place([x, y], 0.0)
                .map_err(|e| source.at("start", e))?;
        }
        Ok(arena)
    }
}

fn wrong(field: &str, message: &str, found: impl std::fmt::Display, allowed: &str) -> Error {
    Error::invalid(message)
        .field(field)
        .found(found)
        .allowed(allowed)
}

impl ArenaFile {
    /// All obstacles of the arena.
    fn objects(&self) -> Result<Vec<Object>> {
        if !self.size_m.iter().all(|s| *s > 0.0 && *s <= LARGEST_M) {
            return Err(wrong(
                "size_m",
                "not a size of a field",
                format!("{:?}", self.size_m),
                "above 0 m, at most 10 km",
            ));
        }
        let mut objects = Vec::new();
        if self.boundary == Boundary::Solid {
            objects.extend(around(self.size_m));
        }
        for (index, pair) in self.outline_m.windows(2).enumerate() {
            let wall = wall(pair[0], pair[1], self.outline_thickness_m, "");
            objects.push(wall.ok_or_else(|| {
                wrong(
                    &format!("outline_m[{index}]"),
                    "not a wall",
                    format!("{:?} to {:?}", pair[0], pair[1]),
                    "two different corners and a thickness above 0",
                )
            })?);
        }
        if let (Some(first), Some(last)) = (self.outline_m.first(), self.outline_m.last())
            && (self.outline_m.len() < 4
                || (first[0] - last[0]).hypot(first[1] - last[1]) > CLOSED_M)
        {
            return Err(wrong(
                "outline_m",
                "the walls do not close",
                format!("from {first:?} to {last:?}"),
                "three or more corners, the last entry the first again",
            ));
        }
        for (index, w) in self.walls.iter().enumerate() {
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
        for (index, b) in self.boxes.iter().enumerate() {
            let (sin, cos) = b.turn_deg.to_radians().sin_cos();
            let shape = Shape::Box {
                half_m: b.half_m,
                turn: [cos, sin],
            };
            objects.push(solid(b.centre_m, shape, &b.material).ok_or_else(|| {
                wrong(
                    &format!("boxes[{index}]"),
                    "not a box",
                    format!("half {:?} m at {:?} m", b.half_m, b.centre_m),
                    "halves above 0 m at a finite place",
                )
            })?);
        }
        for (index, c) in self.circles.iter().enumerate() {
            let shape = Shape::Circle {
                radius_m: c.radius_m,
            };
            objects.push(solid(c.centre_m, shape, &c.material).ok_or_else(|| {
                wrong(
                    &format!("circles[{index}]"),
                    "not a circle",
                    format!("radius {} m at {:?} m", c.radius_m, c.centre_m),
                    "a radius above 0 m at a finite place",
                )
            })?);
        }
        if objects.len() > MOST {
            let allowed = format!("at most {MOST}");
            let error = Error::invalid("too many objects").found(objects.len());
            return Err(error.allowed(allowed));
        }
        Ok(objects)
    }
}

/// An object of a size above 0 at a finite place.
fn solid(centre_m: [f64; 2], shape: Shape, material: &str) -> Option<Object> {
    let is_size = |size: f64| size > 0.0 && size.is_finite();
    let is_sound = match shape {
        Shape::Box {
            half_m: [x, y],
            turn,
        } => is_size(x) && is_size(y) && turn[0].is_finite(),
        Shape::Circle { radius_m } => is_size(radius_m),
    };
    (is_sound && centre_m.iter().all(|v| v.is_finite())).then(|| Object {
        centre_m,
        shape,
        material: material.to_owned(),
    })
}

/// A straight wall as a turned box.
fn wall(from: [f64; 2], to: [f64; 2], thickness_m: f64, material: &str) -> Option<Object> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    let shape = Shape::Box {
        half_m: [0.5 * length, 0.5 * thickness_m],
        turn: [dx / length, dy / length],
    };
    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    solid(middle, shape, material)
}

/// Four walls just outside of the field.
fn around([x, y]: [f64; 2]) -> impl Iterator<Item = Object> {
    let t = thin();
    [
        ([0.5 * x, -0.5 * t], [0.5 * x + t, 0.5 * t]),
        ([0.5 * x, y + 0.5 * t], [0.5 * x + t, 0.5 * t]),
        ([-0.5 * t, 0.5 * y], [0.5 * t, 0.5 * y + t]),
        ([x + 0.5 * t, 0.5 * y], [0.5 * t, 0.5 * y + t]),
    ]
    .into_iter()
    .map(|(centre_m, half_m)| Object {
        centre_m,
        shape: Shape::Box {
            half_m,
            turn: [1.0, 0.0],
        },
        material: String::new(),
    })
}
