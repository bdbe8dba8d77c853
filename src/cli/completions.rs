//! `realgap completions`: shell completions on standard output.

use clap::builder::PossibleValuesParser;
use clap::{Command, CommandFactory};
use realgap::simulation::parameter;

use super::kit::*;

/// Print a script that completes commands, options and parameter names in a shell
///
/// Use it once for each shell; the shell reads the script when it starts.
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
        let mut command = with_names(super::Cli::command());
        clap_complete::generate(self.shell, &mut command, "realgap", &mut text);
        terminal::print(String::from_utf8_lossy(&text).trim_end());
        Ok(())
    }
}

/// The command and its subcommands, with parameter names as completions of `--set`.
fn with_names(command: Command) -> Command {
    let offer = |arg: clap::Arg| match arg.get_long() {
        Some("set") => {
            // The completion ends with `=`, so that the user continues with the value.
            let begun = parameter::all().map(|p| &*format!("{}=", p.name).leak());
            arg.value_parser(PossibleValuesParser::new(begun))
        }
        _ => arg,
    };
    command.mut_args(offer).mut_subcommands(with_names)
}
