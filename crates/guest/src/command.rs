//! The command that starts a simulator, and the hashes of the files that it consists of.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use realgap_core::file::sha256;
use realgap_core::{Error, Result};

/// Longest time until a started simulator says who it is, where the study does not state it, seconds.
const START_LIMIT_S: f64 = 60.0;
/// Longest time of one answer, where the study does not state it, seconds.
const ANSWER_LIMIT_S: f64 = 60.0;

/// A command that starts a simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandLine {
    words: Vec<String>,
    folder: PathBuf,
    /// The files whose contents decide what the simulator does, with their hashes.
    files: Vec<(String, String)>,
    /// Longest time until the simulator says who it is.
    pub start_limit: Duration,
    /// Longest time of one answer.
    pub answer_limit: Duration,
}

impl CommandLine {
    /// A command of these words that is started in `folder`. Words that name files there (the script) and `files` (models, modules)
    /// are read, so that a changed one is noticed.
    ///
    /// # Errors
    /// No words, or one of `files` that cannot be read.
    pub fn new(words: Vec<String>, folder: &Path, files: &[String]) -> Result<Self> {
        if words.first().is_none_or(|word| word.is_empty()) {
            return Err(Error::invalid("a command without words")
                .field("simulator")
                .allowed("the program and its arguments: Command([\"python\", \"walk.py\"])"));
        }
        let folder = match folder.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => folder.to_owned(),
        };
        let mut hashed = Vec::new();
        for word in &words {
            let path = folder.join(word);
            if path.is_file() {
                hashed.push((word.clone(), hash_of(&path)?));
            }
        }
        for file in files {
            hashed.push((file.clone(), hash_of(&folder.join(file))?));
        }
        Ok(Self {
            words,
            folder,
            files: hashed,
            start_limit: Duration::from_secs_f64(START_LIMIT_S),
            answer_limit: Duration::from_secs_f64(ANSWER_LIMIT_S),
        })
    }

    /// The words of the command.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// The folder in which the command is started.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The files whose contents decide what the simulator does, with their SHA-256.
    pub fn files(&self) -> &[(String, String)] {
        &self.files
    }

    /// The command and the hashes of its files: what decides the answers.
    pub fn identity(&self) -> String {
        let files = self.files.iter();
        let files = files.map(|(name, hash)| format!("; {name} sha256 {hash}"));
        format!("{self}{}", files.collect::<String>())
    }
}

impl fmt::Display for CommandLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, word) in self.words.iter().enumerate() {
            let space = if index == 0 { "" } else { " " };
            match word.contains(|c: char| c.is_whitespace() || c.is_control()) {
                true => write!(f, "{space}{word:?}")?,
                false => write!(f, "{space}{word}")?,
            }
        }
        Ok(())
    }
}

fn hash_of(path: &Path) -> Result<String> {
    std::fs::read(path)
        .map(sha256)
        .map_err(|error| Error::io("read a file of the simulator", path, &error))
}
