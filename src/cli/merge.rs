//! `realgap cluster merge`: merges the shards of a plan, and writes the results.

use realgap::plan::{Merged, Plan, Round};

use super::kit::*;
use super::{Command, shell, work};

/// Merge the rows that a plan's shards have computed; after the last round, write the results
///
/// Use it after the shards of a round have run. Every row is compared with its checksum. Missing, damaged and foreign
/// shards are named, and all others are merged; merging twice changes nothing. When a round is complete, the next
/// round is planned, and the shards must be run again. After the last round, PLAN/results holds the files that the
/// command itself would have written.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster merge plan")]
pub struct Merge {
    /// Folder of the plan
    plan: PathBuf,
    /// Remove the stores of the shards whose rows are merged
    #[arg(long)]
    tidy: bool,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    print: Print,
}

impl Merge {
    pub fn run(self) -> Result<()> {
        let (plan, work) = work::open(&self.plan)?;
        let run = self.jobs.stoppable();
        let (merged, before, next) = work.merge(&plan, &run)?;
        drop(work);
        // With `--format json`, standard output holds the answer only.
        let say = |text: String| match self.print.is_json() {
            false => terminal::print(text),
            true => terminal::note(&text),
        };
        if merged.new + merged.known > 0 {
            let known = match merged.known {
                0 => String::new(),
                known => format!(", {known} were merged before, with equal bytes"),
            };
            say(format!(
                "{} of {}: {} merged{known}",
                plan.draft().command[0],
                plan.draft().name,
                counted(merged.new, "new row"),
            ));
        }
        if self.tidy {
            plan.tidy(&next)?;
        }
        if next.complete {
            return self.answer(&plan);
        }
        if next.number == before.number {
            return Err(self.missing(&plan, &merged, &next)?);
        }
        say(format!(
            "round {} is complete; the next one has {}: run the shards again\n  realgap cluster run {} --shard {}",
            next.number - 1,
            counted(next.to - next.from, "row"),
            shell::path(&self.plan),
            plan.status()?.pending(),
        ));
        Ok(())
    }

    /// The error of an incomplete round: which shards are missing, and what to do.
    fn missing(&self, plan: &Plan, merged: &Merged, round: &Round) -> Result<Error> {
        let status = plan.status()?;
        let mut found = Vec::new();
        if !merged.running.is_empty() {
            found.push(format!("still running: {}", numbers(&merged.running)));
        }
        found.extend(
            merged
                .refused
                .iter()
                .map(|refused| format!("{}: {}", refused.shard, refused.why)),
        );
        let left = round.to - round.from - round.merged;
        let damaged = !merged.refused.is_empty();
        Ok(Error::conflict(format!(
            "round {} is incomplete: {left} of {} rows are missing",
            round.number,
            round.to - round.from
        ))
        .at_file(&self.plan)
        .found(match found.is_empty() {
            true => "shards that have not been run to the end".to_owned(),
            false => found.join("\n           "),
        })
        .hint(format!(
            "{}run: realgap cluster run {} --shard {}; then merge again",
            match damaged {
                true =>
                    "remove the folders of damaged shards (their rows are computed again), then ",
                false => "",
            },
            shell::path(&self.plan),
            status.pending()
        )))
    }

    /// Runs the planned command in the results folder, where all rows are stored already.
    fn answer(&self, plan: &Plan) -> Result<()> {
        let mut words = plan.draft().command.clone();
        let results = plan.results();
        words.extend([
            "--output".to_owned(),
            results.to_string_lossy().into_owned(),
            "--jobs".to_owned(),
            self.jobs.count().to_string(),
            "--format".to_owned(),
            if self.print.is_json() {
                "json"
            } else {
                "table"
            }
            .to_owned(),
        ]);
        super::page::stands_for(&words);
        match work::parse(&words)? {
            Command::Ensemble(ensemble) => ensemble.of_store(Some(&plan.store())),
            Command::Gap(gap) => gap.of_store(Some(&plan.store())),
            _ => {
                words.push("--resume".to_owned());
                work::parse(&words)?.run().map(drop)
            }
        }
    }
}

fn numbers(all: &[usize]) -> String {
    let all: Vec<String> = all.iter().map(usize::to_string).collect();
    all.join(", ")
}
