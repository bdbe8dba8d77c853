#![allow(clippy::print_stdout)]
//! Shows how to write your own sensor: one type that implements `RangeSensor`. A log is drawn from it, and a Bayes filter uses it.
//!
//! `cargo run --example own_sensor`

use realgap::Result;
use realgap::random::Numbered;
use realgap::sensing::belief::Belief;
use realgap::sensing::range::{Beam, Characterisation, Options, RangeSensor, ReadingLog};

/// A whisker that bends: its range is 8 cm, and it bends more for nearer obstacles.
struct Whisker;

impl RangeSensor for Whisker {
    fn range_m(&self) -> (f64, f64) {
        (0.01, 0.08)
    }
    fn mean(&self, beam: &Beam) -> f64 {
        100.0 * (-beam.distance_m / 0.03).exp()
    }
    fn sd(&self, beam: &Beam) -> f64 {
        1.0 + 0.02 * self.mean(beam)
    }
    /// The wire of the whisker sometimes loses contact.
    fn dropout(&self, _: &Beam) -> f64 {
        0.02
    }
}

/// Prints the model that is fitted to a log of the sensor, and the estimate of a Bayes filter.
pub fn main() -> Result<()> {
    let mut rng = Numbered::SensorReading.generator(1, 0);
    let mut log = String::from("distance_cm,reading_bend\n");
    for distance_cm in 1..=8 {
        for _ in 0..200 {
            let reading = Whisker.draw(&Beam::straight(0.01 * f64::from(distance_cm)), &mut rng);
            let reading = reading.map_or(String::new(), |value| value.to_string());
            log += &format!("{distance_cm},{reading}\n");
        }
    }
    let found = Characterisation::new(
        &ReadingLog::parse("whisker.csv", &log)?,
        &Options::default(),
    )?;
    println!("{found}\n");

    let mut belief = Belief::uniform(0.01, 0.08, 141);
    for _ in 0..10 {
        if let Some(reading) = Whisker.draw(&Beam::straight(0.04), &mut rng) {
            belief.observe(&Whisker, reading);
        }
    }
    println!(
        "after ten readings at 4 cm: {:.2} cm ± {:.2} cm",
        100.0 * belief.mean_m(),
        100.0 * belief.sd_m()
    );
    Ok(())
}
