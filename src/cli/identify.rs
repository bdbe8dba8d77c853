//! `realgap identify`: what free flight tells before any contact model can spoil it.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use realgap::Result;
use realgap::file::{write_atomic, write_ron};
use realgap::identification::{Identification, Interval, LengthReading, identify};
use realgap::report::{Side, TextTable};
use realgap::study::{BestFile, Overrides, Study};

use super::option::{Format, Recordings, Values};
use super::terminal;

/// How an apparent gravity other than the stated one is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum Reading {
    /// Recorded lengths are off by a factor
    #[default]
    LengthScale,
    /// Gravity is another
    Gravity,
}

/// Estimate centre of mass, apparent gravity, velocity lag and start states from free flight alone
///
/// In flight p + R c is a parabola, whatever happens on the floor later. Intervals are 95 %, bootstrap over
/// recordings. -o writes the values for --parameters of sweep and evaluate, in true lengths.
#[derive(Debug, Args)]
pub struct Identify {
    /// The study: robot, floor height and stated gravity
    study: PathBuf,
    #[command(flatten)]
    recordings: Recordings,
    #[command(flatten)]
    values: Values,
    /// Write body.com_offset_{x,y,z}_m and recording.length_scale (or gravity_m_s2) into this file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What another gravity than the stated one means
    #[arg(long = "as", value_enum, default_value_t)]
    reading: Reading,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Identify {
    pub fn run(self) -> Result<ExitCode> {
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            ..self.recordings.overrides()?
        };
        let study = Study::read(&self.study, &overrides)?;
        let reading = match self.reading {
            Reading::LengthScale => LengthReading::LengthScale,
            Reading::Gravity => LengthReading::Gravity,
        };
        let found =
            identify(&study.experiment(), &study.recordings, reading, study.seed).map_err(|e| {
                match e.file() {
                    Some(_) => e,
                    None => e.at_file(&self.study),
                }
            })?;
        terminal::print_warnings(study.warnings.iter().chain(&found.warnings));
        if let Some(output) = &self.output {
            let file = BestFile {
                description: format!(
                    "Identified from the free flight of {} of {} recordings of the study {} (realgap identify); no contact was used.",
                    found.flying, found.recordings, study.name
                ),
                parameters: found.parameters.clone(),
            };
            write_atomic(output, write_ron(&file)?.as_bytes())?;
        }
        match self.format {
            Format::Json => terminal::print(terminal::json(&found)?),
            Format::Table => print(&found),
        }
        if let Some(output) = &self.output {
            terminal::note(format!("written: {}", output.display()));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn print(found: &Identification) {
    let colour = terminal::stdout_wants_colour();
    let mut table = TextTable::new([
        ("quantity", Side::Left),
        ("estimate", Side::Right),
        ("2.5 %", Side::Right),
        ("97.5 %", Side::Right),
    ]);
    let mut push = |name: &str, interval: &Interval, factor: f64, digits: usize| {
        let text = |v: f64| format!("{:.digits$}", v * factor);
        table.push([
            name.to_owned(),
            text(interval.value),
            text(interval.low),
            text(interval.high),
        ]);
    };
    for (axis, interval) in ["x", "y", "z"].iter().zip(&found.centre_of_mass_recorded_m) {
        let name = format!("centre of mass {axis}, mm (recorded lengths)");
        push(&name, interval, 1e3, 2);
    }
    push(
        "apparent gravity, m/s^2",
        &found.apparent_gravity_m_s2,
        1.0,
        3,
    );
    push(
        "recorded / true length, if gravity is right",
        &found.length_scale,
        1.0,
        4,
    );
    if let Some(ratio) = &found.rest.height_ratio {
        push("height at rest / half width", ratio, 1.0, 4);
    }
    if let Some(lag) = &found.velocity_lag_s {
        push("lag of recorded velocities, ms", lag, 1e3, 2);
    }
    let mut lines = vec![
        format!(
            "{} of {} recordings fly, {} samples; {:.3} mm per axis unexplained",
            found.flying,
            found.recordings,
            found.samples,
            1e3 * found.residual_m
        ),
        table.render(colour).trim_end().to_owned(),
    ];
    for s in &found.sensitivity {
        let c = s.centre_of_mass_m.map(|m| format!("{:.2}", 1e3 * m));
        lines.push(format!(
            "without the first {} samples: centre of mass ({}) mm, gravity {:.3} m/s^2, {:.3} mm unexplained",
            s.first_samples_left_out,
            c.join(", "),
            s.gravity_m_s2,
            1e3 * s.residual_m
        ));
    }
    let faces: Vec<String> = found
        .rest
        .faces
        .iter()
        .map(|f| format!("{} {}", f.face, f.down))
        .collect();
    lines.push(format!(
        "face down at rest: {} ({} still moving at the end)",
        faces.join(", "),
        found.rest.moving
    ));
    let values: Vec<String> = found
        .parameters
        .iter()
        .map(|(name, value)| format!("{name} = {value:.6}"))
        .collect();
    lines.push(format!("parameters (true lengths): {}", values.join(", ")));
    terminal::print(lines.join("\n"));
}
