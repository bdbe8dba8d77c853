//! `realgap ensemble`: repeats of a study's experiment under its noise.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;

use clap::Args;
use realgap::calibration::{Definition, Overrides, RepeatCase, StartRule, Study, read_noise};
use realgap::comparison;
use realgap::plot::{Side, TextTable, quantity};
use realgap::prediction::ensemble::{self, Coverage, Ensemble as Repeats, Forecast, Reality};
use realgap::results::{
    EnsembleResult, draw_repeats, remove_pictures, write_repeats, write_report,
};
use realgap::simulation::parameter::ParameterSet;
use realgap::simulation::{ENGINE_VERSION, Noise, Outcome, Sampling};
use realgap::trajectory::{self, Source};
use realgap::unit::Unit;
use realgap::warning::Code;
use realgap::{Error, Result, Warning};
use serde::Serialize;

use super::option::{Format, Jobs, Recordings, Values};
use super::{forecast, interrupt, progress, terminal};

/// Repeat a study's experiment under its noise: what will really happen, and how sure may we be?
///
/// The `noise` section of the study says how repeats differ. Printed are the distribution of the displacement, the
/// behaviours (groups of repeats that do the same) with their probabilities, and, where there are recordings, how
/// honest these confidences are. The folder gets ensemble.json, repeats.csv, ensemble.png and .svg. Where every
/// recording has its own start (`start: FromRecording`), there is one ensemble a recording; --limit-recordings
/// bounds the work.
#[derive(Debug, Args)]
pub struct Ensemble {
    /// The study, e.g. sweeps/tripod_floor.ron
    study: PathBuf,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    recordings: Recordings,
    /// Noise from this file in place of the study's
    #[arg(long, value_name = "FILE")]
    noise: Option<PathBuf>,
    /// Number of repeats
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=forecast::MOST_REPEATS))]
    repeats: u32,
    /// Seed of all draws [default: the study's]
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Simulate repeat K alone and write its motion to the file named with -o (.csv or .tum)
    #[arg(long, value_name = "K", requires = "output")]
    only: Option<u64>,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results [default: results/<study>_ensemble]; with --only, a file
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// At most so many recordings with a start of their own are drawn.
const PICTURES: usize = 12;

/// One ensemble of the report.
#[derive(Debug, Serialize)]
struct CaseReport {
    case: String,
    summary: Forecast,
    reality: Option<Reality>,
}

/// What is written and printed.
#[derive(Debug, Serialize)]
struct Report {
    study: String,
    morphology: String,
    complete: bool,
    parameters: BTreeMap<String, f64>,
    noise_from: String,
    engine: &'static str,
    version: &'static str,
    reality: Option<Reality>,
    cases: Vec<CaseReport>,
    warnings: Vec<Warning>,
}

/// A study made ready for repeats.
struct Ready {
    definition: Definition,
    cases: Vec<RepeatCase>,
    warnings: Vec<Warning>,
}

impl Ensemble {
    pub fn run(self) -> Result<ExitCode> {
        let ready = self.ready()?;
        let (noise, noise_from) = self.noise(&ready.definition)?;
        let seed = self.seed.unwrap_or(ready.definition.seed);
        terminal::print_warnings(&ready.warnings);
        if let (Some(number), Some(file)) = (self.only, &self.output) {
            return replay(&ready, &noise, seed, number, file);
        }
        let folder = self.output.clone().unwrap_or_else(|| {
            PathBuf::from("results").join(format!("{}_ensemble", ready.definition.name))
        });
        let stop = interrupt::stop_flag()?;
        let pool = self.jobs.pool()?;
        let total = ready.cases.len() * self.repeats as usize;
        let bar = progress::bar(total, "repeating");
        let mut ensembles: Vec<(&RepeatCase, Repeats)> = Vec::new();
        for case in &ready.cases {
            // A case that is not begun says nothing; the first at least says so itself.
            if stop.load(Ordering::Relaxed) && !ensembles.is_empty() {
                break;
            }
            let before = ensembles.len() * self.repeats as usize;
            let repeats = pool.install(|| {
                ensemble::run(
                    &case.experiment,
                    &noise,
                    seed,
                    self.repeats as usize,
                    stop,
                    |done| bar.set_position((before + done) as u64),
                )
            })?;
            ensembles.push((case, repeats));
        }
        bar.finish_and_clear();
        let report = pool.install(|| report(&ready, &ensembles, noise_from))?;
        write_report(&folder, "ensemble.json", &report)?;
        write(&folder, &ready, &ensembles, &report)?;
        terminal::print_warnings(
            report
                .warnings
                .iter()
                .filter(|w| !ready.warnings.contains(w)),
        );
        match self.format {
            Format::Json => terminal::print(terminal::json(&report)?),
            Format::Table => print(&report, &folder),
        }
        if !report.complete {
            let done: usize = report.cases.iter().map(|case| case.summary.repeats).sum();
            return Err(Error::interrupted(format!(
                "interrupted after {done} of {total} repeats; what there is is reported as incomplete"
            ))
            .at_file(&folder)
            .hint("run the command again; the same repeats come out the same"));
        }
        if report
            .cases
            .iter()
            .all(|case| case.summary.displacement_m.is_none())
        {
            return Err(Error::invalid("every repeat diverged")
                .at_file(&self.study)
                .hint("check the robot with `realgap simulate`, then a shorter timestep or more substeps"));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn ready(&self) -> Result<Ready> {
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            // Nothing is scored by the study's metric here, so none can refuse a recording.
            metric: Some(comparison::by_name("rms")?),
            ..self.recordings.overrides()?
        };
        let alone = Definition::read_without_recordings(&self.study, &overrides)?;
        if !(alone.recording_globs.is_empty() && overrides.recordings.is_empty()) {
            let study = Study::read(&self.study, &overrides)?;
            let cases = study.repeat_cases(&ParameterSet::new())?;
            return Ok(Ready {
                cases,
                warnings: study.warnings().to_vec(),
                definition: study.into_definition(),
            });
        }
        let Some(duration_s) = alone
            .duration_s
            .filter(|_| alone.start == StartRule::Settled)
        else {
            return Err(Error::invalid(
                "without recordings the study has to say itself where and how long the runs are",
            )
            .at_file(&self.study)
            .hint("add `duration_s` and `start: Settled` to the study, or name --recordings"));
        };
        let mut experiment = alone.experiment();
        experiment.duration_s = duration_s;
        experiment.sampling = Sampling::Rate(60.0);
        experiment.check().map_err(|e| e.at_file(&self.study))?;
        Ok(Ready {
            cases: vec![RepeatCase {
                name: alone.name.clone(),
                experiment,
                real: Vec::new(),
            }],
            warnings: vec![Warning::new(
                Code::NoRecordings,
                "the study names no recordings: nothing says whether these confidences are honest",
            )],
            definition: alone,
        })
    }

    fn noise(&self, definition: &Definition) -> Result<(Noise, String)> {
        if let Some(file) = &self.noise {
            return Ok((read_noise(file)?, file.display().to_string()));
        }
        let noise = definition.noise.ok_or_else(|| {
            Error::invalid("the study does not say how repeats differ, so all of them would be the same run")
                .at_file(&self.study)
                .field("noise")
                .found("no such section")
                .hint("add e.g. noise: (start_heading_rad: Normal(0.0175), friction_run_relative: LogNormal(0.05)), or name a --noise file")
        })?;
        Ok((noise, self.study.display().to_string()))
    }
}

fn replay(ready: &Ready, noise: &Noise, seed: u64, number: u64, file: &Path) -> Result<ExitCode> {
    let [case] = ready.cases.as_slice() else {
        return Err(Error::usage("which recording's repeat?")
            .field("--only")
            .found(format!(
                "{} recordings with a start each",
                ready.cases.len()
            ))
            .hint("name one with --recordings"));
    };
    trajectory::format_of(file)?;
    let run = ensemble::repeat(&case.experiment, noise, seed, number)?;
    terminal::print_warnings(&run.warnings);
    match run.outcome {
        Outcome::Completed(motion) => {
            terminal::print_warnings(&trajectory::write(file, &motion)?);
            let net_m = motion.net_displacement_world_m().xy().norm();
            terminal::print(format!(
                "repeat {number} of seed {seed}: net displacement {}, written to {}",
                quantity(net_m, Unit::Metre),
                file.display()
            ));
            Ok(ExitCode::SUCCESS)
        }
        Outcome::Diverged(divergence) => Err(Error::invalid(format!(
            "repeat {number} diverges {divergence}"
        ))),
    }
}

fn report(
    ready: &Ready,
    ensembles: &[(&RepeatCase, Repeats)],
    noise_from: String,
) -> Result<Report> {
    let mut cases = Vec::new();
    for (case, repeats) in ensembles {
        let summary = Forecast::new(repeats)?;
        let real: Vec<_> = case.real.iter().map(|(n, p)| (n.as_str(), p)).collect();
        let reality = summary
            .envelope
            .as_ref()
            .and_then(|envelope| Reality::new(repeats, envelope, &summary.behaviours, &real));
        cases.push(CaseReport {
            case: case.name.clone(),
            summary,
            reality,
        });
    }
    let parts: Vec<&Reality> = cases
        .iter()
        .filter_map(|case| case.reality.as_ref())
        .collect();
    let mut warnings = ready.warnings.clone();
    warnings.extend(cases.iter().flat_map(|case| case.summary.warnings.clone()));
    warnings.sort();
    warnings.dedup();
    let definition = &ready.definition;
    Ok(Report {
        study: definition.name.clone(),
        morphology: definition.morphology.name().to_owned(),
        complete: ensembles.len() == ready.cases.len()
            && ensembles.iter().all(|(_, repeats)| repeats.is_complete()),
        parameters: definition
            .set
            .iter()
            .map(|a| (a.parameter.name.to_owned(), a.value))
            .collect(),
        noise_from,
        engine: ENGINE_VERSION,
        version: env!("CARGO_PKG_VERSION"),
        reality: Reality::pooled(&parts),
        cases,
        warnings,
    })
}

fn write(
    folder: &Path,
    ready: &Ready,
    ensembles: &[(&RepeatCase, Repeats)],
    report: &Report,
) -> Result<()> {
    let real_label = Source::of(&ready.definition.recordings).reality_label();
    let results: Vec<(&str, EnsembleResult<'_>)> = ensembles
        .iter()
        .zip(&report.cases)
        .map(|((case, repeats), said)| {
            let result = EnsembleResult {
                ensemble: repeats,
                summary: &said.summary,
                reality: said.reality.as_ref(),
                real_paths_m: case.real.iter().map(|(_, p)| p.xy_m().to_vec()).collect(),
                real_label,
                title: format!("{}: repeats under noise", case.name),
            };
            (case.name.as_str(), result)
        })
        .collect();
    write_repeats(folder, &results)?;
    remove_pictures(folder, "ensemble")?;
    for (index, (_, result)) in results.iter().enumerate().take(PICTURES) {
        // The first has the name that is always there; more than one are numbered.
        let stem = match index {
            0 => "ensemble".to_owned(),
            _ => format!("ensemble_{index:03}"),
        };
        draw_repeats(folder, &stem, result)?;
    }
    Ok(())
}

fn print(report: &Report, folder: &Path) {
    let colour = terminal::stdout_wants_colour();
    let mut lines = Vec::new();
    // A hundred recordings would be a hundred tables; the pooled one says it.
    let shown = if report.cases.len() > 3 {
        0
    } else {
        report.cases.len()
    };
    for case in &report.cases[..shown] {
        lines.push(format!(
            "{}: {} repeats of {} s, {:.1} CPU s",
            case.case, case.summary.repeats, case.summary.duration_s, case.summary.cpu_s
        ));
        lines.extend(forecast::lines(&case.summary));
        lines.push(forecast::behaviours(
            &case.summary,
            case.reality.as_ref(),
            colour,
        ));
    }
    if shown == 0 {
        lines.push(format!(
            "{}: {} recordings with an ensemble of {} repeats each; one by one in ensemble.json",
            report.study,
            report.cases.len(),
            report.cases[0].summary.repeats
        ));
    }
    if let Some(reality) = &report.reality {
        let mut table = TextTable::new([
            ("region of", Side::Left),
            ("real runs, over time", Side::Right),
            ("at the end", Side::Right),
            ("95 % interval", Side::Right),
            ("honest", Side::Left),
        ]);
        for coverage in &reality.coverage {
            let end = &coverage.at_end;
            table.push([
                format!("{:.0} %", 100.0 * coverage.level),
                format!("{:.0} %", 100.0 * coverage.over_time),
                format!("{} of {}", end.count, end.trials),
                format!("{:.0} to {:.0} %", 100.0 * end.low, 100.0 * end.high),
                honesty(coverage).to_owned(),
            ]);
        }
        lines.push(table.render(colour).trim_end().to_owned());
        lines.push(format!(
            "  energy score {} (if reality were one more repeat: {})",
            quantity(reality.energy_score_m, Unit::Metre),
            quantity(reality.expected_energy_score_m, Unit::Metre)
        ));
    }
    lines.push(format!(
        "  results in {}: ensemble.json, repeats.csv, ensemble.png and .svg",
        folder.display()
    ));
    terminal::print(lines.join("\n"));
}

fn honesty(coverage: &Coverage) -> &'static str {
    if coverage.is_honest {
        "not contradicted"
    } else if coverage.at_end.share < coverage.level {
        "NO: region too narrow"
    } else {
        "NO: region too wide"
    }
}
