//! The RON form of a two-wheel robot.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::{Drive, Vehicle};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, parse_ron};
use realgap_sensing::arena::{Arena, StartFile};
use realgap_sensing::range::find_sensor;

/// A two-wheel robot as its file states it.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Vehicle")]
pub struct VehicleFile {
    /// Its name.
    name: String,
    /// Radius of its round body, metres.
    radius_m: f64,
    /// The arena's file, relative to this file; it states the start of the robot.
    arena: PathBuf,
    /// The range sensor: the file of a model, relative to this file, or the name of a built-in model.
    sensor: String,
    /// Starts of other robots of the same kind in the same arena.
    #[serde(default)]
    others: Vec<StartFile>,
    /// Parameters of motion, sensing and control.
    #[serde(default)]
    drive: Drive,
}

/// Largest number of robots in addition to the first.
const MOST_OTHERS: usize = 100;

impl Vehicle {
    /// Reads a two-wheel robot, its arena and its sensor; `sensor` replaces the sensor of the file.
    ///
    /// # Errors
    /// Missing or malformed files, a radius that is not positive, a start in a wall.
    pub fn read(path: impl AsRef<Path>, sensor: Option<&str>) -> Result<Self> {
        let path = path.as_ref();
        let source = Source::read(path, "vehicle")?;
        let file: VehicleFile = parse_ron(&source)?;
        if !(file.radius_m > 0.0 && file.radius_m < 100.0) {
            let error = Error::invalid("not a radius")
                .field("radius_m")
                .found(file.radius_m)
                .allowed("above 0 m");
            return Err(source.at("radius_m", error));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let arena_path = folder.join(&file.arena);
        let arena_source = Source::read(&arena_path, "arena").map_err(|e| {
            e.or_hint("the vehicle's field `arena` names it, relative to the vehicle's file")
        })?;
        let arena = Arena::parse(&arena_source)?;
        let Some([x, y, _]) = arena.start else {
            return Err(Error::invalid("the arena does not say where robots start")
                .at_file(&arena_path)
                .field("start"));
        };
        arena
            .check_place([x, y], file.radius_m)
            .map_err(|e| arena_source.at("start", e))?;
        let others = others(&file, &arena, [x, y]).map_err(|e| source.at("others", e))?;
        let name = sensor.unwrap_or(&file.sensor);
        let sensor = match name.ends_with(".ron") {
            true => find_sensor(&folder.join(name).to_string_lossy()),
            false => find_sensor(name),
        };
        let sensor = sensor.map_err(|e| source.at("sensor", e))?;
        Ok(Self {
            name: file.name,
            radius_m: file.radius_m,
            text: format!(
                "{}\n{}\n{}",
                source.text(),
                arena_source.text(),
                sensor.to_ron()?
            ),
            arena: Arc::new(arena),
            others,
            sensor: Arc::new(sensor),
            drive: file.drive,
        })
    }
}

/// Start poses of the other robots.
///
/// # Errors
/// Too many of them, one in a wall or in another robot.
fn others(file: &VehicleFile, arena: &Arena, first_m: [f64; 2]) -> Result<Vec<[f64; 3]>> {
    if file.others.len() > MOST_OTHERS {
        return Err(Error::invalid("too many robots")
            .field("others")
            .found(file.others.len())
            .allowed(format!("at most {MOST_OTHERS}")));
    }
    let mut taken_m = vec![first_m];
    for (index, other) in file.others.iter().enumerate() {
        let field = format!("others[{index}]");
        let [x_m, y_m, heading_rad] = other.pose();
        let place_m = [x_m, y_m];
        if !heading_rad.is_finite() {
            return Err(Error::invalid("not a heading")
                .field(field)
                .found(heading_rad));
        }
        arena
            .check_place(place_m, file.radius_m)
            .map_err(|e| e.field(&field))?;
        let distance_m = |at: &[f64; 2]| (at[0] - place_m[0]).hypot(at[1] - place_m[1]);
        if let Some(near) = taken_m
            .iter()
            .find(|at| distance_m(at) < 2.0 * file.radius_m)
        {
            return Err(Error::invalid("a robot starts in another")
                .field(field)
                .found(format!("{place_m:?} m, the other at {near:?} m"))
                .allowed(format!("a distance of at least {} m", 2.0 * file.radius_m)));
        }
        taken_m.push(place_m);
    }
    Ok(file.others.iter().map(|other| other.pose()).collect())
}
