//! The one public error type: it says where the error is, what was found, what is allowed, and what to do next.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::text::{shown, shown_end};
use crate::unit::LengthUnit;

/// A result whose error is the crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// The kind of failure that an [`Error`] describes; it decides the exit code of the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The operating system refused: missing file, full disk, no permission.
    Io,
    /// A file or value does not have the form or range it must have.
    Invalid,
    /// The request conflicts with existing files or another process (locked folder, changed study).
    Conflict,
    /// The command was used wrongly (exit code 2).
    Usage,
    /// The user interrupted; the work so far is saved (exit code 130).
    Interrupted,
}

/// An error that says where it happened, what was found, what is allowed and what to do next.
///
/// An error is built step by step; every part except the message is optional:
///
/// ```
/// use realgap_core::Error;
/// use realgap_core::ErrorKind;
///
/// let error = Error::invalid("mass must be positive")
///     .at_file("robot.ron")
///     .at_line(12, 19)
///     .field("mass_kg")
///     .found("-0.1")
///     .allowed("more than 0 kg, at most 100 kg")
///     .hint("a module without mass cannot be simulated; weigh the real one");
/// assert_eq!(error.kind(), ErrorKind::Invalid);
/// assert_eq!(
///     error.to_string(),
///     "robot.ron:12:19: mass_kg: mass must be positive\n  \
///        found:   -0.1\n  \
///        allowed: more than 0 kg, at most 100 kg\n  \
///        hint:    a module without mass cannot be simulated; weigh the real one"
/// );
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Error(Box<Parts>);

#[derive(Debug, Clone, PartialEq)]
struct Parts {
    kind: ErrorKind,
    message: String,
    file: Option<PathBuf>,
    line_column: Option<(usize, usize)>,
    field: Option<String>,
    found: Option<String>,
    allowed: Option<String>,
    hint: Option<String>,
    advice: Vec<Advice>,
}

impl Parts {
    /// The hint followed by the remedies of `advice`, joined as "do this, or that".
    fn hint_with(&self, advice: &[Advice], words: impl Fn(&Advice) -> String) -> Option<String> {
        let remedies: Vec<String> = advice.iter().map(words).collect();
        let remedies = match remedies.as_slice() {
            [] => None,
            [one] => Some(one.clone()),
            [first, last] => Some(format!("{first} or {last}")),
            [first @ .., last] => Some(format!("{}, or {last}", first.join(", "))),
        };
        match (&self.hint, remedies) {
            (Some(hint), Some(remedies)) => Some(format!("{hint}; {remedies}")),
            (hint, remedies) => hint.clone().or(remedies),
        }
    }
}

/// Declares the enum of remedies together with the words that the library uses for each of them.
macro_rules! advice {
    ($($remedy:ident $doc:literal $words:literal;)*) => {
        /// A remedy for an error. A caller of the library applies it through an argument; a user of the command line applies it
        /// through an option. [`Display`](fmt::Display) words it for callers of the library; the command line has its own words.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Advice {
            $(#[doc = $doc] $remedy,)*
            /// Read the file in this unit of length.
            Unit(LengthUnit),
        }

        impl fmt::Display for Advice {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$remedy => f.write_str($words),)*
                    Self::Unit(unit) => write!(f, "read it in {unit}"),
                }
            }
        }
    };
}

advice! {
    Resume "Continue from the stored results." "resume from the stored results";
    Restart "Throw away the stored results, and start anew." "start anew";
    OtherFolder "Write into another folder." "choose another folder";
    AcceptFiles "Accept the files of a results folder as they are." "accept the folder's files as they are";
    FewerThreads "Run in parallel on fewer threads." "use fewer threads";
    OtherOptimizer "Let another optimizer search." "choose another optimizer";
    OtherSeed "Draw other random numbers." "choose another seed";
    MapColumns "Say which column of a recording holds which quantity." "say which column is which: `columns: (t: \"NAME in ms\", x: \"NAME in mm\", ...)` in `reading`";
    ChooseRobot "Read one robot, or one run, of a file that holds several." "read one of them: `only: (column: \"NAME\", value: \"VALUE\")` in `reading`";
    SortSamples "Sort the samples of a recording by time." "sort them: `sort: true` in `reading`";
    Split "Read the runs or bodies of one file as separate recordings." "read them as separate recordings: `split: true` in `reading`";
    Scale "State the size of a file's unit of length." "state the metres of one unit of the file's lengths, e.g. `scale: 0.0021` in `reading`";
    UnpaddedStamps "Read stamps whose nanoseconds lack leading zeros." "read 12.5 as 12 s and 5 ns: `unpadded_stamps: true` in `reading`";
    SkipLost "Leave out samples that the tracker has lost." "leave lost samples out: `skip_lost: true` in `reading`";
    SkipLines "Begin to read below the first lines." "begin to read below the first lines: `skip_lines: N` in `reading`";
    NameColumns "Name the columns of a file without a line of names." "name the columns in their order: `header: [\"t_s\", \"x_m\", \"y_m\", ...]` in `reading`";
    Rate "State the sampling rate of a recording without times." "state the sampling rate, e.g. `rate_hz: 10` in `reading`";
    Topic "Say which topic of a log holds the recording." "choose one topic: `topic: \"/NAME\"` in `reading`, and `child_frame: \"NAME\"` for transforms";
    CommandTopic "Say which topic of a log holds the commands." "choose the topic of the commands: `command_topic: \"/NAME\"` in `reading`";
    Axes "Say which way the axes of poses point." "say which way axes point: `axes: \"world\"` (z up), `y-up`, `z-down` or `camera` in `reading`";
    Crop "Read another part of a recording." "choose another part: `crop: (from_s: ..., to_s: ...)` in `reading`";
    TimeUnit "State the unit of a recording's times." "state the unit of the times: `time: \"ms\"` in `reading`";
    AngleUnit "State the unit of a recording's angles." "state the unit of the angles: `angle: \"deg\"` in `reading`, or the counts of encoders: `ticks: (per_turn: 4096, zero: 2048)`";
    NameRobot "Read a recording together with the robot that it is of." "read it together with the robot's file";
    JointOrder "Name the joints of numbered columns in their order." "name the joints in the order of the numbers";
    Recordings "Name the recordings." "name the recordings, e.g. FOLDER/*.csv";
    CalibratedValues "Give values that a calibration has found." "give values, e.g. those in the best.ron of a sweep";
    MetricWithoutBasis "Compare with a metric that needs no basis of principal components." "choose a metric without a basis, e.g. rms, which needs no first design";
    LetOptimizerChoose "Let an optimizer choose the points instead of evaluating a whole grid." "let an optimizer choose the points";
    HoldRoot "Fix the root of an imported robot to the world." "import the robot as mounted, and give the file that the import has written";
    LeastSquares "Fit joint logs by least squares." "the optimizer gauss-newton fits joint logs by least squares, and reports which parameters they determine and what each log adds";
    OtherTime "Compare at times since each start, or at equal fractions of the durations." "compare at times since each start (`start`), or at equal fractions of the durations (`fraction`)";
    Associate "Match samples farther apart in time, or interpolate." "allow a larger difference of times, or interpolate the other trajectory";
    EstimateOffset "Estimate the offset between two clocks." "let the offset between the clocks be estimated from the speeds";
    AllowCommand "Consent to the command that a study runs." "consent to the command";
    ListParameters "Look up the names of all parameters." "look up the names in the registry of parameters";
}

/// Separates the parts of an error while serde carries them as one message; no text of this project contains this character.
const PART: char = '\u{1f}';

impl Error {
    fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self(Box::new(Parts {
            kind,
            message: message.into(),
            file: None,
            line_column: None,
            field: None,
            found: None,
            allowed: None,
            hint: None,
            advice: Vec::new(),
        }))
    }

    /// A value or file that does not have the form it must have.
    pub fn invalid(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Invalid, message)
    }

    /// A request that conflicts with existing files or another process.
    pub fn conflict(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Conflict, message)
    }

    /// An error about a command that was used wrongly.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, message)
    }

    /// The user interrupted; the work so far is saved.
    pub fn interrupted(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Interrupted, message)
    }

    /// The operating system refused the action `doing` (e.g. "read the recording") on `path`.
    pub fn io(doing: &str, path: impl AsRef<Path>, source: &std::io::Error) -> Self {
        use std::io::ErrorKind as Io;
        let error = Self::new(ErrorKind::Io, format!("cannot {doing}: {source}")).at_file(path);
        match source.kind() {
            Io::NotFound => {
                error.hint("check the path; relative paths start at the current folder")
            }
            Io::PermissionDenied | Io::ReadOnlyFilesystem => {
                error.hint("check the permissions of the file and of its folder")
            }
            Io::StorageFull | Io::QuotaExceeded => {
                error.hint("free some disk space, then run the command again")
            }
            _ => error,
        }
    }

    /// The file in which the error was found.
    #[must_use]
    pub fn at_file(mut self, path: impl AsRef<Path>) -> Self {
        self.0.file = Some(path.as_ref().to_path_buf());
        self
    }

    /// The line and column of the error, both counted from 1.
    #[must_use]
    pub fn at_line(mut self, line: usize, column: usize) -> Self {
        self.0.line_column = Some((line, column));
        self
    }

    /// The field or column concerned, e.g. `modules[2].mass_kg`.
    #[must_use]
    pub fn field(mut self, field: impl Into<String>) -> Self {
        self.0.field = Some(field.into());
        self
    }

    /// What was found.
    #[must_use]
    pub fn found(mut self, found: impl fmt::Display) -> Self {
        self.0.found = Some(found.to_string());
        self
    }

    /// What is allowed instead.
    #[must_use]
    pub fn allowed(mut self, allowed: impl fmt::Display) -> Self {
        self.0.allowed = Some(allowed.to_string());
        self
    }

    /// What the user can do next.
    #[must_use]
    pub fn hint(mut self, hint: impl fmt::Display) -> Self {
        self.0.hint = Some(hint.to_string());
        self
    }

    /// What the user can do next; an error that has a hint already keeps its own.
    #[must_use]
    pub fn or_hint(self, hint: impl fmt::Display) -> Self {
        if self.0.hint.is_some() {
            self
        } else {
            self.hint(hint)
        }
    }

    /// Adds one more remedy, in order of preference; each program says in its own words how to apply it.
    #[must_use]
    pub fn advise(mut self, advice: Advice) -> Self {
        self.0.advice.push(advice);
        self
    }

    /// The remedies, in order of preference.
    pub fn advice(&self) -> &[Advice] {
        &self.0.advice
    }

    /// The same error without its remedies, for a caller that cannot apply any of them.
    #[must_use]
    pub fn without_advice(mut self) -> Self {
        self.0.advice.clear();
        self
    }

    /// The same error with its remedies in a program's own words, e.g. as its options.
    #[must_use]
    pub fn with_advice_as(mut self, words: impl Fn(&Advice) -> String) -> Self {
        let advice = std::mem::take(&mut self.0.advice);
        if let Some(hint) = self.0.hint_with(&advice, words) {
            self.0.hint = Some(hint);
        }
        self
    }

    /// The same error with its field inside a parent field: `values` within `mean` becomes `mean.values`.
    #[must_use]
    pub fn within(mut self, parent: &str) -> Self {
        self.0.field = Some(match self.0.field.take() {
            Some(field) => format!("{parent}.{field}"),
            None => parent.to_owned(),
        });
        self
    }

    /// Packs the error into a message of serde, which carries messages only: for `Deserialize` of values that are looked up by name.
    /// [`parse_ron`](crate::file::parse_ron) unpacks the parts again, and adds the location.
    pub fn through_serde<E: serde::de::Error>(self) -> E {
        let Parts {
            message,
            found,
            allowed,
            hint,
            ..
        } = *self.0;
        let parts = [found, allowed, hint].map(Option::unwrap_or_default);
        E::custom(format!("{message}{PART}{}", parts.join(&PART.to_string())))
    }

    /// Unpacks an error that [`Error::through_serde`] packed; any other message becomes an error with this message only.
    pub(crate) fn from_serde(message: &str) -> Self {
        let mut parts = message.split(PART);
        let mut error = Self::invalid(parts.next().unwrap_or_default());
        let mut next = || parts.next().filter(|p| !p.is_empty()).map(str::to_owned);
        (error.0.found, error.0.allowed, error.0.hint) = (next(), next(), next());
        error
    }

    /// The same error as a wrong use of a command: for values that came from an option, not from a file.
    #[must_use]
    pub fn into_usage(mut self) -> Self {
        self.0.kind = ErrorKind::Usage;
        self
    }

    /// The kind, which decides the exit code.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The message without location, found, allowed and hint.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What was found, if known.
    pub fn found_text(&self) -> Option<&str> {
        self.0.found.as_deref()
    }

    /// What the user can do next, without the remedies of [`Error::advice`].
    pub fn hint_text(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }

    /// The file, if the error belongs to one.
    pub fn file(&self) -> Option<&Path> {
        self.0.file.as_deref()
    }

    /// The field or column concerned, if known.
    pub fn field_name(&self) -> Option<&str> {
        self.0.field.as_deref()
    }

    /// Line and column (from 1), if known.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        self.0.line_column
    }
}

/// The largest number of characters shown of each part; parts that come from files may be longer.
const PATH_SHOWN: usize = 400;
const FIELD_SHOWN: usize = 120;
const FOUND_SHOWN: usize = 400;
const WORDS_SHOWN: usize = 2000;

impl fmt::Display for Error {
    /// Every part is one line without control characters, even where the text comes from a file that contains some.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let p = &self.0;
        if let Some(file) = &p.file {
            write!(f, "{}", shown_end(&file.to_string_lossy(), PATH_SHOWN))?;
            if let Some((line, column)) = p.line_column {
                write!(f, ":{line}:{column}")?;
            }
            write!(f, ": ")?;
        } else if let Some((line, column)) = p.line_column {
            write!(f, "{line}:{column}: ")?;
        }
        if let Some(field) = &p.field {
            write!(f, "{}: ", shown(field, FIELD_SHOWN))?;
        }
        f.write_str(&shown(&p.message, WORDS_SHOWN))?;
        let hint = p.hint_with(&p.advice, Advice::to_string);
        for (label, text, longest) in [
            ("found:  ", &p.found, FOUND_SHOWN),
            ("allowed:", &p.allowed, WORDS_SHOWN),
            ("hint:   ", &hint, WORDS_SHOWN),
        ] {
            if let Some(text) = text {
                write!(f, "\n  {label} {}", shown(text, longest))?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Error {}
