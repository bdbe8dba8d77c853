//! The study of joint logs: commands of the joints, and the servo parameters to fit.

use realgap::calibration::{Commands, RunStart, Unmatched};
use realgap::robot::morphology::{Freedom, Hinge, ServoLaw};
use realgap::trajectory::{Recording, Trajectory};

use super::super::kit::*;
use super::effort::{Effort, Scales};
use super::proposal::{MOST_DELAY_S, Proposal, budget, rounded};
use super::{Draft, Drive, Subject, noise};

/// Words that occur in the names of command columns.
const GOALS: [&str; 5] = ["command", "goal", "target", "setpoint", "cmd"];
/// Least number of steps between two samples, and the longest step, seconds.
const STEPS: f64 = 2.0;
const LONGEST_STEP_S: f64 = 0.01;

/// The study of servos and joints.
///
/// # Errors
/// A robot that has none of the recorded joints.
pub(super) fn draft(subject: &Subject, recordings: &[Recording], drive: &Drive) -> Result<Draft> {
    let mut clues = Vec::new();
    let robot = subject.robot.assemble();
    let efforts = Effort::of_joints(&robot, recordings);
    let hinges = robot.hinges;
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
    let unrecorded = lacking.clone();
    let left_out: Vec<&str> = lacking.into_iter().chain(strange).collect();
    if !unrecorded.is_empty() {
        clues.push((
            "some joints are not compared",
            format!("no column holds their angles: {}", unrecorded.join(", ")),
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
    let unknown = recorded
        .iter()
        .filter(|hinge| has_unknown_gains(hinge, has_command(hinge), drive));
    let unknown: Vec<&str> = unknown.map(|hinge| hinge.name.as_str()).collect();
    if !unknown.is_empty() {
        clues.push((
            "stiffness and damping of servos are fitted, too",
            format!(
                "nothing says that the gains of {} are known; gains and inertia explain each other in part: state known gains with --pd",
                unknown.join(", ")
            ),
        ));
    }
    let scales = |hinge: &Hinge| {
        let at = hinges.iter().position(|known| known.name == hinge.name);
        let effort = at.map(|at| efforts[at]).unwrap_or_default();
        let limit_nm = hinge.actuator.map(|actuator| actuator.servo.max_torque_nm);
        let gravity_nm = summary.mass_kg * 9.81 * summary.body_length_m;
        Scales::new(effort, limit_nm, gravity_nm)
    };
    let parameters: Vec<Proposal> = proposals(&recorded, has_command, drive, scales)
        .into_iter()
        .map(Proposal::within_bounds)
        .collect::<Result<_>>()?;
    clues.push((
        "ranges begin around the robot's own values",
        "`prior` holds them with half of the range as spread, so that what the recordings do not tell stays near them".to_owned(),
    ));
    let is_any_commanded = recorded.iter().any(|hinge| has_command(hinge));
    let commands = only.map(|column| (recorded[0].name.as_str(), column));
    let tune = format!(
        "tune STUDY --optimizer gauss-newton --budget {}",
        budget(parameters.len())
    );
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
        timestep_s: Some(timestep_s(motion, subject)),
        horizon: None,
        parameters: parameters.iter().map(Proposal::line).collect(),
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
    let mut fixed = vec!["\"solver.engine\": 1"];
    fixed.extend(drive.fixed_values());
    before += &format!(
        "    set: {{{}}}, // the tree solver, which simulates joints in a fraction of Rapier's time\n",
        fixed.join(", ")
    );
    before
}

/// At least [`STEPS`] steps per sample, and steps that follow the stiffest joint of the robot.
fn timestep_s(motion: &Trajectory, subject: &Subject) -> f64 {
    let sample_s = motion.duration_s() / (motion.times_s().len() - 1) as f64;
    let stiff_s = subject.robot.assemble().surroundings.timestep_s;
    floored(
        (sample_s / STEPS)
            .min(stiff_s.unwrap_or(LONGEST_STEP_S))
            .min(LONGEST_STEP_S),
    )
}

/// The parameters to fit, with ranges around the values in the robot's file, or of what a servo of this size may have: those that
/// are seldom known (inertia that only the joint feels, friction, the zero of the encoder, one delay), and the gains where they are
/// not known either.
fn proposals(
    recorded: &[&Hinge],
    has_command: impl Fn(&Hinge) -> bool,
    drive: &Drive,
    scales: impl Fn(&Hinge) -> Scales,
) -> Vec<Proposal> {
    let mut all = Vec::new();
    for hinge in recorded {
        all.extend(of_servo(hinge, has_command(hinge), drive));
        all.extend(of_hinge(hinge, has_command(hinge), drive, &scales(hinge)));
    }
    let has_delay = |hinge: &&&Hinge| {
        has_command(hinge)
            && !matches!(
                law(hinge),
                Some(ServoLaw::Direct | ServoLaw::Throttle) | None
            )
    };
    if !drive.known_gains.is_empty() {
        // Stated gains are numbers of the firmware; how much torque they are depends on torque constants, which are seldom exact.
        all.push(proposal("servo.gain", (0.5, 2.0), 1.0));
    }
    if recorded.iter().any(|hinge| has_delay(&hinge)) {
        all.push(proposal("servo.latency_s", (0.0, MOST_DELAY_S), 0.0));
    }
    all
}

fn proposal(name: &str, (from, to): (f64, f64), own: f64) -> Proposal {
    Proposal {
        name: name.to_owned(),
        from,
        to,
        own: Some(own),
    }
}

fn law(hinge: &Hinge) -> Option<ServoLaw> {
    hinge.actuator.map(|actuator| actuator.servo.law)
}

/// Whether both gains of a joint's servo are to be fitted.
fn has_unknown_gains(hinge: &Hinge, has_command: bool, drive: &Drive) -> bool {
    let has_gains = matches!(law(hinge), Some(ServoLaw::Torque { .. }));
    has_gains && has_command && !drive.known_gains.contains(&hinge.name)
}

/// The parameters of a joint's servo.
fn of_servo(hinge: &Hinge, has_command: bool, drive: &Drive) -> Vec<Proposal> {
    let around = |parameter: &str, value: f64| {
        let range = (rounded(value / 10.0), rounded(value * 4.0));
        proposal(&format!("servo.{}.{parameter}", hinge.name), range, value)
    };
    match law(hinge) {
        Some(ServoLaw::Velocity { gain_per_s }) => vec![around("gain_1_s", gain_per_s)],
        Some(
            law @ ServoLaw::Torque {
                damping_nm_s_rad, ..
            },
        ) if law.follows_speeds() && has_command => {
            vec![around("damping_nm_s_rad", damping_nm_s_rad)]
        }
        Some(ServoLaw::Torque {
            stiffness_nm_rad,
            damping_nm_s_rad,
        }) if has_unknown_gains(hinge, has_command, drive) => vec![
            around("stiffness_nm_rad", stiffness_nm_rad),
            around(
                "damping_nm_s_rad",
                damping_nm_s_rad.max(stiffness_nm_rad * 0.01),
            ),
        ],
        Some(ServoLaw::Motor(motor)) => vec![
            around("torque_constant_nm_a", motor.torque_constant_nm_a),
            around("armature_kg_m2", motor.armature_kg_m2.max(1e-6)),
        ],
        Some(ServoLaw::Torque { .. } | ServoLaw::Direct | ServoLaw::Throttle) | None => Vec::new(),
    }
}

/// The parameters of a joint's bearing, and of its zero.
fn of_hinge(hinge: &Hinge, has_command: bool, drive: &Drive, scales: &Scales) -> Vec<Proposal> {
    let name = &hinge.name;
    let bearing = &hinge.bearing;
    let up_to = |parameter: &str, value: f64, most: f64| {
        let name = format!("hinge.{name}.{parameter}");
        proposal(&name, (0.0, rounded(most)), value)
    };
    let mut all = Vec::new();
    let feels_inertia = matches!(
        law(hinge),
        Some(ServoLaw::Torque { .. } | ServoLaw::Direct | ServoLaw::Throttle)
    );
    if feels_inertia {
        let own = bearing.armature_kg_m2;
        all.push(up_to("armature_kg_m2", own, scales.most_armature(own)));
    }
    // Viscous friction and the damping of a servo whose command stands still are one.
    let is_damped = matches!(
        law(hinge),
        Some(ServoLaw::Velocity { .. } | ServoLaw::Motor(_))
    );
    let is_covered = has_unknown_gains(hinge, has_command, drive) || (has_command && is_damped);
    if !is_covered {
        let own = bearing.viscous_nm_s_rad;
        all.push(up_to("viscous_nm_s_rad", own, scales.most_viscous(own)));
    }
    let own = bearing.dry_nm;
    all.push(up_to("dry_nm", own, scales.most_dry(own)));
    // A zero shifts angles, which neither torques nor speeds are.
    let follows_angles = |law: ServoLaw| law != ServoLaw::Direct && !law.follows_speeds();
    if has_command && law(hinge).is_none_or(follows_angles) {
        let most = match hinge.freedom == Freedom::Slide {
            true => 0.01,
            false => 0.1,
        };
        all.push(proposal(
            &format!("joint.{name}.zero_rad"),
            (-most, most),
            0.0,
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
