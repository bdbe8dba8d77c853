//! Options that `sweep` and `tune` share, and how both print their answer.

use realgap::calibration::{Answer, BasisRule, Overrides, ScoreRule, Split, Study};
use realgap::optimization::Ending;
use realgap::results::{self, Kind};

use super::kit::*;
use super::live::LiveOption;
use super::option::metric_option;
use super::page;

#[derive(Debug, Args)]
pub struct StudyOptions {
    /// The study, e.g. sweeps/tripod_floor.ron
    pub study: PathBuf,
    /// Folder for the results [default: results/<study>; for tune: results/<study>_<optimizer>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    page: PageOption,
    #[command(flatten)]
    pub live: LiveOption,
    #[command(flatten)]
    recordings: Recordings,
    /// Metric in place of the study's own
    #[arg(long, value_name = "NAME")]
    metric: Option<String>,
    /// Basis of the pca metric in place of the study's own: the basis.json of another results folder, which makes the scores of
    /// both comparable, or `recordings`, which fits the basis to the recordings alone
    #[arg(long, value_name = "FILE|recordings")]
    basis: Option<String>,
    /// Simulations that a score is the mean of, in place of the study's own: valid (16 equally valid timesteps, substeps, starts
    /// and engines), ensemble:N (N of these, under the study's noise; without :N 16), single (one run, which includes numerical
    /// scatter)
    #[arg(long, value_name = "RULE", value_parser = parse_score)]
    score: Option<ScoreRule>,
    /// Simulate and compare only the first S seconds of every run, so that small early errors do not dominate the rest
    #[arg(long, value_name = "S", value_parser = parse_seconds)]
    duration: Option<f64>,
    /// Seed in place of the study's own
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Check the fit by cross-validation: the recordings are split into K folds, each of which is held out once
    #[arg(long, value_name = "K", conflicts_with = "hold_out")]
    folds: Option<usize>,
    /// Check the fit on this share of the recordings, which is held out from the fit
    #[arg(long, value_name = "FRACTION")]
    hold_out: Option<f64>,
    /// Skip the runs that check the answer: the numerical audit, the test whether the model explains the recordings, and for
    /// gauss-newton the runs that check its posterior; the intervals may then be too narrow. --resume without this option makes up
    /// for it
    #[arg(long)]
    no_audit: bool,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    pub jobs: Jobs,
    #[command(flatten)]
    pub before: Before,
    #[command(flatten)]
    print: Print,
}

/// Number of repeats of `--score ensemble` without a number.
const REPEATS: usize = 16;

fn parse_score(text: &str) -> std::result::Result<ScoreRule, String> {
    match text.split_once(':') {
        None if text == "valid" => Ok(ScoreRule::Valid),
        None if text == "single" => Ok(ScoreRule::Single),
        None if text == "ensemble" => Ok(ScoreRule::Ensemble { repeats: REPEATS }),
        Some(("ensemble", repeats)) => match repeats.parse() {
            Ok(repeats) => Ok(ScoreRule::Ensemble { repeats }),
            Err(_) => Err(format!("{repeats} is not a number of repeats")),
        },
        _ => Err("allowed: valid, ensemble, ensemble:N, single".to_owned()),
    }
}

/// The rule for the basis that `--basis` names.
fn basis_rule(text: &str) -> Result<BasisRule> {
    match text {
        "recordings" => Ok(BasisRule::Recordings),
        file => BasisRule::read(file),
    }
}

impl StudyOptions {
    /// The study with its recordings read, its warnings printed.
    pub fn study(&self, points: Option<usize>) -> Result<Study> {
        self.live.check()?;
        let overrides = Overrides {
            metric: metric_option(self.metric.as_deref())?,
            basis: self.basis.as_deref().map(basis_rule).transpose()?,
            score: self.score,
            duration_s: self.duration,
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
                Code::NoEffect.warning(format!(
                    "{name} was set, but the study varies it: the study's range is used"
                ))
            });
        terminal::print_warnings(&overruled.collect::<Vec<_>>());
        Ok(match self.no_audit {
            true => study.unaudited(),
            false => study,
        })
    }

    /// Locks the folder of `--output`; without this option `results/<study>` followed by `suffix`.
    pub fn folder(&self, study: &Study, suffix: &str) -> Result<ResultsFolder> {
        let name = || format!("{}{suffix}", study.definition().name);
        let folder = match &self.output {
            Some(folder) => folder.clone(),
            None => PathBuf::from("results").join(name()),
        };
        ResultsFolder::take(&folder, Kind::Study)
    }

    /// Writes the folder and prints the answer of the command called `name`.
    pub fn finish(
        &self,
        name: &str,
        study: &Study,
        answer: &Answer,
        folder: &ResultsFolder,
        wall_s: f64,
    ) -> Result<()> {
        let results_page = results::write(folder.path(), study, answer)?;
        let page_said = self.page.write(folder.path(), &results_page, || {
            page::of_study(study, answer)
        });
        folder.write_timing(self.jobs.count())?;
        let folder = folder.path();
        let report = &answer.report;
        // The verdict has said that no parameters explain the recordings.
        let is_said =
            |w: &&Warning| w.code == Code::ModelContradicted || study.warnings().contains(w);
        let warnings = report.warnings.iter().filter(|w| !is_said(w));
        self.print.answer_above(warnings, report, || format!(
                "{answer}\n  {wall_s:.1} s on {}\n  results in {}: summary.json, best.ron, points.csv\n  pictures there: {}{}",
                counted(self.jobs.count(), "thread"),
                folder.display(),
                pictures(folder).join(", "),
                page_said
            ))?;
        if answer.ending == Ending::Interrupted {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} points; all of them are saved",
                report.points, report.points_total
            ))
            .at_file(folder)
            .hint(format!(
                "go on with: realgap {name} {} --resume (and the same options)",
                self.study.display()
            )));
        }
        if report.best.is_none() {
            return Err(Error::invalid("every point diverged, so there is no best one")
                .at_file(&self.study)
                .hint("check the robot with `realgap simulate`, then try a shorter timestep or more substeps"));
        }
        Ok(())
    }
}

/// Up to this many profile pictures are named; more are only counted.
const NAMED: usize = 6;

/// Names of the pictures in a folder.
fn pictures(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.ends_with(".png"))
        .collect();
    names.sort();
    let is_profile = |name: &String| name.starts_with("profile_");
    let profiles = names.iter().filter(|name| is_profile(name)).count();
    if profiles > NAMED {
        names.retain(|name| !is_profile(name));
        names.push(format!("{profiles} of profile_*.png"));
    }
    names
}
