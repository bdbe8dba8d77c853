//! A number that nobody means, in every number of every kind of file: it is refused, or what follows from it is finite.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

use realgap::Result;
use realgap::calibration::{Overrides, Study, read_noise, read_parameters};
use realgap::file::Source;
use realgap::robot::genome::Individual;
use realgap::robot::morphology::Morphology;
use realgap::search::Search;

use realgap::simulation::parameter::ParameterSet;
use realgap::simulation::{Controller, Experiment, Vehicle, run, steer};
use realgap::trajectory::{Reading, read_meta};

/// What is put in place of each number.
const VALUES: [&str; 9] = [
    "1e300", "-1e300", "1e-300", "-1e-300", "NaN", "inf", "-inf", "0", "-1",
];
/// The longest simulated time, seconds.
const SHORT_S: f64 = 0.1;

/// Where the numbers of a text in RON stand: not in comments, texts or names.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let rest = &text[at..];
        let is_digit = bytes[at].is_ascii_digit();
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if bytes[at] == b'"' {
            at += 2 + rest[1..].find('"').unwrap();
        } else if is_digit || (bytes[at] == b'-' && bytes[at + 1].is_ascii_digit()) {
            let is_part = |c: char| c.is_ascii_digit() || "-+.eE_".contains(c);
            let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
            found.push(at..at + length);
            at += length;
        } else if bytes[at].is_ascii_alphabetic() {
            let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
            at += rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    found
}

fn must_be_finite(experiment: &Experiment) -> Result<()> {
    let run = match experiment.controller {
        Some(_) => steer(experiment, None, None)?.0,
        None => run(experiment)?,
    };
    if let Some(motion) = run.outcome.get() {
        let positions = motion.positions_world_m().iter().flat_map(|p| p.iter());
        let times = motion.times_s().iter();
        assert!(
            positions.chain(times).all(|value| value.is_finite()),
            "a run that is not finite"
        );
    }
    Ok(())
}

fn robot(source: &Source) -> Result<()> {
    let robot = Morphology::parse(source)?;
    let summary = robot.summary();
    assert!(
        summary.mass_kg.is_finite() && summary.size_m().iter().all(|m| m.is_finite()),
        "{} kg, {:?} m",
        summary.mass_kg,
        summary.size_m()
    );
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = SHORT_S;
    must_be_finite(&experiment)
}

/// The controller in this file on a tripod.
fn controller(path: &Path) -> Result<()> {
    let tripod = Morphology::read(common::project().join("morphologies/tripod.ron"))?;
    let mut experiment = Experiment::new(tripod.assemble());
    experiment.duration_s = SHORT_S;
    experiment.perturbation.draw = Some((1, 0));
    let controller = Controller::read(path, &experiment)?;
    must_be_finite(&experiment.with_controller(controller)?)
}

/// Reads a file and uses what is in it.
type Used = dyn Fn(&Path, &Source) -> Result<()>;

/// A kind of file: its text, the name under which it is written, and what reads and uses it.
struct Kind {
    name: &'static str,
    text: String,
    used: Box<Used>,
}

fn shipped(name: &'static str, used: impl Fn(&Path, &Source) -> Result<()> + 'static) -> Kind {
    Kind {
        name,
        text: std::fs::read_to_string(common::project().join(name)).unwrap(),
        used: Box::new(used),
    }
}

fn written(
    name: &'static str,
    text: &str,
    used: impl Fn(&Path, &Source) -> Result<()> + 'static,
) -> Kind {
    Kind {
        name,
        text: text.to_owned(),
        used: Box::new(used),
    }
}

fn kinds() -> Vec<Kind> {
    let beside = |path: &Path, name: &str| path.parent().unwrap().with_file_name(name);
    let of_tripod = move |name: &'static str| {
        move |path: &Path, _: &Source| controller(&beside(path, "controllers").join(name))
    };
    vec![
        shipped("morphologies/tripod.ron", |_, source| robot(source)),
        shipped("morphologies/so101_feetech.ron", |_, source| robot(source)),
        shipped("morphologies/turtlebot3_burger.ron", |_, source| {
            robot(source)
        }),
        shipped("morphologies/double_pendulum.ron", |_, source| {
            robot(source)
        }),
        shipped("morphologies/servo_pendulum.ron", |_, source| robot(source)),
        shipped("morphologies/elbow.ron", |_, source| robot(source)),
        shipped("morphologies/push_cube.ron", |_, source| robot(source)),
        shipped("controllers/tripod_avoid.ron", |path, _| controller(path)),
        shipped("controllers/two_tripods.ron", |path, _| controller(path)),
        written("controllers/own.ron", CONTROLLER, |path, _| {
            controller(path)
        }),
        shipped("arenas/paper000.ron", of_tripod("tripod_avoid.ron")),
        shipped("arenas/pen.ron", of_tripod("two_tripods.ron")),
        shipped("radios/paper002.ron", of_tripod("two_tripods.ron")),
        written(
            "sensors/own.ron",
            &std::fs::read_to_string(common::project().join("sensors/laser.ron")).unwrap(),
            of_tripod("own_sensor.ron"),
        ),
        shipped("vehicles/two_wheel.ron", |path, _| {
            Vehicle::read(path, None).map(drop)
        }),
        shipped(
            "genomes/three_modules.ron",
            |_, source| match Individual::parse(source)?.develop() {
                Ok(robot) => {
                    let mut experiment = Experiment::new(robot.assemble());
                    experiment.duration_s = SHORT_S;
                    must_be_finite(&experiment)
                }
                Err(_) => Ok(()),
            },
        ),
        written(
            "studies/search.ron",
            &format!("Search(\n{}\n)\n", common::SMALL_SEARCH),
            |_, source| Search::parse(source, &Default::default()).map(drop),
        ),
        written(
            "studies/noise.ron",
            "(start_heading_rad: Normal(0.02), servo_latency_s: Uniform(0.0, 0.02), mass_relative: LogNormal(0.02))",
            |path, _| read_noise(path).map(drop),
        ),
        written(
            "studies/best.ron",
            "(description: \"best\", parameters: {\"floor.friction\": 0.4, \"gravity_m_s2\": 9.8})",
            |path, _| read_parameters(path).map(drop),
        ),
        written(
            "studies/reading.ron",
            "(crop: (from_s: 1.5, to_s: 20.0), scale: 0.01, skip_lines: 2, rate_hz: 10.0, floor_leans: (0.01, 0.02))",
            |_, source| {
                let reading = Reading::parse(source)?;
                match reading.fault() {
                    Some((_, error)) => Err(error),
                    None => Ok(()),
                }
            },
        ),
        shipped("real_trajectories/tripod_standin/meta.ron", |path, _| {
            read_meta(path).map(drop)
        }),
        written("studies/study.ron", STUDY, |path, _| {
            let study = Study::read(path, &Overrides::default())?;
            let mut experiment = study.experiment_with(0, &ParameterSet::default())?;
            // A duration that is too long for anybody is not a fault, but nothing that a test waits for.
            experiment.duration_s = experiment.duration_s.min(SHORT_S);
            must_be_finite(&experiment)
        }),
    ]
}

const CONTROLLER: &str = "Controller(
    arena: \"../arenas/pen.ron\",
    name: \"west\",
    start: (x_m: 0.6, y_m: 1.0, heading_deg: 170),
    others: [(name: \"east\", x_m: 1.4, y_m: 1.0, heading_deg: -10)],
    rate_hz: 20,
    sensors: [(name: \"front\", on: \"core\", at_m: (0.01, 0.02, 0.03), turn_deg: 190, model: \"laser\")],
    radio: (model: \"../radios/paper002.ron\", every_s: 0.05, latency_s: 0.01, latency_sd_s: 0.02),
    rules: [
        (when: (sensor: \"front\", above_m: 0.02), for_s: 0.03, then: [(actuator: \"leg_a\", hold: 0.5)]),
        (when: (heard: \"any\", within_m: 0.9), for_s: 0.03, then: [
            (actuator: \"leg_b\", gait: (offset_rad: 0.73, amplitude_rad: 0.52, frequency_hz: 1.25, phase_rad: 5.15)),
        ]),
    ],
)";

const STUDY: &str = "Study(
    morphology: \"../morphologies/tripod.ron\",
    recordings: [\"../real_trajectories/tripod_standin/*.csv\"],
    set: {\"floor.restitution\": 0.1},
    timestep_s: 0.002,
    start: Settled,
    duration_s: 0.25,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 3, prior: (0.5, 0.1))],
)";

/// One number of one file is replaced; what is wrong with the outcome, if anything.
fn outcome(
    kind: &Kind,
    place: &std::ops::Range<usize>,
    value: &str,
    root: &Path,
) -> Option<String> {
    let path = root.join(kind.name);
    let text = format!(
        "{}{value}{}",
        &kind.text[..place.start],
        &kind.text[place.end..]
    );
    std::fs::write(&path, &text).unwrap();
    let started = Instant::now();
    let source = Source::new(&path, text.clone());
    let done = catch_unwind(AssertUnwindSafe(|| (kind.used)(&path, &source)));
    let line = kind.text[..place.start].lines().last().unwrap_or_default();
    let was = &kind.text[place.clone()];
    let what = format!("{}: {line}[{was} -> {value}]", kind.name);
    let seconds = started.elapsed().as_secs_f64();
    match done {
        Err(panic) => {
            let said = panic.downcast_ref::<String>().cloned().unwrap_or_default();
            Some(format!("{what}: {said}"))
        }
        Ok(_) if seconds > 10.0 => Some(format!("{what}: {seconds:.0} s")),
        Ok(Err(error)) if error.to_string().is_empty() => Some(format!("{what}: no words")),
        Ok(_) => None,
    }
}

fn every_number_with(values: impl Fn(usize) -> Vec<&'static str>) {
    let root = tempfile::tempdir().unwrap();
    for folder in [
        "morphologies",
        "controllers",
        "arenas",
        "radios",
        "sensors",
        "vehicles",
        "genomes",
        "studies",
        "real_trajectories/tripod_standin",
    ] {
        let to = root.path().join(folder);
        std::fs::create_dir_all(&to).unwrap();
        let from = common::project().join(folder);
        for entry in std::fs::read_dir(from).into_iter().flatten() {
            let entry = entry.unwrap();
            if entry.path().is_file() {
                std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
            }
        }
    }
    let avoid = std::fs::read_to_string(root.path().join("controllers/tripod_avoid.ron")).unwrap();
    let own = avoid.replace("\"ultrasonic\"", "\"../sensors/own.ron\"");
    std::fs::write(root.path().join("controllers/own_sensor.ron"), own).unwrap();
    let (mut wrong, mut tries) = (Vec::new(), 0);
    for kind in kinds() {
        let path = root.path().join(kind.name);
        std::fs::write(&path, &kind.text).unwrap();
        let sound = (kind.used)(&path, &Source::new(&path, kind.text.clone()));
        sound.unwrap_or_else(|error| panic!("{} as shipped: {error}", kind.name));
        for (number, place) in numbers(&kind.text).iter().enumerate() {
            for value in values(number) {
                tries += 1;
                wrong.extend(outcome(&kind, place, value, root.path()));
            }
        }
        std::fs::write(&path, &kind.text).unwrap();
    }
    assert!(tries > 400, "{tries}");
    assert!(
        wrong.is_empty(),
        "{} of {tries}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn an_extreme_number_is_refused_or_what_follows_is_finite() {
    every_number_with(|number| vec![VALUES[number % VALUES.len()]]);
}

#[test]
#[ignore = "minutes; the short one runs always"]
fn every_extreme_number_is_refused_or_what_follows_is_finite() {
    every_number_with(|_| VALUES.to_vec());
}
