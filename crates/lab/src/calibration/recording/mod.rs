//! Finding and reading the recordings of a study.

pub(super) mod expected_noise;
pub(super) mod file_pattern;
pub(super) mod identity;
pub(super) mod joints;
pub(super) mod noise;
pub(super) mod plausibility;
pub(super) mod repeat;
pub(super) mod stand_in;
pub(in crate::calibration) mod start_speed;
pub(super) mod usage;

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hasher as _};
use std::path::{Path, PathBuf};

use crate::calibration::WindowRule;
use crate::calibration::recording::file_pattern::matching_files;
use crate::calibration::{BaseRule, Definition, Horizon, Overrides};
use realgap_core::file::sha256;
use realgap_core::unit::counted;
use realgap_core::{Advice, Code, Error, Result, Warning};
use realgap_identification::is_at_rest;
use realgap_path::trajectory::{self, META_FILE, Recording, Source};
use realgap_robot::morphology::Morphology;

/// A digest of numbers, by which equal ones are found among thousands without comparing all pairs.
pub(in crate::calibration) fn digest<'a>(numbers: impl Iterator<Item = &'a f64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    numbers.for_each(|number| hasher.write_u64(number.to_bits()));
    hasher.finish()
}

/// Recordings with the hashes of their files.
#[derive(Default)]
pub(in crate::calibration) struct Found {
    pub recordings: Vec<Recording>,
    pub sha256: Vec<String>,
}

impl Found {
    /// Cuts every recording into windows and keeps those that the rule admits; a warning says how many it does not.
    pub(crate) fn cut_into(
        &mut self,
        horizon: Horizon,
        rule: &WindowRule,
    ) -> Result<Option<Warning>> {
        let whole = std::mem::take(self);
        for (recording, sha256) in whole.recordings.iter().zip(whole.sha256) {
            for window in horizon.windows(recording)? {
                self.recordings.push(window);
                self.sha256.push(sha256.clone());
            }
        }
        if *rule == WindowRule::default() {
            return Ok(None);
        }
        let (admitted, warning) = rule.of(&self.recordings)?;
        self.keep(&admitted);
        Ok(warning)
    }

    /// Keeps the recordings for which this is true.
    fn keep(&mut self, is_kept: &[bool]) {
        let mut kept = is_kept.iter();
        self.recordings.retain(|_| kept.next() == Some(&true));
        let mut kept = is_kept.iter();
        self.sha256.retain(|_| kept.next() == Some(&true));
    }

    /// Leaves out recordings in which something still moves at the end, with a warning.
    pub(crate) fn keep_those_at_rest(&mut self) -> Result<Option<Warning>> {
        let all = self.recordings.len();
        let rests = self.recordings.iter().map(|r| is_at_rest(&r.trajectory));
        let rests: Vec<bool> = rests.collect();
        let kept = rests.iter().filter(|rests| **rests).count();
        if kept == 0 {
            return Err(Error::invalid("all recordings end while moving")
                .field("only_at_rest")
                .found(counted(all, "recording"))
                .hint("leave only_at_rest out of the study, or name other recordings"));
        }
        self.keep(&rests);
        Ok((kept < all).then(|| {
            Code::MovingAtEnd.warning(format!(
                "{} of {all} recordings end while moving and are left out (only_at_rest)",
                all - kept
            ))
        }))
    }
}

/// Reads every recording that the globs name, in the order of the paths: the overrides' globs, relative to the current folder, or
/// else the study's own, relative to its file.
pub(in crate::calibration) fn find(
    definition: &Definition,
    study: &Path,
    overrides: &Overrides,
) -> Result<Found> {
    let (globs, base) = match overrides.recordings.is_empty() {
        true => (&definition.recording_globs, study.parent()),
        false => (&overrides.recordings, None),
    };
    if globs.is_empty() {
        return Err(Error::invalid("the study names no recordings")
            .at_file(study)
            .field("recordings")
            .hint("name them in the file: recordings: [\"../runs/*.csv\"]")
            .advise(Advice::Recordings));
    }
    let unique = recording_paths(globs, base.unwrap_or(Path::new("")))?;
    let mut found = Found::default();
    let limit = overrides.limit_recordings.unwrap_or(usize::MAX).max(1);
    let mut index = 0;
    let mut sets = BTreeSet::new();
    for path in &unique {
        if found.recordings.len() >= limit {
            break;
        }
        let bytes = trajectory::read_bytes(path)?;
        let sha256 = sha256(&bytes);
        for recording in trajectory::parse_all(path, bytes, &definition.reading)? {
            let set = set_of(&recording.name);
            if let (Some(wanted), Some(set)) = (&definition.condition, set) {
                sets.insert(set.to_owned());
                if set != wanted {
                    continue;
                }
            }
            if overrides.part.is_none_or(|part| part.contains(index)) {
                found.sha256.push(sha256.clone());
                found.recordings.push(recording);
            }
            index += 1;
        }
    }
    found.recordings.truncate(limit);
    found.sha256.truncate(limit);
    if let Some(wanted) = &definition.condition
        && index == 0
    {
        let known: Vec<String> = sets.into_iter().collect();
        return Err(Error::invalid("no recording is of this condition")
            .at_file(study)
            .field("condition")
            .found(wanted)
            .allowed(known.join(", ")));
    }
    if definition.condition.is_some() && sets.is_empty() && !found.recordings.is_empty() {
        return Err(Error::invalid("no recording says of which condition it is")
            .at_file(study)
            .field("condition")
            .allowed("recordings of files with a column `condition` beside `run`")
            .hint("leave `condition` out of the study, or map the column: `reading: (columns: (condition: \"NAME\", run: \"NAME\"))`"));
    }
    if found.recordings.is_empty() {
        return Err(Error::invalid("this part of the recordings is empty")
            .at_file(study)
            .found(format!("{} in all", counted(index, "recording"))));
    }
    Ok(found)
}

/// The set to which a recording of a file with several sets belongs: `runs/us1/3` belongs to `us1`.
fn set_of(name: &str) -> Option<&str> {
    let parts: Vec<&str> = name.split('/').collect();
    match parts.as_slice() {
        [_, set, _] => Some(set),
        _ => None,
    }
}

/// The files that these globs name, relative to `base`, each once; in the order of the globs, then of the paths.
///
/// # Errors
/// A pattern that is not a glob or that matches nothing; a match that is not a file with the ending of a recording. A `meta.ron`,
/// a README and a licence may stand beside recordings.
pub(crate) fn recording_paths(globs: &[String], base: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for pattern in globs {
        let whole = base.join(pattern);
        let mut found = matching_files(base, pattern)?;
        found.retain(|path| !is_beside(path));
        if found.is_empty() {
            return Err(Error::invalid("no file matches")
                .field("recordings")
                .found(whole.display())
                .allowed("a glob that matches at least one recording, e.g. a .csv or .tum file")
                .hint(if base == Path::new("") {
                    "the glob starts at the current folder; in a shell, quote it"
                } else {
                    "a glob in a study file starts at that file's folder"
                }));
        }
        for path in &found {
            trajectory::format_of(path).map_err(|e| {
                e.or_hint("every match of the glob counts: name one that matches recordings only, e.g. FOLDER/*.csv")
            })?;
        }
        paths.extend(found);
    }
    let mut seen = BTreeSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    Ok(paths)
}

/// Whether a file may stand beside recordings without being one.
fn is_beside(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == META_FILE
        || ["README", "LICENSE", "LICENCE"]
            .iter()
            .any(|start| name.starts_with(start))
}

/// Warnings about recordings that are compared with simulations of `robot`, where that is known.
pub(in crate::calibration) fn warnings_for(
    robot: Option<&Morphology>,
    recordings: &[Recording],
    base: BaseRule,
) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
    warnings.extend(different_robots(recordings));
    for (recorded, robot) in robots(recordings)
        .into_iter()
        .zip(robot.into_iter().cycle())
    {
        if recorded == robot.name() {
            continue;
        }
        let message = format!(
            "recordings of the robot \"{recorded}\" are matched with a simulation of \"{}\"",
            robot.name()
        );
        warnings.push(Code::OtherRobot.warning(message));
    }
    // Nothing is known about the robot of a study's own simulator.
    if let Some(robot) = robot {
        warnings.extend(plausibility::lengths(robot, recordings));
        warnings.extend(plausibility::axes(robot, recordings));
        warnings.extend(plausibility::angles(robot, recordings));
        if base == BaseRule::OfRobot {
            warnings.extend(plausibility::held(robot, recordings));
        }
    }
    warnings.extend(plausibility::duplicate_recordings(recordings));
    warnings.extend(stand_in(recordings));
    in_short(warnings)
}

/// With fewer recordings than this the variability of reality is hardly known.
pub(crate) const FEW_RECORDINGS: usize = 5;

/// A warning where there are several recordings, but few.
pub(crate) fn few_recordings(count: usize) -> Option<Warning> {
    (2..FEW_RECORDINGS).contains(&count).then(|| {
        Code::FewRecordings.warning(format!(
            "{count} recordings hardly know how reality repeats itself: what is said about it is wide, or a guess; {FEW_RECORDINGS} are the least, 20 are better"
        ))
    })
}

fn robots(recordings: &[Recording]) -> BTreeSet<&str> {
    let metas = recordings.iter().filter_map(|r| r.meta.as_ref());
    metas.map(|meta| meta.robot.as_str()).collect()
}

fn different_robots(recordings: &[Recording]) -> Option<Warning> {
    let names: Vec<&str> = robots(recordings).into_iter().collect();
    (names.len() > 1).then(|| {
        Code::DifferentRobots.warning(format!(
            "the recordings are of different robots: {}",
            names.join(", ")
        ))
    })
}

fn stand_in(recordings: &[Recording]) -> Option<Warning> {
    (Source::of(recordings) == Source::StandIn).then(|| {
        Code::StandIn
            .warning("the recordings are stand-ins made by a simulator, not recorded from hardware")
    })
}

/// Warnings about these recordings that hold for every result, whatever the recordings are compared with.
pub fn recording_warnings(recordings: &[Recording]) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
    warnings.extend(different_robots(recordings));
    warnings.extend(stand_in(recordings));
    in_short(warnings)
}

/// Most recordings that are listed with the same warning.
const SAID_OF: usize = 3;

/// Every warning once; many recordings with the same warning are summarised.
pub(in crate::calibration) fn in_short(mut warnings: Vec<Warning>) -> Vec<Warning> {
    warnings.sort();
    warnings.dedup();
    let mut short: Vec<Warning> = Vec::new();
    for alike in warnings.chunk_by(|a, b| a.code == b.code) {
        let is_long = alike.len() > SAID_OF && OF_ONE_RECORDING.contains(&alike[0].code);
        let shown = if is_long { SAID_OF } else { alike.len() };
        short.extend_from_slice(&alike[..shown]);
        if let (true, Some(last)) = (is_long, short.last_mut()) {
            last.message += &format!(" (and {} more recordings alike)", alike.len() - shown);
        }
    }
    short
}

/// Warnings that are about single recordings.
const OF_ONE_RECORDING: [Code; 26] = [
    Code::ChangedUnit,
    Code::CoarseEncoder,
    Code::DegreesAsRadians,
    Code::ExchangedJoints,
    Code::FlippedSign,
    Code::FrozenTracker,
    Code::Hole,
    Code::JointDropout,
    Code::LostAsZero,
    Code::LostPackets,
    Code::NormalisedAngles,
    Code::OffFloor,
    Code::OtherRobot,
    Code::QuaternionOrder,
    Code::SameRun,
    Code::SaturatedCommands,
    Code::Spike,
    Code::StaleSamples,
    Code::Standstill,
    Code::SwitchedOff,
    Code::UnknownAxes,
    Code::UnlikelyAngle,
    Code::UnlikelyLength,
    Code::UnlikelyTime,
    Code::UnsynchronisedClocks,
    Code::WrappedAngle,
];
