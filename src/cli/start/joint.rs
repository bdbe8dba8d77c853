//! The study of joint logs: what the joints were told, and what of their servos is looked for.

use realgap::calibration::{Commands, Unmatched};
use realgap::robot::import::{AssumedLaw, Options, is_foreign};
use realgap::robot::morphology::{Freedom, Hinge, ServoLaw, Summary};
use realgap::trajectory::{Recording, Trajectory};

use super::super::import;
use super::super::kit::*;
use super::{Draft, Subject};

/// What people call what a servo was told.
const GOALS: [&str; 5] = ["command", "goal", "target", "setpoint", "cmd"];
/// Simulations a parameter that least squares get.
const RUNS: usize = 5;
/// Steps between two samples, and the longest step of them, seconds.
const STEPS: f64 = 2.0;
const LONGEST_STEP_S: f64 = 0.01;

/// Whether the robot has a servo that a recording says the commands of.
pub(super) fn is_commanded(robot: &Morphology, recordings: &[Recording]) -> bool {
    let hinges = robot.assemble().hinges;
    let told = |r: &Recording| {
        !Commands::default()
            .columns_of(&hinges, &r.trajectory)
            .is_empty()
    };
    recordings.iter().any(told)
}

/// The study of servos and joints. A free robot of another program is held, and written beside the study.
///
/// # Errors
/// A robot that cannot be held, or has none of the recorded joints.
pub(super) fn draft(
    subject: &mut Subject,
    recordings: &[Recording],
    study: &Path,
) -> Result<Draft> {
    let mut clues = Vec::new();
    if subject.robot.assemble().world_from_mount.is_none() && is_foreign(&subject.robot_file) {
        hold(subject, study)?;
        clues.push((
            "the root is held, and servos are springs with damping",
            format!(
                "joints alone were recorded, and the robot's file does not say what its servos are ({} does now)",
                subject.robot_file.display()
            ),
        ));
    }
    let hinges = subject.robot.assemble().hinges;
    let motion = &recordings[0].trajectory;
    let Unmatched {
        joints: lacking,
        columns: strange,
    } = Unmatched::of(&hinges, motion, Some(&Commands::default()));
    let is_recorded = |hinge: &&Hinge| !lacking.contains(&hinge.name.as_str());
    let recorded: Vec<&Hinge> = hinges.iter().filter(is_recorded).collect();
    if recorded.is_empty() {
        return Err(Error::usage("no column is called after a joint of the robot")
            .at_file(&recordings[0].path)
            .found(format!("columns of {}", strange.join(", ")))
            .allowed(format!("columns NAME_rad of the joints {}", lacking.join(", ")))
            .hint("say which is which in a file: (names: {\"theirs\": \"NAME_rad\"}); and name it with --reading FILE"));
    }
    let only = only_command(&recorded, &strange);
    let strange = strange.into_iter().filter(|name| Some(*name) != only);
    let left_out: Vec<&str> = lacking.into_iter().chain(strange).collect();
    if !left_out.is_empty() {
        clues.push((
            "some names are left out",
            format!(
                "not both in the robot and in the recordings: {}",
                left_out.join(", ")
            ),
        ));
    }
    let told = Commands::default().columns_of(&hinges, motion);
    let is_told =
        |hinge: &Hinge| only.is_some() || told.iter().any(|command| command.hinge == hinge.name);
    let untold: Vec<&str> = recorded
        .iter()
        .filter(|hinge| hinge.actuator.is_some() && !is_told(hinge))
        .map(|hinge| hinge.name.as_str())
        .collect();
    if !untold.is_empty() {
        clues.push((
            "servos without commands do what the robot's file says",
            format!("no column NAME_command_rad for {}; what swings freely is made by: realgap robot import --passive", untold.join(", ")),
        ));
    }
    let summary = subject.robot.summary();
    let parameters: Vec<(String, f64, f64)> = recorded
        .iter()
        .flat_map(|hinge| ranges(hinge, is_told(hinge), &summary))
        .collect();
    let is_any_told = recorded.iter().any(|hinge| is_told(hinge));
    let commands = only.map(|column| (recorded[0].name.as_str(), column));
    let budget = RUNS * (parameters.len() + RUNS);
    let tune = format!("tune STUDY --optimizer gauss-newton --budget {budget}");
    Ok(Draft {
        head: format!(
            "\
// Which servos and joints make the simulated robot move like the recorded one (docs/recordings.md)?
//   realgap check STUDY     what is in this file, and is it sound?
//   realgap {tune}     and which of them do these motions tell of?
"
        ),
        before: before(motion, commands, is_any_told, &left_out),
        parameters: parameters
            .iter()
            .map(|(name, from, to)| {
                format!("        (name: {name:?}, from: {from:?}, to: {to:?}),\n")
            })
            .collect(),
        after: "    metric: \"joints\",\n    score: Single,\n".to_owned(),
        clues,
        next: format!("{tune}    # {}", counted(parameters.len(), "parameter")),
    })
}

/// The fields before the parameters; `commands` is the servo and the only column of goals, where that is not called after it.
fn before(
    motion: &Trajectory,
    commands: Option<(&str, &str)>,
    is_any_told: bool,
    left_out: &[&str],
) -> String {
    let sample_s = motion.duration_s() / (motion.times_s().len() - 1) as f64;
    let timestep_s = floored((sample_s / STEPS).min(LONGEST_STEP_S));
    let mut before =
        "    start: FromRecording, // each run starts with the joints as they were seen first\n"
            .to_owned();
    if let Some((hinge, column)) = commands {
        before += &format!(
            "    commands: Commands(columns: [(hinge: {hinge:?}, column: {column:?})]), // each held until the next\n"
        );
    } else if is_any_told {
        before +=
            "    commands: Commands(), // columns NAME_command_rad, each held until the next\n";
    }
    if !left_out.is_empty() {
        before += &format!("    left_out: {left_out:?},\n");
    }
    before += &format!(
        "    timestep_s: {timestep_s:?}, // at least {STEPS} steps a sample\n    set: {{\"solver.engine\": 1}}, // the tree solver: joints in a fraction of Rapier's time\n"
    );
    before
}

/// Reads the robot again with its root held, and its assumed servos as springs: those of arms give way under load.
fn hold(subject: &mut Subject, study: &Path) -> Result<()> {
    let source = import::source(&subject.robot_file)?;
    let options = Options {
        mounted: true,
        law: AssumedLaw::Torque,
        ..Options::default()
    };
    let (robot, notes) = Morphology::import(&source, &options)?;
    let stem = study.file_stem().unwrap_or_default().to_string_lossy();
    let file = study.with_file_name(format!("{stem}_robot.ron"));
    output::write_ron(&file, &import::text(&subject.robot_file, &robot, &notes)?)?;
    subject.robot = robot;
    subject.robot_file = file;
    Ok(())
}

/// What is looked for at a joint, and where: ten times around what the robot's file says, else what a servo of its size may have.
fn ranges(hinge: &Hinge, is_told: bool, summary: &Summary) -> Vec<(String, f64, f64)> {
    let name = &hinge.name;
    let around = |parameter: &str, value: f64| {
        (
            format!("servo.{name}.{parameter}"),
            rounded(value / 10.0),
            rounded(value * 4.0),
        )
    };
    let mut all = Vec::new();
    // What gravity may do about the joint, for those that nothing drives.
    let mut torque_nm = summary.mass_kg * 9.81 * summary.body_length_m;
    if let Some(actuator) = hinge.actuator {
        torque_nm = actuator.servo.max_torque_nm;
        match actuator.servo.law {
            ServoLaw::Velocity { gain_per_s } => all.push(around("gain_1_s", gain_per_s)),
            ServoLaw::Torque {
                stiffness_nm_rad,
                damping_nm_s_rad,
            } => {
                all.push(around("stiffness_nm_rad", stiffness_nm_rad));
                let damping = damping_nm_s_rad.max(stiffness_nm_rad * 0.01);
                all.push(around("damping_nm_s_rad", damping));
            }
            ServoLaw::Motor(motor) => {
                all.push(around("torque_constant_nm_a", motor.torque_constant_nm_a));
                all.push(around("armature_kg_m2", motor.armature_kg_m2.max(1e-6)));
            }
            ServoLaw::Direct => all.push((
                format!("hinge.{name}.armature_kg_m2"),
                0.0,
                rounded(summary.mass_kg * summary.body_length_m.powi(2)),
            )),
        }
    }
    let is_slide = hinge.freedom == Freedom::Slide;
    let offset = if is_slide { 0.01 } else { 0.1 };
    let part = if hinge.actuator.is_some() { 0.2 } else { 0.1 };
    all.push((
        format!("hinge.{name}.dry_nm"),
        0.0,
        rounded(part * torque_nm),
    ));
    if is_told && !matches!(hinge.actuator.map(|a| a.servo.law), Some(ServoLaw::Direct)) {
        all.push((format!("servo.{name}.latency_s"), 0.0, 0.1));
        all.push((format!("servo.{name}.offset_rad"), -offset, offset));
    } else {
        all.push((
            format!("hinge.{name}.viscous_nm_s_rad"),
            0.0,
            rounded(part * torque_nm),
        ));
    }
    all
}

/// The only column of commands of a robot with one servo, where it is not called after it.
fn only_command<'a>(recorded: &[&Hinge], strange: &[&'a str]) -> Option<&'a str> {
    let is_command = |name: &&&str| GOALS.iter().any(|goal| name.to_lowercase().contains(goal));
    let mut commands = strange.iter().filter(is_command);
    match (recorded, commands.next(), commands.next()) {
        ([hinge], Some(column), None) if hinge.actuator.is_some() => Some(column),
        _ => None,
    }
}

/// Two digits, from below.
fn floored(value: f64) -> f64 {
    let digit = 10f64.powf(value.log10().floor() - 1.0);
    rounded((value / digit + 1e-9).floor() * digit)
}

/// Three digits: it is read by people.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
