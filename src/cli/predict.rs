//! `realgap predict`: the prediction card of any robot.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use realgap::calibration::read_noise;
use realgap::plot::quantity;
use realgap::prediction::ensemble::{self, Ensemble, Forecast};
use realgap::results::{
    EnsembleResult, draw_repeats, remove_pictures, write_repeats, write_report,
};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{ENGINE_VERSION, Experiment, Noise, Sampling};
use realgap::statistics::Proportion;
use realgap::unit::Unit;
use realgap::warning::Code;
use realgap::{Error, Result, Warning};
use serde::Serialize;

use super::option::{Format, Jobs, Values, recording_unused};
use super::{forecast, interrupt, progress, terminal};

/// A robot that gets less far than this share of its body length without noise goes nowhere.
const NOWHERE_BODY_LENGTHS: f64 = 0.1;

/// Say what a robot will do before anybody builds it: how far, which behaviours, how likely
///
/// Simulates repeats of one run from rest under noise and prints the prediction card: displacement quantiles,
/// behaviours with probabilities, the probability of success. -o writes prediction.json, repeats.csv and pictures.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Predict {
    /// The robot, e.g. morphologies/tripod.ron
    morphology: PathBuf,
    #[command(flatten)]
    values: Values,
    /// Length of each run, seconds
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    duration: f64,
    /// How repeats differ, a file as a study's `noise` section [default: a robot that nobody has measured, see docs/cli.md]
    #[arg(long, value_name = "FILE")]
    noise: Option<PathBuf>,
    /// Number of repeats
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=forecast::MOST_REPEATS))]
    repeats: u32,
    /// Seed of all draws
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Net displacement that counts as success, metres [default: half of the run without noise]
    #[arg(long, value_name = "M")]
    success_m: Option<f64>,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// How likely the robot gets far enough.
#[derive(Debug, Serialize)]
struct Success {
    least_displacement_m: f64,
    /// Who said so.
    rule: &'static str,
    probability: Proportion,
}

/// The card.
#[derive(Debug, Serialize)]
struct Card {
    morphology: String,
    parameters: BTreeMap<String, f64>,
    noise_from: String,
    engine: &'static str,
    version: &'static str,
    success: Option<Success>,
    prediction: Forecast,
    warnings: Vec<Warning>,
}

impl Predict {
    pub fn run(self) -> Result<ExitCode> {
        if let Some(least_m) = self.success_m
            && !(least_m.is_finite() && least_m > 0.0)
        {
            return Err(Error::usage("success must be a distance")
                .field("--success-m")
                .found(least_m)
                .allowed("more than 0 m"));
        }
        let morphology = Morphology::read(&self.morphology)?;
        let values = self.values.parameter_set()?;
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = self.duration;
        experiment.sampling = Sampling::Rate(60.0);
        let mut warnings = values.without_effect(&experiment);
        warnings.extend(recording_unused(&values));
        let experiment = values.apply(&experiment);
        experiment.check().map_err(Error::into_usage)?;
        let (noise, noise_from) = match &self.noise {
            Some(file) => (read_noise(file)?, file.display().to_string()),
            None => {
                warnings.push(Warning::new(
                    Code::EstimatedNoise,
                    "the noise is an estimate for a robot that nobody has measured; name your own with --noise",
                ));
                (Noise::unmeasured_robot(), "estimate".to_owned())
            }
        };
        let stop = interrupt::stop_flag()?;
        let pool = self.jobs.pool()?;
        let bar = progress::bar(self.repeats as usize, "repeating");
        let repeats = pool.install(|| {
            ensemble::run(
                &experiment,
                &noise,
                self.seed,
                self.repeats as usize,
                stop,
                |done| bar.set_position(done as u64),
            )
        });
        bar.finish_and_clear();
        let repeats = repeats?;
        let prediction = Forecast::new(&repeats)?;
        warnings.extend(prediction.warnings.iter().cloned());
        let success = self.success(&repeats, &mut warnings);
        let card = Card {
            morphology: morphology.name().to_owned(),
            parameters: values
                .iter()
                .map(|a| (a.parameter.name.to_owned(), a.value))
                .collect(),
            noise_from,
            engine: ENGINE_VERSION,
            version: env!("CARGO_PKG_VERSION"),
            success,
            prediction,
            warnings,
        };
        terminal::print_warnings(&card.warnings);
        if let Some(folder) = &self.output {
            write_report(folder, "prediction.json", &card)?;
            let result = EnsembleResult {
                ensemble: &repeats,
                summary: &card.prediction,
                reality: None,
                real_paths_m: Vec::new(),
                real_label: "reality",
                title: format!("{}: what it will do", card.morphology),
            };
            remove_pictures(folder, "prediction")?;
            draw_repeats(folder, "prediction", &result)?;
            write_repeats(folder, &[(&card.morphology, result)])?;
        }
        match self.format {
            Format::Json => terminal::print(terminal::json(&card)?),
            Format::Table => self.print(&card),
        }
        if !repeats.is_complete() {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} repeats; the card is of those",
                repeats.repeats.len(),
                repeats.asked
            )));
        }
        if card.prediction.displacement_m.is_none() {
            return Err(Error::invalid("every repeat diverged")
                .at_file(&self.morphology)
                .hint("check the robot with `realgap simulate`, then a shorter timestep or more substeps"));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn success(&self, repeats: &Ensemble, warnings: &mut Vec<Warning>) -> Option<Success> {
        let (least_displacement_m, rule) = match self.success_m {
            Some(least_m) => (least_m, "--success-m"),
            None => {
                let far_m = repeats
                    .noise_free
                    .get()
                    .map(|motion| motion.net_displacement_m())
                    .filter(|m| *m >= NOWHERE_BODY_LENGTHS * repeats.body_length_m);
                let Some(far_m) = far_m else {
                    warnings.push(Warning::new(
                        Code::NoSuccessRule,
                        "without noise the robot goes nowhere (or diverges), so half of that is no success; say what is with --success-m",
                    ));
                    return None;
                };
                (0.5 * far_m, "half of the run without noise")
            }
        };
        Some(Success {
            least_displacement_m,
            rule,
            probability: repeats.success(least_displacement_m),
        })
    }

    fn print(&self, card: &Card) {
        let prediction = &card.prediction;
        let mut lines = vec![format!(
            "{}: {} repeats of {} s under noise ({}), {:.1} CPU s",
            card.morphology,
            prediction.repeats,
            prediction.duration_s,
            card.noise_from,
            prediction.cpu_s
        )];
        if let Some(success) = &card.success {
            lines.push(format!(
                "  P(success)        {}: net displacement of at least {} ({})",
                forecast::percent(&success.probability),
                quantity(success.least_displacement_m, Unit::Metre),
                success.rule
            ));
        }
        lines.extend(forecast::lines(prediction));
        if let Some(speed) = &prediction.speed_m_s {
            lines.push(format!(
                "  speed             {:.1} mm/s, standard deviation {:.1} mm/s (net displacement per time)",
                1e3 * speed.mean,
                1e3 * speed.standard_deviation
            ));
        }
        lines.push(forecast::behaviours(
            prediction,
            None,
            terminal::stdout_wants_colour(),
        ));
        if let Some(folder) = &self.output {
            lines.push(format!(
                "  results in {}: prediction.json, repeats.csv, prediction.png and .svg",
                folder.display()
            ));
        }
        terminal::print(lines.join("\n"));
    }
}
