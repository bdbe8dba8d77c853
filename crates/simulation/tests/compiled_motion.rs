//! Motion of imported MJCFs against MuJoCo: a passive fall, and the step of a servo, both without contacts and with a held root.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
#![allow(
    clippy::print_stdout,
    reason = "the table is the result that the docs quote"
)]

use std::path::Path;
use std::process::Command;

use realgap_core::file::Source;
use realgap_robot::import::{Imported, Options, import};
use realgap_robot::morphology::body::Surroundings;
use realgap_robot::morphology::{Morphology, ServoLaw};
use realgap_simulation::{CommandTrack, Experiment, JointState, engine_by_name, run};
use serde_json::Value;

use crate::common::{project, python_with};

/// Largest difference that counts as agreement: 1 mrad (or mm), or this share of the motion.
const MOST_RAD: f64 = 1e-3;
const MOST_SHARE: f64 = 0.01;
const DURATION_S: f64 = 0.2;

fn moved(arguments: &[&Path]) -> Option<Vec<Value>> {
    let python = python_with("mujoco")?;
    let done = Command::new(python)
        .arg(project().join("tools/compiled_motion.py"))
        .args(arguments)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    Some(
        said.lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect(),
    )
}

fn clean(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.chars()
        .map(|c| if plain(c) { c } else { '_' })
        .collect()
}

/// Angles at the end of a run from the start of `case`; with `commands`, actuators follow them, otherwise springs of servos are absent.
fn ours(imported: &Imported, case: &Value, commands: Option<&Value>) -> Vec<(String, f64)> {
    let mut structure = imported.structure.clone();
    structure
        .bodies
        .iter_mut()
        .for_each(|body| body.shapes.clear());
    if commands.is_none() {
        structure.actuators.retain(|driver| {
            driver.servo.law == ServoLaw::Direct || driver.servo.law.follows_speeds()
        });
    }
    // MuJoCo starts without the commands of a keyframe, and with the same gravity for all.
    structure
        .actuators
        .iter_mut()
        .for_each(|driver| driver.gait = None);
    structure.world = Surroundings::default();
    let robot = Morphology::of_bodies(structure).unwrap_or_else(|e| panic!("{e}"));
    let mut experiment = Experiment::new(robot.assemble());
    experiment.solver.engine = engine_by_name("tree").unwrap();
    experiment.solver.timestep_s = 1.0 / 8000.0;
    experiment.duration_s = DURATION_S;
    experiment.records_joints = true;
    let start = |name: &str| {
        let all = case["start"].as_object().unwrap();
        let own = all.iter().find(|(key, _)| clean(key) == name);
        own.map_or(0.0, |(_, value)| value.as_f64().unwrap())
    };
    let hinges = &experiment.assembly.hinges;
    experiment.start_joints = (hinges.iter())
        .map(|hinge| JointState {
            angle_rad: start(&hinge.name),
            speed_rad_s: 0.0,
        })
        .collect();
    if let Some(commands) = commands {
        for (name, value) in commands.as_object().unwrap() {
            let track = CommandTrack::new(vec![0.0], vec![value.as_f64().unwrap()], None).unwrap();
            experiment.commands.insert(clean(name), track.into());
        }
    }
    let motion = run(&experiment).unwrap().outcome.completed().unwrap();
    let names = experiment
        .assembly
        .hinges
        .iter()
        .map(|hinge| hinge.name.clone());
    names
        .filter_map(|name| {
            let angle = *motion.joint(&name)?.angles_rad.last()?;
            Some((name, angle))
        })
        .collect()
}

/// The joint that differs most from MuJoCo, in units of the allowance, with its numbers.
fn worst(ours: &[(String, f64)], case: &Value, end: &Value) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for (name, theirs) in end.as_object().unwrap() {
        let theirs = theirs.as_f64().unwrap();
        let own = clean(name);
        let Some((_, angle)) = ours.iter().find(|(known, _)| *known == own) else {
            continue;
        };
        let began = case["start"][name].as_f64().unwrap();
        let most = MOST_RAD.max(MOST_SHARE * (theirs - began).abs());
        let share = (angle - theirs).abs() / most;
        if share > worst.0 || share.is_nan() {
            worst = (share, format!("{name} from {began}: {angle} for {theirs}"));
        }
    }
    worst
}

fn check(cases: &[Value]) -> Vec<String> {
    let mut broken = Vec::new();
    let (mut falls, mut steps, mut left) = (0, 0, 0);
    for case in cases {
        let path = case["path"].as_str().unwrap();
        if let Some(why) = case["left"].as_str() {
            left += 1;
            println!("LEFT {path}: {why}");
            continue;
        }
        let options = Options {
            mounted: true,
            ..Options::default()
        };
        let imported = import(&Source::read(path, "robot").unwrap(), &options).unwrap();
        let lacks = imported.notes.iter().find(|note| {
            [
                "the actuator",
                "activation",
                "negative damping",
                "have no mass",
                "yielding",
                "polynomial",
                "limit and spring",
            ]
            .iter()
            .any(|part| note.what.contains(part))
        });
        if let Some(note) = lacks {
            left += 1;
            println!("LEFT {path}: {note}");
            continue;
        }
        let mut compare = |what: &str, commands: Option<&Value>| {
            if case[what].is_null() {
                return 0;
            }
            let (share, joint) = worst(&ours(&imported, case, commands), case, &case[what]);
            println!("{what} {share:.3} {path} {joint}");
            if share > 1.0 || share.is_nan() {
                broken.push(format!(
                    "{what} of {path}: {share:.2} allowances at {joint}"
                ));
            }
            1
        };
        falls += compare("fall", None);
        steps += compare("step", Some(&case["commands"]));
    }
    println!(
        "{falls} falls, {steps} steps, {left} left out, {} broken",
        broken.len()
    );
    broken
}

#[test]
fn imported_robots_fall_and_step_as_in_mujoco() {
    let Some(cases) = moved(&[Path::new("--wheels")]) else {
        return;
    };
    let broken = check(&cases);
    assert!(
        broken.is_empty(),
        "{} faults:\n{}",
        broken.len(),
        broken.join("\n")
    );
}
