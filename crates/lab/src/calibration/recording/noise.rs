//! Noise in a file of its own, for robots that have no study.

use std::path::Path;

use realgap_core::Result;
use realgap_core::file::{Source, parse_ron};
use realgap_simulation::Noise;

/// Reads a noise file: what a study has in its `noise` section.
///
/// # Errors
/// A missing or malformed file, unknown fields, distributions that are not sound.
pub fn read_noise(path: impl AsRef<Path>) -> Result<Noise> {
    let source = Source::read(path, "noise")?;
    let noise: Noise = parse_ron(&source)?;
    match noise.fault() {
        Some((field, error)) => Err(source.at(field, error)),
        None => Ok(noise),
    }
}
