//! Writes trajectories, with the format chosen by the file extension.

use std::path::Path;

use super::csv::{self, Csv};
use super::format::Format as _;
use super::registry::{FORMATS, format_of};
use super::{Trajectory, body_column};
use realgap_core::error::{Error, Result};
use realgap_core::file::write_atomic;
use realgap_core::warning::Warning;

/// Checks that [`write()`] can write a file with this extension.
///
/// # Errors
/// An unknown extension, or the extension of a format that is only read.
pub fn check_output(path: &Path) -> Result<()> {
    if format_of(path)?.writes() {
        return Ok(());
    }
    let written = FORMATS.iter().filter(|format| format.writes());
    let first: Vec<String> = written.map(|f| format!(".{}", f.extensions()[0])).collect();
    Err(
        Error::usage("files of this format can be read but not written")
            .at_file(path)
            .allowed(first.join(", ")),
    )
}

/// Writes `trajectory` to `path`, in metres; the extension chooses the format.
///
/// The file is written completely or not at all: it is written under another name in the same folder, then
/// renamed. The warnings name the data that the format cannot hold.
///
/// # Errors
/// An unknown extension, an unwritable folder, a full disk.
pub fn write(path: impl AsRef<Path>, trajectory: &Trajectory) -> Result<Vec<Warning>> {
    let path = path.as_ref();
    check_output(path)?;
    let rendered = format_of(path)?.render(trajectory)?;
    write_atomic(path, &rendered.bytes)?;
    Ok(rendered.warnings)
}

/// As [`write()`], with the poses of other bodies in columns `NAME_x_m,NAME_y_m,NAME_z_m,NAME_qw,…`; `bodies` has the form of
/// [`Recording::bodies`](super::Recording::bodies).
///
/// # Errors
/// The errors of [`write()`]; a format that cannot hold several bodies; a body whose times differ from those of the trajectory.
pub fn write_with_bodies(
    path: impl AsRef<Path>,
    trajectory: &Trajectory,
    bodies: &[(String, Trajectory)],
) -> Result<()> {
    let path = path.as_ref();
    if format_of(path)?.name() != Csv.name() {
        return Err(Error::usage("this format holds one body only")
            .at_file(path)
            .allowed("a .csv file"));
    }
    let mut text = csv::text_of(trajectory);
    for (name, motion) in bodies {
        if motion.times_s() != trajectory.times_s() {
            return Err(
                Error::invalid("all bodies in one file must have the same times").field(name),
            );
        }
        text = body_column::beside(&text, name, &csv::text_of(motion));
    }
    write_atomic(path, text.as_bytes())
}
