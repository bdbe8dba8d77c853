//! Noise files, for robots that have no study.

use std::path::Path;

use realgap_core::Result;
use realgap_core::file::{Source, parse_ron};
use realgap_simulation::Noise;

/// Reads a noise file, which has the form of a study's `noise` section.
///
/// # Errors
/// A missing or malformed file, unknown fields, invalid distributions.
pub fn read_noise(path: impl AsRef<Path>) -> Result<Noise> {
    let source = Source::read(path, "noise")?;
    let noise: Noise = parse_ron(&source)?;
    match noise.fault() {
        Some((field, error)) => Err(source.at(field, error)),
        None => Ok(noise),
    }
}
