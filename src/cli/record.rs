//! `realgap study record`: stand-in recordings from hidden parameters, with noise.

use realgap::calibration::{NoiseReport, StandIn};

use super::kit::*;

/// Make stand-in recordings: repeats of a simulation with start, servo and camera noise
///
/// Use it to test a calibration against known parameters where there are no real runs. `meta.ron` in the same folder
/// says that the recordings are stand-ins and how they were made.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap study record morphologies/tripod.ron -o recordings --repeats 10")]
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
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = parse_seconds)]
    duration: f64,
    /// Samples per second
    #[arg(long, alias = "rate", value_name = "HZ", default_value_t = 30.0)]
    rate_hz: f64,
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
    #[command(flatten)]
    print: Print,
}

impl Record {
    pub fn run(self) -> Result<()> {
        let stand_in = StandIn {
            repeats: self.repeats,
            duration_s: self.duration,
            rate_hz: self.rate_hz,
            values: self.values.parameter_set()?,
            seed: self.seed,
            noise: NoiseReport {
                start_position_m: self.start_position_noise,
                start_angle_rad: self.start_angle_noise,
                servo_zero_rad: self.servo_zero_noise,
                camera_m: self.camera_noise,
                camera_rad: self.camera_angle_noise,
                camera_s: self.camera_time_noise,
            },
        };
        let robot = read_morphology(&self.morphology)?;
        let total = self.repeats as usize;
        let report = progress::during(total, "recording", Default::default(), |run| {
            stand_in.record(&robot, &self.output, run)
        })?;
        terminal::print_warnings(&report.warnings);
        self.print.answer(&report, || {
            format!(
                "{} of {} in {}",
                counted(total, "stand-in recording"),
                report.morphology,
                self.output.display()
            )
        })
    }
}
