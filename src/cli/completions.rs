//! `realgap completions`: shell completions on standard output.

use clap::{Args, CommandFactory};
use realgap::Result;

/// Print completions for a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap completions bash > ~/.local/share/bash-completion/completions/realgap")]
pub struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub fn run(self) -> Result<()> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut super::Cli::command(), "realgap", &mut text);
        super::terminal::print(String::from_utf8_lossy(&text).trim_end());
        Ok(())
    }
}
