//! The way to a simulator: questions and answers as lines of JSON.

use std::fmt;

use super::failure::Answered;

/// The way to a simulator. Calls from several threads at once are allowed.
pub trait Port: fmt::Debug + Send + Sync {
    /// What is asked, with the hashes of what it consists of; two ports with the same identity give the same answers.
    fn identity(&self) -> String;

    /// The answer to one line. The first question may take longer than the others.
    ///
    /// # Errors
    /// No answer.
    fn ask(&self, line: &str, question: Question) -> Answered<String>;

    /// The folder in which relative paths of answers start; `None` for the current one.
    fn folder(&self) -> Option<&std::path::Path> {
        None
    }
}

/// Which question is asked, so that its answer can be told from other lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Who the simulator is.
    Hello,
    /// The run with this number.
    Run(u64),
}
