//! `realgap tune`: let an optimizer choose the points.

use std::time::Instant;

use realgap::calibration::TuneOptions;
use realgap::optimization::{OPTIMIZERS, Progress, RunOptions, optimizer_by_name};
use realgap::plan::Work;

use super::answer::StudyOptions;
use super::kit::*;

/// Let an optimizer find the values that match reality best, with far fewer simulations than a sweep
///
/// Use it for more than two or three parameters, or where simulations are slow. Any number of parameters may vary,
/// within the ranges of the study. The same study, optimizer, seed and budget give the same bits for any number of
/// threads and after any interruption; a larger budget with --resume continues the run. Points that diverge count as
/// worse than any other. The run ends when the budget is spent, when the optimizer has no more points to try (a
/// grid), or by --patience. The folder gets the files of a sweep, convergence.png and trials.csv.
#[derive(Debug, Args)]
#[command(after_help = optimizers())]
pub struct Tune {
    #[command(flatten)]
    options: StudyOptions,
    /// Optimizer that chooses the points (listed above)
    #[arg(long, value_name = "NAME", default_value = "cma-es")]
    optimizer: String,
    /// Largest number of points to evaluate, including the first design
    #[arg(long, value_name = "N", default_value_t = 100)]
    budget: usize,
    /// Stop after N points in a row that are not better than the best
    #[arg(long, value_name = "N")]
    patience: Option<usize>,
}

const EXAMPLES: &str = "  realgap tune sweeps/tripod_floor.ron --budget 100
  realgap tune sweeps/tripod_floor.ron --metric rms --optimizer bayesian --folds 5";

/// Examples, and the list of optimizers.
fn optimizers() -> String {
    let lines = OPTIMIZERS
        .iter()
        .map(|optimizer| format!("  {:<15} {}", optimizer.name(), optimizer.doc()));
    format!(
        "Examples:\n{EXAMPLES}\n\nOptimizers:\n{}\n\nThe pca metric fits its basis to a first design of 64 points, which are part of\nthe budget.",
        lines.collect::<Vec<_>>().join("\n")
    )
}

impl Tune {
    fn tuning(&self) -> Result<TuneOptions> {
        Ok(TuneOptions {
            optimizer: optimizer_by_name(&self.optimizer).map_err(Error::into_usage)?,
            budget: self.budget,
            patience: self.patience,
        })
    }

    /// The work that can be divided into shards.
    pub fn work(&self) -> Result<Work> {
        let study = Box::new(self.options.study(None)?);
        Ok(Work::Tune(study, self.tuning()?))
    }

    pub fn run(self) -> Result<()> {
        let tuning = self.tuning()?;
        let options = &self.options;
        let study = options.study(None)?;
        let folder = options.folder(&study, &format!("_{}", tuning.optimizer.name()))?;
        let bar = progress::bar(self.budget, "tuning");
        let started = Instant::now();
        let unit = study.definition().metric.unit();
        let follow = progress::follow(&bar);
        let say = |progress: Progress| {
            follow(progress);
            if let Some(best) = progress.best.filter(|_| progress.finishing.is_none()) {
                bar.set_message(format!("tuning, best {}", quantity(best, unit)));
            }
        };
        let run = RunOptions {
            progress: Some(&say),
            ..options.jobs.stoppable()
        };
        let of = (&study, folder.path());
        let result = options.live.during(of, false, run, |run| {
            study.tune_into(folder.lock(), options.before.mode(), &tuning, run)
        });
        bar.finish_and_clear();
        folder.check()?;
        let wall_s = started.elapsed().as_secs_f64();
        options.finish("tune", &study, &result?, &folder, wall_s)
    }
}
