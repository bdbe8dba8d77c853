//! `realgap ensemble`: repeats of a study's experiment under its noise.

use realgap::calibration::{Overrides, Repeatable, read_noise};
use realgap::comparison;
use realgap::plan::Work;
use realgap::prediction::{EnsembleOptions, EnsembleReport};
use realgap::results::{Kind, write_ensemble};
use realgap::simulation::Outcome;
use realgap::trajectory;

use super::kind::{read_definition, read_repeatable};
use super::kit::*;
use super::option::{MOST_REPEATS, ModelErrorOption};
use super::page;

/// Repeat a study's experiment under its noise, and print how the outcomes are distributed
///
/// Use it after a sweep or a tuning, to predict further real runs and to test these predictions against recordings.
/// The `noise` section of the study says how repeats differ. The command prints the distribution of the displacement,
/// the behaviours (groups of repeats that do the same) with their probabilities, and, where there are recordings,
/// whether they contradict these probabilities. The folder gets ensemble.json, repeats.csv, ensemble.png and .svg;
/// docs/results.md explains them. Repeat K is the same for every value of --repeats. Where every recording has its
/// own start (`start: FromRecording`), every recording has its own ensemble; --limit-recordings bounds the work.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap ensemble sweeps/tripod_floor.ron --parameters best.ron --repeats 200
  realgap ensemble sweeps/tripod_floor.ron --only 17 -o run.csv")]
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
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=MOST_REPEATS))]
    repeats: u32,
    /// Seed of all draws [default: the study's]
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Simulate repeat K alone and write its motion to the file named with -o (.csv or .tum)
    #[arg(long, value_name = "K", requires = "output")]
    only: Option<u64>,
    #[command(flatten)]
    page: PageOption,
    #[command(flatten)]
    model: ModelErrorOption,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results [default: results/<study>_ensemble]; with --only, a file
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

impl Ensemble {
    pub fn run(self) -> Result<()> {
        self.of_store(None)
    }

    /// The work that can be divided into shards.
    pub fn work(&self) -> Result<Work> {
        if self.only.is_some() {
            return Err(
                Error::usage("a single repeat cannot be divided into shards").field("--only"),
            );
        }
        let (study, options) = self.read()?;
        Ok(Work::Ensemble(Box::new(study), options))
    }

    fn read(&self) -> Result<(Repeatable, EnsembleOptions)> {
        let overrides = Overrides {
            // The study's metric scores nothing here, so it must not reject a recording: rms accepts every path.
            metric: Some(comparison::by_name("rms")?),
            ..self.values.over(self.recordings.overrides()?)?
        };
        let study = read_of_paths(&self.study, &overrides)?;
        let (noise, noise_from) = match &self.noise {
            Some(file) => (read_noise(file)?, file),
            // Repeats may differ by the draws of a fit, or by the random numbers of the user's own simulator.
            None if !study.definition.draws.is_empty()
                || study.definition.own_simulator.is_some() =>
            {
                (study.definition.noise.unwrap_or_default(), &self.study)
            }
            None => (study.noise()?, &self.study),
        };
        let options = EnsembleOptions {
            noise,
            noise_from: noise_from.display().to_string(),
            repeats: self.repeats as usize,
            seed: self.seed.unwrap_or(study.definition.seed),
            model: self.model.options()?,
        };
        Ok((study, options))
    }

    /// As [`Ensemble::run`], with the repeats that a store already holds.
    pub fn of_store(self, store: Option<&Path>) -> Result<()> {
        let (study, options) = self.read()?;
        terminal::print_warnings(&study.warnings);
        if let (Some(number), Some(file)) = (self.only, &self.output) {
            return replay(&study, &options, number, file);
        }
        let folder = self.output.clone().unwrap_or_else(|| {
            PathBuf::from("results").join(format!("{}_ensemble", study.definition.name))
        });
        let folder = ResultsFolder::take(&folder, Kind::Ensemble)?;
        let total = study.cases.len() * options.repeats;
        let run = self.jobs.stoppable();
        let report = progress::during(total, "repeating", run, |run| match store {
            None => EnsembleReport::new(&study, &options, run),
            Some(store) => EnsembleReport::of_store(&study, &options, store, run),
        })?;
        folder.check()?;
        let results_page = write_ensemble(folder.path(), &report)?;
        let page_said = self
            .page
            .write(folder.path(), &results_page, || page::of_repeats(&study));
        folder.write_timing(run.jobs)?;
        let warnings = report
            .warnings
            .iter()
            .filter(|w| !study.warnings.contains(w));
        self.print.answer_above(warnings, &report, || {
            format!(
                "{report}\n  results in {}: ensemble.json, repeats.csv, ensemble.png and .svg{}",
                folder.path().display(),
                page_said
            )
        })?;
        if !report.complete && report.repeats() == total {
            return Err(Error::interrupted(
                "interrupted before other models and engines had answered; all repeats are in the results",
            )
            .at_file(folder.path()));
        }
        if !report.complete {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {total} repeats; the results so far are marked as incomplete",
                report.repeats()
            ))
            .at_file(folder.path())
            .hint("run the command again; finished repeats come out the same"));
        }
        if report.is_lost() {
            return Err(Error::invalid("every repeat diverged")
                .at_file(&self.study)
                .hint("check the robot with `realgap simulate`, then try a shorter timestep or more substeps"));
        }
        Ok(())
    }
}

/// Reads a study for repeats, whose paths are judged.
pub fn read_of_paths(path: &Path, overrides: &Overrides) -> Result<Repeatable> {
    let study = read_repeatable(path, overrides).map_err(|error| {
        let own = Overrides {
            metric: None,
            ..overrides.clone()
        };
        match read_definition(path, &own) {
            Ok(definition) if definition.is_of_joints() => {
                Error::invalid("repeats are judged by their paths, and no recording has one")
                    .at_file(path)
                    .found("joints or channels alone")
                    .allowed("recordings with x_m and y_m")
                    .hint("`realgap gap` compares joints and channels")
            }
            _ => error,
        }
    })?;
    let mut cases = study.cases.iter();
    if cases.any(|case| case.experiment.assembly.body_length_m <= 0.0) {
        return Err(Error::invalid(
            "what repeats do is told apart by the body's length, and the simulator states none",
        )
        .at_file(path)
        .allowed("`body_length_m` in its answer to hello, more than 0 (docs/simulator.md)"));
    }
    Ok(study)
}

/// Simulates one repeat alone and writes its motion.
fn replay(study: &Repeatable, options: &EnsembleOptions, number: u64, file: &Path) -> Result<()> {
    let [_] = study.cases.as_slice() else {
        return Err(Error::usage(
            "every recording has its own start, so --only needs one recording",
        )
        .field("--only")
        .found(format!(
            "{} recordings with a start each",
            study.cases.len()
        ))
        .hint("name one with --recordings"));
    };
    trajectory::check_output(file)?;
    output::check(file)?;
    let run = EnsembleReport::run(study, options, 0, number)?;
    terminal::print_warnings(&run.warnings);
    match run.outcome {
        Outcome::Completed(motion) => {
            terminal::print_warnings(&trajectory::write(file, &motion)?);
            let net_m = motion.net_displacement_world_m().xy().norm();
            terminal::print(format!(
                "repeat {number} of seed {}: net displacement {}, written to {}",
                options.seed,
                quantity(net_m, Unit::Metre),
                file.display()
            ));
            Ok(())
        }
        Outcome::Diverged(divergence) => Err(Error::invalid(format!(
            "repeat {number} diverges {divergence}"
        ))),
    }
}
