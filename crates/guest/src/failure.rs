//! Why a simulator gave no usable answer.

use std::fmt;

/// A result, or why a simulator did not give it.
pub type Answered<T> = Result<T, Failure>;

/// What a simulator did in place of a usable answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Its process ended.
    Ended,
    /// It did not answer in time.
    Hung,
    /// It answered something that cannot be used, or that it cannot simulate this.
    Answered,
}

/// Why a run of a simulator has no result, with the simulator's last words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    pub(crate) fault: Fault,
    why: String,
    last_words: Option<String>,
}

impl Failure {
    pub(crate) fn new(fault: Fault, why: impl Into<String>) -> Self {
        Self {
            fault,
            why: why.into(),
            last_words: None,
        }
    }

    /// An answer that cannot be used.
    pub fn of_answer(why: impl Into<String>) -> Self {
        Self::new(Fault::Answered, why)
    }

    /// The same failure with what the simulator wrote last; nothing where it wrote nothing.
    #[must_use]
    pub(crate) fn with_last_words(mut self, words: &str) -> Self {
        let words = words.trim();
        self.last_words = (!words.is_empty()).then(|| words.to_owned());
        self
    }

    /// What happened, without the last words.
    pub fn why(&self) -> &str {
        &self.why
    }

    /// What the simulator wrote last; `None` where it wrote nothing.
    pub fn last_words(&self) -> Option<&str> {
        self.last_words.as_deref()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the simulator {}", self.why)?;
        match &self.last_words {
            Some(words) => write!(f, "; its last words: {}", words.replace('\n', " | ")),
            None => Ok(()),
        }
    }
}
