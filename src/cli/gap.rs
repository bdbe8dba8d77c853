//! `realgap gap`: the distance between simulation and reality in noise floors.

use realgap::calibration::{Overrides, Study, read_noise};
use realgap::comparison::{Components, DEFAULT_METRIC, Metric, TimeBase, by_name};
use realgap::plan::Work;
use realgap::prediction::gap::{FloorReport, GapOptions, Scoring, StudyGap, read_sets};
use realgap::report::PageData;
use realgap::results::{Kind, write_floor, write_gap};

use super::between::TwoSets;
use super::kit::*;
use super::option::{MOST_REPEATS, metric_option};
use super::page;
use super::timing::{TimeOption, TimeParser};

/// Measure how many noise floors the simulation is away from reality, and until when to trust it
///
/// Use it to judge a simulation with given values against repeats of real runs. The noise floor is the distance
/// between repeats of the same real run; the gap is the distance between simulation and reality; the gap ratio is the
/// gap divided by the noise floor. At a ratio of 1, the simulation is as far from the recordings as the recordings
/// are from each other. An energy test tells whether simulated and real runs have the same distribution. Where the study has noise, repeats under this noise give the probability, over time, that a real run
/// lies inside the predicted region. The folder gets gap.json, confidence.png, rmse.png and .svg; docs/results.md
/// explains them.
///
/// Without a study, the command prints the noise floor of the recordings alone, for each set of repeats: --group
/// names the column whose values are the sets, and the column `run` separates the repeats of a set.
///
/// With --between and --and, the command tells whether two sets of recorded runs move alike, without a simulator: did the floor
/// change? Whole runs are compared by an energy test that exchanges runs, so that each set needs four repeats of one experiment. The
/// answer is: they differ, no difference is found (and which one would be), or the runs cannot tell.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap gap sweeps/tripod_floor.ron --parameters results/tripod_floor/best.ron
  realgap gap --recordings 'runs.csv' --group condition
  realgap gap --between 'monday/*.csv' --and 'tuesday/*.csv'")]
pub struct Gap {
    /// The study, e.g. sweeps/tripod_floor.ron; without one, the noise floor of --recordings
    study: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    recordings: Recordings,
    /// Without a study: column of a long-format CSV whose values name the sets of repeats; the column `run` separates the repeats
    /// of a set [default: condition, where there is one]
    #[arg(long, value_name = "COLUMN", conflicts_with_all = ["study", "between"])]
    group: Option<String>,
    /// Without a study: compare the runs of a set at times since each start up to the end of the shortest run, or at equal fractions
    /// of their durations; repeats have no common clock, and a study always compares at times since each start [default: fraction]
    #[arg(long, value_name = "TIME", value_parser = TimeParser, conflicts_with_all = ["study", "between"])]
    time: Option<TimeOption>,
    #[command(flatten)]
    between: TwoSets,
    /// Metric, repeatable [default: the study's (or pca), rms and displacement]
    #[arg(long = "metric", value_name = "NAME")]
    metrics: Vec<String>,
    /// Noise from this file in place of the study's
    #[arg(long, value_name = "FILE", requires = "study")]
    noise: Option<PathBuf>,
    /// Number of repeats under noise, for each start
    #[arg(long, value_name = "N", default_value_t = 200, conflicts_with = "between", value_parser = clap::value_parser!(u32).range(1..=MOST_REPEATS))]
    repeats: u32,
    /// Seed of noise and permutations [default: the study's]
    #[arg(long, value_name = "SEED", requires = "study")]
    seed: Option<u64>,
    #[command(flatten)]
    page: PageOption,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results [default: results/<study>_gap; without a study and this option, nothing is written]
    #[arg(short, long, value_name = "DIR", conflicts_with = "between")]
    output: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

impl Gap {
    pub fn run(self) -> Result<()> {
        self.of_store(None)
    }

    /// As [`Gap::run`], with the runs that a store already holds.
    pub fn of_store(self, store: Option<&Path>) -> Result<()> {
        match &self.study {
            Some(study) => self.with_study(study, store),
            None if self.between.is_given() => self.two_sets(),
            None => self.recordings_alone(),
        }
    }

    /// Whether two sets of recorded runs move alike.
    fn two_sets(&self) -> Result<()> {
        if !self.values.parameter_set()?.is_empty() {
            return Err(
                Error::usage("nothing is simulated between two sets of runs")
                    .field("--set, --parameters")
                    .hint("leave the values out"),
            );
        }
        let overrides = self.recordings.overrides()?;
        if !overrides.recordings.is_empty() {
            return Err(
                Error::usage("the runs of two sets are named by --between and --and")
                    .field("recordings"),
            );
        }
        let scoring = self.scoring()?;
        let found = self
            .between
            .compare(&overrides, &scoring, &self.jobs.run())?;
        self.print
            .answer_above(&found.warnings, &found, || found.to_string())
    }

    /// How recordings without a study are compared.
    fn scoring(&self) -> Result<Scoring> {
        Ok(Scoring {
            metrics: self.metrics(by_name(DEFAULT_METRIC)?)?,
            components: Components::default(),
            body_length_m: None,
            channels: None,
            seed: 1,
        })
    }

    /// The work that can be divided into shards.
    pub fn work(&self) -> Result<Work> {
        let Some(study) = &self.study else {
            return Err(Error::usage(
                "without a study nothing is simulated, so there is no work for shards",
            ));
        };
        let (study, options) = self.read(study)?;
        Ok(Work::Gap(Box::new(study), options))
    }

    /// The metrics of `--metric`; without this option `first`, rms and displacement.
    fn metrics(&self, first: &'static dyn Metric) -> Result<Vec<&'static dyn Metric>> {
        let mut metrics: Vec<&'static dyn Metric> = Vec::new();
        let asked: Vec<&str> = if self.metrics.is_empty() {
            // The channels of a study are no metric of their own; between any two runs joints are compared.
            let first = match first.name() {
                "channels" => "joints",
                name => name,
            };
            vec![first, "rms", "displacement"]
        } else {
            self.metrics.iter().map(String::as_str).collect()
        };
        for name in asked {
            let metric = by_name(name).map_err(Error::into_usage)?;
            if !metrics.iter().any(|known| known.name() == metric.name()) {
                metrics.push(metric);
            }
        }
        Ok(metrics)
    }

    fn read(&self, path: &Path) -> Result<(Study, GapOptions)> {
        let overrides = Overrides {
            metric: metric_option(self.metrics.first().map(String::as_str))?,
            ..self.values.over(self.recordings.overrides()?)?
        };
        // This is checked before the study is read: an unknown metric is wrong usage even where the file is invalid, too.
        self.metrics(by_name(DEFAULT_METRIC)?)?;
        let study = read_study(path, &overrides)?;
        let definition = study.definition();
        let mut recordings = definition.recordings.iter();
        let has_joints = recordings.all(|r| !r.trajectory.joints().is_empty());
        let options = GapOptions {
            metrics: match definition.is_of_joints() && !has_joints {
                // Recordings of channels alone have nothing else to compare.
                true => vec![definition.metric],
                false => self.metrics(definition.metric)?,
            },
            noise: match &self.noise {
                Some(file) => Some(read_noise(file)?),
                None => definition.noise,
            },
            repeats: self.repeats as usize,
            seed: self.seed.unwrap_or(definition.seed),
        };
        Ok((study, options))
    }

    fn with_study(&self, path: &Path, store: Option<&Path>) -> Result<()> {
        let (study, options) = self.read(path)?;
        let definition = study.definition();
        let folder = self
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from("results").join(format!("{}_gap", definition.name)));
        let folder = ResultsFolder::take(&folder, Kind::Gap)?;
        let run = self.jobs.stoppable();
        let found = progress::during(0, "simulating", run, |run| match store {
            None => StudyGap::new(&study, &options, run),
            Some(store) => StudyGap::of_store(&study, &options, store, run),
        })?;
        folder.check()?;
        let results_page = write_gap(folder.path(), &found)?;
        let page_said = self
            .page
            .write(folder.path(), &results_page, || page::of_gap(&study));
        folder.write_timing(run.jobs)?;
        let pictures = if found.confidence.is_some() {
            "gap.json, rmse.png, confidence.png and .svg"
        } else {
            "gap.json, rmse.png and .svg"
        };
        self.print.answer_above(&found.warnings, &found, || {
            format!(
                "{found}\n  results in {}: {pictures}{}",
                folder.path().display(),
                page_said
            )
        })?;
        if !found.complete {
            return Err(Error::interrupted(
                "interrupted before the last repeat; the results so far are marked as incomplete",
            )
            .at_file(folder.path())
            .hint("run the command again; finished repeats come out the same"));
        }
        Ok(())
    }

    /// Whether runs are compared at times since each start.
    fn equal_times(&self) -> Result<bool> {
        match self.time.map(|time| time.0) {
            Some(TimeBase::Clock) => Err(Error::usage(
                "repeats of a run were recorded one after the other, so they have no common time by the clock",
            )
            .field("time")
            .found("clock")
            .allowed("start, fraction")),
            Some(TimeBase::Start) => Ok(true),
            Some(TimeBase::Fraction) | None => Ok(false),
        }
    }

    fn recordings_alone(&self) -> Result<()> {
        if !self.values.parameter_set()?.is_empty() {
            return Err(Error::usage("nothing is simulated without a study")
                .field("--set, --parameters")
                .hint("name the study: realgap gap STUDY --set ..."));
        }
        let scoring = self.scoring()?;
        let overrides = Overrides {
            equal_times: self.equal_times()?,
            ..self.recordings.overrides()?
        };
        let sets = read_sets(&overrides, self.group.as_deref())?;
        let run = self.jobs.run();
        let folder = self.output.as_deref();
        let folder = folder.map(|folder| ResultsFolder::take(folder, Kind::Gap));
        let folder = folder.transpose()?;
        let report = FloorReport::new(sets, &scoring, &run)?;
        for set in &report.sets {
            let named = set
                .floor
                .warnings
                .iter()
                .map(|w| w.code.warning(format!("{}: {}", set.set, w.message)));
            terminal::print_warnings(&named.collect::<Vec<_>>());
        }
        if let Some(folder) = &folder {
            folder.check()?;
            let results_page = write_floor(folder.path(), &report)?;
            self.page
                .write(folder.path(), &results_page, PageData::default);
            folder.write_timing(run.jobs)?;
        }
        self.print.value(&report)
    }
}
