//! Consent to the command that a study runs: an option, or an answer on the terminal.

use std::io::{BufRead as _, IsTerminal as _};
use std::sync::{Mutex, PoisonError};

use realgap::calibration::{CommandConsent, Overrides};
use realgap::{Advice, Error, Result};

use super::terminal;

/// The commands to which the user has said yes: some read a study several times.
static CONSENTED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Option of commands that read studies.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ConsentOption {
    /// Run the command that the study names as its simulator; without this option it is asked about on a terminal
    #[arg(long)]
    allow_command: bool,
}

impl ConsentOption {
    /// The consent, or `otherwise`.
    pub fn or(&self, otherwise: CommandConsent) -> CommandConsent {
        match self.allow_command {
            true => CommandConsent::Given,
            false => otherwise,
        }
    }
}

/// Reads a study. If it names a command to which the user has not consented, the terminal asks for consent.
pub fn reading<T>(read: impl Fn(&Overrides) -> Result<T>, overrides: &Overrides) -> Result<T> {
    let refused = match read(overrides) {
        Err(error) if error.advice().contains(&Advice::AllowCommand) => error,
        result => return result,
    };
    let command = refused.found_text().unwrap_or_default().to_owned();
    let given = || {
        read(&Overrides {
            command: CommandConsent::Given,
            ..overrides.clone()
        })
    };
    let mut consented = CONSENTED.lock().unwrap_or_else(PoisonError::into_inner);
    if consented.contains(&command) {
        return given();
    }
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return Err(refused);
    }
    terminal::note(format!(
        "This study runs the command {command}. Run it (yes, no)?"
    ));
    let mut line = String::new();
    let read_line = std::io::stdin().lock().read_line(&mut line);
    read_line.map_err(|e| Error::io("read the answer", "standard input", &e))?;
    match line.trim() {
        "yes" | "y" => {
            consented.push(command);
            given()
        }
        _ => Err(refused),
    }
}
