//! `realgap gap`: how many noise floors is the simulation away from reality, and until when may it be trusted?

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use realgap::calibration::{Overrides, read_noise};
use realgap::comparison::{Components, DEFAULT_METRIC, Metric, by_name};
use realgap::plot::{Side, TextTable, number, quantity};
use realgap::prediction::gap::{
    Estimate, GapOptions, NoiseFloor, Scoring, Side as GapSide, StudyGap, noise_floor, read_sets,
    study_gap,
};
use realgap::results::{draw_gap, write_report};
use realgap::trajectory::Source;
use realgap::unit::{Unit, counted};
use realgap::{Error, Result, Warning};
use serde::Serialize;

use super::kind::read_study;
use super::option::{Format, Jobs, Recordings, Values, metric_option};
use super::{forecast, interrupt, progress, terminal};

/// How many noise floors is the simulation away from reality, and until when may it be trusted?
///
/// The noise floor is the distance between repeats of the same real run; the gap is that between simulation and reality; the gap
/// ratio is one over the other, and 1 means indistinguishable. Where the study has noise, the repeats under it say how likely a
/// real run lies inside what was predicted, over time. The folder gets gap.json, confidence.png, rmse.png and .svg.
/// Without a study, the noise floor of the recordings alone: realgap gap --recordings 'runs.csv' --group condition
#[derive(Debug, Args)]
pub struct Gap {
    /// The study, e.g. sweeps/tripod_floor.ron; without one, the noise floor of --recordings
    study: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    recordings: Recordings,
    /// Without a study: column of a long-format CSV whose values are sets of repeats, told apart by the column `run`
    /// [default: condition, where there is one]
    #[arg(long, value_name = "COLUMN", conflicts_with = "study")]
    group: Option<String>,
    /// Metric, repeatable [default: the study's (or pca), rms and displacement]
    #[arg(long = "metric", value_name = "NAME")]
    metrics: Vec<String>,
    /// Noise from this file in place of the study's
    #[arg(long, value_name = "FILE", requires = "study")]
    noise: Option<PathBuf>,
    /// Number of repeats under noise of each start
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=forecast::MOST_REPEATS))]
    repeats: u32,
    /// Seed of noise and resamples [default: the study's, or 1]
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results [default: results/<study>_gap; without a study nothing is written unless named]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Noise floors of sets of recordings.
#[derive(Debug, Serialize)]
struct FloorReport {
    seed: u64,
    version: &'static str,
    sets: Vec<SetReport>,
}

#[derive(Debug, Serialize)]
struct SetReport {
    set: String,
    #[serde(flatten)]
    floor: NoiseFloor,
}

impl Gap {
    pub fn run(self) -> Result<ExitCode> {
        match &self.study {
            Some(study) => self.with_study(study),
            None => self.recordings_alone(),
        }
    }

    /// The metrics asked for, or `first` and two that everybody understands.
    fn metrics(&self, first: &'static dyn Metric) -> Result<Vec<&'static dyn Metric>> {
        let mut metrics: Vec<&'static dyn Metric> = Vec::new();
        let asked: Vec<&str> = if self.metrics.is_empty() {
            vec![first.name(), "rms", "displacement"]
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

    fn with_study(&self, path: &Path) -> Result<ExitCode> {
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            metric: metric_option(self.metrics.first().map(String::as_str))?,
            ..self.recordings.overrides()?
        };
        // Before the study is read: a wrong name is a wrong use, whatever the file says.
        self.metrics(by_name(DEFAULT_METRIC)?)?;
        let study = read_study(path, &overrides)?;
        let definition = study.definition();
        let options = GapOptions {
            metrics: self.metrics(definition.metric)?,
            noise: match &self.noise {
                Some(file) => Some(read_noise(file)?),
                None => definition.noise,
            },
            repeats: self.repeats as usize,
            seed: self.seed.unwrap_or(definition.seed),
        };
        let folder = self
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from("results").join(format!("{}_gap", definition.name)));
        let stop = interrupt::stop_flag()?;
        let bar = progress::bar(0, "simulating");
        let found = self.jobs.pool()?.install(|| {
            study_gap(&study, &options, stop, |done, total| {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
            })
        });
        bar.finish_and_clear();
        let found = found?;
        let real_label = Source::of(&definition.recordings).reality_label();
        write_report(&folder, "gap.json", &found)?;
        draw_gap(&folder, &found, real_label)?;
        terminal::print_warnings(&found.warnings);
        match self.format {
            Format::Json => terminal::print(terminal::json(&found)?),
            Format::Table => print(&found, &folder),
        }
        Ok(ExitCode::SUCCESS)
    }

    fn recordings_alone(&self) -> Result<ExitCode> {
        if !self.values.parameter_set()?.is_empty() {
            return Err(Error::usage("nothing is simulated without a study")
                .field("--set, --parameters")
                .hint("name the study: realgap gap STUDY --set ..."));
        }
        let seed = self.seed.unwrap_or(1);
        let scoring = Scoring {
            metrics: self.metrics(by_name(DEFAULT_METRIC)?)?,
            components: Components::default(),
            body_length_m: None,
            seed,
        };
        let sets = read_sets(&self.recordings.overrides()?, self.group.as_deref())?;
        let pool = self.jobs.pool()?;
        let mut reports = Vec::new();
        for set in sets {
            let mut floor = pool.install(|| noise_floor(&set.runs, &scoring))?;
            floor.warnings.extend(set.warnings);
            reports.push(SetReport {
                set: set.name,
                floor,
            });
        }
        if reports.iter().all(|report| report.floor.pairs == 0) {
            return Err(
                Error::invalid("there is no noise floor without repeats of the same run")
                    .field("recordings")
                    .found(counted(
                        reports.iter().map(|r| r.floor.recordings).sum(),
                        "recording",
                    ))
                    .allowed("two or more recordings in a set")
                    .hint("record the same run again, at least five times"),
            );
        }
        for report in &reports {
            let named = report
                .floor
                .warnings
                .iter()
                .map(|w| Warning::new(w.code, format!("{}: {}", report.set, w.message)));
            terminal::print_warnings(&named.collect::<Vec<_>>());
        }
        let report = FloorReport {
            seed,
            version: env!("CARGO_PKG_VERSION"),
            sets: reports,
        };
        if let Some(folder) = &self.output {
            write_report(folder, "gap.json", &report)?;
        }
        match self.format {
            Format::Json => terminal::print(terminal::json(&report)?),
            Format::Table => print_floors(&report, &scoring.metrics),
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// `3.1 cm (2.0 to 4.4)`.
fn estimate(estimate: &Estimate, unit: Unit) -> String {
    let value = quantity(estimate.value, unit);
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => {
            format!(
                "{value} ({} to {})",
                quantity(low, unit),
                quantity(high, unit)
            )
        }
        _ => value,
    }
}

fn print_floors(report: &FloorReport, metrics: &[&'static dyn Metric]) {
    let mut columns = vec![
        ("set".to_owned(), Side::Left),
        ("runs".to_owned(), Side::Right),
    ];
    columns.extend(
        metrics
            .iter()
            .map(|metric| (metric.name().to_owned(), Side::Right)),
    );
    let mut table = TextTable::new(columns);
    for set in &report.sets {
        let mut row = vec![set.set.clone(), set.floor.recordings.to_string()];
        for (index, metric) in metrics.iter().enumerate() {
            row.push(match set.floor.metrics.get(index) {
                Some(floor) => estimate(&floor.floor, metric.unit()),
                None => "-".to_owned(),
            });
        }
        table.push(row);
    }
    terminal::print(format!(
        "noise floor: mean distance between repeats (95 % interval over recordings)\n{}",
        table.render(terminal::stdout_wants_colour()).trim_end()
    ));
}

fn print(gap: &StudyGap, folder: &Path) {
    let mut table = TextTable::new([
        ("metric", Side::Left),
        ("noise floor", Side::Right),
        ("simulation", Side::Left),
        ("gap", Side::Right),
        ("gap ratio", Side::Right),
    ]);
    for row in &gap.metrics {
        let unit = by_name(row.metric).map_or(Unit::One, |metric| metric.unit());
        let floor = row.floor.map_or("-".to_owned(), |f| estimate(&f, unit));
        let mut push = |name: &str, floor: &str, what: &str, side: &Option<GapSide>| {
            if let Some(side) = side {
                table.push([
                    name.to_owned(),
                    floor.to_owned(),
                    what.to_owned(),
                    estimate(&side.gap, unit),
                    side.ratio
                        .map_or("-".to_owned(), |ratio| estimate(&ratio, Unit::One)),
                ]);
            }
        };
        push(row.metric, &floor, "without noise", &row.ideal);
        push("", "", "repeats, mean", &row.repeats);
    }
    let mut lines = vec![
        format!(
            "{}: {} of {}, {} under noise each (95 % intervals over recordings)",
            gap.study,
            counted(gap.recordings, "recording"),
            counted(gap.starts, "start"),
            counted(gap.repeats, "repeat")
        ),
        table
            .render(terminal::stdout_wants_colour())
            .trim_end()
            .to_owned(),
    ];
    if let Some(fitness) = &gap.displacement {
        lines.push(format!(
            "  displacement: real {}, repeats {}; drawn alike? p = {} (Mann-Whitney), {} (Kolmogorov-Smirnov)",
            quantity(fitness.real_mean_m, Unit::Metre),
            quantity(fitness.simulated_mean_m, Unit::Metre),
            number(fitness.mann_whitney.p_value),
            number(fitness.kolmogorov_smirnov.p_value)
        ));
    }
    if let Some(confidence) = &gap.confidence {
        let dropped = confidence.drop_in_words();
        lines.push(format!(
            "  confidence: {:.0} % of real runs inside the {:.0} % region, mean over time; {dropped}",
            100.0 * confidence.over_time,
            100.0 * confidence.level
        ));
    }
    let pictures = if gap.confidence.is_some() {
        "gap.json, rmse.png, confidence.png and .svg"
    } else {
        "gap.json, rmse.png and .svg"
    };
    lines.push(format!("  results in {}: {pictures}", folder.display()));
    terminal::print(lines.join("\n"));
}
