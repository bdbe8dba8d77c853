//! The command line: one file per subcommand, each one library call plus printing.

/// Declares commands: the type that clap parses them into, and the method that runs them. With `if "FEATURE"` after a command, the
/// command is compiled with that feature only.
macro_rules! commands {
    ($(#[$about:meta])* $name:ident: $($(#[$meta:meta])* $variant:ident($options:ty) $(if $feature:literal)?,)*) => {
        $(#[$about])*
        #[derive(Debug, clap::Subcommand)]
        #[allow(clippy::large_enum_variant, reason = "the program holds a single value of it")]
        pub enum $name {
            $(
                $(#[cfg(feature = $feature)])?
                $(#[$meta])*
                #[command(help_template = $crate::cli::LAYOUT)]
                $variant($options),
            )*
        }

        impl $name {
            pub fn run(self) -> realgap::Result<u8> {
                use $crate::cli::Ending as _;
                match self {
                    $(
                        $(#[cfg(feature = $feature)])?
                        Self::$variant(options) => options.run().map(|ending| ending.code()),
                    )*
                }
            }
        }
    };
}

/// Imports of almost every command.
mod kit {
    pub use std::path::{Path, PathBuf};

    pub use clap::{Args, ValueEnum};
    pub use realgap::plot::{Side, TextTable};
    pub use realgap::robot::morphology::Morphology;
    pub use realgap::simulation::Experiment;
    pub use realgap::unit::{Unit, counted, quantity};
    pub use realgap::warning::Code;
    pub use realgap::{Error, Result, Warning};
    pub use serde::Serialize;

    pub use super::duration::parse_seconds;
    pub use super::folder::ResultsFolder;
    pub use super::kind::{read_morphology, read_study};
    pub use super::option::{Before, Choice, Jobs, Print, Recordings, Values, choice};
    pub use super::page::{PageOption, Telling};
    pub use super::reading::ReadingOptions;
    pub(super) use super::{output, progress, terminal};
}

mod advice;
mod answer;
mod apply;
mod between;
mod check;
#[cfg(all(test, any(feature = "papers", feature = "schema")))]
mod committed;
mod compare;
mod completions;
mod consent;
mod develop;
mod duration;
mod ensemble;
pub mod evaluate;
mod example_file;
mod examples;
mod export;
mod folder;
#[macro_use]
mod form;
mod gap;
mod genome;
pub mod identify;
mod import;
mod interrupt;
mod invocation;
mod kind;
mod live;
mod merge;
mod mujoco;
mod new;
mod odds;
mod option;
mod output;
mod page;
mod parameters;
mod plan;
mod predict;
mod progress;
mod question;
mod reading;
mod record;
#[cfg(all(test, feature = "papers"))]
mod reference;
mod replay;
mod report;
mod results;
mod run;
mod schema;
mod search;
#[cfg(feature = "papers")]
mod sense;
mod sensitivity;
mod shell;
mod simulate;
mod slurm;
pub mod start;
mod status;
mod stream;
mod submit;
mod sweep;
mod terminal;
mod timing;
mod tune;
mod verify;
mod work;

use std::ffi::OsString;

use clap::{Parser, Subcommand as _};
use realgap::ErrorKind;

/// How far is your simulated robot from the real one, what closes the gap, and how sure may you be?
///
/// Robots are RON files (morphologies/), or URDF and MJCF; studies are RON files, too (sweeps/); real runs are CSV files or one
/// of many other formats (real_trajectories/).
#[derive(Debug, Parser)]
#[command(name = "realgap", version, max_term_width = 80, arg_required_else_help = true, after_help = NOTES)]
#[command(help_template = help())]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Replace files that realgap did not write
    #[arg(long, global = true)]
    force: bool,
}

const EXAMPLES: &str = "\
The usual order of commands:
  realgap start runs/*.csv robot.ron                a study of your own data
  realgap check morphologies/tripod.ron             is it valid, what is in it?
  realgap simulate morphologies/tripod.ron -o a.csv one run as a trajectory
  realgap replay morphologies/tripod.ron            watch it move, in a browser
  realgap compare real.csv a.csv --plot gap.png     how far apart are the two?
  realgap sweep sweeps/tripod_floor.ron             which friction fits best?
  realgap report results/tripod_floor               the same answer as one page
  realgap tune sweeps/tripod_floor.ron              with fewer simulations
  realgap gap sweeps/tripod_floor.ron               how large is the gap left?
  realgap predict morphologies/tripod.ron           how far will it go?
  realgap search sweeps/best_tripod_gait.ron        which gait goes farthest?";

const NOTES: &str = "\
In place of a file, `-` means standard input; after -o it means standard output.
Exit codes: 0 success, 1 failure, 2 wrong usage, 130 interrupted (results kept).";

const ROBOT: &str = "\
Examples:
  realgap robot import robot.urdf -o robot.ron          # a robot in RON
  realgap robot export robot.ron --format mjcf -o a.xml # for MuJoCo
  realgap robot genome random --modules 5 -o genome.ron # ten numbers a module
  realgap robot develop genome.ron -o robot.ron         # builds its robot";

const STUDY: &str = "\
Examples:
  realgap study new study -o study.ron              # a commented template
  realgap study parameters                          # what can be varied?
  realgap study sensitivity sweeps/tripod_floor.ron # which of it matters?
  realgap study identify sweeps/cube_toss_fit.ron   # values from free flight
  realgap study results results/tripod_floor        # the points of a sweep";

const CLUSTER: &str = "\
Examples:
  realgap cluster plan sweeps/tripod_floor.ron --shards 9 -o plan
  realgap cluster run plan --shard 0           # on any machine
  realgap cluster merge plan                   # after every round
  realgap cluster submit slurm plan            # or let Slurm do all of it";

/// The layout of a command's help: examples stand before usage and options.
const LAYOUT: &str = "{about}{after-help}\n\n{usage-heading} {usage}\n\n{all-args}";

commands! {
    /// The commands. In the help, a question stands above the first command that answers it.
    Command:
    Start(start::Start),
    Check(check::Check),
    Simulate(simulate::Simulate),
    Replay(replay::ReplayCommand),
    Compare(compare::Compare),
    Gap(gap::Gap),
    Evaluate(evaluate::Evaluate),
    Sweep(sweep::Sweep),
    Tune(tune::Tune),
    Predict(predict::Predict),
    Ensemble(ensemble::Ensemble),
    Search(search::Search),
    Report(report::ReportCommand),
    Apply(apply::Apply),
    Verify(verify::Verify),
    #[command(subcommand, after_help = ROBOT)]
    Robot(RobotCommand),
    #[command(subcommand, after_help = STUDY)]
    Study(StudyCommand),
    #[command(subcommand, after_help = sense::EXAMPLES)]
    Sense(sense::SenseCommand) if "papers",
    #[command(subcommand, after_help = CLUSTER)]
    Cluster(ClusterCommand),
    #[command(hide = true)]
    Completions(completions::Completions),
}

commands! {
    /// Import, export and build robots: import, export, develop, genome
    RobotCommand:
    Import(import::Import),
    Export(export::Export),
    Develop(develop::Develop),
    #[command(subcommand)]
    Genome(genome::GenomeCommand),
}

commands! {
    /// Prepare and inspect studies: record, results, identify, sensitivity, parameters, new, schema, examples
    StudyCommand:
    Record(record::Record),
    Results(results::Results),
    Identify(identify::Identify),
    Sensitivity(sensitivity::Sensitivity),
    Parameters(parameters::Parameters),
    New(new::New),
    Schema(schema::SchemaCommand),
    #[command(subcommand)]
    Examples(examples::Examples),
}

commands! {
    /// Distribute one run over many machines: plan, run, merge, status, submit
    ClusterCommand:
    Plan(plan::PlanCommand),
    Run(run::Run),
    Merge(merge::Merge),
    Status(status::StatusCommand),
    #[command(subcommand)]
    Submit(submit::Submit),
}

/// Questions, each with the first of the commands that answer it.
const QUESTIONS: [(&str, &str); 7] = [
    ("start", "How do I begin with my own recordings?"),
    ("check", "Is my file valid, and what does the robot do?"),
    ("compare", "How far is the simulation from reality?"),
    ("sweep", "What closes the gap, and how sure may I be?"),
    ("predict", "What will a robot do, and which does it best?"),
    ("verify", "Can I trust the simulator itself?"),
    ("robot", "Groups of commands:"),
];

/// Width of the list of commands, and the column where its text begins.
const WIDTH: usize = 80;
const INDENT: usize = 13;

/// The layout of the help: examples, then the commands by question.
fn help() -> String {
    let mut list = String::new();
    let top = Command::augment_subcommands(clap::Command::new("realgap"));
    for command in top.get_subcommands().filter(|c| !c.is_hide_set()) {
        let name = command.get_name();
        for (_, question) in QUESTIONS.iter().filter(|(first, _)| *first == name) {
            list += &format!("{question}\n");
        }
        let mut line = format!("  {name:<width$}", width = INDENT - 2);
        let about = command.get_about().map(ToString::to_string);
        for word in about.unwrap_or_default().split_whitespace() {
            if line.len() + 1 + word.len() > WIDTH {
                list += &format!("{}\n", line.trim_end());
                line = " ".repeat(INDENT);
            }
            line += word;
            line.push(' ');
        }
        list += &format!("{}\n", line.trim_end());
    }
    format!(
        "{{about-with-newline}}\n{EXAMPLES}\n\n{{usage-heading}} {{usage}}\n\nCommands:\n{list}\nOptions:\n{{options}}{{after-help}}"
    )
}

/// The exit code of a command that does not fail.
trait Ending {
    fn code(self) -> u8;
}

/// Most commands exit with 0.
impl Ending for () {
    fn code(self) -> u8 {
        0
    }
}

impl Ending for u8 {
    fn code(self) -> Self {
        self
    }
}

/// Parses the arguments (the program's name first), runs the command, prints its error if there is one, and returns the exit code.
pub fn run(words: impl Iterator<Item = OsString>) -> u8 {
    interrupt::listen();
    let ended = stream::kept(invocation::record(words)).and_then(|words| {
        let cli = Cli::try_parse_from(words)
            .unwrap_or_else(|error| advice::with_decimal_point(error).exit());
        if cli.force {
            output::force();
        }
        cli.command.run()
    });
    let handed_out = stream::finish();
    match ended.and_then(|code| handed_out.map(|()| code)) {
        Ok(_) if terminal::output_lost() => 1,
        Ok(code) => code,
        Err(error) => {
            terminal::print_error(&error);
            match error.kind() {
                ErrorKind::Usage => 2,
                ErrorKind::Interrupted => 130,
                _ => 1,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::{Cli, WIDTH};

    /// The lines of a command's help, and of all below it, that are too wide.
    fn too_wide(command: &mut clap::Command, path: &str, found: &mut Vec<String>) {
        let path = format!("{path} {}", command.get_name());
        for help in [command.render_help(), command.render_long_help()] {
            let lines = help.to_string();
            let wide = lines.lines().filter(|line| line.chars().count() > WIDTH);
            found.extend(wide.map(|line| format!("{path}: {line}")));
        }
        for below in command.get_subcommands_mut() {
            too_wide(below, &path, found);
        }
    }

    #[test]
    fn no_help_page_is_wider_than_eighty_columns() {
        let mut found = Vec::new();
        let mut program = Cli::command();
        program.build();
        too_wide(&mut program, "", &mut found);
        assert!(found.is_empty(), "{found:#?}");
    }
}
