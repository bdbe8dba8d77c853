//! `realgap cluster status`: the progress of a plan.

use realgap::plan::{Plan, ShardState, Status};

use super::kit::*;
use super::shell;

/// Print the progress of a plan's shards
///
/// Use it while shards run, and in scripts (--pending, --round, --answered).
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster status plan
  realgap cluster status plan --pending")]
pub struct StatusCommand {
    /// Folder of the plan
    plan: PathBuf,
    /// Print only the shards that are still to run, as Slurm writes arrays (0-3,7); empty where none is left
    #[arg(long, conflicts_with_all = ["round", "answered", "format"])]
    pending: bool,
    /// Print only the number of the current round, or `complete`
    #[arg(long, conflicts_with_all = ["answered", "format"])]
    round: bool,
    /// Print only the folder of the results, once they are written
    #[arg(long, conflicts_with = "format")]
    answered: bool,
    #[command(flatten)]
    print: Print,
}

/// Up to this many shards are listed one by one.
const LISTED: usize = 40;

impl StatusCommand {
    pub fn run(self) -> Result<()> {
        let plan = Plan::read(&self.plan)?;
        let status = plan.status()?;
        if self.pending {
            print_if_any(status.pending());
        } else if self.round {
            print_if_any(match status.round.complete {
                true => "complete".to_owned(),
                false => status.round.number.to_string(),
            });
        } else if self.answered {
            if status.answered {
                terminal::print(plan.results().display().to_string());
            }
        } else {
            return self.print.answer(&status, || self.table(&plan, &status));
        }
        Ok(())
    }

    fn table(&self, plan: &Plan, status: &Status) -> String {
        let round = &status.round;
        let mut lines = vec![format!(
            "{}: {}",
            status.name,
            if status.answered {
                format!(
                    "complete, {} rows in {}",
                    status.merged,
                    plan.results().display()
                )
            } else if round.complete {
                format!(
                    "all {} rows are merged; to write the results: realgap cluster merge {}",
                    status.merged,
                    shell::path(&self.plan)
                )
            } else {
                format!(
                    "round {}, rows {} to {}: {} merged",
                    round.number,
                    round.from,
                    round.to.saturating_sub(1),
                    round.merged
                )
            }
        )];
        if let Some(cost) = status.cost {
            lines.push(format!("  {cost}"));
        }
        let states = [
            ShardState::Merged,
            ShardState::Done,
            ShardState::Running,
            ShardState::Stopped,
            ShardState::Waiting,
            ShardState::Damaged,
            ShardState::Idle,
        ];
        let counts: Vec<String> = states
            .into_iter()
            .filter_map(|state| {
                let count = status.shards.iter().filter(|s| s.state == state).count();
                (count > 0).then(|| format!("{count} {}", state.name()))
            })
            .collect();
        lines.push(format!("  shards: {}", counts.join(", ")));
        if status.shards.len() <= LISTED && !round.complete {
            let mut table = TextTable::new([
                ("shard", Side::Right),
                ("state", Side::Left),
                ("rows", Side::Right),
                ("of", Side::Right),
            ]);
            for shard in &status.shards {
                table.push(vec![
                    shard.shard.to_string(),
                    shard.state.name().to_owned(),
                    shard.done.to_string(),
                    shard.rows.to_string(),
                ]);
            }
            lines.push(terminal::table(&table));
        }
        let pending = status.pending();
        if !round.complete && !pending.is_empty() {
            let folder = shell::path(&self.plan);
            lines.push(format!(
                "  to be run: realgap cluster run {folder} --shard {pending}"
            ));
        }
        lines.join("\n")
    }
}

fn print_if_any(text: String) {
    if !text.is_empty() {
        terminal::print(text);
    }
}
