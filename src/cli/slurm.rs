//! Scripts for Slurm: an array of shards, a merge that depends on it, and the next array.

use std::process::Command;

use realgap::file::write_atomic;
use realgap::plan::Plan;

use super::kit::*;
use super::shell;
use super::work::absolute;

const CHAIN: &str = r#"# Submits the shards that a round still needs, and a merge that follows whether or not they succeed.
submit_round() { # RETRY ROUND
    local pending job
    pending=$("$realgap" cluster status "$plan" --pending) || exit 1
    if [ -z "$pending" ]; then
        # All rows are computed: only the merge and the answer are left.
        sbatch --parsable "${options[@]}" --job-name="merge-$name" --output="$logs/merge_%j.txt" \
            "$here/merge.sh" "$1" "$2"
        return
    fi
    job=$(sbatch --parsable "${options[@]}" --job-name="$name" --array="$pending" --requeue --open-mode=append \
        --output="$logs/%A_%a.txt" "$here/shard.sh") || exit 1
    echo "round $2: shards $pending are job ${job%%;*}"
    job=$(sbatch --parsable "${options[@]}" --job-name="merge-$name" --output="$logs/merge_%j.txt" \
        --dependency=afterany:"${job%%;*}" "$here/merge.sh" "$1" "$2") || exit 1
    echo "its merge is job ${job%%;*}"
}
"#;

const SHARD: &str = r#"exec "$realgap" cluster run "$plan" --shard "$SLURM_ARRAY_TASK_ID" --jobs "${SLURM_CPUS_PER_TASK:-1}"
"#;

const MERGE: &str = r#"retry=$1
before=$2
"$realgap" cluster merge "$plan" --jobs "${SLURM_CPUS_PER_TASK:-1}"
code=$?
round=$("$realgap" cluster status "$plan" --round) || exit 1
if [ "$round" = complete ]; then
    exit $code
fi
if [ "$round" = "$before" ]; then
    retry=$((retry + 1))
    if [ "$retry" -gt "$retries" ]; then
        echo "round $round failed $retry times; see $logs, then: bash $here/submit.sh" >&2
        exit 1
    fi
else
    retry=0
fi
submit_round "$retry" "$round"
"#;

const SUBMIT: &str = r#"round=$("$realgap" cluster status "$plan" --round) || exit 1
if [ "$round" = complete ] && [ -n "$("$realgap" cluster status "$plan" --answered)" ]; then
    echo "the plan is complete: see $plan/results"
    exit 0
fi
submit_round 0 "$round"
"#;

/// Write job scripts for Slurm into PLAN/slurm, and with --go submit them
///
/// Use it to run a whole plan on a cluster with Slurm. Every round is an array of jobs, one per shard. A merge
/// follows whether or not these jobs succeed, and submits the shards that are still missing, or the next round, until
/// PLAN/results is written. Jobs that are requeued continue where they stopped.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap cluster submit slurm plan --partition long --time 02:00:00 --go")]
pub struct Slurm {
    /// Folder of the plan
    plan: PathBuf,
    /// Partition of Slurm
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account of Slurm
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Longest time of one job, as Slurm writes it
    #[arg(long, value_name = "HH:MM:SS")]
    time: Option<String>,
    /// Memory of one job, as Slurm writes it
    #[arg(long, value_name = "SIZE")]
    mem: Option<String>,
    /// Processors of one job, which is also its number of threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    cpus: u16,
    /// How often shards that failed in a round are submitted again
    #[arg(long, value_name = "N", default_value_t = 3)]
    retries: usize,
    /// Any other option of sbatch, e.g. --sbatch=--nodelist=n1 (repeatable)
    #[arg(long = "sbatch", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<String>,
    /// Also submit the jobs
    #[arg(long)]
    go: bool,
}

impl Slurm {
    pub fn run(self) -> Result<()> {
        let plan = Plan::read(&self.plan)?;
        let script = self.scripts(&plan)?;
        if !self.go {
            terminal::print(format!("submit it with: bash {}", shell::path(&script)));
            return Ok(());
        }
        let done = Command::new("bash").arg(&script).status();
        let done = done.map_err(|e| Error::io("start bash for", &script, &e))?;
        if !done.success() {
            return Err(Error::invalid("Slurm did not take the jobs")
                .at_file(&script)
                .found(done)
                .hint("its message stands above; try `sinfo`"));
        }
        Ok(())
    }

    /// Writes `slurm/` into the plan's folder: `submit.sh` begins, `shard.sh` and `merge.sh` are jobs. The path of `submit.sh`.
    ///
    /// # Errors
    /// Paths or options with control characters; an unwritable folder.
    fn scripts(&self, plan: &Plan) -> Result<PathBuf> {
        let program =
            std::env::current_exe().map_err(|e| Error::io("find this program", "realgap", &e))?;
        let folder = absolute(plan.folder())?;
        let here = folder.join("slurm");
        let logs = here.join("logs");
        std::fs::create_dir_all(&logs)
            .map_err(|e| Error::io("make the folder of logs", &logs, &e))?;
        let mut options = vec![format!("--cpus-per-task={}", self.cpus)];
        let named = [
            ("partition", &self.partition),
            ("account", &self.account),
            ("time", &self.time),
            ("mem", &self.mem),
        ];
        for (name, value) in named {
            options.extend(value.iter().map(|value| format!("--{name}={value}")));
        }
        options.extend(self.options.iter().cloned());
        let options: Result<Vec<String>> = options.iter().map(|option| quoted(option)).collect();
        let text = |path: &Path| quoted(&path.to_string_lossy());
        let head = format!(
            "#!/bin/bash\n\
             # Written by realgap cluster submit slurm.\n\
             set -u\n\
             realgap={}\n\
             plan={}\n\
             here={}\n\
             logs={}\n\
             name={}\n\
             retries={}\n\
             options=({})\n",
            text(&program)?,
            text(&folder)?,
            text(&here)?,
            text(&logs)?,
            quoted(&plan.draft().name)?,
            self.retries,
            options?.join(" "),
        );
        let submit = here.join("submit.sh");
        for (file, body) in [
            (here.join("shard.sh"), SHARD.to_owned()),
            (here.join("merge.sh"), format!("{CHAIN}{MERGE}")),
            (submit.clone(), format!("{CHAIN}{SUBMIT}")),
        ] {
            write_atomic(file, format!("{head}{body}").as_bytes())?;
        }
        Ok(submit)
    }
}

/// A text, quoted as one word of a shell.
fn quoted(text: &str) -> Result<String> {
    if text.chars().any(char::is_control) {
        return Err(Error::usage("a script cannot hold this")
            .found(text.escape_debug())
            .allowed("text without control characters"));
    }
    Ok(format!("'{}'", text.replace('\'', r"'\''")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_path_is_quoted_as_one_word() {
        assert_eq!(quoted("a b").unwrap(), "'a b'");
        assert_eq!(quoted("it's $(rm)").unwrap(), r"'it'\''s $(rm)'");
        assert!(quoted("a\nb").is_err());
    }
}
