//! Arenas: a field with its boundary, walls, boxes and circles, in which beams are cast, and the ground of the field.
//!
//! Intersections of beams with boxes and circles are computed in closed form. An arena has tens of objects, so that no acceleration
//! structure is needed.
//!
//! ```
//! use realgap_sensing::arena::Arena;
//!
//! let arena = Arena::read("../../arenas/paper000.ron")?;
//! let hit = arena.cast([0.36, 0.51], 0.0).expect("a box stands ahead");
//! assert!((hit.distance_m - 0.5).abs() < 1e-12 && hit.incidence_rad == 0.0);
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod arena_file;
mod cast;
mod ground;

use realgap_core::error::{Error, Result};

#[cfg(feature = "schema")]
pub use arena_file::ArenaFile;
pub use arena_file::StartFile;
pub use cast::{Crossing, Hit};
pub use ground::{Ground, HeightField, Region, Step};

/// The boundary of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Boundary {
    /// Walls all round.
    Solid,
    /// No walls: beams leave the field.
    Open,
}

/// The shape of an object seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A box, turned about its centre.
    Box {
        /// Half of its sides, metres.
        half_m: [f64; 2],
        /// Cosine and sine of its turn.
        turn: [f64; 2],
    },
    /// A circle.
    Circle {
        /// Radius, metres.
        radius_m: f64,
    },
}

/// An obstacle in the field.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Centre, metres.
    pub centre_m: [f64; 2],
    /// Shape.
    pub shape: Shape,
    /// Material; may be empty.
    pub material: String,
}

/// A fixed radio station: a sender or receiver of radio waves.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Anchor {
    /// Name of the anchor, as in the columns of logs.
    pub name: String,
    /// Position of the anchor: x, y and height above the floor, metres.
    pub position_m: [f64; 3],
}

/// A field with its obstacles and radio anchors.
#[derive(Debug, Clone, PartialEq)]
pub struct Arena {
    /// Name of the arena.
    pub name: String,
    /// Width and depth of the field, which begins at (0, 0), metres.
    pub size_m: [f64; 2],
    /// Boundary of the field.
    pub boundary: Boundary,
    /// Obstacles in the field, including the walls of a solid boundary and of an outline.
    pub objects: Vec<Object>,
    /// Fixed radio stations.
    pub anchors: Vec<Anchor>,
    /// Start pose of robots: x, y in metres and heading in radians.
    pub start: Option<[f64; 3]>,
    /// Regions of the floor, steps and a height field, which beams do not meet.
    pub ground: Ground,
}

impl Arena {
    /// The object in which a point lies, if any.
    pub fn object_at(&self, point_m: [f64; 2]) -> Option<usize> {
        self.objects
            .iter()
            .position(|object| object.distance_m(point_m) < 0.0)
    }

    /// Distance from a point to the nearest object, metres; negative inside of an object, infinite in an arena without objects.
    pub fn clearance_m(&self, point_m: [f64; 2]) -> f64 {
        self.objects
            .iter()
            .map(|object| object.distance_m(point_m))
            .fold(f64::INFINITY, f64::min)
    }

    /// Checks that a robot of this radius can stand here.
    ///
    /// # Errors
    /// The robot would overlap an object, or would be outside of the field.
    pub fn check_place(&self, point_m: [f64; 2], radius_m: f64) -> Result<()> {
        let [x, y] = point_m;
        let is_in = (0.0..=self.size_m[0]).contains(&x) && (0.0..=self.size_m[1]).contains(&y);
        let clearance_m = self.clearance_m(point_m);
        if is_in && clearance_m >= radius_m {
            return Ok(());
        }
        let error = Error::invalid("a robot cannot start here")
            .field("start")
            .found(format!("({x}, {y}) m"));
        Err(if is_in {
            error.allowed(format!(
                "{radius_m} m or more from every wall; this is {clearance_m:.3} m"
            ))
        } else {
            error.allowed(format!(
                "inside of the field, (0, 0) to ({}, {}) m",
                self.size_m[0], self.size_m[1]
            ))
        })
    }
}

impl Anchor {
    /// Checks this anchor, and that its name differs from those of the anchors before it.
    ///
    /// # Errors
    /// No name, the name of another anchor, a position that is not finite.
    pub fn check(&self, before: &[Self]) -> Result<()> {
        if self.name.is_empty() || before.iter().any(|other| other.name == self.name) {
            return Err(Error::invalid("not the name of an anchor")
                .field("name")
                .found(format!("`{}`", self.name))
                .allowed("a name that no other anchor has"));
        }
        if self.position_m.iter().any(|v| !v.is_finite()) {
            return Err(Error::invalid("not a place")
                .field("position_m")
                .found(format!("{:?}", self.position_m))
                .allowed("three finite numbers"));
        }
        Ok(())
    }
}

impl Object {
    /// A point in the object's own frame.
    fn local(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = [x - self.centre_m[0], y - self.centre_m[1]];
        match self.shape {
            Shape::Box {
                turn: [cos, sin], ..
            } => [cos * dx + sin * dy, cos * dy - sin * dx],
            Shape::Circle { .. } => [dx, dy],
        }
    }

    /// Distance from a point to the surface, metres; negative inside.
    pub fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        let [x, y] = self.local(point_m);
        match self.shape {
            Shape::Circle { radius_m } => x.hypot(y) - radius_m,
            Shape::Box { half_m, .. } => {
                let [dx, dy] = [x.abs() - half_m[0], y.abs() - half_m[1]];
                if dx <= 0.0 && dy <= 0.0 {
                    return dx.max(dy);
                }
                dx.max(0.0).hypot(dy.max(0.0))
            }
        }
    }

    /// The corners of a box, or points on a circle, for drawing, metres.
    pub fn outline_m(&self) -> Vec<[f64; 2]> {
        let [cx, cy] = self.centre_m;
        match self.shape {
            Shape::Circle { radius_m } => (0..48)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) / 48.0 * std::f64::consts::TAU).sin_cos();
                    [cx + radius_m * cos, cy + radius_m * sin]
                })
                .collect(),
            Shape::Box { half_m, turn } => rectangle_m(self.centre_m, half_m, turn).to_vec(),
        }
    }
}

/// The corners of a rectangle, turned about its centre by an angle with this cosine and sine, metres.
fn rectangle_m([cx, cy]: [f64; 2], [hx, hy]: [f64; 2], [cos, sin]: [f64; 2]) -> [[f64; 2]; 4] {
    [[-hx, -hy], [hx, -hy], [hx, hy], [-hx, hy]]
        .map(|[x, y]| [cx + cos * x - sin * y, cy + sin * x + cos * y])
}
