//! Fitted parameters in the RON file of a robot.

use super::{Calibrated, Fate};
use crate::Experiment;
use crate::parameter::{Assignment, FOREIGN, ParameterSet};
use realgap_core::error::Result;
use realgap_core::file::Source;
use realgap_robot::import::amendment::Written;
use realgap_robot::morphology::amendment::{Change, amend, largest_difference};
use realgap_robot::morphology::{Assembly, Morphology};

/// Largest relative difference between what a value makes of a robot and what its file gives again.
const ROUNDING: f64 = 1e-9;

/// Writes fitted values into the RON file of a robot.
///
/// # Errors
/// As [`Morphology::parse`].
pub(super) fn calibrate(
    source: &Source,
    set: &ParameterSet,
    remark: impl Fn(&Assignment) -> String,
) -> Result<Calibrated> {
    let robot = Morphology::parse(source)?;
    let before = Experiment::new(robot.assemble());
    let wanted = |set: &ParameterSet| stated(&before, &set.apply(&before));
    let assignments: Vec<Assignment> = set.iter().copied().collect();
    let new = wanted(set);
    let changes = robot.changes(&new);
    // A number comes from the values without which it would be another.
    let without = assignments.iter().map(|left_out| {
        let others = set.iter().filter(|value| *value != left_out).copied();
        robot.changes(&wanted(&others.collect()))
    });
    let without: Vec<Vec<Change>> = without.collect();
    let causes = changes.iter().map(|change| {
        let differs = |others: &Vec<Change>| !others.contains(change);
        let all = without.iter().enumerate();
        let causing = all.filter(|(_, others)| differs(others));
        causing.map(|(index, _)| index).collect::<Vec<usize>>()
    });
    let causes: Vec<Vec<usize>> = causes.collect();
    let remarked = changes.iter().zip(&causes).map(|(change, causes)| {
        let each = causes.iter().map(|index| remark(&assignments[*index]));
        (change.clone(), each.collect::<Vec<_>>().join("; "))
    });
    let amended = amend(source, &remarked.collect::<Vec<_>>())?;
    let mut values = Vec::new();
    for (index, value) in assignments.iter().enumerate() {
        let mine = causes.iter().zip(&amended.outcomes);
        let mine = mine.filter(|(causes, _)| causes.contains(&index));
        let mut written: Vec<Written> = Vec::new();
        let mut refused = None;
        for (_, outcome) in mine {
            match outcome {
                Ok(numbers) => written.extend(numbers.iter().cloned()),
                Err(why) => refused = Some(why.clone()),
            }
        }
        let fate = match (refused, written.is_empty()) {
            (Some(why), true) => Fate::Unsaid(why),
            (Some(why), false) => Fate::Unsaid(format!("only in part: {why}")),
            (None, true) if value.parameter.value(&before) == Some(value.value) => Fate::Unchanged,
            (None, true) => Fate::Unsaid(reason(value, &robot)),
            (None, false) if is_whole(source, &robot, &before, value)? => Fate::Written(written),
            (None, false) => Fate::Unsaid(format!("only in part: {}", reason(value, &robot))),
        };
        values.push((*value, fate));
    }
    let read = Morphology::parse(&Source::new(source.path(), amended.text.clone()))?;
    let left = read.changes(&new).into_iter();
    let left = left.filter(|left| changes.iter().any(|change| change.path() == left.path()));
    let largest_difference = left.map(|left| left.difference()).fold(0.0, f64::max);
    Ok(Calibrated {
        text: amended.text,
        values,
        largest_difference,
    })
}

/// Whether the file with this value alone gives the robot that the value makes.
fn is_whole(
    source: &Source,
    robot: &Morphology,
    before: &Experiment,
    value: &Assignment,
) -> Result<bool> {
    let alone = stated(before, &ParameterSet::from_iter([*value]).apply(before));
    let changes = robot
        .changes(&alone)
        .into_iter()
        .map(|change| (change, String::new()));
    let amended = amend(source, &changes.collect::<Vec<_>>())?;
    let read = Morphology::parse(&Source::new(source.path(), amended.text))?;
    Ok(largest_difference(&read.assemble(), &alone) <= ROUNDING)
}

/// The robot of an experiment, with all of the experiment that a robot's file states.
fn stated(before: &Experiment, after: &Experiment) -> Assembly {
    let mut robot = after.adjusted_assembly();
    for (index, hinge) in robot.hinges.iter_mut().enumerate() {
        if let Some(actuator) = &mut hinge.actuator {
            actuator.servo.delay_s += after.hinge_adjustment(index).latency_s;
        }
    }
    let world = &mut robot.surroundings;
    let numbers = [
        (
            &mut world.gravity_m_s2,
            before.gravity_m_s2,
            after.gravity_m_s2,
        ),
        (
            &mut world.floor_friction,
            before.floor.friction,
            after.floor.friction,
        ),
        (
            &mut world.floor_rolling_m,
            before.floor.rolling_m.unwrap_or(0.0),
            after.floor.rolling_m.unwrap_or(0.0),
        ),
        (
            &mut world.floor_torsional_m,
            before.floor.torsional_m.unwrap_or(0.0),
            after.floor.torsional_m.unwrap_or(0.0),
        ),
        (
            &mut world.floor_height_m,
            before.floor.height_m,
            after.floor.height_m,
        ),
        (
            &mut world.floor_slope_rad,
            before.floor.slope_rad,
            after.floor.slope_rad,
        ),
    ];
    for (place, from, to) in numbers {
        if from != to {
            *place = Some(to);
        }
    }
    robot
}

/// Why the file of a robot does not say a parameter, and where it belongs.
fn reason(value: &Assignment, robot: &Morphology) -> String {
    let name = value.parameter.name;
    let study = "leave it in the study, under `set`";
    let why = match name.split('.').next().unwrap_or(name) {
        "floor" | "gravity_m_s2" if robot.structure().is_none() => {
            "the file of a robot of modules states no world around it"
        }
        "floor" => "a robot's file states friction (rolling and torsional, too), height and slope of the floor only",
        "pusher" => "it belongs to the bodies beside the robot",
        "contact" | "solver" | "timestep_s" | "substeps" => "it belongs to the engine that it was fitted in",
        "recording" => "it describes the recordings, not the robot",
        "joint" => "it describes the encoders, not the robot",
        "mount" => "it describes the stand, not the robot",
        "vehicle" | "sensor" => "it belongs to a robot on wheels that no file of modules or bodies describes",
        FOREIGN => return "it belongs to the simulator that it was fitted in, and to that simulator's own files".to_owned(),
        _ => "a robot's file has no field for it, or this robot has no such part",
    };
    format!("{why}: {study}")
}
