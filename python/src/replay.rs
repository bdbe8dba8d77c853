//! A run in motion with its recordings, as `realgap replay` shows it.

use std::path::PathBuf;

use pyo3::prelude::*;
use realgap::file::write_atomic;
use realgap::report::{Replay, SIMULATION};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Film, Floor};
use realgap::trajectory::Recording;
use realgap::{Error, Result};

use crate::error::Raise;
use crate::robot::Robot;
use crate::simulation::Simulation;
use crate::trajectory::Trajectory;

/// The page of a simulated or a recorded run, or a file for another program, by the ending of `output`; the page as a text where
/// nothing is written.
#[pyfunction]
pub fn replay(
    py: Python<'_>,
    simulated: Option<&Simulation>,
    recorded: Option<&Trajectory>,
    robot: Option<&Robot>,
    against: Vec<Bound<'_, Trajectory>>,
    align: bool,
    output: Option<PathBuf>,
) -> PyResult<Option<String>> {
    let recordings: Vec<Recording> = against
        .iter()
        .map(|one| (*one.get().recording).clone())
        .collect();
    py.detach(|| {
        let morphology = robot.map(|robot| &robot.morphology);
        let (film, name) = match (simulated, recorded) {
            (Some(run), _) => (run.film().clone(), SIMULATION),
            (None, Some(run)) => (film_of(morphology, &run.recording), &*run.recording.name),
            (None, None) => return Err(Error::usage("there is no run to show")),
        };
        let provenance = vec![("realgap".to_owned(), env!("CARGO_PKG_VERSION").to_owned())];
        let warnings: Vec<_> = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
        let replay = Replay {
            robot: morphology,
            run: &film,
            run_name: name,
            recordings: &recordings,
            align,
            floor: Floor::default(),
            scene: &[],
            warnings: &warnings,
            provenance: &provenance,
        };
        written(&replay, output)
    })
    .or_raise(py)
}

fn film_of(robot: Option<&Morphology>, run: &Recording) -> Film {
    match robot {
        Some(robot) => Film::of_recording(&robot.assemble(), run),
        None => Film {
            track: run.trajectory.clone(),
            parts: Vec::new(),
            scene: Vec::new(),
        },
    }
}

fn written(replay: &Replay<'_>, output: Option<PathBuf>) -> Result<Option<String>> {
    let Some(path) = output else {
        return replay.page().map(Some);
    };
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let bytes = match ending.as_deref().and_then(std::ffi::OsStr::to_str) {
        Some("html") => replay.page()?.into_bytes(),
        Some("mcap") => replay.mcap()?,
        Some("glb") => replay.gltf()?,
        Some("png" | "apng") => replay.animation()?,
        _ => {
            return Err(Error::usage("a replay cannot be written as such a file")
                .at_file(&path)
                .allowed("a name that ends in .html, .png, .mcap or .glb"));
        }
    };
    write_atomic(&path, &bytes)?;
    Ok(None)
}
