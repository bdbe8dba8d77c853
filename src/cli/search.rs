//! `realgap search`: searches for the best robot.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use realgap::claim::verdict_lines;
use realgap::optimization::{Ending, Progress, RunOptions};
use realgap::plan::Work;
use realgap::report::PageData;
use realgap::results::{Kind, SearchSummary, write_search};
use realgap::search::{self, Finalist, Overrides, SearchResults};

use super::kind::read_search;
use super::kit::*;
use super::mujoco;
use super::option::recording_unused;
use super::page;

/// Number of the best robots that the page shows in motion.
const SIDE_BY_SIDE: usize = 5;

/// Search for the best robot or gait by its predicted performance
///
/// Use it to design a robot once its simulation is calibrated. Every robot is simulated several times under noise and
/// with the posterior of the parameters (--posterior), in the tree solver unless the file says otherwise. The best
/// are simulated again in Rapier with fresh seeds, at half and double timestep and substeps, at the limit of hard
/// contact, and with the other formulation of joints at its own limit; a robot that does not walk the same there is
/// marked and ranked last. Results are stored as they come; Ctrl-C saves them, and --resume continues with the same
/// bits.
///
/// The folder gets history.csv, fitness.png, best/*.ron with a prediction card each (.json), gallery.png, paths.png,
/// summary.json, and for map-elites archive.csv and archive.png; docs/results.md explains them.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap check sweeps/best_robot.ron           # how many robots?
  realgap search sweeps/best_robot.ron
  realgap search sweeps/best_robot.ron --posterior results/tripod_floor")]
pub struct Search {
    /// The search, e.g. sweeps/best_robot.ron
    search: PathBuf,
    /// Folder for the results [default: results/<search>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
    /// Results folder of a sweep or tuning: every repeat uses one of its posterior draws (indistinguishable.csv)
    #[arg(long, value_name = "DIR")]
    posterior: Option<PathBuf>,
    /// Also run the finalists in MuJoCo, with this Python (python3 unless named); a robot that walks differently there does not
    /// survive
    #[arg(long, value_name = "PYTHON", num_args = 0..=1, require_equals = true, default_missing_value = "python3")]
    mujoco: Option<String>,
    /// Seed in place of the file's own
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    #[command(flatten)]
    page: PageOption,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    before: Before,
    #[command(flatten)]
    print: Print,
}

impl Search {
    fn read(&self) -> Result<search::Search> {
        let fitted = self.values.fitted()?;
        terminal::print_warnings(&recording_unused(&fitted.values));
        let overrides = Overrides {
            set: fitted.values,
            draws: fitted.draws,
            indistinguishable: self.posterior.clone(),
            seed: self.seed,
        };
        read_search(&self.search, &overrides)
    }

    /// The work that can be divided into shards.
    pub fn work(&self) -> Result<Work> {
        Ok(Work::Search(Box::new(self.read()?)))
    }

    pub fn run(self) -> Result<()> {
        let search = self.read()?;
        let folder = match &self.output {
            Some(folder) => folder.clone(),
            None => PathBuf::from("results").join(search.name()),
        };
        let options = self.jobs.stoppable();
        let started = Instant::now();
        // The folder stays locked until the finalists are simulated again and all files are written.
        let folder = ResultsFolder::take(&folder, Kind::Search)?;
        let results = self.simulate(&search, &folder, &options);
        folder.check()?;
        let results = results?;
        let (mut finalists, mut baseline, mut share) = (Ok(Vec::new()), None, None);
        if results.ending == Ending::Complete {
            finalists = look_again(&search, &results, &options);
            if finalists.is_ok() {
                baseline = search.baseline(&options)?;
            }
            if let Some(first) = finalists
                .as_ref()
                .ok()
                .and_then(|best: &Vec<Finalist>| best.first())
            {
                share = search.parameter_share(first, &options)?;
            }
        }
        let known = finalists.as_ref().map_or(&[][..], Vec::as_slice);
        folder.check()?;
        let write = |finalists: &[Finalist]| {
            write_search(
                folder.path(),
                &search,
                &results,
                finalists,
                (baseline.as_ref(), share),
            )
        };
        let (mut summary, mut results_page) = write(known)?;
        if let (Some(python), Ok(known)) = (&self.mujoco, &finalists)
            && !known.is_empty()
        {
            let bar = progress::spinner("running the best in MuJoCo");
            let reranked = mujoco::rerun(python, folder.path(), &search, known.clone());
            bar.finish_and_clear();
            let reranked = reranked?;
            (summary, results_page) = write(&reranked)?;
            finalists = Ok(reranked);
        }
        let page_said = self.page.write(folder.path(), &results_page, || {
            match finalists.as_deref() {
                Ok(best) => {
                    let runs = best
                        .iter()
                        .take(SIDE_BY_SIDE)
                        .map(|one| (search.experiment(&one.robot), &one.robot));
                    page::of_robots(&runs.collect::<Vec<_>>())
                }
                Err(_) => PageData::default(),
            }
        });
        folder.write_timing(options.jobs)?;
        self.print.answer_above(&summary.warnings, &summary, || {
            let wall_s = started.elapsed().as_secs_f64();
            let head = format!("{wall_s:.1} s on {}", counted(options.jobs, "thread"));
            format!(
                "{}\n  results in {}: summary.json, history.csv, best/ and pictures{}",
                words(&summary, &search, &head),
                folder.path().display(),
                page_said
            )
        })?;
        let go_on = format!(
            "go on with: realgap search {} --resume (and the same options)",
            self.search.display()
        );
        if results.ending == Ending::Interrupted {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} robots; all of them are saved",
                summary.robots, summary.robots_total
            ))
            .at_file(folder.path())
            .hint(go_on));
        }
        finalists.map_err(|e| e.at_file(folder.path()).hint(go_on))?;
        if summary.best.is_empty() {
            return Err(
                Error::invalid("every robot failed, so there is no best one")
                    .at_file(&self.search)
                    .hint("history.csv says why: see its columns `status` and `seen`"),
            );
        }
        Ok(())
    }

    /// Simulates the robots, with a bar.
    fn simulate(
        &self,
        search: &search::Search,
        folder: &ResultsFolder,
        options: &RunOptions<'_>,
    ) -> Result<SearchResults> {
        let unit = search.objective().measure.unit();
        let bar = progress::bar(search.strategy().budget(), "searching");
        let is_first = AtomicBool::new(true);
        let show = |progress: Progress| {
            bar.set_position(progress.done as u64);
            if is_first.swap(false, Ordering::Relaxed) {
                // Rate and time left are computed from here, without the steps of an earlier run.
                bar.reset_eta();
            }
            if let Some(best) = progress.best {
                bar.set_message(format!("searching, best {}", quantity(best, unit)));
            }
        };
        let options = RunOptions {
            progress: Some(&show),
            ..*options
        };
        let results = search.run_in(folder.lock(), self.before.mode(), &options);
        bar.finish_and_clear();
        results
    }
}

/// Simulates the best robots again, with a bar.
fn look_again(
    search: &search::Search,
    results: &SearchResults,
    options: &RunOptions<'_>,
) -> Result<Vec<Finalist>> {
    let bar = progress::bar(search.finals().count, "simulating the best again");
    let show = |progress: Progress| bar.set_position(progress.done as u64);
    let options = RunOptions {
        progress: Some(&show),
        ..*options
    };
    let finalists = search.finalists(results, &options);
    bar.finish_and_clear();
    finalists
}

/// A parameter with its values and where they come from.
fn known_parameter(known: &search::KnownParameter) -> String {
    let [low, high] = known.q05_q95;
    let unit = Unit::by_label(&known.unit).unwrap_or(Unit::One);
    let values = match low == high {
        true => quantity(known.median, unit),
        false => format!(
            "{} ({} to {}, 90 %)",
            quantity(known.median, unit),
            quantity(low, unit),
            quantity(high, unit)
        ),
    };
    format!("{} = {values}, {}", known.parameter, known.from)
}

fn words(summary: &SearchSummary, search: &search::Search, head: &str) -> String {
    let unit = search.objective().measure.unit();
    let failures: Vec<String> = summary
        .failures
        .iter()
        .map(|(reason, count)| format!("{count} {reason}"))
        .collect();
    let mut lines = vec![format!(
        "{}{}: {} of {} by {}, {} each of {} s, {head}",
        verdict_lines(&summary.claims),
        summary.search,
        summary.robots,
        counted(summary.robots_total, "robot"),
        summary.strategy,
        counted(summary.repeats, "repeat"),
        summary.duration_s,
    )];
    if !failures.is_empty() {
        lines.push(format!("  failed: {}", failures.join(", ")));
    }
    if let Some([filled, all]) = summary.archive {
        lines.push(format!("  archive: {filled} of {all} cells"));
    }
    for known in &summary.parameters {
        lines.push(format!("  {}", known_parameter(known)));
    }
    if let Some(best) = summary.best_fitness {
        lines.push(format!(
            "  best in the search: {} ({})",
            quantity(best, unit),
            summary.objective
        ));
    }
    if !summary.best.is_empty() {
        let mut table = TextTable::new([
            ("rank", Side::Right),
            ("robot", Side::Left),
            ("modules", Side::Right),
            ("in the search", Side::Right),
            ("fresh seeds", Side::Right),
            ("displacement, 90 %", Side::Right),
            ("P(half of noise-free)", Side::Right),
            ("survives", Side::Left),
        ]);
        let metres = |value: f64| quantity(value, Unit::Metre);
        for robot in &summary.best {
            table.push(vec![
                robot.rank.to_string(),
                robot.file.clone(),
                robot.modules.to_string(),
                robot
                    .search_fitness
                    .map_or("-".to_owned(), |f| quantity(f, unit)),
                robot.fitness.map_or("-".to_owned(), |f| quantity(f, unit)),
                robot
                    .displacement_q05_q95_m
                    .map_or("-".to_owned(), |[a, b]| {
                        format!("{} to {}", metres(a), metres(b))
                    }),
                robot
                    .success
                    .zip(robot.success_m)
                    .map_or("-".to_owned(), |(p, m)| {
                        format!("{:.0} % over {}", 100.0 * p, metres(m))
                    }),
                match (
                    robot.survives,
                    robot.largest_change,
                    robot.worst_rerun.as_deref(),
                ) {
                    (true, ..) => "yes".to_owned(),
                    (_, Some(change), Some(worst)) => {
                        format!("NO: changes by {:.0} % at {worst}", 100.0 * change)
                    }
                    (_, _, worst) => format!("NO: fails at {}", worst.unwrap_or("reruns")),
                },
            ]);
        }
        lines.push(terminal::table(&table));
        if let Some(share) = &summary.parameter_share {
            lines.push(format!(
                "  of the variance of the best robot's displacement, {:.0} % comes from the drawn parameters ({} repeats)",
                100.0 * share.share, share.repeats
            ));
        }
        if let Some(baseline) = &summary.baseline {
            let worth = match (&baseline.failure, baseline.fitness) {
                (Some(failure), _) => format!("fails: {failure}"),
                (None, Some(fitness)) => quantity(fitness, unit),
                (None, None) => "diverges".to_owned(),
            };
            lines.push(format!(
                "  started from {}: {worth} with the same fresh seeds",
                baseline.robot
            ));
        }
    }
    lines.join("\n")
}
