//! `realgap cluster run`: computes the rows of some shards.

use realgap::store::Share;

use super::kit::*;
use super::{shell, work};

/// Compute the rows of one shard of a plan, or of several, one after the other
///
/// Use it on every machine that takes part. A shard that was stopped or killed continues where it stopped; a finished
/// shard has nothing to do. Every shard writes into a store of its own, so any number of shards can run at the same
/// time, on any machine that sees the plan's folder.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster run plan --shard 0-3")]
pub struct Run {
    /// Folder of the plan
    plan: PathBuf,
    /// Numbers of the shards: 3, or 0-7, or 0-3,9
    #[arg(long = "shard", value_name = "NUMBERS", value_parser = parse_numbers, allow_hyphen_values = true)]
    shards: Numbers,
    #[command(flatten)]
    jobs: Jobs,
}

/// Numbers of shards, in the order in which they were named.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Numbers(Vec<(usize, usize)>);

fn parse_numbers(text: &str) -> std::result::Result<Numbers, String> {
    let refused = || "allowed: whole numbers from 0, and ranges of them: 0-3,9".to_owned();
    let number = |text: &str| text.parse::<usize>().map_err(|_| refused());
    let parts = text.split(',').map(|part| match part.split_once('-') {
        None => Ok((number(part)?, number(part)?)),
        Some((first, last)) => match (number(first)?, number(last)?) {
            (first, last) if first <= last => Ok((first, last)),
            _ => Err(refused()),
        },
    });
    Ok(Numbers(parts.collect::<std::result::Result<_, _>>()?))
}

impl Run {
    pub fn run(self) -> Result<()> {
        let (plan, work) = work::open(&self.plan)?;
        let of = plan.draft().shards;
        let highest = self.shards.0.iter().map(|(_, last)| *last).max();
        // All numbers are checked before any work begins.
        Share::new(highest.unwrap_or(0), of)?;
        let round = plan.round()?;
        if round.complete {
            terminal::print(format!(
                "nothing is left to compute; next: realgap cluster merge {}",
                shell::path(&self.plan)
            ));
            return Ok(());
        }
        for number in self
            .shards
            .0
            .iter()
            .flat_map(|(first, last)| *first..=*last)
        {
            let share = Share::new(number, of)?;
            let rows = round.rows_of(share);
            let bar = progress::bar(rows, &format!("shard {number}"));
            let left = work.run_shard(&plan, share, &self.jobs.stoppable());
            bar.finish_and_clear();
            let left = left?;
            if left > 0 {
                return Err(Error::interrupted(format!(
                    "shard {number} was interrupted with {} of {} rows left; all others are saved",
                    left, rows
                ))
                .at_file(plan.shard_folder(round.number, number))
                .hint("run the shard again: it continues where it stopped"));
            }
            terminal::print(format!(
                "shard {number} of {of}, round {}: {} computed",
                round.number,
                counted(rows, "row")
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_numbers_and_ranges() {
        let numbers = |text| parse_numbers(text).map(|numbers| numbers.0);
        assert_eq!(numbers("3").unwrap(), [(3, 3)]);
        assert_eq!(numbers("0-2,7").unwrap(), [(0, 2), (7, 7)]);
        for wrong in ["-1", "", "a", "3-1", "1,,2", "1-"] {
            assert!(numbers(wrong).is_err(), "{wrong}");
        }
    }
}
