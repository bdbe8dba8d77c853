//! Printing: colours only on a terminal that wants them, broken pipes are no error.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use realgap::{Error, Warning};

use super::advice;

/// Whether a stream wants colours: a terminal, and `NO_COLOR` unset or empty.
fn wants_colour(is_terminal: bool) -> bool {
    is_terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Whether standard output wants colours.
pub fn stdout_wants_colour() -> bool {
    wants_colour(std::io::stdout().is_terminal())
}

/// Set when standard output refused something, e.g. on a full disk.
static OUTPUT_LOST: AtomicBool = AtomicBool::new(false);

/// Writes text and a newline to standard output; a reader that has gone away is no error, a full disk is.
pub fn print(text: impl AsRef<str>) {
    let mut stdout = std::io::stdout();
    let written = writeln!(stdout, "{}", text.as_ref()).and_then(|()| stdout.flush());
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

/// Writes text and a newline to standard error.
pub fn note(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", text.as_ref());
}

/// Prints an error to standard error.
pub fn print_error(error: &Error) {
    let label = if wants_colour(std::io::stderr().is_terminal()) {
        "\x1b[1;31merror:\x1b[0m"
    } else {
        "error:"
    };
    note(format!("{label} {}", advice::in_options(error.clone())));
}

/// Prints warnings to standard error, each once.
pub fn print_warnings<'a>(warnings: impl IntoIterator<Item = &'a Warning>) {
    let label = if wants_colour(std::io::stderr().is_terminal()) {
        "\x1b[1;33mwarning:\x1b[0m"
    } else {
        "warning:"
    };
    let mut seen = std::collections::BTreeSet::new();
    for warning in warnings {
        if seen.insert(warning) {
            note(format!("{label} {}", advice::warning_in_options(warning)));
        }
    }
}

/// Pretty JSON of a value of ours.
pub fn json(value: &impl serde::Serialize) -> realgap::Result<String> {
    serde_json::to_string_pretty(value)
        .map_err(|e| Error::invalid(format!("cannot write JSON: {e}")))
}
