//! Commands whose work can be shared: from a plan's arguments to the library's [`Work`], and to the command itself.

use clap::Parser as _;
use realgap::plan::{Plan, Work};

use super::kit::*;
use super::{Cli, Command};

/// Options that a plan decides itself.
const OWN: [&str; 7] = [
    "-o",
    "--output",
    "--resume",
    "--restart",
    "--format",
    "-j",
    "--jobs",
];

/// Checks that nothing among a command's arguments is the plan's business.
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

/// The command that these arguments say.
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
/// A command that cannot be shared, a study that cannot be read.
pub fn work_of(command: &Command) -> Result<Work> {
    match command {
        Command::Sweep(sweep) => sweep.work(),
        Command::Tune(tune) => tune.work(),
        Command::Search(search) => search.work(),
        Command::Ensemble(ensemble) => ensemble.work(),
        Command::Gap(gap) => gap.work(),
        _ => Err(Error::usage("this command cannot be cut into shards")
            .allowed("sweep, tune, search, ensemble, gap")),
    }
}

/// The plan in a folder and its work, with the place that its paths begin at made the current one. The plan's own path is
/// absolute then.
///
/// # Errors
/// As [`Plan::read`] and [`work_of`]; a place that is not on this machine.
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
