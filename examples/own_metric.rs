#![allow(clippy::print_stdout)]
//! A metric of your own: one type that implements `Metric`.
//!
//! `cargo run --example own_metric`

use realgap::comparison::{Context, Measurement, Metric, Needs, Pair};
use realgap::trajectory::{Trajectory, prepare};
use realgap::unit::Unit;
use realgap::{Error, Result};

/// Difference of the highest points of the two paths above the straight line from start to end.
struct Bulge;

impl Metric for Bulge {
    fn name(&self) -> &'static str {
        "bulge"
    }
    fn column(&self) -> &'static str {
        "bulge_error_m"
    }
    fn unit(&self) -> Unit {
        Unit::Metre
    }
    fn doc(&self) -> &'static str {
        "difference of how far the paths bulge to the left of their net displacement"
    }
    fn needs(&self) -> Needs {
        Needs::POINTS
    }
    fn measure(&self, pair: &Pair<'_>, _context: &Context<'_>) -> Result<Measurement> {
        // Prepared paths run along +x, so y is the distance from the straight line.
        let bulge = |path: &[[f64; 2]]| path.iter().map(|p| p[1]).fold(0.0, f64::max);
        let (real, simulated) = (
            bulge(pair.real_prepared.xy_m()),
            bulge(pair.simulated_prepared.xy_m()),
        );
        Ok(Measurement::new(
            (real - simulated).abs(),
            pair.real_prepared.xy_m().len(),
        ))
    }
}

fn arc(height_m: f64) -> Result<Trajectory> {
    let times_s: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
    let point = |t: &f64| {
        nalgebra::Vector3::new(
            0.1 * t,
            height_m * (std::f64::consts::PI * t / 9.9).sin(),
            0.0,
        )
    };
    let positions = times_s.iter().map(point).collect();
    Trajectory::new(times_s, positions)
}

fn main() -> std::result::Result<(), Error> {
    let (real, simulated) = (arc(0.10)?, arc(0.07)?);
    let (real_prepared, simulated_prepared) = (prepare(&real)?, prepare(&simulated)?);
    let pair = Pair {
        real: &real,
        simulated: &simulated,
        real_prepared: &real_prepared,
        simulated_prepared: &simulated_prepared,
    };
    let score = Bulge.compare(&pair, &Context::default())?;
    println!("{}: {:.4} {}", Bulge.doc(), score.value, score.unit);
    Ok(())
}
