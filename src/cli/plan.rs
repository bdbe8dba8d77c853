//! `realgap cluster plan`: divides a long run into shards.

use realgap::plan::{Plan, PlanDraft, time};

use super::kit::*;
use super::work::{absolute, check_arguments, parse, work_of};
use super::{kind, shell};

/// Divide a sweep, a tuning, a search, an ensemble or a gap into shards for many machines
///
/// Use it where one machine would take too long, and all machines see one disk. The plan is a folder. `realgap
/// cluster run PLAN --shard I` computes a part of the rows. `realgap cluster merge PLAN` merges the parts, plans the
/// next round, and at the end writes PLAN/results: byte for byte what one machine would have written. `realgap
/// cluster submit slurm PLAN` lets Slurm do all of that. Options of the planned command follow after --. A few runs
/// are measured first, to estimate the cost.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster plan sweeps/tripod_floor.ron --shards 9 -o plan -- --points 41
  realgap cluster plan sweeps/best_robot.ron --shard-minutes 30 -o plan")]
pub struct PlanCommand {
    /// The study or search, e.g. sweeps/tripod_floor.ron
    study: PathBuf,
    /// Folder for the plan, on a disk that all machines see
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Number of shards in every round
    #[arg(long, value_name = "N", required_unless_present = "shard_minutes")]
    shards: Option<usize>,
    /// Choose the number of shards so that each takes about this many minutes of one core
    #[arg(long, value_name = "MINUTES", conflicts_with = "shards")]
    shard_minutes: Option<f64>,
    /// Command to plan for a study [default: sweep]
    #[arg(long = "as", value_name = "COMMAND", value_parser = PLANNED)]
    command: Option<String>,
    /// Do not measure runs to estimate the cost
    #[arg(long, conflicts_with = "shard_minutes")]
    no_measure: bool,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    print: Print,
    /// Options of the planned command
    #[arg(last = true, value_name = "OPTIONS")]
    arguments: Vec<String>,
}

/// Commands that can be divided into shards.
const PLANNED: [&str; 5] = ["sweep", "tune", "search", "ensemble", "gap"];

impl PlanCommand {
    pub fn run(self) -> Result<()> {
        check_arguments(&self.arguments)?;
        let command = match self.command.as_deref() {
            Some(command) => command,
            None if kind::is_search(&self.study) => "search",
            None => "sweep",
        };
        let directory =
            std::env::current_dir().map_err(|e| Error::io("find the current folder", ".", &e))?;
        let study = absolute(&self.study)?;
        let Some(study) = study.to_str() else {
            return Err(Error::usage("a plan cannot hold this path")
                .found(study.display())
                .allowed("text in UTF-8"));
        };
        let mut words = vec![command.to_owned(), study.to_owned()];
        words.extend(self.arguments.iter().cloned());
        let work = work_of(&parse(&words)?)?;
        let cost = match self.no_measure {
            true => None,
            false => Some(work.measure()?),
        };
        let shards = match (self.shards, self.shard_minutes, cost) {
            (Some(shards), ..) => shards,
            (None, Some(minutes), Some(cost)) if minutes > 0.0 => cost.shards_of(60.0 * minutes),
            _ => {
                return Err(Error::usage("a shard needs a positive duration")
                    .field("--shard-minutes")
                    .allowed("more than 0"));
            }
        };
        let draft = PlanDraft {
            command: words,
            directory,
            name: work.name().to_owned(),
            shards,
            fingerprint: work.fingerprint().entries().to_vec(),
            cost,
        };
        let plan = Plan::create(&self.output, draft)?;
        let round = work.begin(&plan, &self.jobs.stoppable())?;
        if self.print.is_json() {
            terminal::print_answer(&plan.status()?)?;
            return Ok(());
        }
        let folder = shell::path(&self.output);
        let mut lines = vec![format!(
            "{command} of {} in {}; {} in the first round",
            work.name(),
            counted(shards, "shard"),
            counted(round.to, "row"),
        )];
        if round.to < shards {
            lines.push(format!(
                "  {} of the shards have nothing to do in this round: rows are not divided",
                shards - round.to
            ));
        }
        if let Some(cost) = cost {
            lines.push(format!("  {cost}"));
            let all = cost.cpu_s() / shards.min(round.to.max(1)) as f64;
            lines.push(format!(
                "  with all shards at once, one core each: {}, plus the time of the merges",
                time(all)
            ));
        }
        lines.push(format!(
            "  a shard:        realgap cluster run {folder} --shard 0"
        ));
        lines.push(format!("  after a round:  realgap cluster merge {folder}"));
        lines.push(format!("  progress:       realgap cluster status {folder}"));
        lines.push(format!(
            "  or everything:  realgap cluster submit slurm {folder} --go"
        ));
        terminal::print(lines.join("\n"));
        Ok(())
    }
}
