//! `realgap sweep`: the main job.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Args;
use realgap::folder::{self, Summary};
use realgap::quantity::{LengthUnit, counted};
use realgap::report::quantity;
use realgap::study::{Mode, Overrides, Problem, sweep};
use realgap::tuning::{Ending, UncertaintySource};
use realgap::{Error, Result, Warning};

use super::kind::read_study;
use super::option::{Format, UnitOption, Values};
use super::{interrupt, progress, terminal};

/// Simulate every combination of a study's parameters and find what matches reality best
///
/// Results reach the folder as they come; Ctrl-C saves and draws what there is, --resume goes on. The folder gets
/// points.csv, scores.csv, summary.json, best.ron, a heat map (or curve) and trajectories.png.
#[derive(Debug, Args)]
pub struct Sweep {
    /// The study, e.g. sweeps/tripod_floor.ron
    study: PathBuf,
    /// Folder for the results [default: results/<study>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Recordings in place of the study's own; quote the glob (repeatable)
    #[arg(long, value_name = "GLOB")]
    recordings: Vec<String>,
    /// Use only the first N recordings
    #[arg(long, value_name = "N")]
    limit_recordings: Option<NonZeroUsize>,
    /// Metric in place of the study's own
    #[arg(long, value_name = "NAME")]
    metric: Option<String>,
    /// Points per parameter in place of the study's own
    #[arg(long, value_name = "N")]
    points: Option<usize>,
    /// Unit of length of the recordings
    #[arg(long, value_enum, default_value_t)]
    unit: UnitOption,
    #[command(flatten)]
    values: Values,
    /// Threads [default: all cores]
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Go on with an interrupted sweep
    #[arg(long, conflicts_with = "restart")]
    resume: bool,
    /// Throw old results in the folder away and start anew
    #[arg(long)]
    restart: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Sweep {
    pub fn run(self) -> Result<ExitCode> {
        let overrides = Overrides {
            recordings: self.recordings.clone(),
            limit_recordings: self.limit_recordings.map(NonZeroUsize::get),
            metric: self.metric.clone(),
            points: self.points,
            set: self.values.parameter_set()?,
            unit: LengthUnit::from(self.unit),
            ..Overrides::default()
        };
        let problem = Problem::new(read_study(&self.study, &overrides)?)?;
        terminal::print_warnings(problem.warnings());
        let varied = problem
            .study()
            .grid
            .ranges()
            .iter()
            .map(|range| range.parameter.name);
        let overruled = varied
            .filter(|name| overrides.set.value(name).is_some())
            .map(|name| {
                Warning::new(
                    "no-effect",
                    format!("{name} was set, but the study varies it: the study's range counts"),
                )
            });
        terminal::print_warnings(&overruled.collect::<Vec<_>>());
        let folder = match &self.output {
            Some(folder) => folder.clone(),
            None => PathBuf::from("results").join(&problem.study().name),
        };
        let mode = match (self.resume, self.restart) {
            (true, _) => Mode::Resume,
            (_, true) => Mode::Restart,
            _ => Mode::Start,
        };
        let jobs = self
            .jobs
            .or_else(|| std::thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get);
        let stop = interrupt::stop_flag()?;
        let points = problem.study().grid.len();
        let bar = progress::bar(points, "sweeping");
        let started = Instant::now();
        let mut first = None;
        let result = sweep(&problem, &folder, mode, jobs, stop, |done| {
            if first.is_none() {
                first = Some(done);
                // Rate and time left count from here, not from what an earlier run did.
                bar.set_position(done as u64);
                bar.reset_eta();
            }
            bar.set_position(done as u64);
        });
        bar.finish_and_clear();
        let result = result?;
        let wall_s = started.elapsed().as_secs_f64();
        let summary = folder::write(&folder, &problem, &result)?;
        terminal::print_warnings(
            summary
                .warnings
                .iter()
                .filter(|w| !problem.warnings().contains(w)),
        );
        match self.format {
            Format::Json => terminal::print(terminal::json(&summary)?),
            Format::Table => print(&summary, &folder, &problem, wall_s, jobs),
        }
        if result.ending == Ending::Interrupted {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {points} points; all of them are saved",
                summary.points
            ))
            .at_file(&folder)
            .hint(format!(
                "go on with: realgap sweep {} --resume (and the same options)",
                self.study.display()
            )));
        }
        if summary.best.is_none() {
            return Err(Error::invalid("every point diverged, so there is no best one")
                .at_file(&self.study)
                .hint("check the robot with `realgap simulate`, then a shorter timestep or more substeps"));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn print(summary: &Summary, folder: &std::path::Path, problem: &Problem, wall_s: f64, jobs: usize) {
    let mut lines = vec![format!(
        "{}: {} of {}, {}, {wall_s:.1} s on {}",
        summary.study,
        summary.points,
        counted(summary.points_total, "point"),
        counted(summary.recordings, "recording"),
        counted(jobs, "thread"),
    )];
    let unit = problem.study().metric.unit();
    if let Some(best) = &summary.best {
        let values: Vec<String> = best
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {value:.4}"))
            .collect();
        lines.push(format!("  best: {}", values.join(", ")));
        lines.push(format!(
            "  {} discrepancy {}",
            summary.metric,
            quantity(best.score, unit)
        ));
        if let Some(pose) = &summary.pose {
            lines.push(format!(
                "  mean position error {:.2} % of the body length, mean rotation error {:.2} deg",
                pose.position_percent, pose.rotation_deg
            ));
        }
    }
    if let Some(uncertainty) = &summary.uncertainty {
        let source = match uncertainty.source {
            UncertaintySource::Bootstrap => "bootstrap over recordings",
            UncertaintySource::Ensemble => "perturbed starts of the best point",
        };
        lines.push(format!(
            "  {} of {} points cannot be told apart from it at {:.0} % ({source})",
            uncertainty.indistinguishable,
            summary.points,
            100.0 * uncertainty.level
        ));
    }
    lines.extend(
        summary
            .verdicts
            .iter()
            .map(|verdict| format!("  {}", verdict.text)),
    );
    lines.push(format!(
        "  results in {}: summary.json, best.ron, points.csv and pictures",
        folder.display()
    ));
    terminal::print(lines.join("\n"));
}
