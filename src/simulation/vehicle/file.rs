//! The RON form of a two-wheel robot.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::{Drive, Vehicle};
use crate::error::{Error, Result};
use crate::file::{Source, parse_ron};
use crate::sensing::arena::Arena;
use crate::sensing::range::find_sensor;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Vehicle")]
struct VehicleFile {
    name: String,
    radius_m: f64,
    arena: PathBuf,
    sensor: String,
    #[serde(default)]
    drive: Drive,
}

impl Vehicle {
    /// Reads a two-wheel robot, its arena and its sensor; `sensor` takes the place of the file's own.
    ///
    /// # Errors
    /// Any of the files missing or malformed, a radius that is not positive, a start in a wall.
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
            sensor: Arc::new(sensor),
            drive: file.drive,
        })
    }
}
