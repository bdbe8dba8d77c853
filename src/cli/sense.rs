//! `realgap sense`: a log of what a sensor's model reads.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use realgap::file::write_atomic;
use realgap::random::Numbered;
use realgap::sensing::range::{Beam, RangeSensor, ReadingUnit, find_sensor};
use realgap::unit::counted;
use realgap::{Error, Result, Warning};

use super::terminal;

/// Draw a log of readings from a range sensor's model: a stand-in for a real log, with known truth
///
/// The log can be given to `realgap characterise` and `realgap belief`. Distances are in the model's own unit.
#[derive(Debug, Args)]
pub struct Sense {
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
    /// The log to write (.csv)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Most rows of a log.
const MOST: usize = 5_000_000;

impl Sense {
    pub fn run(self) -> Result<ExitCode> {
        let sensor = find_sensor(&self.sensor)?;
        let distances: Vec<f64> = if self.distances.is_empty() {
            let (low, high) = sensor.range;
            (0..21)
                .map(|k| low + (high - low) * f64::from(k) / 20.0)
                .collect()
        } else {
            self.distances.clone()
        };
        if let Some(wrong) = distances.iter().find(|d| !(**d > 0.0 && d.is_finite())) {
            return Err(Error::usage("a distance must be above 0")
                .field("--distances")
                .found(wrong));
        }
        if distances.len() * self.readings as usize > MOST {
            return Err(
                Error::usage("too many readings for one log").allowed(format!("at most {MOST}"))
            );
        }
        let length = sensor.distance_unit.symbol();
        let reading = match (&sensor.reading_unit, sensor.reading_unit.symbol()) {
            (ReadingUnit::Own(_), "") => "reading".to_owned(),
            (_, symbol) => format!("reading_{symbol}"),
        };
        let mut text = format!("distance_{length},{reading},incidence_deg\n");
        let mut warnings: Vec<Warning> = Vec::new();
        let mut rows = 0;
        for (index, distance) in distances.iter().enumerate() {
            let beam = Beam {
                incidence_rad: self.incidence.to_radians(),
                ..Beam::straight(distance * sensor.distance_unit.metres())
            };
            warnings.extend(sensor.warning_at(beam.distance_m));
            let mut rng = Numbered::SensorReading.generator(self.seed, index as u64);
            for _ in 0..self.readings {
                let value = sensor
                    .draw(&beam, &mut rng)
                    .map_or(String::new(), |v| v.to_string());
                text += &format!("{distance},{value},{}\n", self.incidence);
                rows += 1;
            }
        }
        write_atomic(&self.output, text.as_bytes())?;
        terminal::print_warnings(&warnings);
        terminal::print(format!(
            "{} at {} in {}",
            counted(rows, "reading"),
            counted(distances.len(), "distance"),
            self.output.display()
        ));
        Ok(ExitCode::SUCCESS)
    }
}
