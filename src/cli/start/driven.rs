//! The study of a robot that was driven by recorded commands of any name: paths in windows, fitted by least squares.

use std::collections::BTreeMap;
use std::str::FromStr;

use realgap::robot::morphology::{Assembly, Hinge, ServoLaw};
use realgap::text::fits;
use realgap::trajectory::Recording;

use super::super::kit::*;
use super::proposal::{Proposal, budget, rounded};
use super::{Draft, Subject};

/// Columns that command the joints whose names match a pattern (`--command`).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Commanded {
    joints: String,
    column: String,
    on: Option<String>,
}

const FORM: &str = "allowed: JOINT=COLUMN or JOINT=COLUMN:SWITCH (* for any letters), e.g. 'drive_*=throttle:enabled'";

impl FromStr for Commanded {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (joints, rest) = text.split_once('=').ok_or(FORM)?;
        let (column, on) = match rest.split_once(':') {
            Some((column, on)) => (column, Some(on.trim().to_owned())),
            None => (rest, None),
        };
        let is_empty = |text: &str| text.trim().is_empty();
        if is_empty(joints) || is_empty(column) || on.as_deref().is_some_and(is_empty) {
            return Err(FORM.to_owned());
        }
        Ok(Self {
            joints: joints.trim().to_owned(),
            column: column.trim().to_owned(),
            on,
        })
    }
}

/// The columns that all of these name, commands and switches, each once.
pub(super) fn columns(all: &[Commanded]) -> Vec<String> {
    let named = all
        .iter()
        .flat_map(|one| [Some(&one.column), one.on.as_ref()]);
    let mut columns: Vec<String> = named.flatten().cloned().collect();
    columns.sort();
    columns.dedup();
    columns
}

/// Windows of so many seconds, one so often, that begin while the robot moves so fast (m/s) and have no longer gap (s).
const WINDOW_S: (f64, f64) = (1.5, 1.5);
const SLOW_M_S: f64 = 0.2;
const GAP_S: f64 = 0.1;
/// A range reaches from the robot's own value over this factor to this times the value.
const FACTOR: f64 = 4.0;
/// The friction of a floor.
const FRICTION: (f64, f64) = (0.1, 1.6);
/// Trims of steerings, radians, and delays of commands, seconds: recorders are late by up to a tenth of a second.
const TRIM_RAD: f64 = 0.1;
const DELAY_S: (f64, f64) = (-0.1, 0.15);
/// How far the recorded heading may be off the robot's own, radians.
const HEADING_RAD: f64 = 0.05;

/// A range around the robot's own value, which is weak knowledge.
fn around(name: String, own: f64) -> Result<Option<String>> {
    if own <= 0.0 || !own.is_finite() {
        return Ok(None);
    }
    let proposal = Proposal {
        name,
        from: rounded(own / FACTOR),
        to: rounded(own * FACTOR),
        own: Some(own),
    };
    Ok(Some(proposal.within_bounds()?.line()))
}

/// A range about a value, of every run.
fn of_each_run(name: &str, (from, to): (f64, f64)) -> String {
    format!("        (name: {name:?}, from: {from:?}, to: {to:?}, each: Run),\n")
}

/// The shortest pattern that fits these names and none of the others: letters at their beginning, or all letters of one.
fn pattern(names: &[&str], others: &[&str]) -> Option<String> {
    let first = names.first()?;
    if names.len() == 1 {
        return Some((*first).to_owned());
    }
    let ends = first.char_indices().map(|(end, c)| end + c.len_utf8());
    let mut forms = std::iter::once(0)
        .chain(ends)
        .map(|end| format!("{}*", &first[..end]));
    forms.find(|form| {
        names.iter().all(|name| fits(form, name)) && !others.iter().any(|name| fits(form, name))
    })
}

/// The parameters of the tyres: wheels of one stiffness share theirs.
fn of_tyres(assembly: &Assembly) -> Result<Vec<String>> {
    let mut groups: BTreeMap<u64, Vec<&str>> = BTreeMap::new();
    for solid in assembly.parts.iter().flat_map(|part| &part.solids) {
        if let Some(tyre) = &solid.tyre {
            let name = assembly.module_names[solid.module].as_str();
            let own = groups
                .entry(tyre.slip_stiffness_1_rad.to_bits())
                .or_default();
            own.push(name);
        }
    }
    let mut lines = Vec::new();
    for (stiffness, names) in &groups {
        let others = groups.iter().filter(|(other, _)| *other != stiffness);
        let others: Vec<&str> = others
            .flat_map(|(_, names)| names.iter().copied())
            .collect();
        let own = f64::from_bits(*stiffness);
        let subjects: Vec<String> = match pattern(names, &others) {
            Some(form) => vec![form],
            None => names.iter().map(|name| (*name).to_owned()).collect(),
        };
        for subject in subjects {
            lines.extend(around(format!("tyre.{subject}.slip_stiffness_1_rad"), own)?);
        }
    }
    Ok(lines)
}

/// The parameters of joints that one column commands, by the first of them: throttles have torque, top speed and friction, other laws
/// the scale and the trim of an angle.
fn of_joints(form: &str, hinge: &Hinge) -> Result<Vec<String>> {
    let Some(actuator) = &hinge.actuator else {
        return Ok(Vec::new());
    };
    let (servo, command) = (&actuator.servo, &actuator.command);
    let mut lines = vec![format!(
        "        (name: {:?}, from: {:?}, to: {:?}),\n",
        format!("command.{form}.delay_s"),
        DELAY_S.0,
        DELAY_S.1
    )];
    if servo.law == ServoLaw::Throttle {
        lines.extend(around(
            format!("servo.{form}.max_torque_nm"),
            servo.max_torque_nm,
        )?);
        lines.extend(around(
            format!("servo.{form}.max_speed_rad_s"),
            servo.max_speed_rad_s,
        )?);
        lines.extend(around(
            format!("hinge.{form}.dry_nm"),
            hinge.bearing.dry_nm,
        )?);
        if command.dead_zone > 0.0 {
            let name = format!("command.{form}.dead_zone");
            lines.push(of_each_run(&name, (0.0, rounded(3.0 * command.dead_zone))));
        }
        return Ok(lines);
    }
    lines.extend(around(format!("command.{form}.factor"), command.factor)?);
    lines.extend(around(format!("command.{form}.bend"), command.bend)?);
    let trim = (command.offset - TRIM_RAD, command.offset + TRIM_RAD);
    lines.push(of_each_run(&format!("command.{form}.offset"), trim));
    Ok(lines)
}

/// The study of floor, tyres, drive and steering.
///
/// # Errors
/// Paths without a heading, or a pattern that fits no joint with a servo.
pub(super) fn draft(
    subject: &Subject,
    recordings: &[Recording],
    commanded: &[Commanded],
) -> Result<Draft> {
    for recording in recordings {
        let motion = &recording.trajectory;
        if motion.is_of_joints() || motion.orientations_world_from_body().is_none() {
            return Err(Error::usage(
                "a driven robot starts as it was recorded, which needs its heading",
            )
            .at_file(&recording.path)
            .found("no orientations and no heading")
            .allowed("columns qw, qx, qy, qz, or a heading")
            .hint("say which column holds it, e.g. --column heading=NAME"));
        }
    }
    let assembly = subject.robot.assemble();
    let mut parameters = format!(
        "        (name: \"floor.friction\", from: {:?}, to: {:?}),\n",
        FRICTION.0, FRICTION.1
    );
    parameters += &of_tyres(&assembly)?.concat();
    let mut columns = Vec::new();
    let mut clues = Vec::new();
    for Commanded { joints, column, on } in commanded {
        let mut servos = assembly
            .hinges
            .iter()
            .filter(|hinge| hinge.actuator.is_some());
        let Some(hinge) = servos.clone().find(|hinge| fits(joints, &hinge.name)) else {
            let names = servos.by_ref().map(|hinge| hinge.name.as_str());
            return Err(Error::usage("no joint with a servo has such a name")
                .field("--command")
                .found(joints)
                .allowed(names.collect::<Vec<_>>().join(", ")));
        };
        parameters += &of_joints(joints, hinge)?.concat();
        let switch = on
            .as_ref()
            .map_or(String::new(), |on| format!(", on: {on:?}"));
        columns.push(format!("(hinge: {joints:?}, column: {column:?}{switch})"));
        clues.push((
            "columns command joints",
            format!("`{column}` those called {joints}, as --command says"),
        ));
    }
    parameters += &format!(
        "        (name: \"track.heading_rad\", from: {:?}, to: {HEADING_RAD:?}, prior: (0.0, {:?})),\n",
        -HEADING_RAD,
        rounded(0.4 * HEADING_RAD)
    );
    let on = commanded.iter().find_map(|one| one.on.as_ref());
    let on = on.map_or(String::new(), |on| format!(", on: Some({on:?})"));
    let runs = parameters.matches("each: Run").count() * recordings.len();
    let count = parameters.lines().count() + runs;
    let before = format!(
        "    start: FromRecording, // each window starts as it was recorded, with the velocity of the 0.1 s before it\n    align: World,\n    windows: (from_m_s: {SLOW_M_S:?}{on}, gap_s: Some({GAP_S:?})), // a robot that stands tells little\n    commands: Commands(columns: [{}]),\n    set: {{\"floor.restitution\": 0}},\n",
        columns.join(", ")
    );
    Ok(Draft {
        head: "\
// Which floor, tyres, drive and steering make the simulated robot drive like the recorded one?
//   realgap check STUDY       is this file valid, and what is in it?
//   realgap evaluate STUDY    how errors grow over the windows
"
        .to_owned(),
        before,
        timestep_s: Some(0.004),
        horizon: Some(WINDOW_S),
        parameters,
        after: "    metric: \"pose\",\n    score: Single,\n".to_owned(),
        clues,
        next: format!(
            "tune STUDY --optimizer gauss-newton --budget {}",
            budget(count)
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheels_of_one_kind_share_the_shortest_pattern_that_fits_no_other() {
        let front = ["fl_wheel", "fr_wheel"];
        let rear = ["rl_wheel", "rr_wheel"];
        assert_eq!(pattern(&front, &rear).unwrap(), "f*");
        assert_eq!(pattern(&[front, rear].concat(), &[]).unwrap(), "*");
        assert_eq!(pattern(&["left"], &["left_rear"]).unwrap(), "left");
        assert_eq!(pattern(&["a1", "b1"], &["a2"]), None);
    }

    #[test]
    fn a_command_names_joints_a_column_and_a_switch() {
        let of = |text: &str| text.parse::<Commanded>();
        let found = of("drive_*=throttle:enabled").unwrap();
        assert_eq!(found.on.as_deref(), Some("enabled"));
        assert_eq!(
            columns(&[found, of("steer=steering").unwrap()]),
            ["enabled", "steering", "throttle"]
        );
        for wrong in ["throttle", "=throttle", "drive=", "drive=throttle:"] {
            assert!(of(wrong).unwrap_err().contains("allowed"), "{wrong}");
        }
    }
}
