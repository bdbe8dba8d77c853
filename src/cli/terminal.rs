//! Printing: colours only on a terminal that wants them; a broken pipe is not an error.

use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use realgap::file::versioned_json;
use realgap::plot::TextTable;
use realgap::text::escaped_lines;
use realgap::{Error, Warning};
use serde::Serialize;

use super::advice;

/// What a command prints for machines; `form.rs` lists them.
pub trait Answer: Serialize {}

/// Whether a stream wants colours: a terminal, and `NO_COLOR` unset or empty.
fn wants_colour(is_terminal: bool) -> bool {
    is_terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Whether standard output wants colours.
pub fn stdout_wants_colour() -> bool {
    wants_colour(std::io::stdout().is_terminal())
}

/// A table, formatted for standard output, without the line feed at its end.
pub fn table(table: &TextTable) -> String {
    let text = table.render(stdout_wants_colour());
    text.trim_end().to_owned()
}

/// Set where a file is written to standard output: messages then go to standard error.
static IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Reserves standard output for a file.
pub fn leave_stdout() {
    IS_TAKEN.store(true, Ordering::Relaxed);
}

/// The folder of temporary files for streams. The user has not named it, so messages do not show it.
static UNNAMED: OnceLock<String> = OnceLock::new();

/// Leaves this folder out of what is printed.
pub fn leave_out(folder: &Path) {
    let _first = UNNAMED.set(format!("{}/", folder.display()));
}

fn without_unnamed(text: &str) -> Cow<'_, str> {
    match UNNAMED.get() {
        Some(folder) => text.replace(folder, "").into(),
        None => text.into(),
    }
}

/// Set when standard output refused something, e.g. on a full disk.
static OUTPUT_LOST: AtomicBool = AtomicBool::new(false);

/// Writes text and a newline to standard output; a reader that has gone away is not an error, a full disk is one. Names in the text
/// may come from untrusted files: control characters are escaped, except for bold headers where colours are wanted.
pub fn print(text: impl AsRef<str>) {
    if IS_TAKEN.load(Ordering::Relaxed) {
        return note(text);
    }
    let bold: &[&str] = if stdout_wants_colour() {
        &["\x1b[1m", "\x1b[0m"]
    } else {
        &[]
    };
    let text = harmless(&without_unnamed(text.as_ref()), bold);
    let mut stdout = std::io::stdout();
    let written = writeln!(stdout, "{text}").and_then(|()| stdout.flush());
    if let Err(error) = written
        && error.kind() != std::io::ErrorKind::BrokenPipe
        && !OUTPUT_LOST.swap(true, Ordering::Relaxed)
    {
        print_error(&Error::io(
            "write to standard output",
            "standard output",
            &error,
        ));
    }
}

/// Whether some output could not be written; the exit code must say so.
pub fn output_lost() -> bool {
    OUTPUT_LOST.load(Ordering::Relaxed)
}

/// Text with its control characters escaped, except for line feeds, tabs and the sequences in `own`.
fn harmless(text: &str, own: &[&str]) -> String {
    let mut safe = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(escape) = rest.find('\x1b') {
        safe += &escaped_lines(&rest[..escape]);
        rest = &rest[escape..];
        let sequence = own.iter().find(|sequence| rest.starts_with(**sequence));
        let (kept, length) = match sequence {
            Some(sequence) => (*sequence, sequence.len()),
            None => ("\\u{1b}", 1),
        };
        safe += kept;
        rest = &rest[length..];
    }
    safe + &escaped_lines(rest)
}

/// Writes text and a newline to standard error, without control characters.
pub fn note(text: impl AsRef<str>) {
    labelled("", text.as_ref());
}

/// Writes a label, which may hold colours, and a text to standard error.
fn labelled(label: &str, text: &str) {
    let text = without_unnamed(text);
    let _ = writeln!(std::io::stderr(), "{label}{}", escaped_lines(&text));
}

/// Prints an error to standard error.
pub fn print_error(error: &Error) {
    let label = if wants_colour(std::io::stderr().is_terminal()) {
        "\x1b[1;31merror:\x1b[0m "
    } else {
        "error: "
    };
    labelled(label, &advice::in_options(error.clone()).to_string());
}

/// Prints warnings to standard error, each once.
pub fn print_warnings<'a>(warnings: impl IntoIterator<Item = &'a Warning>) {
    let label = if wants_colour(std::io::stderr().is_terminal()) {
        "\x1b[1;33mwarning:\x1b[0m "
    } else {
        "warning: "
    };
    let mut seen = std::collections::BTreeSet::new();
    for warning in warnings {
        if seen.insert(warning) {
            labelled(label, &advice::warning_in_options(warning));
        }
    }
}

/// Prints an answer for machines.
///
/// # Errors
/// None for the answers of this program.
pub fn print_answer<A: Answer>(answer: &A) -> realgap::Result<()> {
    versioned_json(answer).map(print)
}

/// As [`print_answer`], several in a list.
///
/// # Errors
/// None for the answers of this program.
pub fn print_answers<A: Answer>(answers: &[A]) -> realgap::Result<()> {
    versioned_json(&answers).map(print)
}
