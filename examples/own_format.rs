#![allow(clippy::print_stdout)]
//! Shows how to write your own trajectory format: one type that implements `Format`.
//!
//! `cargo run --example own_format`

use nalgebra::Vector3;
use realgap::trajectory::{Format, Parsed, Reading, Rendered, Trajectory};
use realgap::unit::LengthUnit;
use realgap::{Error, Result};

/// A format with lines of `time: x y`, in seconds and lengths.
struct Track;

impl Format for Track {
    fn name(&self) -> &'static str {
        "track"
    }
    fn doc(&self) -> &'static str {
        "lines of `time: x y`"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["track"]
    }
    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        let metres = reading.length.unwrap_or_default().metres();
        let (mut times_s, mut positions_world_m) = (Vec::new(), Vec::new());
        for (index, line) in text.lines().enumerate() {
            let number = |text: &str| {
                text.parse::<f64>().map_err(|_| {
                    Error::invalid("not a number")
                        .at_line(index + 1, 1)
                        .found(text)
                })
            };
            let numbers = line.split([':', ' ']).filter(|text| !text.is_empty());
            let numbers = numbers.map(number).collect::<Result<Vec<f64>>>()?;
            let [time_s, x, y] = numbers[..] else {
                return Err(Error::invalid("wrong number of numbers")
                    .at_line(index + 1, 1)
                    .found(numbers.len())
                    .allowed("3: time, x and y"));
            };
            times_s.push(time_s);
            positions_world_m.push(Vector3::new(x, y, 0.0) * metres);
        }
        Ok(Parsed {
            trajectory: Trajectory::new(times_s, positions_world_m)?.planar(),
            warnings: Vec::new(),
        })
    }
    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        let samples = trajectory
            .times_s()
            .iter()
            .zip(trajectory.positions_world_m());
        let lines: String = samples
            .map(|(t, p)| format!("{t}: {} {}\n", p.x, p.y))
            .collect();
        Ok(Rendered {
            bytes: lines.into_bytes(),
            warnings: Vec::new(),
        })
    }
}

fn main() -> Result<()> {
    let written = "0: 0 0\n1: 100 0\n2: 200 50\n";
    let parsed = Track.parse(written, &LengthUnit::Centimetre.into())?;
    // One line in FORMATS does the same for every file that ends in `.track`.
    let file = Track.render(&parsed.trajectory)?;
    print!("{}", String::from_utf8_lossy(&file.bytes));
    Ok(())
}
