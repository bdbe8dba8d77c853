//! What an import has to say.

use std::fmt;

use serde::Serialize;

/// What kind of remark it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    /// Something that the file says is not in the robot.
    LeftOut,
    /// Something is in the robot otherwise than the file says it.
    Changed,
    /// Something that the file does not say was made up.
    Assumed,
    /// Something looks wrong.
    Doubt,
}

impl Sort {
    /// As people read it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeftOut => "left out",
            Self::Changed => "changed",
            Self::Assumed => "assumed",
            Self::Doubt => "doubt",
        }
    }
}

/// One remark of an import.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Note {
    /// What kind of remark it is.
    pub sort: Sort,
    /// Line in the file, from 1, where that is known.
    pub line: Option<usize>,
    /// What was left out, changed or assumed, or looks wrong.
    pub what: String,
    /// What to do about it.
    pub remedy: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.sort.name())?;
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{}; {}", self.what, self.remedy)
    }
}

/// Remarks in the making.
#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Note>);

impl Notes {
    fn add(&mut self, sort: Sort, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.0.push(Note {
            sort,
            line,
            what: what.into(),
            remedy: remedy.to_owned(),
        });
    }

    pub fn left_out(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(Sort::LeftOut, line, what, remedy);
    }

    pub fn changed(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(Sort::Changed, line, what, remedy);
    }

    pub fn assumed(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(Sort::Assumed, line, what, remedy);
    }

    pub fn doubt(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(Sort::Doubt, line, what, remedy);
    }

    /// All of them: doubts first, then by line.
    pub fn sorted(mut self) -> Vec<Note> {
        self.0.sort_by_key(|note| {
            (
                std::cmp::Reverse(note.sort == Sort::Doubt),
                note.line,
                note.sort,
            )
        });
        self.0
    }
}
