//! The command line: one file per subcommand, each one library call plus printing.

/// Declares commands: the type that clap reads them into, and what runs them.
macro_rules! commands {
    ($(#[$about:meta])* $name:ident: $($(#[$meta:meta])* $variant:ident($options:ty),)*) => {
        $(#[$about])*
        #[derive(Debug, clap::Subcommand)]
        pub enum $name {
            $($(#[$meta])* $variant($options),)*
        }

        impl $name {
            pub fn run(self) -> realgap::Result<std::process::ExitCode> {
                use $crate::cli::Ending as _;
                match self {
                    $(Self::$variant(options) => options.run().map(|ending| ending.code()),)*
                }
            }
        }
    };
}

mod advice;
mod answer;
mod belief;
mod characterise;
mod check;
mod compare;
mod completions;
mod develop;
mod ensemble;
mod evaluate;
mod example_file;
mod examples;
mod export;
mod folder;
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
mod page;
mod parameters;
mod picture;
mod plan;
mod predict;
mod progress;
mod radio;
mod reading;
mod record;
mod replay;
mod report;
mod results;
mod run;
mod schema;
mod search;
mod sense;
mod sensitivity;
mod sensorgraph;
mod simulate;
mod slurm;
mod status;
mod submit;
mod sweep;
mod tasks;
mod terminal;
mod tune;
mod verify;
mod vision;
mod work;

use std::process::ExitCode;

use clap::Parser;
use realgap::ErrorKind;

/// How far is your simulated robot from the real one, what closes the gap, and how sure may you be?
///
/// Robots are modular cubes described in RON files (morphologies/), studies are RON files too (sweeps/),
/// real runs are CSV or TUM files (real_trajectories/).
#[derive(Debug, Parser)]
#[command(name = "realgap", version, max_term_width = 100, arg_required_else_help = true, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
The usual way through:
  realgap check morphologies/tripod.ron             what is in this file, and is it sound?
  realgap simulate morphologies/tripod.ron -o a.csv one run, written as a trajectory
  realgap replay morphologies/tripod.ron            watch it move, in a browser
  realgap compare real.csv a.csv --plot gap.png     how far apart are the two?
  realgap sweep sweeps/tripod_floor.ron             which friction and restitution fit best?
  realgap report results/tripod_floor               the same answer as one page for the browser
  realgap tune sweeps/tripod_floor.ron              the same question with a quarter of the simulations
  realgap gap sweeps/tripod_floor.ron               how many noise floors between the two?
  realgap predict morphologies/tripod.ron           how far will the robot go, how likely, in which ways?
  realgap search sweeps/best_tripod_gait.ron        which gait takes it farthest, whatever the floor turns out to be?
  realgap search sweeps/best_robot.ron              which robot walks farthest, and how sure is that?

Exit codes: 0 fine, 1 failed, 2 wrong usage, 130 interrupted (the work so far is saved).";

commands! {
    /// What there is to do.
    Command:
    Check(check::Check),
    Simulate(simulate::Simulate),
    Replay(replay::ReplayCommand),
    Compare(compare::Compare),
    Sweep(sweep::Sweep),
    Tune(tune::Tune),
    Results(results::Results),
    Report(report::ReportCommand),
    Plan(plan::PlanCommand),
    Run(run::Run),
    Merge(merge::Merge),
    Status(status::StatusCommand),
    #[command(subcommand)]
    Submit(submit::Submit),
    Sensitivity(sensitivity::Sensitivity),
    Evaluate(evaluate::Evaluate),
    Ensemble(ensemble::Ensemble),
    Gap(gap::Gap),
    Predict(predict::Predict),
    Identify(identify::Identify),
    Record(record::Record),
    Search(search::Search),
    Develop(develop::Develop),
    #[command(subcommand)]
    Genome(genome::GenomeCommand),
    Export(export::Export),
    Import(import::Import),
    Characterise(characterise::Characterise),
    Sense(sense::Sense),
    Belief(belief::Belief),
    #[command(subcommand)]
    Sensorgraph(sensorgraph::SensorgraphCommand),
    #[command(subcommand)]
    Radio(radio::RadioCommand),
    #[command(subcommand)]
    Tasks(tasks::TasksCommand),
    Picture(picture::Picture),
    #[command(subcommand)]
    Vision(vision::VisionCommand),
    New(new::New),
    #[command(subcommand)]
    Examples(examples::Examples),
    Schema(schema::SchemaCommand),
    Parameters(parameters::Parameters),
    Verify(verify::Verify),
    Completions(completions::Completions),
}

/// How a command ends that does not fail.
trait Ending {
    fn code(self) -> ExitCode;
}

/// Most commands have nothing to say.
impl Ending for () {
    fn code(self) -> ExitCode {
        ExitCode::SUCCESS
    }
}

impl Ending for ExitCode {
    fn code(self) -> Self {
        self
    }
}

/// Parses the arguments, runs the command, prints the error if there is one.
pub fn main() -> ExitCode {
    interrupt::listen();
    let cli = Cli::try_parse().unwrap_or_else(|error| advice::with_decimal_point(error).exit());
    match cli.command.run() {
        Ok(_) if terminal::output_lost() => ExitCode::FAILURE,
        Ok(code) => code,
        Err(error) => {
            terminal::print_error(&error);
            ExitCode::from(match error.kind() {
                ErrorKind::Usage => 2,
                ErrorKind::Interrupted => 130,
                _ => 1,
            })
        }
    }
}
