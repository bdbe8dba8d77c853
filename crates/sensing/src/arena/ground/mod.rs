//! The ground of an arena: regions of the floor with friction of their own, steps that stand on it, and a height field.

mod height_field;
mod height_file;

use std::sync::Arc;

use serde::Deserialize;

pub use height_field::HeightField;
pub use height_file::GroundFile;

use super::rectangle_m;

use realgap_core::error::{Error, Result};

/// The largest number of regions and of steps, and the largest number of corners of a region.
const MOST: usize = 100;
/// The farthest corner, metres.
const FARTHEST_M: f64 = 1e4;
/// The longest name, bytes.
const LONGEST: usize = 64;

/// What the ground of an arena is made of, beside a flat floor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ground {
    /// Regions of the floor. Where regions overlap, the later one lies on top.
    pub regions: Vec<Region>,
    /// Steps that stand on the floor.
    pub steps: Vec<Step>,
    /// A height field in place of a part of the flat floor.
    pub heights: Option<Arc<HeightField>>,
}

/// A region of the floor with friction of its own, seen from above.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Region")]
pub struct Region {
    /// Name: letters, digits, `_` and `-`; its parameters are `floor.NAME.friction` and `floor.NAME.restitution`.
    pub name: String,
    /// Corners of its outline in order, metres.
    pub corners_m: Vec<[f64; 2]>,
    /// Coulomb friction coefficient of the pair robot and region, in place of the floor's.
    pub friction: f64,
    /// Restitution coefficient of the pair robot and region; without it, that of the floor.
    #[serde(default)]
    pub restitution: Option<f64>,
}

/// A step: a box that stands on the floor and does not move.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Step")]
pub struct Step {
    /// Name: letters, digits, `_` and `-`; its parameters are `floor.NAME.friction` and `floor.NAME.height_m`.
    pub name: String,
    /// Centre, metres.
    pub centre_m: [f64; 2],
    /// Half of its sides, metres.
    pub half_m: [f64; 2],
    /// Rotation counter-clockwise, degrees.
    #[serde(default)]
    pub turn_deg: f64,
    /// Height of its top above the floor, metres.
    pub height_m: f64,
    /// Coulomb friction coefficient of the pair robot and step.
    pub friction: f64,
}

/// A value with the range that it must be in.
fn within(field: String, value: f64, (low, high): (f64, f64), unit: &str) -> Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::invalid("out of range")
        .field(field)
        .found(format!("{value} {unit}").trim_end())
        .allowed(format!("{low} to {high} {unit}").trim_end()))
}

impl Ground {
    /// Range of the heights of steps, metres.
    pub const STEP_HEIGHTS_M: (f64, f64) = (1e-4, 10.0);

    /// Whether the ground is a flat floor of one friction.
    pub fn is_plain(&self) -> bool {
        self.regions.is_empty() && self.steps.is_empty() && self.heights.is_none()
    }

    /// The region at a point of the floor, seen from above: the last one that contains it.
    pub fn region_at(&self, point_m: [f64; 2]) -> Option<usize> {
        self.regions
            .iter()
            .rposition(|region| region.contains(point_m))
    }

    /// Checks names, outlines and numbers.
    ///
    /// # Errors
    /// A name that is not one or that is used twice, an outline that is not one, numbers out of range.
    pub fn check(&self) -> Result<()> {
        for (field, count) in [("regions", self.regions.len()), ("steps", self.steps.len())] {
            if count > MOST {
                return Err(Error::invalid("too many of them")
                    .field(field)
                    .found(count)
                    .allowed(format!("at most {MOST}")));
            }
        }
        let regions = self.regions.iter().map(|region| region.name.as_str());
        let names: Vec<&str> = regions
            .chain(self.steps.iter().map(|step| step.name.as_str()))
            .collect();
        for (index, name) in names.iter().enumerate() {
            let place = match index.checked_sub(self.regions.len()) {
                None => format!("regions[{index}]"),
                Some(step) => format!("steps[{step}]"),
            };
            let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
            if name.is_empty() || name.len() > LONGEST || !name.chars().all(is_plain) {
                return Err(Error::invalid("not a name: parameters are called after it")
                    .field(format!("{place}.name"))
                    .found(format!("{name:?}"))
                    .allowed(format!("1 to {LONGEST} letters, digits, `_` and `-`")));
            }
            if names[..index].contains(name) {
                return Err(Error::invalid("two regions or steps of one name")
                    .field(format!("{place}.name"))
                    .found(format!("`{name}` twice"))
                    .allowed("a name for each, because parameters are called after them"));
            }
        }
        for (index, region) in self.regions.iter().enumerate() {
            region.check(&format!("regions[{index}]"))?;
        }
        for (index, step) in self.steps.iter().enumerate() {
            step.check(&format!("steps[{index}]"))?;
        }
        Ok(())
    }
}

impl Region {
    /// Whether a point lies in the region: a line from it to infinity crosses the outline an odd number of times.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let crosses = |[a, b]: [[f64; 2]; 2]| {
            (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        self.edges().filter(|edge| crosses(*edge)).count() % 2 == 1
    }

    /// The sides of the outline.
    pub fn edges(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        let next = self.corners_m.iter().cycle().skip(1);
        self.corners_m.iter().zip(next).map(|(a, b)| [*a, *b])
    }

    fn check(&self, at: &str) -> Result<()> {
        within(format!("{at}.friction"), self.friction, (0.0, 10.0), "")?;
        if let Some(restitution) = self.restitution {
            within(format!("{at}.restitution"), restitution, (0.0, 1.0), "")?;
        }
        let refuse = |what: &str, found: String, allowed: &str| {
            let error = Error::invalid(what).field(format!("{at}.corners_m"));
            Err(error.found(found).allowed(allowed))
        };
        if !(3..=MOST).contains(&self.corners_m.len()) {
            return refuse(
                "not an outline",
                format!("{} corners", self.corners_m.len()),
                "3 to 100 corners in order; the last is joined to the first",
            );
        }
        if let Some(far) = (self.corners_m.iter())
            .find(|corner| !(corner.iter()).all(|value| (-FARTHEST_M..=FARTHEST_M).contains(value)))
        {
            return refuse(
                "not a corner",
                format!("{far:?} m"),
                "finite numbers, at most 10 km from the origin",
            );
        }
        let edges: Vec<_> = self.edges().collect();
        let last = edges.len() - 1;
        if let Some([corner, _]) = edges.iter().find(|[a, b]| a == b) {
            return refuse(
                "a side of an outline has no length",
                format!("{corner:?} m twice in a row"),
                "different corners; the first is not repeated at the end",
            );
        }
        for (k, edge) in edges.iter().enumerate() {
            // Neighbours share a corner.
            let others = edges.iter().enumerate().skip(k + 2);
            for (_, other) in others.filter(|(m, _)| (k, *m) != (0, last)) {
                if do_cross(*edge, *other) {
                    return refuse(
                        "the sides of an outline cross",
                        format!(
                            "{:?} to {:?} and {:?} to {:?}",
                            edge[0], edge[1], other[0], other[1]
                        ),
                        "corners in order around the region",
                    );
                }
            }
        }
        let doubled_m2: f64 = edges.iter().map(|[a, b]| a[0] * b[1] - b[0] * a[1]).sum();
        if doubled_m2.abs() < 1e-9 {
            return refuse(
                "an outline without an area",
                "corners on one line".to_owned(),
                "corners around an area",
            );
        }
        Ok(())
    }
}

/// Whether two sides cross or touch.
fn do_cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

impl Step {
    /// The corners of its outline, seen from above, metres.
    pub fn outline_m(&self) -> [[f64; 2]; 4] {
        let (sin, cos) = self.turn_deg.to_radians().sin_cos();
        rectangle_m(self.centre_m, self.half_m, [cos, sin])
    }

    fn check(&self, at: &str) -> Result<()> {
        within(format!("{at}.friction"), self.friction, (0.0, 10.0), "")?;
        within(
            format!("{at}.height_m"),
            self.height_m,
            Ground::STEP_HEIGHTS_M,
            "m",
        )?;
        for axis in 0..2 {
            let range = (-FARTHEST_M, FARTHEST_M);
            within(
                format!("{at}.centre_m[{axis}]"),
                self.centre_m[axis],
                range,
                "m",
            )?;
            within(
                format!("{at}.half_m[{axis}]"),
                self.half_m[axis],
                (1e-4, 50.0),
                "m",
            )?;
        }
        within(
            format!("{at}.turn_deg"),
            self.turn_deg,
            (-3600.0, 3600.0),
            "degrees",
        )
    }
}
