//! `realgap study identify`: parameters from free flight, which do not depend on a contact model; for recordings of joints, which
//! parameters they determine.

use std::collections::BTreeMap;

use realgap::RunOptions;
use realgap::calibration::{
    BestFile, Definition, Determination, Overrides, RestingOdds, StartRule, Study, recording_id,
};
use realgap::claim::flights;
use realgap::comparison::{Joints, Pose};
use realgap::file::write_ron;
use realgap::identification::{
    FlightErrors, Identification, Interval, JointIdentification, LengthReading, identify,
    identify_joints,
};
use realgap::simulation::parameter::{Assignment, ParameterSet};

use super::kind::read_definition;
use super::kit::*;

/// Explanations of an apparent gravity that differs from the stated one.
const READINGS: &[Choice<LengthReading>] = &[
    (
        "length-scale",
        LengthReading::LengthScale,
        "Recorded lengths are wrong by a factor",
    ),
    (
        "gravity",
        LengthReading::Gravity,
        "Gravity differs from the stated one",
    ),
];

/// Estimate centre of mass, apparent gravity, velocity lag and start states from free flight alone
///
/// Use it before fitting friction and restitution to recordings of tosses: contact cannot distort these values. In
/// flight, p + R c follows a parabola (p: tracked point, R: orientation, c: centre of mass in the body). Intervals
/// are 95 %, by bootstrap over recordings. -o writes the values, in true lengths, for --parameters of sweep and
/// evaluate. At the end, the command prints how often each face ends down, in the recordings and in one simulation of
/// each recording with the study's values and the identified ones. Only these simulations involve contact, so
/// friction and restitution should be given for them (--parameters best.ron).
///
/// Recordings of joints alone do not fly. For them the command ranks the study's parameters: which of them the recordings
/// determine, which trade with each other, what each recording tells, and which further motion would tell most. All channels that
/// the study scores count (`channels`: torques, currents, speeds and inertial sensors beside angles). Errors are linearised around
/// the robot's own values; nothing is fitted.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study identify sweeps/cube_toss_fit.ron -o body.ron
  realgap study identify sweeps/cube_toss_fit.ron --as gravity -o gravity.ron
  realgap study identify sweeps/go2_fit.ron    # joints: what a fit could tell")]
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
    /// How to explain an apparent gravity that differs from the stated one
    #[arg(long = "as", value_parser = choice(READINGS), default_value = "length-scale")]
    reading: LengthReading,
    #[command(flatten)]
    print: Print,
}

impl Identify {
    pub fn run(self) -> Result<()> {
        output::check_all(&self.output)?;
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            ..self.recordings.overrides()?
        };
        let study = read_definition(&self.study, &overrides)?;
        if self.output.is_some() && study.is_of_joints() && !study.recordings.is_empty() {
            return Err(Error::usage(
                "recordings of joints determine parameters, but no values without a fit",
            )
            .field("-o")
            .found(self.output.unwrap_or_default().display())
            .hint("leave it out; `realgap tune` fits values"));
        }
        let found = progress::during(0, "simulating", RunOptions::default(), |run| {
            identified(study, self.reading, run)
        });
        let found = found.map_err(|e| match e.file() {
            Some(_) => e,
            None => e.at_file(&self.study),
        })?;
        if let Some((output, file)) = self.output.as_ref().zip(found.file.as_ref()) {
            output::write_ron(output, &write_ron(file)?)?;
        }
        let text = || found.text(terminal::stdout_wants_colour());
        match &found.kind {
            IdentifiedKind::Flight(flight, odds) => self
                .print
                .answer(&Identified::new(flight, odds.as_ref()), text),
            IdentifiedKind::JointedFlight(flight) => self.print.answer(&**flight, text),
            IdentifiedKind::Joints(joints) => self.print.answer(&**joints, text),
        }?;
        terminal::print_warnings(&found.warnings);
        if let Some(output) = &self.output {
            terminal::note(format!("written: {}", output.display()));
        }
        Ok(())
    }
}

/// What recordings say without a fit.
pub struct Findings {
    /// What was found.
    pub kind: IdentifiedKind,
    /// The values for `--parameters`; recordings of joints give none.
    pub file: Option<BestFile>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// The kinds of findings.
pub enum IdentifiedKind {
    /// A free flight of one body, with the faces that end down where they were simulated.
    Flight(Box<Identification>, Option<RestingOdds>),
    /// A free flight of a robot with joints.
    JointedFlight(Box<JointIdentification>),
    /// What recordings of joints determine.
    Joints(Box<Determination>),
}

impl Findings {
    /// For people.
    pub fn text(&self, colour: bool) -> String {
        match &self.kind {
            IdentifiedKind::Flight(found, odds) => words(found, odds.as_ref(), colour),
            IdentifiedKind::JointedFlight(found) => words_of_joints(found, colour),
            IdentifiedKind::Joints(found) => words_of_motion(found, colour),
        }
    }
}

/// What the recordings of a study say without a fit: values from free flight, or which parameters recordings of joints determine.
///
/// # Errors
/// Recordings that do not fly, a study with a simulator of its own, a run that diverges, or the work was stopped.
pub fn identified(
    mut study: Definition,
    reading: LengthReading,
    run: &RunOptions<'_>,
) -> Result<Findings> {
    if study.own_simulator.is_some() {
        return Err(Error::invalid("nothing is identified without the robot's bodies, and the study names its own simulator")
            .hint("use `realgap tune`, which varies what the simulator declares"));
    }
    if !study.recordings.is_empty() && study.is_of_joints() {
        return determined(study, run);
    }
    // Nothing is compared here, so the metric only has to accept the recordings: the metric of tossed bodies requires the least.
    study.metric = &Pose;
    let experiment = study.experiment();
    let (recordings, seed) = (&study.recordings, study.seed);
    // A file for `--parameters`.
    let file = |flying: usize, parameters: &BTreeMap<String, f64>| BestFile {
        study: None,
        description: format!(
            "Identified from the free flight of {flying} of {} of the study {} (realgap study identify); no contact was used.",
            counted(recordings.len(), "recording"),
            study.name,
        ),
        parameters: parameters.clone(),
        draws: BTreeMap::new(),
        fitted_on: recordings.iter().map(recording_id).collect(),
    };
    if !experiment.assembly.hinges.is_empty() {
        let found = identify_joints(&experiment, recordings, reading, seed)?;
        return Ok(Findings {
            file: Some(file(found.flying, &found.parameters)),
            warnings: [&study.warnings[..], &found.warnings].concat(),
            kind: IdentifiedKind::JointedFlight(Box::new(found)),
        });
    }
    let found = identify(&experiment, recordings, reading, seed)?;
    let file = file(found.flying, &found.parameters);
    let (odds, more) = simulate_rest(study, &found, run)?;
    Ok(Findings {
        file: Some(file),
        warnings: [&found.warnings[..], &more].concat(),
        kind: IdentifiedKind::Flight(Box::new(found), odds),
    })
}

/// Ranks the parameters of recordings of joints, by all channels that the study scores; by the angles alone where it compares
/// anything else.
fn determined(mut study: Definition, run: &RunOptions<'_>) -> Result<Findings> {
    if !study.metric.needs().joints {
        study.metric = &Joints;
    }
    let study = Study::new(study)?;
    let found = study.determination(run)?;
    Ok(Findings {
        file: None,
        warnings: study.warnings().to_vec(),
        kind: IdentifiedKind::Joints(Box::new(found)),
    })
}

/// For people.
fn words_of_motion(found: &Determination, colour: bool) -> String {
    format!("{}\n{found}", rows(found).render(colour).trim_end())
}

/// The parameters from the best determined.
fn rows(found: &Determination) -> TextTable {
    let mut table = TextTable::new([
        ("parameter", Side::Left),
        ("value", Side::Right),
        ("±", Side::Right),
        ("% of range", Side::Right),
        ("verdict", Side::Left),
        ("most told by", Side::Left),
    ]);
    for one in &found.parameters {
        table.push([
            one.parameter.to_owned(),
            realgap::unit::number(one.value),
            realgap::unit::number(one.half_width),
            format!("{:.1}", 100.0 * one.share_of_range),
            match one.is_determined {
                true => "determined",
                false => "not determined",
            }
            .to_owned(),
            one.told_by.clone().unwrap_or_default(),
        ]);
    }
    table
}

fn words_of_joints(found: &JointIdentification, colour: bool) -> String {
    let mut table = TextTable::new([
        ("parameter", Side::Left),
        ("stated", Side::Right),
        ("from flight", Side::Right),
        ("2.5 %", Side::Right),
        ("97.5 %", Side::Right),
        ("left of prior", Side::Right),
        ("verdict", Side::Left),
    ]);
    for verdict in &found.verdicts {
        let text = |value: f64| {
            if verdict.is_determined {
                format!("{value:.5}")
            } else {
                String::new()
            }
        };
        table.push([
            verdict.parameter.to_owned(),
            format!("{}", verdict.stated),
            text(verdict.estimate.value),
            text(verdict.estimate.low),
            text(verdict.estimate.high),
            format!("{:.2}", verdict.left_of_prior),
            flights(verdict).word,
        ]);
    }
    let mut errors = TextTable::new([
        ("last sample of flight, median", Side::Left),
        ("mm", Side::Right),
        ("deg", Side::Right),
        ("joints, deg", Side::Right),
    ]);
    for (name, e) in [
        (
            "whole flight fitted, as stated",
            &found.last_sample_as_stated,
        ),
        ("whole flight fitted, as identified", &found.last_sample),
        ("two thirds fitted, as stated", &found.predicted_as_stated),
        ("two thirds fitted, as identified", &found.predicted),
    ] {
        let FlightErrors {
            position_m,
            rotation_deg,
            hinge_deg,
        } = e;
        errors.push([
            name.to_owned(),
            format!("{:.2}", 1e3 * position_m),
            format!("{rotation_deg:.2}"),
            format!("{hinge_deg:.2}"),
        ]);
    }
    format!(
        "{} of {} fly, {}; {:.3} mm unexplained (root mean square)\n{}\n{}",
        found.flying,
        counted(found.recordings, "recording"),
        counted(found.samples, "sample"),
        1e3 * found.residual_m,
        table.render(colour).trim_end(),
        errors.render(colour).trim_end()
    )
}

/// The answer as JSON: the identification, with the simulated and the real odds of the resting faces.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identified<'a> {
    #[serde(flatten)]
    found: &'a Identification,
    /// Null where nothing could be simulated; a warning says why.
    resting_odds: Option<&'a RestingOdds>,
}

impl<'a> Identified<'a> {
    /// The answer, with the odds where they were simulated.
    pub fn new(found: &'a Identification, resting_odds: Option<&'a RestingOdds>) -> Self {
        Self {
            found,
            resting_odds,
        }
    }
}

/// Resting faces in simulations with the identified values, and warnings; `None` where nothing can be simulated.
fn simulate_rest(
    study: Definition,
    found: &Identification,
    run: &RunOptions<'_>,
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
        let warning =
            Code::NoSimulatedOdds.warning(format!("resting faces were not simulated: {why}"));
        return Ok((None, [study.warnings, vec![warning]].concat()));
    }
    let identified = found
        .parameters
        .iter()
        .map(|(name, value)| Assignment::new(name, *value))
        .collect::<Result<ParameterSet>>()?;
    let odds = study.resting_odds(&identified, run)?;
    let warnings = odds.warnings.clone();
    Ok((Some(odds), warnings))
}

fn words(found: &Identification, odds: Option<&RestingOdds>, colour: bool) -> String {
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
    lines.join("\n")
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
