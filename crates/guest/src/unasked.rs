//! A simulator whose command is described, but not started, because the user has not consented to it.

use realgap_core::{Advice, Error, Result, Warning};
use realgap_simulation::{Experiment, Log, Push, Run, RunHooks, Simulator};

use super::command::CommandLine;

/// A command to which the user has not consented. It is never started.
#[derive(Debug)]
pub struct Unasked {
    command: CommandLine,
    version: &'static str,
}

impl Unasked {
    /// The command.
    pub fn new(command: CommandLine) -> Self {
        let version = super::guest::leaked(format!("not asked: {}", command.identity()));
        Self { command, version }
    }

    /// The error of whoever wants to run a command without consent.
    pub fn refusal(command: &CommandLine) -> Error {
        let files = command.files().iter();
        let files: Vec<&str> = files.map(|(name, _)| name.as_str()).collect();
        let reads = match files.is_empty() {
            true => String::new(),
            false => format!(" (files: {})", files.join(", ")),
        };
        Error::usage("this study runs a command, and nobody has consented to it")
            .field("simulator")
            .found(format!(
                "{command}, in the folder {}{reads}",
                command.folder().display()
            ))
            .hint("read what the command does")
            .advise(Advice::AllowCommand)
    }
}

impl Simulator for Unasked {
    fn version(&self, _: &Experiment) -> &'static str {
        self.version
    }

    fn run(&self, _: &Experiment, _: &[Push], _: RunHooks<'_>) -> Result<(Run, Log)> {
        Err(Self::refusal(&self.command))
    }

    fn vary(&self, experiment: &mut Experiment, number: u64) {
        experiment.foreign.setting = number;
    }

    fn settings(&self, _: usize) -> usize {
        1
    }

    fn joints(&self, _: &Experiment) -> Vec<String> {
        Vec::new()
    }

    fn prepare(&self, _: &Experiment) -> Result<Vec<Warning>> {
        Ok(Vec::new())
    }
}
