//! Commands that can be divided into shards: a plan's arguments become a command, and its [`Work`] in the library.

use clap::Parser as _;
use realgap::plan::{Plan, Work};

use super::kit::*;
use super::{Cli, Command};

/// Options that a plan sets itself.
const OWN: [&str; 7] = [
    "-o",
    "--output",
    "--resume",
    "--restart",
    "--format",
    "-j",
    "--jobs",
];

/// Checks that the arguments of a command hold no option that the plan sets itself.
///
/// # Errors
/// Such an option.
pub fn check_arguments(arguments: &[String]) -> Result<()> {
    let name = |argument: &str| argument.split('=').next().unwrap_or_default().to_owned();
    let is_own = |argument: &&String| {
        OWN.contains(&name(argument).as_str())
            || (!argument.starts_with("--")
                && ["-o", "-j"].iter().any(|own| argument.starts_with(own)))
    };
    match arguments.iter().find(is_own) {
        None => Ok(()),
        Some(argument) => Err(Error::usage("a plan decides this itself")
            .field(name(argument))
            .hint("results go to the plan's own folder; threads are an option of realgap cluster run and merge")),
    }
}

/// Parses these arguments as a command.
///
/// # Errors
/// Arguments that are no command.
pub fn parse(arguments: &[String]) -> Result<Command> {
    let words = std::iter::once("realgap".to_owned()).chain(arguments.iter().cloned());
    match Cli::try_parse_from(words) {
        Ok(cli) => Ok(cli.command),
        Err(error) => {
            let said = error.to_string();
            let first = said.lines().next().unwrap_or_default();
            Err(Error::usage(first.trim_start_matches("error: "))
                .found(arguments.join(" "))
                .hint("options of the command follow after --"))
        }
    }
}

/// The work of a command.
///
/// # Errors
/// A command that cannot be divided into shards, a study that cannot be read.
pub fn work_of(command: &Command) -> Result<Work> {
    match command {
        Command::Sweep(sweep) => sweep.work(),
        Command::Tune(tune) => tune.work(),
        Command::Search(search) => search.work(),
        Command::Ensemble(ensemble) => ensemble.work(),
        Command::Gap(gap) => gap.work(),
        _ => Err(Error::usage("this command cannot be divided into shards")
            .allowed("sweep, tune, search, ensemble, gap")),
    }
}

/// The plan in a folder and its work. The folder in which the plan was made becomes the current folder, because the plan's paths
/// are relative to it; the plan's own path is made absolute.
///
/// # Errors
/// As [`Plan::read`] and [`work_of`]; a folder that is not on this machine.
pub fn open(folder: &Path) -> Result<(Plan, Work)> {
    let plan = Plan::read(&absolute(folder)?)?;
    let place = &plan.draft().directory;
    std::env::set_current_dir(place).map_err(|e| {
        Error::io("go to where the plan was made", place, &e).hint(
            "a plan runs where its files are at the same paths as on the machine that made it",
        )
    })?;
    let work = work_of(&parse(&plan.draft().command)?)?;
    Ok((plan, work))
}

pub fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|e| Error::io("find the absolute path", path, &e))
}
