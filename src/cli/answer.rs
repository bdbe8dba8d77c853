//! What `sweep` and `tune` share: their options, and how the answer is printed.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use realgap::calibration::UncertaintySource;
use realgap::calibration::{Answer, Mode, Overrides, Split, Study};
use realgap::optimization::Ending;
use realgap::plot::quantity;
use realgap::results::{self, Summary};
use realgap::unit::counted;
use realgap::warning::Code;
use realgap::{Error, Result, Warning};

use super::kind::read_study;
use super::option::{Format, Jobs, Recordings, Values, metric_option};
use super::terminal;

#[derive(Debug, Args)]
pub struct StudyOptions {
    /// The study, e.g. sweeps/tripod_floor.ron
    pub study: PathBuf,
    /// Folder for the results [default: results/<study>, of tune results/<study>_<optimizer>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    recordings: Recordings,
    /// Metric in place of the study's own
    #[arg(long, value_name = "NAME")]
    metric: Option<String>,
    /// Seed in place of the study's own
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Check the fit with recordings it has not seen: K parts, each held out once
    #[arg(long, value_name = "K", conflicts_with = "hold_out")]
    folds: Option<usize>,
    /// Check the fit with this share of the recordings, which it does not see
    #[arg(long, value_name = "FRACTION")]
    hold_out: Option<f64>,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    jobs: Jobs,
    /// Go on with an interrupted run
    #[arg(long, conflicts_with = "restart")]
    resume: bool,
    /// Throw old results in the folder away and start anew
    #[arg(long)]
    restart: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl StudyOptions {
    /// The study with its recordings read, its warnings printed.
    pub fn study(&self, points: Option<usize>) -> Result<Study> {
        let overrides = Overrides {
            metric: metric_option(self.metric.as_deref())?,
            points,
            seed: self.seed,
            set: self.values.parameter_set()?,
            split: match (self.folds, self.hold_out) {
                (Some(folds), _) => Some(Split::Folds(folds)),
                (None, Some(share)) => Some(Split::HoldOut(share)),
                (None, None) => None,
            },
            ..self.recordings.overrides()?
        };
        let study = read_study(&self.study, &overrides)?;
        terminal::print_warnings(study.warnings());
        let ranges = study.definition().grid.ranges().iter();
        let overruled = ranges
            .map(|range| range.parameter.name)
            .filter(|name| overrides.set.value(name).is_some())
            .map(|name| {
                Warning::new(
                    Code::NoEffect,
                    format!("{name} was set, but the study varies it: the study's range counts"),
                )
            });
        terminal::print_warnings(&overruled.collect::<Vec<_>>());
        Ok(study)
    }

    /// The folder that was asked for, or `results/<study>`, with `suffix` where that is not empty.
    pub fn folder(&self, study: &Study, suffix: &str) -> PathBuf {
        match &self.output {
            Some(folder) => folder.clone(),
            None => PathBuf::from("results").join(format!("{}{suffix}", study.definition().name)),
        }
    }

    pub fn mode(&self) -> Mode {
        match (self.resume, self.restart) {
            (true, _) => Mode::Resume,
            (_, true) => Mode::Restart,
            _ => Mode::Start,
        }
    }

    pub fn jobs(&self) -> usize {
        self.jobs.count()
    }

    /// Writes the folder and prints the answer of the command called `name`.
    pub fn finish(
        &self,
        name: &str,
        study: &Study,
        answer: &Answer,
        folder: &Path,
        wall_s: f64,
    ) -> Result<ExitCode> {
        let summary = results::write(folder, study, answer)?;
        terminal::print_warnings(
            summary
                .warnings
                .iter()
                .filter(|w| !study.warnings().contains(w)),
        );
        match self.format {
            Format::Json => terminal::print(terminal::json(&summary)?),
            Format::Table => print(&summary, folder, study, wall_s, self.jobs()),
        }
        if answer.ending == Ending::Interrupted {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} points; all of them are saved",
                summary.points, summary.points_total
            ))
            .at_file(folder)
            .hint(format!(
                "go on with: realgap {name} {} --resume (and the same options)",
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

fn print(summary: &Summary, folder: &Path, study: &Study, wall_s: f64, jobs: usize) {
    let mut lines = vec![format!(
        "{}: {} of {}, {}, {wall_s:.1} s on {}",
        summary.study,
        summary.points,
        counted(summary.points_total, "point"),
        counted(summary.recordings, "recording"),
        counted(jobs, "thread"),
    )];
    let unit = study.definition().metric.unit();
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
    if let Some(validation) = &summary.validation {
        lines.push(format!(
            "  held out ({}): {} where the fitted recordings have {} (difference {} +- {})",
            validation.split,
            quantity(validation.held_out_score, unit),
            quantity(validation.fit_score, unit),
            quantity(validation.held_out_score - validation.fit_score, unit),
            quantity(validation.difference_standard_error, unit),
        ));
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
    let verdicts = summary.verdicts.iter();
    lines.extend(verdicts.map(|verdict| format!("  {}", verdict.text)));
    if let Some(audit) = &summary.audit {
        lines.push(format!(
            "  half and double timestep and substeps change the score by up to {}",
            quantity(audit.largest_change, unit)
        ));
    }
    lines.push(format!(
        "  results in {}: summary.json, best.ron, points.csv and pictures",
        folder.display()
    ));
    terminal::print(lines.join("\n"));
}
