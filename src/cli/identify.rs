//! `realgap identify`: what free flight tells before any contact model can spoil it.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use realgap::calibration::identification::{Identification, Interval, LengthReading, identify};
use realgap::calibration::{BestFile, Definition, Overrides, RestingOdds, StartRule};
use realgap::comparison::Pose;
use realgap::file::{check_writable, write_atomic, write_ron};
use realgap::optimization::RunOptions;
use realgap::plot::{Side, TextTable};
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::unit::counted;
use realgap::warning::Code;
use realgap::{Result, Warning};
use serde::Serialize;

use super::kind::read_definition;
use super::option::{Format, Recordings, Values};
use super::{progress, terminal};

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
/// recordings. -o writes the values for --parameters of sweep and evaluate, in true lengths. Last comes which face ends
/// down, how often, beside one simulation of each recording with the study's values and what was identified; contact
/// is in those simulations alone, so friction and restitution are worth giving (--parameters best.ron).
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
        if let Some(output) = &self.output {
            check_writable(output)?;
        }
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            // Nothing is compared here; what tossed bodies are compared by asks least of a study's recordings.
            metric: Some(&Pose),
            ..self.recordings.overrides()?
        };
        let study = read_definition(&self.study, &overrides)?;
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
        let name = study.name.clone();
        let (odds, more) = simulate_rest(study, &found)?;
        terminal::print_warnings(found.warnings.iter().chain(&more));
        if let Some(output) = &self.output {
            let file = BestFile {
                description: format!(
                    "Identified from the free flight of {} of {} of the study {} (realgap identify); no contact was used.",
                    found.flying,
                    counted(found.recordings, "recording"),
                    name
                ),
                parameters: found.parameters.clone(),
            };
            write_atomic(output, write_ron(&file)?.as_bytes())?;
        }
        match self.format {
            Format::Json => terminal::print(terminal::json(&Report {
                found: &found,
                resting_odds: odds.as_ref(),
            })?),
            Format::Table => print(&found, odds.as_ref()),
        }
        if let Some(output) = &self.output {
            terminal::note(format!("written: {}", output.display()));
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// What JSON holds: the identification, and the simulated odds beside the real ones.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    found: &'a Identification,
    /// Null where nothing could be simulated; a warning says why.
    resting_odds: Option<&'a RestingOdds>,
}

/// Simulated resting faces with what was identified, where there is something to simulate, and the warnings about it.
fn simulate_rest(
    study: Definition,
    found: &Identification,
) -> Result<(Option<RestingOdds>, Vec<Warning>)> {
    let why_not = if found.rest.at_rest == 0 {
        Some("no recording ends at rest")
    } else if study.start == StartRule::Settled {
        Some(
            "the runs of this study start settled on the floor (`start: FromRecording` starts them as recorded)",
        )
    } else {
        None
    };
    if let Some(why) = why_not {
        let warning = Warning::new(
            Code::NoSimulatedOdds,
            format!("resting faces were not simulated: {why}"),
        );
        return Ok((None, [study.warnings, vec![warning]].concat()));
    }
    let identified = found
        .parameters
        .iter()
        .map(|(name, value)| Assignment::new(name, *value))
        .collect::<Result<ParameterSet>>()?;
    let bar = progress::bar(found.rest.at_rest, "simulating");
    let follow = progress::follow(&bar);
    let run = RunOptions {
        progress: Some(&follow),
        ..RunOptions::default()
    };
    let odds = study.resting_odds(&identified, &run);
    bar.finish_and_clear();
    let odds = odds?;
    let warnings = odds.warnings.clone();
    Ok((Some(odds), warnings))
}

fn print(found: &Identification, odds: Option<&RestingOdds>) {
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
            "{} of {} fly, {}; {:.3} mm per axis unexplained",
            found.flying,
            counted(found.recordings, "recording"),
            counted(found.samples, "sample"),
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
    let values: Vec<String> = found
        .parameters
        .iter()
        .map(|(name, value)| format!("{name} = {value:.6}"))
        .collect();
    lines.push(format!("parameters (true lengths): {}", values.join(", ")));
    lines.push(rest(found, odds, colour));
    terminal::print(lines.join("\n"));
}

/// Which face ends down: real counts, and simulated ones where there are any.
fn rest(found: &Identification, odds: Option<&RestingOdds>, colour: bool) -> String {
    let rest = &found.rest;
    let Some(odds) = odds else {
        let faces = rest.faces.iter().map(|f| format!("{} {}", f.face, f.down));
        return format!(
            "face down at rest: {} ({} still moving at the end)",
            faces.collect::<Vec<_>>().join(", "),
            rest.moving
        );
    };
    let mut table = TextTable::new([
        ("face down", Side::Left),
        ("real", Side::Right),
        ("%", Side::Right),
        ("simulated", Side::Right),
        ("%", Side::Right),
        ("same recording", Side::Right),
    ]);
    let percent = |count: usize| {
        format!(
            "{:.1}",
            100.0 * count as f64 / odds.simulations.max(1) as f64
        )
    };
    for face in &odds.faces {
        table.push([
            face.face.to_owned(),
            face.real.to_string(),
            percent(face.real),
            face.simulated.to_string(),
            percent(face.simulated),
            face.both.to_string(),
        ]);
    }
    let simulated = odds.values.iter().map(|(name, value)| {
        let origin = if odds.identified.contains(name) {
            " (identified)"
        } else if odds.at_default.contains(name) {
            " (default)"
        } else {
            ""
        };
        format!("{name} = {value:.6}{origin}")
    });
    format!(
        "{}\n{} at rest, each simulated once ({} diverged), {} on the same face; {} still moving at the end\nsimulated from the {} with {}",
        table.render(colour).trim_end(),
        counted(odds.simulations, "recording"),
        odds.diverged,
        odds.same_face,
        rest.moving,
        odds.start,
        simulated.collect::<Vec<_>>().join(", ")
    )
}
