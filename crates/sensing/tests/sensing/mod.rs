//! Tests of range sensors: the contract of forms and models, recovery of known models, and errors for bad logs.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/validation/sensing.md"
)]

mod contract;
mod recovery;
mod refusal;
mod session;

use realgap_core::file::Source;
use realgap_core::random::Numbered;
use realgap_sensing::range::form::Form;
use realgap_sensing::range::{Beam, RangeModel, RangeSensor, ReadingLog};

/// A log of readings of a model at 21 evenly spaced distances.
fn log_of(sensor: &RangeModel, readings: usize, seed: u64) -> ReadingLog {
    let mut text = String::from("distance_cm,reading\n");
    let (low, high) = sensor.range;
    for index in 0..=20_u64 {
        let distance = low + (high - low) * index as f64 / 20.0;
        let beam = Beam::straight(0.01 * distance);
        let mut rng = Numbered::SensorReading.generator(seed, index);
        for _ in 0..readings {
            let value = sensor
                .draw(&beam, &mut rng)
                .map_or(String::new(), |v| v.to_string());
            text += &format!("{distance},{value}\n");
        }
    }
    ReadingLog::parse("log.csv", &text).unwrap()
}

fn model(mean: (&str, &[f64]), spread: (&str, &[f64]), more: &str) -> RangeModel {
    let curve = |(form, values): (&str, &[f64])| {
        let knots = if form == "table" {
            "knots: [1.0, 5.0, 12.0, 21.0], "
        } else {
            ""
        };
        format!("(form: \"{form}\", {knots}values: {values:?})")
    };
    let text = format!(
        "(distance_unit: \"cm\", reading_unit: Own(\"\"), range: (1.0, 21.0), mean: {}, spread: {}, {more})",
        curve(mean),
        curve(spread)
    );
    RangeModel::parse(&Source::new("model.ron", text)).unwrap()
}

/// Parameters for every form that make sense between 1 and 21.
fn example(form: &dyn Form) -> Vec<f64> {
    match form.name() {
        "linear" => vec![0.5, 0.9],
        "power" => vec![900.0, -1.1],
        "exponential" => vec![40.0, -0.12],
        "table" => vec![2.0, 9.0, 11.0, 30.0],
        other => panic!("an example for {other}"),
    }
}
