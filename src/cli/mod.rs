//! The command line: one file per subcommand, each one library call plus printing.

/// Declares commands: the type that clap reads them into, and what runs them. `if "FEATURE"` behind a command: only with that feature.
macro_rules! commands {
    ($(#[$about:meta])* $name:ident: $($(#[$meta:meta])* $variant:ident($options:ty) $(if $feature:literal)?,)*) => {
        $(#[$about])*
        #[derive(Debug, clap::Subcommand)]
        #[allow(clippy::large_enum_variant, reason = "there is one, as long as the program runs")]
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

/// What almost every command is written with.
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

    pub use super::folder::ResultsFolder;
    pub use super::kind::{read_morphology, read_study};
    pub use super::option::{Before, Choice, Jobs, Print, Recordings, Values, choice};
    pub use super::page::{PageOption, Telling};
    pub use super::reading::ReadingOptions;
    pub(super) use super::{output, progress, terminal};
}

mod advice;
mod answer;
mod check;
#[cfg(all(test, any(feature = "papers", feature = "schema")))]
mod committed;
mod compare;
mod completions;
mod develop;
mod ensemble;
mod evaluate;
mod example_file;
mod examples;
mod export;
mod folder;
#[macro_use]
mod form;
mod gap;
mod genome;
mod identify;
mod import;
mod interrupt;
mod kind;
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
mod start;
mod status;
mod stream;
mod submit;
mod sweep;
mod terminal;
mod tune;
mod verify;
mod word;
mod work;

use std::ffi::OsString;

use clap::{Parser, Subcommand as _};
use realgap::ErrorKind;

/// How far is your simulated robot from the real one, what closes the gap, and how sure may you be?
///
/// Robots are RON files (morphologies/), or URDF and MJCF; studies are RON files, too (sweeps/); real runs are CSV files or one
/// of many other formats (real_trajectories/).
#[derive(Debug, Parser)]
#[command(name = "realgap", version, max_term_width = 100, arg_required_else_help = true, after_help = NOTES)]
#[command(help_template = help())]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Replace files that realgap did not write
    #[arg(long, global = true)]
    force: bool,
}

const EXAMPLES: &str = "\
The usual way through:
  realgap start runs/*.csv robot.ron                a study of your own recordings
  realgap check morphologies/tripod.ron             what is in this file, and is it sound?
  realgap simulate morphologies/tripod.ron -o a.csv one run, written as a trajectory
  realgap replay morphologies/tripod.ron            watch it move, in a browser
  realgap compare real.csv a.csv --plot gap.png     how far apart are the two?
  realgap sweep sweeps/tripod_floor.ron             which friction and restitution fit best?
  realgap report results/tripod_floor               the same answer as one page
  realgap tune sweeps/tripod_floor.ron              with a quarter of the simulations
  realgap gap sweeps/tripod_floor.ron               how many noise floors between the two?
  realgap predict morphologies/tripod.ron           how far will it go, how likely?
  realgap search sweeps/best_tripod_gait.ron        which gait takes it farthest, on any floor?";

const NOTES: &str = "\
`-` where one file is meant is standard input; behind -o it is standard output.
Exit codes: 0 fine, 1 failed, 2 wrong usage, 130 interrupted (the work so far is saved).";

const ROBOT: &str = "\
Examples:
  realgap robot import robot.urdf -o robot.ron               # any robot, in RON
  realgap robot export robot.ron --format mjcf -o robot.xml  # for MuJoCo
  realgap robot genome random --modules 5 -o genome.ron      # ten numbers a module
  realgap robot develop genome.ron -o robot.ron              # and the robot they say";

const STUDY: &str = "\
Examples:
  realgap study new study > study.ron                       # a commented file to fill in
  realgap study parameters                                  # what can be tuned?
  realgap study sensitivity sweeps/tripod_floor.ron         # what of it matters?
  realgap study identify sweeps/cube_toss_fit.ron           # what does free flight tell?
  realgap study results results/tripod_floor                # the points of a sweep";

const CLUSTER: &str = "\
Examples:
  realgap cluster plan sweeps/tripod_floor.ron --shards 9 -o plan
  realgap cluster run plan --shard 0                        # on any machine
  realgap cluster merge plan                                # and so on, until the answer
  realgap cluster submit slurm plan                         # or Slurm does it";

/// How the help of a command is laid out: examples before everything that takes long to read.
const LAYOUT: &str = "{about}{after-help}\n\n{usage-heading} {usage}\n\n{all-args}";

commands! {
    /// What there is to do; in the help a question stands above the first command that answers it.
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
    #[command(subcommand, after_help = ROBOT)]
    Robot(RobotCommand),
    #[command(subcommand, after_help = STUDY)]
    Study(StudyCommand),
    #[command(subcommand, after_help = sense::EXAMPLES)]
    Sense(sense::SenseCommand) if "papers",
    #[command(subcommand, after_help = CLUSTER)]
    Cluster(ClusterCommand),
    #[command(hide = true)]
    Verify(verify::Verify),
    #[command(hide = true)]
    Completions(completions::Completions),
}

commands! {
    /// Robots from genomes and for other programs: import, export, develop, genome
    RobotCommand:
    Import(import::Import),
    Export(export::Export),
    Develop(develop::Develop),
    #[command(subcommand)]
    Genome(genome::GenomeCommand),
}

commands! {
    /// Around a study: record, results, identify, sensitivity, parameters, new, schema, examples
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
    /// One run on many machines: plan, run, merge, status, submit
    ClusterCommand:
    Plan(plan::PlanCommand),
    Run(run::Run),
    Merge(merge::Merge),
    Status(status::StatusCommand),
    #[command(subcommand)]
    Submit(submit::Submit),
}

/// Questions, each above the first of the commands that answer it.
const QUESTIONS: [(&str, &str); 6] = [
    ("start", "How do I begin with my own recordings?"),
    ("check", "Is it sound, and what does it do?"),
    ("compare", "How far is the simulation from reality?"),
    ("sweep", "What closes the gap, and how sure may I be?"),
    ("predict", "What will a robot do, and which does it best?"),
    ("robot", "And, with commands of their own:"),
];

/// Widest line of the list of commands, and where its text begins.
const WIDTH: usize = 80;
const INDENT: usize = 13;

/// How the help is laid out: examples, then the commands by question.
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

/// How a command ends that does not fail.
trait Ending {
    fn code(self) -> u8;
}

/// Most commands have nothing to say.
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

/// Parses the words, the program's name first, runs the command and prints the error if there is one; how it ends.
pub fn run(words: impl Iterator<Item = OsString>) -> u8 {
    interrupt::listen();
    let ended = stream::kept(word::today(word::keep(words))).and_then(|words| {
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
