//! Finding and reading the recordings of a study.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::matching::matching_files;
use super::overrides::Overrides;
use crate::error::{Advice, Error, Result};
use crate::file::sha256;
use crate::robot::morphology::Morphology;
use crate::trajectory::{self, META_FILE, Recording, Source};
use crate::unit::counted;
use crate::warning::{Code, Warning};

/// Recordings with the hashes of their files.
pub(super) struct Found {
    pub recordings: Vec<Recording>,
    pub sha256: Vec<String>,
}

/// Reads every recording that the overrides' globs (relative to the current folder) or the study's own
/// (relative to its file) name, in order of their paths.
pub(super) fn find(study: &Path, own_globs: &[String], overrides: &Overrides) -> Result<Found> {
    let (globs, base) = if overrides.recordings.is_empty() {
        (own_globs, study.parent().unwrap_or(Path::new("")))
    } else {
        (overrides.recordings.as_slice(), Path::new(""))
    };
    if globs.is_empty() {
        return Err(Error::invalid("the study names no recordings")
            .at_file(study)
            .field("recordings")
            .hint("name them in the file: recordings: [\"../runs/*.csv\"]")
            .advise(Advice::Recordings));
    }
    let unique = recording_paths(globs, base)?;
    let mut found = Found {
        recordings: Vec::new(),
        sha256: Vec::new(),
    };
    let limit = overrides.limit_recordings.unwrap_or(usize::MAX).max(1);
    let mut index = 0;
    for path in &unique {
        if found.recordings.len() >= limit {
            break;
        }
        let bytes = trajectory::read_bytes(path)?;
        let sha256 = sha256(&bytes);
        for recording in trajectory::parse_all(path, bytes, overrides.unit)? {
            if overrides.part.is_none_or(|part| part.contains(index)) {
                found.sha256.push(sha256.clone());
                found.recordings.push(recording);
            }
            index += 1;
        }
    }
    found.recordings.truncate(limit);
    found.sha256.truncate(limit);
    if found.recordings.is_empty() {
        return Err(Error::invalid("this part of the recordings is empty")
            .at_file(study)
            .found(format!("{} in all", counted(index, "recording"))));
    }
    Ok(found)
}

/// The files that these globs name, relative to `base`, each once; in order of the globs, then of the paths.
///
/// # Errors
/// A glob that is none or that matches nothing; a match that is no file with the ending of a recording. A `meta.ron`, a README
/// and a licence may lie beside recordings.
pub fn recording_paths(globs: &[String], base: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for pattern in globs {
        let whole = base.join(pattern);
        let mut found = matching_files(base, pattern)?;
        found.retain(|path| !is_beside(path));
        if found.is_empty() {
            return Err(Error::invalid("no file matches")
                .field("recordings")
                .found(whole.display())
                .allowed("a glob that matches at least one .csv or .tum file")
                .hint("in a shell, quote the glob; it is relative to the current folder, in a study file to that file"));
        }
        for path in &found {
            trajectory::format_of(path).map_err(|e| {
                e.or_hint("every match of the glob counts: name one that matches recordings only, e.g. FOLDER/*.csv")
            })?;
        }
        paths.extend(found);
    }
    let mut unique: Vec<PathBuf> = Vec::new();
    for path in paths {
        if !unique.contains(&path) {
            unique.push(path);
        }
    }
    Ok(unique)
}

/// Whether a file lies beside recordings without being one.
fn is_beside(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == META_FILE
        || ["README", "LICENSE", "LICENCE"]
            .iter()
            .any(|start| name.starts_with(start))
}

/// What the reader should know of recordings that are matched with simulations of `robot`.
pub(super) fn warnings_for(robot: &Morphology, recordings: &[Recording]) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
    warnings.extend(different_robots(recordings));
    for recorded in robots(recordings) {
        if recorded == robot.name() {
            continue;
        }
        let message = format!(
            "recordings of the robot \"{recorded}\" are matched with a simulation of \"{}\"",
            robot.name()
        );
        warnings.push(Warning::new(Code::OtherRobot, message));
    }
    warnings.extend(stand_in(recordings));
    warnings.sort();
    warnings.dedup();
    warnings
}

fn robots(recordings: &[Recording]) -> BTreeSet<&str> {
    let metas = recordings.iter().filter_map(|r| r.meta.as_ref());
    metas.map(|meta| meta.robot.as_str()).collect()
}

fn different_robots(recordings: &[Recording]) -> Option<Warning> {
    let names: Vec<&str> = robots(recordings).into_iter().collect();
    (names.len() > 1).then(|| {
        Warning::new(
            Code::DifferentRobots,
            format!(
                "the recordings are of different robots: {}",
                names.join(", ")
            ),
        )
    })
}

fn stand_in(recordings: &[Recording]) -> Option<Warning> {
    (Source::of(recordings) == Source::StandIn).then(|| {
        Warning::new(
            Code::StandIn,
            "the recordings are stand-ins made by a simulator, not recorded from hardware",
        )
    })
}

/// What the reader of any result from these recordings should know, whatever they are compared with.
pub fn recording_warnings(recordings: &[Recording]) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
    warnings.extend(different_robots(recordings));
    warnings.extend(stand_in(recordings));
    warnings.sort();
    warnings.dedup();
    warnings
}
