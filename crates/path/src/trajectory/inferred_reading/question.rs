//! The questions that files leave open, and the inferences that answer the others.

use super::super::column::{Columns, Role};
use realgap_core::error::{Advice, Error};
use realgap_core::unit::LengthUnit;

/// An inference and its reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Evidence {
    /// The inference, e.g. `lengths are in millimetres`.
    pub finding: String,
    /// The observation from which it follows.
    pub reason: String,
}

/// A question that the files alone do not answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Ambiguity {
    /// The question.
    pub question: Question,
    /// What was found in the files about it.
    pub found: String,
    /// The sets of columns among which to choose, if the question is about them.
    pub candidates: Vec<Candidate>,
}

impl Ambiguity {
    /// The question as an error that says how to answer it.
    pub fn error(&self) -> Error {
        let error = Error::usage("the recordings leave a question open").found(&self.found);
        let names: Vec<&str> = self
            .candidates
            .iter()
            .map(|one| one.name.as_str())
            .collect();
        match self.question {
            Question::Time => error
                .allowed("in which unit are times: s, ms, us, ns?")
                .advise(Advice::TimeUnit),
            Question::Length if !self.candidates.is_empty() => error
                .allowed("are lengths in the unit that the names of the columns state, or in which: m, cm, mm?")
                .hint((self.candidates.last()).map_or_else(String::new, |one| {
                    format!("in {}, map the columns: {}", one.name, one.mapping())
                }))
                .advise(Advice::Unit(LengthUnit::Metre))
                .advise(Advice::MapColumns),
            Question::Length => error
                .allowed("in which unit are lengths: m, cm, mm, in, ft, or a scale?")
                .advise(Advice::Unit(LengthUnit::Metre))
                .advise(Advice::Unit(LengthUnit::Millimetre))
                .advise(Advice::Scale),
            Question::Up => error
                .allowed("which way do axes point: world (z up), y-up, z-down, camera?")
                .advise(Advice::Axes),
            Question::Robot => error
                .allowed("whose rows are read?")
                .advise(Advice::ChooseRobot),
            Question::Body => error
                .allowed(format!("which of them is read: {}?", names.join(", ")))
                .hint((self.candidates.first()).map_or_else(String::new, |one| {
                    format!("for {}, map its columns: {}", one.name, one.mapping())
                }))
                .advise(Advice::MapColumns),
            Question::Split => error
                .allowed("are these several recordings, or is it one?")
                .advise(Advice::Split),
        }
    }
}

/// The columns of one body in a file that has columns of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The words of the columns' names that say whose they are.
    pub name: String,
    /// The mapping that reads this body.
    pub columns: Columns,
}

impl Candidate {
    /// The mapping in words.
    pub(super) fn mapping(&self) -> String {
        let columns = self.columns.iter();
        let columns = columns.map(|(role, column)| format!("{}={column}", role.name()));
        columns.collect::<Vec<_>>().join(", ")
    }

    /// The name of the column of x.
    pub fn x(&self) -> &str {
        let column = self.columns.get(Role::X);
        column.map_or("", |column| column.name.as_str())
    }
}

/// A question about files that the user has to answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Question {
    /// In which unit are times?
    Time,
    /// In which unit are lengths?
    Length,
    /// Which axis points up?
    Up,
    /// The rows of which robot are read, if a file holds several?
    Robot,
    /// The columns of which body are read, if a file holds several?
    Body,
    /// Is a file whose times start again, or whose rows alternate between places, read as several recordings?
    Split,
}
