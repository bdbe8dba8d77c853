//! Notes: remarks of an import about values that were left out, changed or assumed.

use std::fmt;

use serde::Serialize;

/// Kind of a note.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Sort", rename_all = "snake_case")]
pub enum NoteKind {
    /// Something that the file states is not in the robot.
    LeftOut,
    /// Something in the robot differs from what the file states.
    Changed,
    /// A value that the file does not state was assumed.
    Assumed,
    /// Something looks wrong.
    Doubt,
}

impl NoteKind {
    /// Name for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeftOut => "left out",
            Self::Changed => "changed",
            Self::Assumed => "assumed",
            Self::Doubt => "doubt",
        }
    }
}

/// One note of an import.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Note {
    /// Kind of a note.
    #[serde(rename = "sort")]
    pub kind: NoteKind,
    /// Line in the file, from 1, if it is known.
    pub line: Option<usize>,
    /// Description of what was left out, changed or assumed, or looks wrong.
    pub what: String,
    /// Advice for the user.
    pub remedy: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.kind.name())?;
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{}; {}", self.what, self.remedy)
    }
}

/// The notes that are collected during an import.
#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Note>);

impl Notes {
    fn add(&mut self, kind: NoteKind, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.0.push(Note {
            kind,
            line,
            what: what.into(),
            remedy: remedy.to_owned(),
        });
    }

    pub fn left_out(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(NoteKind::LeftOut, line, what, remedy);
    }

    pub fn changed(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(NoteKind::Changed, line, what, remedy);
    }

    pub fn assumed(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(NoteKind::Assumed, line, what, remedy);
    }

    pub fn doubt(&mut self, line: Option<usize>, what: impl Into<String>, remedy: &str) {
        self.add(NoteKind::Doubt, line, what, remedy);
    }

    /// All notes: what changes the motion first (doubts, then what is left out or changed, then what is assumed, then what changes no
    /// motion), each sorted by line; the hulls of meshes, of which a robot may have many, in one line at the end.
    pub fn sorted(self) -> Vec<Note> {
        let is_hull = |note: &Note| note.what.starts_with(HULL);
        let (hulls, mut notes): (Vec<Note>, Vec<Note>) = self.0.into_iter().partition(is_hull);
        notes.sort_by_key(|note| {
            let rank = match note.kind {
                _ if is_still(note) => 3,
                NoteKind::Doubt => 0,
                NoteKind::LeftOut | NoteKind::Changed => 1,
                NoteKind::Assumed => 2,
            };
            (rank, note.line, note.kind)
        });
        notes.extend(in_one_line(hulls));
        notes
    }
}

/// The beginnings of notes about what moves nothing: names, sensors, lights and cameras.
const STILL: [&str; 7] = [
    "the name ",
    "<sensor>",
    "<camera>",
    "<light>",
    "<custom>",
    "<extension>",
    "<statistic>",
];

/// Whether a note is about something that moves nothing.
fn is_still(note: &Note) -> bool {
    note.kind != NoteKind::Doubt && STILL.iter().any(|start| note.what.starts_with(start))
}

/// The beginning of every note about the hull of a mesh.
pub(super) const HULL: &str = "the hull of the mesh ";

/// The notes about the hulls of meshes as one note, with those of the first three.
fn in_one_line(hulls: Vec<Note>) -> Option<Note> {
    let mut first = hulls.first()?.clone();
    if hulls.len() > 1 {
        let shown = hulls
            .iter()
            .take(3)
            .map(|note| note.what.trim_start_matches(HULL));
        let shown: Vec<&str> = shown.collect();
        let more = if hulls.len() > 3 { "; and others" } else { "" };
        first.what = format!(
            "the hulls of {} meshes are simplified: {}{more}",
            hulls.len(),
            shown.join("; ")
        );
        first.line = None;
    }
    Some(first)
}
