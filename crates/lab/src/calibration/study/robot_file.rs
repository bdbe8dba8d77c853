//! The RON form of the robots in a study's file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::calibration::StartRule;
use crate::calibration::answer::values::assignments;
use crate::calibration::study::fleet::Member;
use realgap_core::file::{Source, unique_keys};
use realgap_core::{ErrorKind, Result, range};
use realgap_robot::morphology::Morphology;

/// One of the robots of a study of many.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Robot")]
pub(in crate::calibration) struct RobotFile {
    /// The robot's file with its gait, relative to the study's.
    morphology: PathBuf,
    /// Paths and patterns of its own recordings, relative to the study's file.
    recordings: Vec<String>,
    /// Parameters that are fixed for it alone, by name.
    #[serde(default, deserialize_with = "unique_keys")]
    set: BTreeMap<String, f64>,
    /// Where its runs start, if not where those of the study do.
    start: Option<StartRule>,
    /// Its controller's file, relative to the study's, if not the study's own.
    pub(in crate::calibration) controller: Option<PathBuf>,
    /// How many times each of its recordings counts.
    #[serde(default = "default_weight")]
    weight: f64,
}

impl RobotFile {
    fn member(&self, source: &Source, folder: &Path, start: StartRule) -> Result<Member> {
        let robot = morphology_source(source, &folder.join(&self.morphology))?;
        range::Range::within(1e-6, 1e6, "").check(self.weight, "weight")?;
        Ok(Member {
            morphology: Morphology::parse(&robot)?,
            sha256: robot.sha256(),
            recording_globs: self.recordings.clone(),
            recordings: 0..0,
            set: assignments(&self.set).map_err(|e| e.field("set"))?,
            start: self.start.unwrap_or(start),
            steering: None,
            weight: self.weight,
        })
    }
}

fn default_weight() -> f64 {
    1.0
}

/// The robots that a study names, without their recordings.
pub(in crate::calibration) fn members(
    robots: &[RobotFile],
    source: &Source,
    folder: &Path,
    start: StartRule,
) -> Result<Vec<Member>> {
    let members = robots.iter().enumerate().map(|(index, robot)| {
        robot.member(source, folder, start).map_err(|e| {
            let inner = e
                .field_name()
                .map_or(String::new(), |field| format!(".{field}"));
            let field = format!("robots[{index}]{inner}");
            source.at(&field, e.field(&field))
        })
    });
    members.collect()
}

/// Reads the robot that a study names.
pub(in crate::calibration) fn morphology_source(study: &Source, named: &Path) -> Result<Source> {
    Source::read(named, "morphology").map_err(|e| {
        let e = match e.file() {
            Some(_) => e,
            None => study.at("morphology", e),
        };
        match e.kind() {
            ErrorKind::Io => e.hint(format!(
                "`morphology` in {} names it; relative paths in a study start at the study's folder",
                study.path().display()
            )),
            _ => e,
        }
    })
}
