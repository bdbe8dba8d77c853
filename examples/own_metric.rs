#![allow(clippy::print_stdout)]
//! Shows how to write your own metric: one type that implements `Metric`. It appears in the table of all metrics.
//!
//! `cargo run --example own_metric`

use realgap::Result;
use realgap::comparison::{
    Comparison, Components, Context, Measurement, Metric, Needs, Pair, position_metrics,
};
use realgap::trajectory::{Reading, Recording, Trajectory};
use realgap::unit::Unit;

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

fn arc(name: &str, height_m: f64) -> Result<Recording> {
    let times_s: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
    let point = |t: &f64| {
        nalgebra::Vector3::new(
            0.1 * t,
            height_m * (std::f64::consts::PI * t / 9.9).sin(),
            0.0,
        )
    };
    let positions = times_s.iter().map(point).collect();
    Ok(Recording {
        name: name.to_owned(),
        path: name.into(),
        trajectory: Trajectory::new(times_s, positions)?,
        log: None,
        bodies: Vec::new(),
        meta: None,
        reading: Reading::default(),
        warnings: Vec::new(),
    })
}

fn main() -> Result<()> {
    let real = arc("real", 0.10)?;
    let simulated = [arc("flat", 0.07)?, arc("round", 0.12)?];
    // One line in METRICS does the same for `realgap compare`, for studies and for tuning.
    let mut metrics = position_metrics();
    metrics.push(&Bulge);
    let table = Comparison::new(&real, &simulated, Components::default())?.rows(&metrics)?;
    for row in &table {
        for distance in &row.distances {
            println!(
                "{}: {} = {:.4} {}",
                row.trajectory, distance.column, distance.value, distance.unit
            );
        }
    }
    Ok(())
}
