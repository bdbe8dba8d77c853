//! `realgap predict`: the prediction card of any robot.

use realgap::calibration::{CommandConsent, Overrides, read_noise};
use realgap::comparison;
use realgap::file::Source;
use realgap::prediction::ensemble::{Draws, run_each};
use realgap::prediction::{Card, DivergenceRate, ModelError, SuccessRule, UncertainParameters};
use realgap::report::PageData;
use realgap::results::{Kind, write_prediction};
use realgap::simulation::parameter::ParameterSet;
use realgap::simulation::{Noise, Sampling};

use super::consent::ConsentOption;
use super::ensemble::read_of_paths;
use super::kind::is_of_own_simulator;
use super::kit::*;
use super::option::{MOST_REPEATS, ModelErrorOption};
use super::page;

/// Length of a run where nothing else is said, seconds, and its samples per second.
const USUAL_S: f64 = 20.0;
const RATE_HZ: f64 = 60.0;

/// Predict what a robot will do before it is built: how far, which behaviours, how likely
///
/// Use it for a robot without recordings; for a study with recordings use `realgap ensemble`. The command simulates
/// repeats of one run from rest under noise, and prints the prediction card: quantiles of the displacement,
/// behaviours with their probabilities, and the probability of success. -o writes prediction.json, repeats.csv and
/// pictures. A study of your own simulator is predicted, too, as far as that answers with positions: its repeats differ
/// by the draws of a fit (--parameters FOLDER/best.ron) and by the simulator's own random numbers.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap predict morphologies/tripod.ron
  realgap predict morphologies/tripod.ron --arena arenas/step.ron
  realgap predict robot.ron --set floor.friction=0.43 --success-m 0.5 -o card
  realgap predict study.ron --parameters fit/best.ron --allow-command")]
pub struct Predict {
    /// The robot, e.g. morphologies/tripod.ron; or a study of your own simulator
    morphology: PathBuf,
    #[command(flatten)]
    values: Values,
    /// Length of each run, seconds [default: 20, or that of the study]
    #[arg(long, value_name = "S", value_parser = parse_seconds)]
    duration: Option<f64>,
    /// How repeats differ: a file with the fields of a study's `noise` section [default: a noise preset for robots without
    /// measurements, see docs/results.md]
    #[arg(long, value_name = "FILE")]
    noise: Option<PathBuf>,
    /// Predict among the walls and on the ground of this arena, from its start pose
    #[arg(long, value_name = "FILE")]
    arena: Option<PathBuf>,
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
    consent: ConsentOption,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

/// What is predicted.
struct Subject {
    name: String,
    experiment: Experiment,
    /// The robot; `None` for a simulator of the user's own.
    robot: Option<Morphology>,
    values: ParameterSet,
    uncertain: UncertainParameters,
    /// How repeats differ, and who says so.
    noise: (Noise, String),
    warnings: Vec<Warning>,
}

impl Predict {
    /// A robot, from rest.
    fn robot(&self) -> Result<Subject> {
        let morphology = read_morphology(&self.morphology)?;
        let fitted = self.values.fitted()?;
        let (values, uncertain) = (fitted.values, UncertainParameters::of_draws(&fitted.draws));
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = self.duration.unwrap_or(USUAL_S);
        experiment.sampling = Sampling::Rate(RATE_HZ);
        if let Some(path) = &self.arena {
            experiment.enter_arena(&Source::read(path, "arena")?)?;
        }
        let mut warnings = morphology.warnings();
        let (experiment, without_effect) = self.values.apply(&experiment)?;
        warnings.extend(without_effect);
        experiment.check().map_err(Error::into_usage)?;
        let noise = match &self.noise {
            Some(file) => (read_noise(file)?, file.display().to_string()),
            None => {
                warnings.push(Code::EstimatedNoise.warning(
                    "the noise is a default preset for robots without measurements; give your own with --noise",
                ));
                (Noise::unmeasured_robot(), "estimate".to_owned())
            }
        };
        Ok(Subject {
            name: morphology.name().to_owned(),
            experiment,
            robot: Some(morphology),
            values,
            uncertain,
            noise,
            warnings,
        })
    }

    /// A study of the user's own simulator: its run, without the recordings.
    fn simulator(&self) -> Result<Subject> {
        if let Some(path) = &self.arena {
            return Err(Error::usage("an arena is for robots of realgap")
                .field("--arena")
                .found(path.display())
                .allowed("none beside a simulator of your own"));
        }
        let overrides = Overrides {
            // Nothing is scored here.
            metric: Some(comparison::by_name("rms")?),
            command: self.consent.or(CommandConsent::Refused),
            ..self.values.over(Overrides::default())?
        };
        let study = read_of_paths(&self.morphology, &overrides)?;
        let file = |error: Error| error.at_file(&self.morphology);
        let [case] = study.cases.as_slice() else {
            return Err(file(
                Error::usage("every recording has its own start, and a prediction has one")
                    .found(counted(study.cases.len(), "recording"))
                    .hint("use `start: Settled`, or name one recording; `realgap ensemble` repeats all of them"),
            ));
        };
        let mut experiment = case.experiment.clone();
        if let Some(duration_s) = self.duration {
            experiment.duration_s = duration_s;
            experiment.sampling = Sampling::Rate(RATE_HZ);
        }
        let warnings = study.warnings.clone();
        let noise = match (&self.noise, study.definition.noise) {
            (Some(file), _) => (read_noise(file)?, file.display().to_string()),
            (None, Some(noise)) => (noise, self.morphology.display().to_string()),
            (None, None) => (Noise::default(), "none".to_owned()),
        };
        Ok(Subject {
            name: study.definition.name.clone(),
            experiment,
            robot: None,
            values: study.definition.set.clone(),
            uncertain: UncertainParameters::of_draws(&study.definition.draws),
            noise,
            warnings,
        })
    }

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
        let options = self.model.options()?;
        let Subject {
            name,
            experiment,
            robot,
            values,
            uncertain,
            noise,
            mut warnings,
        } = match is_of_own_simulator(&self.morphology) {
            true => self.simulator()?,
            false => self.robot()?,
        };
        let (noise, noise_from) = noise;
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
        let growth = match repeats.is_complete() && robot.is_some() {
            true => DivergenceRate::of(&experiment)?,
            false => None,
        };
        let card = Card::new(name, &repeats, rule)?;
        let model = options.map(|options| {
            let forecast = &card.prediction;
            progress::during(0, "simulating other models", run, |run| {
                ModelError::new(&experiment, &repeats, forecast, &options, run)
            })
        });
        let is_asked = model.is_some();
        let model = model.transpose()?.flatten();
        let is_cut_short = is_asked && model.is_none() && repeats.is_complete() && run.is_stopped();
        if is_cut_short {
            warnings.push(ModelError::unasked());
        }
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
            page_said = self
                .page
                .write(folder.path(), &results_page, || match &robot {
                    Some(robot) => page::of_robot(&experiment, robot),
                    None => PageData {
                        duration_s: experiment.duration_s,
                        ..PageData::default()
                    },
                });
            folder.write_timing(run.jobs)?;
        }
        self.print.answer_above(&card.warnings, &card, || {
            let written = folder.as_ref().map(|folder| {
                format!(
                    "\n  results in {}: prediction.json, repeats.csv, prediction.png and .svg{}",
                    folder.path().display(),
                    page_said
                )
            });
            card.to_string() + &written.unwrap_or_default()
        })?;
        if !repeats.is_complete() {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} repeats; the card covers only these",
                repeats.repeats.len(),
                repeats.asked
            )));
        }
        if is_cut_short {
            return Err(Error::interrupted(
                "interrupted before other models and engines had answered; all repeats are in the card",
            ));
        }
        if card.prediction.displacement_m.is_none() {
            return Err(Error::invalid("every repeat diverged")
                .at_file(&self.morphology)
                .hint("check the robot with `realgap simulate`, then try a shorter timestep or more substeps"));
        }
        Ok(())
    }
}
