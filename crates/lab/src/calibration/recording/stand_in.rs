//! Stand-in recordings: repeats of a simulation with known truth, in place of real runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use realgap_core::{Advice, Error, Result, Warning};
use realgap_optimization::{Progress, RunOptions};
use realgap_path::trajectory::{self, Meta, Reading, Source};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{self as simulation, Camera, Distribution, Experiment, Noise, Sampling};
use realgap_store::FolderLock;
use serde::Serialize;

/// What is simulated as a stand-in for recordings, and how repeats differ.
#[derive(Debug, Clone, PartialEq)]
pub struct StandIn {
    /// Number of recordings.
    pub repeats: u64,
    /// Length of each, seconds.
    pub duration_s: f64,
    /// Samples in a second.
    pub rate_hz: f64,
    /// Hidden values of parameters.
    pub values: ParameterSet,
    /// Seed of the noise.
    pub seed: u64,
    /// Standard deviations of the noise.
    pub noise: NoiseReport,
}

/// The written recordings, and how they were made.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordReport {
    /// Name of the robot.
    pub morphology: String,
    /// What kind of recordings these are.
    pub source: Source,
    /// The files.
    pub recordings: Vec<PathBuf>,
    /// The metadata file, which says how they were made.
    pub meta: PathBuf,
    /// Time of each, seconds.
    pub duration_s: f64,
    /// Samples in a second.
    pub rate_hz: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Parameters that were set, by name.
    pub parameters: BTreeMap<&'static str, f64>,
    /// How the repeats differ.
    pub noise: NoiseReport,
    /// Engine and its version.
    pub engine: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Standard deviations of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseReport {
    /// Start position, each axis, metres.
    pub start_position_m: f64,
    /// Start orientation, radians.
    pub start_angle_rad: f64,
    /// Zero of each servo, radians.
    pub servo_zero_rad: f64,
    /// Position that the camera sees, metres.
    pub camera_m: f64,
    /// Orientation that the camera sees, radians.
    pub camera_rad: f64,
    /// Time of the camera, seconds.
    pub camera_s: f64,
}

impl NoiseReport {
    fn noise(&self) -> Result<Noise> {
        let noise = Noise {
            start_position_m: Distribution::Normal(self.start_position_m),
            start_height_m: Distribution::Normal(self.start_position_m),
            start_tilt_rad: Distribution::Normal(self.start_angle_rad),
            start_heading_rad: Distribution::Normal(self.start_angle_rad),
            servo_zero_rad: Distribution::Normal(self.servo_zero_rad),
            ..Noise::default()
        };
        noise.check()?;
        Ok(noise)
    }

    fn camera(&self) -> Result<Camera> {
        let camera = Camera {
            position_m: Distribution::Normal(self.camera_m),
            angle_rad: Distribution::Normal(self.camera_rad),
            time_s: Distribution::Normal(self.camera_s),
        };
        camera.check()?;
        Ok(camera)
    }
}

impl StandIn {
    /// Records a simulated robot into a folder, with a `meta.ron` that declares the recordings as stand-ins and says how they
    /// were made.
    ///
    /// # Errors
    /// Invalid noise, a folder that holds recordings already, a run that diverges, a full disk.
    pub fn record(
        &self,
        robot: &Morphology,
        folder: &Path,
        options: &RunOptions<'_>,
    ) -> Result<RecordReport> {
        let (noise, camera) = (self.noise.noise()?, self.noise.camera()?);
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = self.duration_s;
        experiment.sampling = Sampling::Rate(self.rate_hz);
        let warnings = self.values.without_effect(&experiment);
        let experiment = self.values.apply(&experiment);
        let lock = self.take(folder)?;
        let mut recordings = Vec::new();
        for repeat in 0..self.repeats {
            let run = simulation::run(&noise.perturb(&experiment, self.seed, repeat))?;
            let diverged = |d| Error::invalid(format!("repeat {repeat} diverged {d}"));
            let motion = match run.outcome {
                simulation::Outcome::Completed(motion) => motion,
                simulation::Outcome::Diverged(divergence) => return Err(diverged(divergence)),
            };
            let path = run_file(folder, repeat);
            lock.check()?;
            trajectory::write(&path, &camera.record(&motion, self.seed, repeat)?)?;
            recordings.push(path);
            if let Some(follow) = options.progress {
                follow(Progress {
                    done: recordings.len(),
                    total: self.repeats as usize,
                    best: None,
                    finishing: None,
                });
            }
        }
        trajectory::write_meta(folder, &self.meta(robot, experiment.engine_version()))?;
        let values = self.values.iter();
        Ok(RecordReport {
            morphology: robot.name().to_owned(),
            source: Source::StandIn,
            recordings,
            meta: folder.join(trajectory::META_FILE),
            duration_s: self.duration_s,
            rate_hz: self.rate_hz,
            seed: self.seed,
            parameters: values.map(|a| (a.parameter.name, a.value)).collect(),
            noise: self.noise,
            engine: experiment.engine_version(),
            version: env!("CARGO_PKG_VERSION"),
            warnings,
        })
    }

    /// Makes and locks the folder, unless it holds files that would be mixed up or replaced.
    fn take(&self, folder: &Path) -> Result<FolderLock> {
        if folder.join(trajectory::META_FILE).exists() {
            return Err(Error::conflict("the folder already holds recordings")
                .at_file(folder)
                .hint("name a new folder, or remove the old one: a mixture of two sets would carry the wrong meta.ron"));
        }
        let is_ours = FolderLock::was_used(folder);
        let lock = FolderLock::make(folder)?;
        let mut files = (0..self.repeats).map(|repeat| run_file(folder, repeat));
        match files.find(|path| !is_ours && path.exists()) {
            None => Ok(lock),
            Some(path) => Err(Error::conflict(
                "this file would be replaced, and nothing says that this program wrote it",
            )
            .at_file(path)
            .hint("move it away")
            .advise(Advice::OtherFolder)),
        }
    }

    fn meta(&self, robot: &Morphology, engine: &str) -> Meta {
        let noise = &self.noise;
        Meta {
            robot: robot.name().to_owned(),
            source: Source::StandIn,
            description: format!(
                "STAND-IN: simulated by realgap {} ({}), not recorded from hardware. {} repeats of {} s at {} Hz, seed {}, with {}. \
                 Noise (standard deviations): start {} m and {} rad, servo zero {} rad, camera {} m, {} rad and {} s.",
                env!("CARGO_PKG_VERSION"),
                engine,
                self.repeats,
                self.duration_s,
                self.rate_hz,
                self.seed,
                if self.values.is_empty() {
                    "default parameters".to_owned()
                } else {
                    self.values.to_string()
                },
                noise.start_position_m,
                noise.start_angle_rad,
                noise.servo_zero_rad,
                noise.camera_m,
                noise.camera_rad,
                noise.camera_s,
            ),
            frame: "world, z up; pose of the tracked module's centre".to_owned(),
            licence: "MIT OR Apache-2.0".to_owned(),
            reading: Reading::default(),
        }
    }
}

fn run_file(folder: &Path, repeat: u64) -> PathBuf {
    folder.join(format!("run_{repeat:02}.csv"))
}
