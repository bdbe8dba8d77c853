//! The file `plan.json`: the command, its folder, and the number of shards.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Cost;
use realgap_core::file::{Source, sha256, write_atomic};
use realgap_core::{Advice, Error, Result};
use realgap_store::{Fingerprint, Share};

/// Name of the file that makes a folder a plan.
pub const PLAN_FILE: &str = "plan.json";
/// Version of the file's form.
const SCHEMA_VERSION: u32 = 1;

/// The contents of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlanDraft {
    /// The command and its arguments, as they follow the program's name.
    pub command: Vec<String>,
    /// Where the command is run: paths in its arguments begin there.
    pub directory: PathBuf,
    /// Name of the study or search.
    pub name: String,
    /// Number of shards of every round.
    pub shards: usize,
    /// Everything that decides the results, by name.
    pub fingerprint: Vec<(String, String)>,
    /// Estimated cost, where runs were measured.
    pub cost: Option<Cost>,
}

/// The outermost form of the file: the checksum is that of the plan's own JSON.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Saved {
    schema_version: u32,
    plan: PlanDraft,
    sha256: String,
}

/// A plan in its folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    folder: PathBuf,
    draft: PlanDraft,
}

impl Plan {
    /// Writes a new plan into a folder, which is made where it does not exist.
    ///
    /// # Errors
    /// A plan that exists already, an invalid number of shards, a folder that cannot be written.
    pub fn create(folder: &Path, draft: PlanDraft) -> Result<Self> {
        Share::new(0, draft.shards)?;
        let file = folder.join(PLAN_FILE);
        if file.exists() {
            return Err(Error::conflict("there is a plan already")
                .at_file(file)
                .hint("remove this one with everything that its shards have done")
                .advise(Advice::OtherFolder));
        }
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::io("make the folder of the plan", folder, &e))?;
        let saved = Saved {
            schema_version: SCHEMA_VERSION,
            sha256: checksum(&draft)?,
            plan: draft,
        };
        write_json(&file, &saved)?;
        Self::read(folder)
    }

    /// Reads the plan in a folder.
    ///
    /// # Errors
    /// No plan there, a plan of another version, or a plan that was changed.
    pub fn read(folder: &Path) -> Result<Self> {
        let file = folder.join(PLAN_FILE);
        if folder.is_dir() && !file.exists() {
            return Err(Error::invalid("no plan here")
                .at_file(folder)
                .hint("name the folder of a plan, or make one"));
        }
        let source = Source::read(&file, "plan")?;
        let refused = |e: serde_json::Error| {
            Error::invalid(format!("not a plan: {e}"))
                .at_file(&file)
                .hint("plans are not written by hand: make another")
        };
        let value: serde_json::Value = serde_json::from_str(source.text()).map_err(refused)?;
        let version = value
            .get("schema_version")
            .and_then(serde_json::Value::as_u64);
        if let Some(version) = version.filter(|version| *version != u64::from(SCHEMA_VERSION)) {
            return Err(
                Error::conflict("another version of this program made this plan")
                    .at_file(&file)
                    .found(format!("schema_version {version}"))
                    .allowed(format!("schema_version {SCHEMA_VERSION}"))
                    .hint("use that version, or make the plan again"),
            );
        }
        let saved: Saved = serde_json::from_value(value).map_err(refused)?;
        if checksum(&saved.plan)? != saved.sha256 {
            return Err(Error::conflict("the plan was changed after it was made")
                .at_file(&file)
                .field("sha256")
                .hint("undo the change, or make another plan: shards of this one would not fit"));
        }
        Share::new(0, saved.plan.shards).map_err(|e| e.at_file(&file))?;
        Ok(Self {
            folder: folder.to_path_buf(),
            draft: saved.plan,
        })
    }

    /// The contents of the plan.
    pub fn draft(&self) -> &PlanDraft {
        &self.draft
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The folder into which everything is merged.
    pub fn results(&self) -> PathBuf {
        self.folder.join("results")
    }

    /// The folder of the store into which the shards are merged: that of the results, where these have a store.
    pub fn store(&self) -> PathBuf {
        match self.answer_file() {
            None => self.results(),
            Some(_) => self.folder.join("merged"),
        }
    }

    /// The file that exists once the answer is written, of a command whose results hold no store.
    pub(super) fn answer_file(&self) -> Option<&'static str> {
        match self.draft.command.first().map(String::as_str) {
            Some("ensemble") => Some("ensemble.json"),
            Some("gap") => Some("gap.json"),
            _ => None,
        }
    }

    /// The folder of the shards of a round, counted from 0.
    pub(crate) fn round_folder(&self, round: usize) -> PathBuf {
        self.folder.join("shards").join(format!("round_{round:04}"))
    }

    /// The folder of a shard's rows.
    pub fn shard_folder(&self, round: usize, shard: usize) -> PathBuf {
        self.round_folder(round).join(format!("shard_{shard:05}"))
    }

    /// Everything that decides the results.
    pub fn fingerprint(&self) -> Fingerprint {
        self.draft.fingerprint.iter().cloned().collect()
    }

    /// Checks that the current inputs are those of the plan.
    ///
    /// # Errors
    /// The inputs that differ: another version of this program, a study or a recording that has changed.
    pub fn must_be_of(&self, fingerprint: &Fingerprint) -> Result<()> {
        fingerprint.must_equal(&self.fingerprint()).map_err(|error| {
            error
                .without_advice()
                .at_file(self.folder.join(PLAN_FILE))
                .or_hint("run every shard with the program and the files that the plan was made with, or make another plan")
        })
    }
}

/// Writes a file of a plan.
pub(super) fn write_json(file: &Path, value: &impl Serialize) -> Result<()> {
    let fail = |e| Error::invalid(format!("cannot write the plan: {e}")).at_file(file);
    let text = serde_json::to_string_pretty(value).map_err(fail)?;
    write_atomic(file, (text + "\n").as_bytes())
}

fn checksum(draft: &PlanDraft) -> Result<String> {
    let text = serde_json::to_string(draft)
        .map_err(|e| Error::invalid(format!("cannot write the plan: {e}")))?;
    Ok(sha256(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draft() -> PlanDraft {
        PlanDraft {
            command: vec!["sweep".to_owned(), "a b.ron".to_owned()],
            directory: PathBuf::from("/tmp"),
            name: "mine".to_owned(),
            shards: 3,
            fingerprint: vec![("realgap".to_owned(), "0.1".to_owned())],
            cost: None,
        }
    }

    #[test]
    fn a_plan_comes_back_as_it_was_made_and_is_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("plan");
        let plan = Plan::create(&place, draft()).unwrap();
        assert_eq!(Plan::read(&place).unwrap(), plan);
        let error = Plan::create(&place, draft()).unwrap_err().to_string();
        assert!(error.contains("a plan already"), "{error}");
    }

    #[test]
    fn what_was_edited_by_hand_is_refused_with_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        Plan::create(folder.path(), draft()).unwrap();
        let file = folder.path().join(PLAN_FILE);
        let text = std::fs::read_to_string(&file).unwrap();
        for (from, to, said) in [
            (
                "\"shards\": 3",
                "\"shards\": 4",
                "changed after it was made",
            ),
            ("\"shards\": 3", "\"shards\": -3", "not a plan"),
            (
                "\"shards\": 3",
                "\"shards\": 3, \"x\": 1",
                "unknown field `x`",
            ),
            (
                "\"schema_version\": 1",
                "\"schema_version\": 2",
                "schema_version 2",
            ),
            ("{", "", "not a plan"),
        ] {
            assert!(text.contains(from));
            std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
            let error = Plan::read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(said) && error.contains("hint"), "{error}");
        }
    }

    #[test]
    fn another_program_is_named_with_both_versions() {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan::create(folder.path(), draft()).unwrap();
        plan.must_be_of(&Fingerprint::new().with("realgap", "0.1"))
            .unwrap();
        let other = Fingerprint::new().with("realgap", "0.2");
        let error = plan.must_be_of(&other).unwrap_err().to_string();
        assert!(error.contains("now 0.2, stored 0.1"), "{error}");
    }
}
