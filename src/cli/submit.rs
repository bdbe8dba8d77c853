//! `realgap cluster submit`: let an engine that people have run a plan.

use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use realgap::plan::Plan;
use realgap::{Error, Result};

use super::slurm::{Slurm, scripts};
use super::{shell, terminal};

commands! {
    /// Let Slurm run a plan: arrays of shards, a merge after each, retries, and the answer
    Submit:
    Slurm(SlurmOptions),
}

/// Write job scripts for Slurm into PLAN/slurm, and with --go submit them
///
/// A round is an array of jobs, one a shard; a merge follows whatever became of them, and submits the shards that are still
/// missing, or the next round, until PLAN/results is written. Jobs that are requeued go on where they were.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster submit slurm plan --partition long --time 02:00:00 --go")]
pub struct SlurmOptions {
    /// Folder of the plan
    plan: PathBuf,
    /// Partition
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Longest time of one job, as Slurm writes it
    #[arg(long, value_name = "HH:MM:SS")]
    time: Option<String>,
    /// Memory of one job, as Slurm writes it
    #[arg(long, value_name = "SIZE")]
    mem: Option<String>,
    /// Processors of one job, and so threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    cpus: u16,
    /// How often what failed in a round is begun again
    #[arg(long, value_name = "N", default_value_t = 3)]
    retries: usize,
    /// Any other option of sbatch, e.g. --sbatch=--nodelist=n1 (repeatable)
    #[arg(long = "sbatch", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<String>,
    /// Submit, too
    #[arg(long)]
    go: bool,
}

impl SlurmOptions {
    pub fn run(self) -> Result<()> {
        let options = self;
        let plan = Plan::read(&options.plan)?;
        let program =
            std::env::current_exe().map_err(|e| Error::io("find this program", "realgap", &e))?;
        let slurm = Slurm {
            program,
            partition: options.partition,
            account: options.account,
            time: options.time,
            memory: options.mem,
            cpus: usize::from(options.cpus),
            retries: options.retries,
            options: options.options,
        };
        let script = scripts(&plan, &slurm)?;
        if !options.go {
            terminal::print(format!("submit it with: bash {}", shell::path(&script)));
            return Ok(());
        }
        let done = Command::new("bash").arg(&script).status();
        let done = done.map_err(|e| Error::io("start bash for", &script, &e))?;
        if !done.success() {
            return Err(Error::invalid("Slurm did not take the jobs")
                .at_file(&script)
                .found(done)
                .hint("what it said stands above; try `sinfo`"));
        }
        Ok(())
    }
}
