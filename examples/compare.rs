//! Compares two recordings by every metric that needs no basis. `cargo run --release --example compare`

#![allow(clippy::print_stdout)]

use realgap::Result;
use realgap::comparison::{Context, METRICS, Pair};
use realgap::trajectory::{prepare, read};
use realgap::unit::{LengthUnit, quantity};

/// Compares two recordings and prints one line for each metric.
pub fn main() -> Result<()> {
    let file = |run| format!("real_trajectories/tripod_mujoco/run_{run:02}.csv");
    let real = read(file(0), LengthUnit::Metre)?.trajectory;
    let other = read(file(1), LengthUnit::Metre)?.trajectory;
    let (real_prepared, simulated_prepared) = (&prepare(&real)?, &prepare(&other)?);
    let pair = Pair {
        real: &real,
        simulated: &other,
        real_prepared,
        simulated_prepared,
    };
    let context = Context {
        basis: None,
        spread: None,
        body_length_m: Some(0.06),
    };
    for metric in METRICS
        .iter()
        .filter(|metric| !metric.needs().basis && !metric.needs().spread)
        // These recordings have no joints.
        .filter(|metric| !metric.needs().joints)
    {
        let score = metric.compare(&pair, &context)?;
        println!(
            "{:<13} {}",
            metric.name(),
            quantity(score.value, score.unit)
        );
    }
    Ok(())
}
