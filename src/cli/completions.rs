//! `realgap completions`: shell completions on standard output.

use clap::builder::PossibleValuesParser;
use clap::{Command, CommandFactory};
use realgap::simulation::parameter;

use super::kit::*;

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
        let mut command = with_names(super::Cli::command());
        clap_complete::generate(self.shell, &mut command, "realgap", &mut text);
        terminal::print(String::from_utf8_lossy(&text).trim_end());
        Ok(())
    }
}

/// A command and all below it, whose `--set` offers the names of parameters.
fn with_names(command: Command) -> Command {
    let offer = |arg: clap::Arg| match arg.get_long() {
        Some("set") => {
            // A shell that has the name goes on with its value.
            let begun = parameter::all().map(|p| &*format!("{}=", p.name).leak());
            arg.value_parser(PossibleValuesParser::new(begun))
        }
        _ => arg,
    };
    command.mut_args(offer).mut_subcommands(with_names)
}
