//! The study of joint logs: commands of the joints, and the servo parameters to fit.

use realgap::calibration::{Commands, RunStart, Unmatched};
use realgap::robot::morphology::{Freedom, Hinge, ServoLaw, Summary};
use realgap::simulation::parameter::by_name;
use realgap::trajectory::{Recording, Trajectory};

use super::super::kit::*;
use super::{Draft, Drive, Subject, noise};

/// Words that occur in the names of command columns.
const GOALS: [&str; 5] = ["command", "goal", "target", "setpoint", "cmd"];
/// Simulations per parameter in the budget of least squares.
const RUNS: usize = 5;
/// Least number of steps between two samples, and the longest step, seconds.
const STEPS: f64 = 2.0;
const LONGEST_STEP_S: f64 = 0.01;
/// The largest torque of a servo that fits a robot, as a multiple of the torque of its weight at its whole length.
const SERVO: f64 = 2.0;

/// The study of servos and joints.
///
/// # Errors
/// A robot that has none of the recorded joints.
pub(super) fn draft(subject: &Subject, recordings: &[Recording], drive: &Drive) -> Result<Draft> {
    let mut clues = Vec::new();
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
            .hint("map the names in a file, e.g. (names: {\"theirs\": \"NAME_rad\"}), and give it with --reading FILE"));
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
    let commanded = Commands::default().columns_of(&hinges, motion);
    let has_command = |hinge: &Hinge| {
        only.is_some() || commanded.iter().any(|command| command.hinge == hinge.name)
    };
    let uncommanded: Vec<&str> = recorded
        .iter()
        .filter(|hinge| hinge.actuator.is_some() && !has_command(hinge))
        .map(|hinge| hinge.name.as_str())
        .collect();
    if !uncommanded.is_empty() {
        clues.push((
            "servos without recorded commands follow the gait in the robot's file",
            format!("no column NAME_command_rad for {}; for joints that swing freely use: realgap robot import --passive", uncommanded.join(", ")),
        ));
    }
    let summary = subject.robot.summary();
    let parameters: Vec<(String, f64, f64)> = recorded
        .iter()
        .flat_map(|hinge| ranges(hinge, has_command(hinge), &summary))
        .map(within_bounds)
        .collect::<Result<_>>()?;
    let is_any_commanded = recorded.iter().any(|hinge| has_command(hinge));
    let commands = only.map(|column| (recorded[0].name.as_str(), column));
    let budget = RUNS * (parameters.len() + RUNS);
    let tune = format!("tune STUDY --optimizer gauss-newton --budget {budget}");
    let (noise, clue) = noise::section(recordings, RunStart::Joints, &subject.robot);
    clues.push(clue);
    Ok(Draft {
        head: format!(
            "\
// Which servos and joints make the simulated robot move like the recorded one (docs/recordings.md)?
//   realgap check STUDY     is this file valid, and what is in it?
//   realgap {tune}     and which of them do these motions determine?
"
        ),
        before: before(commands, is_any_commanded, &left_out, drive),
        timestep_s: Some(timestep_s(motion)),
        horizon: None,
        parameters: parameters
            .iter()
            .map(|(name, from, to)| {
                format!("        (name: {name:?}, from: {from:?}, to: {to:?}),\n")
            })
            .collect(),
        after: format!("    metric: \"joints\",\n    score: Single,\n{noise}"),
        clues,
        next: format!("{tune}    # {}", counted(parameters.len(), "parameter")),
    })
}

/// The fields before the parameters; `commands` is the servo and the only column of goals, where that is not called after it.
fn before(
    commands: Option<(&str, &str)>,
    is_any_commanded: bool,
    left_out: &[&str],
    drive: &Drive,
) -> String {
    let mut before =
        "    start: FromRecording, // each run starts with the first recorded angles\n".to_owned();
    if let Some((hinge, column)) = commands {
        before += &format!(
            "    commands: Commands(columns: [(hinge: {hinge:?}, column: {column:?})]), // each value is held until the next\n"
        );
    } else if is_any_commanded {
        before += "    commands: Commands(), // columns NAME_command_rad, NAME_command_rad_s or NAME_command_nm, held until the next\n";
    }
    if !left_out.is_empty() {
        before += &format!("    left_out: {left_out:?},\n");
    }
    let gait = match drive.gait_values() {
        "" => String::new(),
        values => format!(", {values}"),
    };
    before += &format!(
        "    set: {{\"solver.engine\": 1{gait}}}, // the tree solver, which simulates joints in a fraction of Rapier's time\n"
    );
    before
}

/// At least [`STEPS`] steps per sample.
fn timestep_s(motion: &Trajectory) -> f64 {
    let sample_s = motion.duration_s() / (motion.times_s().len() - 1) as f64;
    floored((sample_s / STEPS).min(LONGEST_STEP_S))
}

/// The part of a range that the parameter allows.
fn within_bounds((name, from, to): (String, f64, f64)) -> Result<(String, f64, f64)> {
    let (low, high) = by_name(&name)?.bounds;
    Ok((name, from.clamp(low, high), to.clamp(low, high)))
}

/// The parameters to fit at a joint, with ranges around the values in the robot's file, or of what a servo of this size may have.
fn ranges(hinge: &Hinge, has_command: bool, summary: &Summary) -> Vec<(String, f64, f64)> {
    let name = &hinge.name;
    let around = |parameter: &str, value: f64| {
        (
            format!("servo.{name}.{parameter}"),
            rounded(value / 10.0),
            rounded(value * 4.0),
        )
    };
    let mut all = Vec::new();
    // The torque that gravity may have about a joint. The limit of a servo may be far above it, where a file states no limit.
    let gravity_nm = summary.mass_kg * 9.81 * summary.body_length_m;
    let mut torque_nm = gravity_nm;
    if let Some(actuator) = hinge.actuator {
        torque_nm = actuator.servo.max_torque_nm.min(SERVO * gravity_nm);
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
    if has_command && !matches!(hinge.actuator.map(|a| a.servo.law), Some(ServoLaw::Direct)) {
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

/// The only column of commands of a robot with one servo and other names, in a recording of joints.
pub(super) fn only_command_of<'a>(hinges: &[Hinge], motion: &'a Trajectory) -> Option<&'a str> {
    let unmatched = Unmatched::of(hinges, motion, Some(&Commands::default()));
    let strange: Vec<&str> = motion
        .joints()
        .iter()
        .map(|joint| joint.name.as_str())
        .chain(motion.signals().iter().map(|signal| signal.name.as_str()))
        .filter(|name| unmatched.columns.contains(name))
        .collect();
    let recorded = hinges
        .iter()
        .filter(|hinge| motion.joint(&hinge.name).is_some());
    only_command(&recorded.collect::<Vec<_>>(), &strange)
}

/// The only column of commands of a robot with one servo, where the column is not named after the servo.
fn only_command<'a>(recorded: &[&Hinge], strange: &[&'a str]) -> Option<&'a str> {
    let is_command = |name: &&&str| GOALS.iter().any(|goal| name.to_lowercase().contains(goal));
    let mut commands = strange.iter().filter(is_command);
    match (recorded, commands.next(), commands.next()) {
        ([hinge], Some(column), None) if hinge.actuator.is_some() => Some(column),
        _ => None,
    }
}

/// Rounds down to two digits.
fn floored(value: f64) -> f64 {
    let digit = 10f64.powf(value.log10().floor() - 1.0);
    rounded((value / digit + 1e-9).floor() * digit)
}

/// Rounds to three digits, for readability.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
