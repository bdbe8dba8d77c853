//! `realgap sweep`: simulates a grid of parameters.

use std::time::Instant;

use realgap::plan::Work;

use super::answer::StudyOptions;
use super::kit::*;

/// Simulate every combination of a study's parameters and find the values that match reality best
///
/// Use it for one or two parameters; where there are more than two or three, `realgap tune` needs far fewer
/// simulations. The grid is simulated; then the points that may be the best are simulated again with other equally
/// valid settings. Results are stored as they come; Ctrl-C saves them and draws the results so far, and --resume
/// continues and ends with the same bytes. The folder gets points.csv, scores.csv, profiles.csv, summary.json,
/// best.ron, a heat map (or curve), the profile of each parameter and trajectories.png; docs/results.md explains
/// them.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sweep sweeps/cube_toss.ron
  realgap sweep sweeps/tripod_floor.ron --points 11 --folds 5 -o results/coarse
  realgap sweep sweeps/tripod_floor.ron --resume")]
pub struct Sweep {
    #[command(flatten)]
    options: StudyOptions,
    /// Points per parameter in place of the study's own
    #[arg(long, value_name = "N")]
    points: Option<usize>,
}

impl Sweep {
    /// The work that can be divided into shards.
    pub fn work(&self) -> Result<Work> {
        Ok(Work::Sweep(Box::new(self.options.study(self.points)?)))
    }

    pub fn run(self) -> Result<()> {
        let options = &self.options;
        let study = options.study(self.points)?;
        let folder = options.folder(&study, "")?;
        let started = Instant::now();
        let (total, run) = (study.definition().grid.len(), options.jobs.stoppable());
        let of = (&study, folder.path());
        let result = options.live.during(of, true, run, |run| {
            progress::during(total, "sweeping", *run, |run| {
                study.sweep_into(folder.lock(), options.before.mode(), run)
            })
        });
        folder.check()?;
        let wall_s = started.elapsed().as_secs_f64();
        options.finish("sweep", &study, &result?, &folder, wall_s)
    }
}
