//! `realgap sense belief`: a Bayes filter estimates a distance from readings.

use realgap::results::draw_belief;
use realgap::sensing::belief::{BeliefOptions, BeliefReport};
use realgap::sensing::range::{ReadingLog, find_sensor};

use crate::cli::kit::*;

/// Estimate a distance from several readings of a range sensor with a Bayes filter
///
/// Use it to see how sure a robot can be of a distance, and whether a sensor's model gives the same certainty as the
/// real sensor.
///
/// A discrete Bayes filter (paper 000, algorithm 1) processes the readings of many trials: readings that are drawn
/// from the model, and readings of a real log (--log) at the same distances, in the log's order. The command prints
/// the mean standard deviation of the beliefs, how often the 90 % interval of a belief contains the true distance,
/// the common area of the two mean beliefs, and the estimate of a Kalman filter where the model's mean is linear.
/// Where a reading is impossible at every distance, the belief is reset to the uniform one.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense belief ultrasonic --distances 2,20 --log log.csv --plot out.png")]
pub struct Belief {
    /// A shipped sensor (ultrasonic, infrared) or a model's .ron file
    sensor: String,
    /// A real log of readings at known distances, as for `realgap sense fit`
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// True distances, in the model's unit [default: near both ends of its range]
    #[arg(long, value_name = "D", value_delimiter = ',')]
    distances: Vec<f64>,
    /// Number of trials
    #[arg(long, value_name = "N", default_value_t = 200)]
    trials: usize,
    /// Readings per trial
    #[arg(long, value_name = "N", default_value_t = 10)]
    readings: usize,
    /// Grid cells over the sensor's range
    #[arg(long, value_name = "N", default_value_t = 401)]
    cells: usize,
    /// Distance by which the robot approaches between two readings, in the model's unit
    #[arg(
        long,
        value_name = "D",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    approach: f64,
    /// Standard deviation of --approach, in the model's unit
    #[arg(long, value_name = "D", default_value_t = 0.0)]
    approach_sd: f64,
    /// Seed of the simulated readings
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Draw the beliefs, one row a distance, into this .png or .svg (as figures 5 and 6 of paper 000)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

impl Belief {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_pictures(&self.plot)?;
        let sensor = find_sensor(&self.sensor)?;
        let log = self.log.as_ref().map(ReadingLog::read).transpose()?;
        let (low, high) = sensor.range;
        let distances = if self.distances.is_empty() {
            vec![low + 0.05 * (high - low), high - 0.05 * (high - low)]
        } else {
            self.distances.clone()
        };
        let options = BeliefOptions {
            distances,
            trials: self.trials,
            readings: self.readings,
            cells: self.cells,
            approach: self.approach,
            approach_sd: self.approach_sd,
            seed: self.seed,
        };
        let found =
            BeliefReport::new(&sensor, log.as_ref(), &options).map_err(Error::into_usage)?;
        terminal::print_warnings(&found.warnings);
        if let Some(plot) = &self.plot {
            draw_belief(&found, plot)?;
        }
        let name = Path::new(&self.sensor);
        self.telling.value("belief", name, &found, &self.plot, &[])
    }
}
