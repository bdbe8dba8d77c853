//! `realgap predict`: the prediction card of any robot.

use realgap::calibration::read_noise;
use realgap::prediction::ensemble::{Draws, run_each};
use realgap::prediction::{Card, DivergenceRate, ModelError, SuccessRule, UncertainParameters};
use realgap::results::{Kind, write_prediction};
use realgap::simulation::{Noise, Sampling};

use super::kit::*;
use super::option::{MOST_REPEATS, ModelErrorOption};
use super::page;

/// Predict what a robot will do before it is built: how far, which behaviours, how likely
///
/// Use it for a robot without recordings; for a study with recordings use `realgap ensemble`. The command simulates
/// repeats of one run from rest under noise, and prints the prediction card: quantiles of the displacement,
/// behaviours with their probabilities, and the probability of success. -o writes prediction.json, repeats.csv and
/// pictures.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap predict morphologies/tripod.ron
  realgap predict robot.ron --set floor.friction=0.43 --success-m 0.5 -o card")]
pub struct Predict {
    /// The robot, e.g. morphologies/tripod.ron
    morphology: PathBuf,
    #[command(flatten)]
    values: Values,
    /// Length of each run, seconds
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = parse_seconds)]
    duration: f64,
    /// How repeats differ: a file with the fields of a study's `noise` section [default: a noise preset for robots without
    /// measurements, see docs/results.md]
    #[arg(long, value_name = "FILE")]
    noise: Option<PathBuf>,
    /// Number of repeats
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=MOST_REPEATS))]
    repeats: u32,
    /// Seed of all draws
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Net displacement that counts as success, metres [default: half of the net displacement without noise]
    #[arg(long, value_name = "M")]
    success_m: Option<f64>,
    #[command(flatten)]
    model: ModelErrorOption,
    #[command(flatten)]
    page: PageOption,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

impl Predict {
    pub fn run(self) -> Result<()> {
        let rule = match self.success_m {
            Some(least_m) if least_m.is_finite() && least_m > 0.0 => SuccessRule::AtLeast(least_m),
            Some(least_m) => {
                return Err(Error::usage("success must be a distance")
                    .field("--success-m")
                    .found(least_m)
                    .allowed("more than 0 m"));
            }
            None => SuccessRule::HalfOfNoiseFree,
        };
        let points = self.model.points()?;
        let morphology = read_morphology(&self.morphology)?;
        let fitted = self.values.fitted()?;
        let (values, uncertain) = (fitted.values, UncertainParameters::of_draws(&fitted.draws));
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = self.duration;
        experiment.sampling = Sampling::Rate(60.0);
        let mut warnings = morphology.warnings();
        let (experiment, without_effect) = self.values.apply(&experiment)?;
        warnings.extend(without_effect);
        experiment.check().map_err(Error::into_usage)?;
        let (noise, noise_from) = match &self.noise {
            Some(file) => (read_noise(file)?, file.display().to_string()),
            None => {
                warnings.push(Code::EstimatedNoise.warning(
                    "the noise is a default preset for robots without measurements; give your own with --noise",
                ));
                (Noise::unmeasured_robot(), "estimate".to_owned())
            }
        };
        let folder = self.output.as_deref();
        let folder = folder.map(|folder| ResultsFolder::take(folder, Kind::Prediction));
        let folder = folder.transpose()?;
        let (total, run) = (self.repeats as usize, self.jobs.stoppable());
        let repeats = progress::during(total, "repeating", run, |run| {
            let draws = Draws {
                noise: &noise,
                uncertain: &uncertain,
                seed: self.seed,
                repeats: total,
                recall: &|_| Ok(None),
            };
            run.install(|| run_each(&experiment, &draws, run))?
        })?;
        // The divergence rate needs two more runs, which are left out after an interruption.
        let growth = match repeats.is_complete() {
            true => DivergenceRate::of(&experiment)?,
            false => None,
        };
        let card = Card::new(morphology.name(), &repeats, rule)?;
        let model = points.map(|points| {
            let forecast = &card.prediction;
            ModelError::new(&experiment, &repeats, forecast, &points, &run)
        });
        let model = model.transpose()?.flatten();
        let card = card
            .with_model(&repeats, model)
            .with_parameters(&values)
            .with_noise_from(noise_from)
            .with_growth(growth)
            .with_warnings(warnings);
        let mut page_said = "";
        if let Some(folder) = &folder {
            folder.check()?;
            let results_page = write_prediction(folder.path(), &card, &repeats)?;
            page_said = self.page.write(folder.path(), &results_page, || {
                page::of_robot(&experiment, &morphology)
            });
            folder.write_timing(run.jobs)?;
        }
        self.print.answer(&card, || {
            let written = folder.as_ref().map(|folder| {
                format!(
                    "\n  results in {}: prediction.json, repeats.csv, prediction.png and .svg{}",
                    folder.path().display(),
                    page_said
                )
            });
            card.to_string() + &written.unwrap_or_default()
        })?;
        // The verdict stands above warnings.
        terminal::print_warnings(&card.warnings);
        if !repeats.is_complete() {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} repeats; the card covers only these",
                repeats.repeats.len(),
                repeats.asked
            )));
        }
        if card.prediction.displacement_m.is_none() {
            return Err(Error::invalid("every repeat diverged")
                .at_file(&self.morphology)
                .hint("check the robot with `realgap simulate`, then try a shorter timestep or more substeps"));
        }
        Ok(())
    }
}
