//! `realgap sense draw`: simulates readings of a range sensor.

use realgap::sensing::range::{DrawOptions, DrawnLog, find_sensor};

use crate::cli::kit::*;

/// Simulate readings of a range sensor and write them as a log: a stand-in for a real log, with known truth
///
/// Use it to test the analysis of a log where the true distances and the true model are known. The log can be given to
/// `realgap sense fit` and `realgap sense belief`. Distances are in the model's own unit.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense draw ultrasonic --readings 300 -o log.csv")]
pub struct Draw {
    /// A shipped sensor (ultrasonic, infrared, laser) or a model's .ron file
    sensor: String,
    /// Distances, in the model's unit [default: 21 over its range]
    #[arg(
        long,
        value_name = "D",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    distances: Vec<f64>,
    /// Readings at each distance
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    readings: u32,
    /// Angle of incidence, degrees
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    incidence: f64,
    /// Seed of the readings
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Number of sessions; each session reads all distances
    #[arg(long, value_name = "N", default_value_t = 1)]
    sessions: u32,
    /// Standard deviation of the offset that a session adds to all its readings, in the reading's unit [default: the model's]
    #[arg(long, value_name = "SD", requires = "sessions")]
    session_sd: Option<f64>,
    /// The log to write (.csv)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Draw {
    pub fn run(self) -> Result<()> {
        let options = DrawOptions {
            distances: self.distances,
            readings: self.readings,
            incidence_deg: self.incidence,
            sessions: self.sessions,
            seed: self.seed,
        };
        let mut sensor = find_sensor(&self.sensor)?;
        if let Some(sd) = self.session_sd {
            sensor.session_sd = sd;
            sensor.check().map_err(Error::into_usage)?;
        }
        let log = DrawnLog::new(&sensor, &options).map_err(Error::into_usage)?;
        output::write(&self.output, log.csv.as_bytes())?;
        terminal::print_warnings(&log.warnings);
        terminal::print(format!(
            "{} at {} in {}",
            counted(log.readings, "reading"),
            counted(log.distances, "distance"),
            self.output.display()
        ));
        Ok(())
    }
}
