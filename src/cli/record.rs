//! `realgap record`: stand-in recordings from hidden parameters, with noise.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use realgap::simulation::{self, Camera, Distribution, Experiment, Noise, Outcome, Sampling};
use realgap::store::FolderLock;
use realgap::trajectory::{self, Meta, Reading, Source};
use realgap::unit::counted;
use realgap::{Advice, Error, Result, Warning};
use serde::Serialize;

use super::kind::read_morphology;
use super::option::{Format, Values};
use super::terminal;

/// Make stand-in recordings: repeats of a simulation with start, servo and camera noise
///
/// They take the place of real runs where there are none, so that a calibration can be tested on known
/// truth. `meta.ron` beside them says that they are stand-ins and how they were made.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Record {
    /// The robot
    morphology: PathBuf,
    /// Folder for the recordings
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Number of recordings
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    repeats: u64,
    /// Length of each, seconds
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    duration: f64,
    /// Samples per second
    #[arg(long, value_name = "HZ", default_value_t = 30.0)]
    rate: f64,
    #[command(flatten)]
    values: Values,
    /// Seed of the noise
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Start position error, standard deviation in metres
    #[arg(long, value_name = "M", default_value_t = 0.001)]
    start_position_noise: f64,
    /// Start tilt and heading error, standard deviation in radians
    #[arg(long, value_name = "RAD", default_value_t = 0.0175)]
    start_angle_noise: f64,
    /// Servo zero error, standard deviation in radians
    #[arg(long, value_name = "RAD", default_value_t = 0.00436)]
    servo_zero_noise: f64,
    /// Camera position error, standard deviation in metres
    #[arg(long, value_name = "M", default_value_t = 0.001)]
    camera_noise: f64,
    /// Camera orientation error, standard deviation in radians
    #[arg(long, value_name = "RAD", default_value_t = 0.005)]
    camera_angle_noise: f64,
    /// Camera time error, standard deviation in seconds
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    camera_time_noise: f64,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What was written.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordReport {
    /// Name of the robot.
    morphology: String,
    /// What the recordings are.
    source: Source,
    /// The files.
    recordings: Vec<PathBuf>,
    /// The file that says what they are.
    meta: PathBuf,
    /// Time of each, seconds.
    duration_s: f64,
    /// Samples in a second.
    rate_hz: f64,
    /// What the noise was drawn from.
    seed: u64,
    /// Parameters that were set, by name.
    parameters: BTreeMap<&'static str, f64>,
    /// How the repeats differ.
    noise: NoiseReport,
    /// Engine and its version.
    engine: &'static str,
    /// Version of the program.
    version: &'static str,
    /// What the reader should know.
    warnings: Vec<Warning>,
}

/// Standard deviations.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct NoiseReport {
    /// Start position, each axis, metres.
    start_position_m: f64,
    /// Start orientation, radians.
    start_angle_rad: f64,
    /// Zero of each servo, radians.
    servo_zero_rad: f64,
    /// Position that the camera sees, metres.
    camera_m: f64,
    /// Orientation that the camera sees, radians.
    camera_rad: f64,
    /// Time of the camera, seconds.
    camera_s: f64,
}

impl Record {
    fn run_file(&self, repeat: u64) -> PathBuf {
        self.output.join(format!("run_{repeat:02}.csv"))
    }

    pub fn run(self) -> Result<ExitCode> {
        let noise = Noise {
            start_position_m: Distribution::Normal(self.start_position_noise),
            start_height_m: Distribution::Normal(self.start_position_noise),
            start_tilt_rad: Distribution::Normal(self.start_angle_noise),
            start_heading_rad: Distribution::Normal(self.start_angle_noise),
            servo_zero_rad: Distribution::Normal(self.servo_zero_noise),
            ..Noise::default()
        };
        let camera = Camera {
            position_m: Distribution::Normal(self.camera_noise),
            angle_rad: Distribution::Normal(self.camera_angle_noise),
            time_s: Distribution::Normal(self.camera_time_noise),
        };
        noise.check()?;
        camera.check()?;
        let morphology = read_morphology(&self.morphology)?;
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = self.duration;
        experiment.sampling = Sampling::Rate(self.rate);
        let values = self.values.parameter_set()?;
        let warnings = values.without_effect(&experiment);
        terminal::print_warnings(&warnings);
        let experiment = values.apply(&experiment);
        let old = self.output.join(trajectory::META_FILE);
        if old.exists() {
            return Err(Error::conflict("the folder already holds recordings")
                .at_file(&self.output)
                .hint("name a new folder, or remove the old one: a mixture of two sets would carry the wrong meta.ron"));
        }
        let is_ours = FolderLock::was_in(&self.output);
        let lock = FolderLock::make(&self.output)?;
        for repeat in 0..self.repeats {
            let path = self.run_file(repeat);
            if !is_ours && path.exists() {
                return Err(Error::conflict(
                    "this file would be replaced, and nothing says that this program wrote it",
                )
                .at_file(path)
                .hint("move it away")
                .advise(Advice::OtherFolder));
            }
        }
        let mut written = Vec::new();
        let bar = super::progress::bar(self.repeats as usize, "recording");
        for repeat in 0..self.repeats {
            let run = simulation::run(&noise.perturb(&experiment, self.seed, repeat))?;
            let motion = match run.outcome {
                Outcome::Completed(motion) => motion,
                Outcome::Diverged(divergence) => {
                    return Err(Error::invalid(format!(
                        "repeat {repeat} diverged {divergence}"
                    )));
                }
            };
            let path = self.run_file(repeat);
            lock.check()?;
            trajectory::write(&path, &camera.record(&motion, self.seed, repeat)?)?;
            written.push(path);
            bar.inc(1);
        }
        bar.finish_and_clear();
        let meta = Meta {
            robot: morphology.name().to_owned(),
            source: Source::StandIn,
            description: format!(
                "STAND-IN: simulated by realgap {} ({}), not recorded from hardware. {} repeats of {} s at {} Hz, seed {}, with {}. \
                 Noise (standard deviations): start {} m and {} rad, servo zero {} rad, camera {} m, {} rad and {} s.",
                env!("CARGO_PKG_VERSION"),
                simulation::ENGINE_VERSION,
                self.repeats,
                self.duration,
                self.rate,
                self.seed,
                if values.is_empty() {
                    "default parameters".to_owned()
                } else {
                    values.to_string()
                },
                self.start_position_noise,
                self.start_angle_noise,
                self.servo_zero_noise,
                self.camera_noise,
                self.camera_angle_noise,
                self.camera_time_noise,
            ),
            frame: "world, z up; pose of the tracked module's centre".to_owned(),
            licence: "MIT OR Apache-2.0".to_owned(),
            reading: Reading::default(),
        };
        trajectory::write_meta(&self.output, &meta)?;
        match self.format {
            Format::Json => terminal::print_answer(&RecordReport {
                morphology: morphology.name().to_owned(),
                source: Source::StandIn,
                recordings: written,
                meta: old,
                duration_s: self.duration,
                rate_hz: self.rate,
                seed: self.seed,
                parameters: values.iter().map(|a| (a.parameter.name, a.value)).collect(),
                noise: NoiseReport {
                    start_position_m: self.start_position_noise,
                    start_angle_rad: self.start_angle_noise,
                    servo_zero_rad: self.servo_zero_noise,
                    camera_m: self.camera_noise,
                    camera_rad: self.camera_angle_noise,
                    camera_s: self.camera_time_noise,
                },
                engine: simulation::ENGINE_VERSION,
                version: env!("CARGO_PKG_VERSION"),
                warnings,
            })?,
            Format::Table => terminal::print(format!(
                "{} of {} in {}",
                counted(written.len(), "stand-in recording"),
                morphology.name(),
                self.output.display()
            )),
        }
        Ok(ExitCode::SUCCESS)
    }
}
