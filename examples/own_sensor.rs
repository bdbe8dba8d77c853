#![allow(clippy::print_stdout)]
//! A sensor of your own: one type that implements `RangeSensor`. It draws logs, and a Bayes filter believes it.
//!
//! `cargo run --example own_sensor`

use realgap::Result;
use realgap::random::Numbered;
use realgap::sensing::belief::Belief;
use realgap::sensing::range::{Beam, Characterisation, Options, RangeSensor, ReadingLog};

/// A whisker that bends: nothing beyond 8 cm, and the more the nearer something is.
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
    /// Now and then its wire breaks contact.
    fn dropout(&self, _: &Beam) -> f64 {
        0.02
    }
}

/// Prints what a log of it becomes, and what a filter believes of it.
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
