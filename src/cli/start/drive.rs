//! What drives the recorded robot: its recorded commands, or the gait of its own file.

use std::collections::{BTreeMap, BTreeSet};

use realgap::calibration::RecordedCommand;
use realgap::robot::import::{AssumedLaw, Options, PositionGains, is_foreign};
use realgap::robot::morphology::{Gait, Hinge, ServoLaw};
use realgap::simulation::Quantity;
use realgap::trajectory::Recording;

use super::super::import;
use super::super::kit::*;
use super::Subject;
use super::gains::{Gains, by_joint, values};

/// A joint whose gait swings farther than this turns like a wheel, radians.
const WHEEL_RAD: f64 = std::f64::consts::PI;
/// A recording in which nothing moves farther than this needs no drive: a share of the body length, and radians.
const STILL: f64 = 0.05;
/// Joints that are listed in a sentence.
const LISTED: usize = 4;

/// What drives the robot.
pub(super) struct Drive {
    /// Whether the recordings hold commands of joints with a servo.
    pub has_commands: bool,
    /// Whether the servos follow the gait of the robot's file.
    pub has_own_gait: bool,
    /// Joints whose gains were stated.
    pub known_gains: BTreeSet<String>,
    /// The stated gains of a robot in RON, as values of the study's `set`.
    set_gains: String,
    /// Whether a robot with joints moves although nothing drives it.
    lacks_drive: bool,
    /// Assumptions, each with its evidence.
    pub clues: Vec<(&'static str, String)>,
}

impl Drive {
    /// Finds what drives the robot. A robot of another program gets the servos that its recorded commands need, and is held where
    /// joints alone were recorded; it is then written beside the study.
    ///
    /// # Errors
    /// A robot that moves in the recordings although nothing drives it.
    pub fn find(
        subject: &mut Subject,
        recordings: &[Recording],
        study: &Path,
        is_own_gait: bool,
        gains: &[Gains],
    ) -> Result<Self> {
        let is_of_joints = recordings.iter().all(|r| r.trajectory.is_of_joints());
        let is_imported = is_foreign(&subject.robot_file);
        let mut clues = Vec::new();
        let gains = by_joint(gains, &subject.robot.assemble().hinges)?;
        if is_imported {
            clues.extend(import_again(
                subject,
                recordings,
                (study, is_of_joints),
                &gains,
            )?);
        }
        let hinges = subject.robot.assemble().hinges;
        let set_gains = match is_imported {
            true => String::new(),
            false => values(&gains, &hinges)?,
        };
        if !gains.is_empty() {
            clues.push((
                "gains are known",
                format!(
                    "stated for {}: inertia, friction and zero of these joints are fitted, and one factor on all gains, because torque constants are seldom exact",
                    shortened(&gains.keys().map(String::as_str).collect::<Vec<_>>())
                ),
            ));
        }
        let has_servo = |command: &RecordedCommand| {
            let mut hinges = hinges.iter();
            hinges.any(|hinge| hinge.name == command.hinge && hinge.actuator.is_some())
        };
        let (commanded, idle): (Vec<_>, Vec<_>) = all_commands(&hinges, recordings)
            .into_iter()
            .partition(has_servo);
        if !idle.is_empty() {
            let columns: Vec<&str> = idle.iter().map(|c| c.column.as_str()).collect();
            clues.push((
                "recorded commands are not used",
                format!(
                    "{}: these joints have no servo in the robot's file; give them a `servo` there",
                    columns.join(", ")
                ),
            ));
        }
        check_gains(&hinges, &commanded, recordings)?;
        let mut drive = Self {
            has_commands: !commanded.is_empty(),
            known_gains: gains.into_keys().collect(),
            set_gains,
            has_own_gait: false,
            lacks_drive: false,
            clues,
        };
        let is_only_command = is_of_joints
            && super::joint::only_command_of(&hinges, &recordings[0].trajectory).is_some();
        if drive.has_commands {
            check_all_commanded(&hinges, recordings)?;
        }
        if drive.has_commands || is_only_command {
            return Ok(drive);
        }
        let moving: Vec<(&Hinge, Gait)> = hinges.iter().filter_map(moving).collect();
        let has_wheels = moving.iter().any(|(hinge, gait)| is_wheel(hinge, gait));
        if !moving.is_empty() && (is_own_gait || !has_wheels) {
            drive.has_own_gait = true;
            drive.clues.push((
                "the robot moves by the gait in its own file",
                format!(
                    "{}; no commands were recorded; `gait.amplitude_scale: 0` switches it off",
                    listed(&moving)
                ),
            ));
            return Ok(drive);
        }
        let has_servos = hinges.iter().any(|hinge| hinge.actuator.is_some());
        drive.lacks_drive = !hinges.is_empty() && is_moving(subject, &hinges, recordings);
        if has_servos && drive.lacks_drive {
            return Err(undriven(&hinges, recordings, has_wheels));
        }
        Ok(drive)
    }

    /// Refuses recordings of a jointed robot without servos that moves, for a study whose runs start at rest.
    ///
    /// # Errors
    /// Such recordings.
    pub fn check_at_rest(&self, subject: &Subject, recordings: &[Recording]) -> Result<()> {
        match self.lacks_drive {
            true => Err(undriven(
                &subject.robot.assemble().hinges,
                recordings,
                false,
            )),
            false => Ok(()),
        }
    }

    /// The values that the study fixes: those of the robot's own gait, if that drives it, and stated gains.
    pub fn fixed_values(&self) -> Vec<&str> {
        let gait = match self.has_own_gait {
            true => "\"gait.amplitude_scale\": 1.0, \"gait.frequency_scale\": 1.0",
            false => "",
        };
        let all = [gait, &self.set_gains];
        all.into_iter()
            .filter(|values| !values.is_empty())
            .collect()
    }
}

/// The commands of the first recording that has any.
fn all_commands(hinges: &[Hinge], recordings: &[Recording]) -> Vec<RecordedCommand> {
    let all = recordings.iter();
    let all = all.map(|recording| RecordedCommand::all_of(hinges, &recording.trajectory));
    all.into_iter().find(|c| !c.is_empty()).unwrap_or_default()
}

/// Reads a robot of another program again, with the servos that the recorded commands need, and writes it beside the study if it
/// differs.
fn import_again(
    subject: &mut Subject,
    recordings: &[Recording],
    (study, is_of_joints): (&Path, bool),
    gains: &BTreeMap<String, PositionGains>,
) -> Result<Vec<(&'static str, String)>> {
    let assembly = subject.robot.assemble();
    let is_free = assembly.world_from_mount.is_none();
    let law_for = |quantity: Quantity| match quantity {
        Quantity::Torque | Quantity::Current | Quantity::Duty => AssumedLaw::Direct,
        Quantity::Position if is_of_joints && is_free => AssumedLaw::Torque,
        Quantity::Position | Quantity::Velocity => AssumedLaw::Velocity,
    };
    let needs = |command: &RecordedCommand| {
        let mut hinges = assembly.hinges.iter();
        let servo = hinges
            .find(|hinge| hinge.name == command.hinge)
            .and_then(|hinge| hinge.actuator);
        servo.is_none_or(|a| {
            law_for(command.quantity) == AssumedLaw::Direct && a.servo.law != ServoLaw::Direct
        })
    };
    let commands = all_commands(&assembly.hinges, recordings);
    let is_held_now = is_of_joints && is_free;
    // The floor of a simulation is at height 0; joints alone do not say that there is one.
    if !is_of_joints && gains.is_empty() && !commands.iter().any(needs) {
        return Ok(Vec::new());
    }
    let driven: BTreeMap<String, AssumedLaw> = commands
        .iter()
        .map(|command| (command.hinge.clone(), law_for(command.quantity)))
        .collect();
    let source = import::source(&subject.robot_file)?;
    let options = Options {
        mounted: is_of_joints,
        lifted: true,
        law: match is_held_now {
            true => AssumedLaw::Torque,
            false => AssumedLaw::Velocity,
        },
        driven,
        gains: gains.clone(),
        ..Options::default()
    };
    let (robot, notes) = Morphology::import(&source, &options)?;
    let stem = study.file_stem().unwrap_or_default().to_string_lossy();
    let file = study.with_file_name(format!("{stem}_robot.ron"));
    output::write_ron(&file, &import::text(&subject.robot_file, &robot, &notes)?)?;
    let mut clues = Vec::new();
    if is_of_joints {
        clues.push((
            "the root is held so high that no posture reaches the floor",
            format!("joints alone were recorded ({} says so)", file.display()),
        ));
    }
    // A law that the first import had already is not assumed for the recordings.
    let is_assumed = |hinge: &Hinge| {
        let law = |hinge: &Hinge| hinge.actuator.map(|a| a.servo.law);
        let mut before = assembly.hinges.iter();
        let before = before.find(|other| other.name == hinge.name);
        before.and_then(law) != law(hinge)
    };
    let hinges = robot.assemble().hinges;
    let servos = hinges.iter().filter_map(|hinge| {
        let law = match hinge.actuator?.servo.law {
            _ if !is_assumed(hinge) || gains.contains_key(&hinge.name) => return None,
            ServoLaw::Direct => "exerts the commanded torque",
            // No import assumes this law.
            ServoLaw::Throttle => return None,
            ServoLaw::Torque { .. } => "is a spring with damping",
            ServoLaw::Velocity { .. } => "turns to its command",
            ServoLaw::Motor(_) => "is a motor with a position loop",
        };
        Some((hinge.name.clone(), law))
    });
    let servos: Vec<(String, &str)> = servos.collect();
    for law in [
        "exerts the commanded torque",
        "is a spring with damping",
        "turns to its command",
    ] {
        let names = servos.iter().filter(|(_, own)| *own == law);
        let names: Vec<&str> = names.map(|(name, _)| name.as_str()).collect();
        if !names.is_empty() {
            clues.push((
                "control laws of servos are assumed",
                format!(
                    "{}: each {law}; the robot's file does not state it ({} now does)",
                    shortened(&names),
                    file.display()
                ),
            ));
        }
    }
    subject.robot = robot;
    subject.robot_file = file;
    Ok(clues)
}

/// Refuses recordings of which some hold commands and others do not: servos without commands would follow another drive.
fn check_all_commanded(hinges: &[Hinge], recordings: &[Recording]) -> Result<()> {
    let lacks = |r: &&Recording| RecordedCommand::all_of(hinges, &r.trajectory).is_empty();
    let Some(first) = recordings.iter().find(lacks) else {
        return Ok(());
    };
    let count = recordings.iter().filter(lacks).count();
    Err(Error::usage("some recordings hold no commands")
        .at_file(&first.path)
        .found(format!("{count} of {} without commands", recordings.len()))
        .allowed("columns of commands in every recording, or in none")
        .hint("make a study of those with commands and a study of the others"))
}

/// Refuses commanded angles of motors that exert torques: only the gains of the firmware say which torques.
fn check_gains(
    hinges: &[Hinge],
    commanded: &[RecordedCommand],
    recordings: &[Recording],
) -> Result<()> {
    let is_motor = |command: &&RecordedCommand| {
        let mut hinges = hinges.iter();
        let hinge = hinges.find(|hinge| hinge.name == command.hinge);
        let law = hinge.and_then(|hinge| Some(hinge.actuator?.servo.law));
        command.quantity == Quantity::Position && law == Some(ServoLaw::Direct)
    };
    let motors = commanded.iter().filter(is_motor);
    let motors: Vec<&str> = motors.map(|command| command.hinge.as_str()).collect();
    if motors.is_empty() {
        return Ok(());
    }
    Err(Error::usage("the robot's motors take torques, and the recordings hold commanded angles")
        .at_file(&recordings[0].path)
        .found(format!("{} without gains: {}", counted(motors.len(), "motor"), shortened(&motors)))
        .allowed("--pd KP,KD: the gains with which the firmware turns angles into torques, N m/rad and N m s/rad")
        .hint("e.g. --pd 20,1.5; for some of the joints --pd '*_calf_joint=30,2'; they stand in the robot's controller or driver"))
}

/// A hinge whose gait moves it.
fn moving(hinge: &Hinge) -> Option<(&Hinge, Gait)> {
    let gait = hinge.actuator?.gait;
    (gait.amplitude_rad != 0.0 && gait.frequency_hz != 0.0).then_some((hinge, gait))
}

fn is_wheel(hinge: &Hinge, gait: &Gait) -> bool {
    hinge.bearing.limits_rad.is_none() && gait.amplitude_rad.abs() > WHEEL_RAD
}

fn shortened(names: &[&str]) -> String {
    let shown = names[..names.len().min(LISTED)].join(", ");
    match names.len().saturating_sub(LISTED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

fn listed(moving: &[(&Hinge, Gait)]) -> String {
    let gait = |(hinge, gait): &(&Hinge, Gait)| {
        format!(
            "{} {} rad at {} Hz",
            hinge.name, gait.amplitude_rad, gait.frequency_hz
        )
    };
    let all: Vec<String> = moving.iter().map(gait).collect();
    shortened(&all.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Whether anything moves in the recordings.
fn is_moving(subject: &Subject, hinges: &[Hinge], recordings: &[Recording]) -> bool {
    let body_m = subject.robot.summary().body_length_m;
    recordings.iter().any(|recording| {
        let motion = &recording.trajectory;
        let turns = motion.joints().iter().any(|joint| {
            let is_hinge = hinges.iter().any(|hinge| hinge.name == joint.name);
            let first_rad = joint.angles_rad[0];
            let mut angles = joint.angles_rad.iter();
            is_hinge && angles.any(|angle| (angle - first_rad).abs() > STILL)
        });
        turns || motion.extent_m() > STILL * body_m
    })
}

/// The error of a jointed robot that moves although nothing drives it.
fn undriven(hinges: &[Hinge], recordings: &[Recording], has_wheels: bool) -> Error {
    let servos = hinges.iter().filter(|hinge| hinge.actuator.is_some());
    let servos: Vec<&str> = servos.map(|hinge| hinge.name.as_str()).collect();
    let joints: Vec<&str> = hinges.iter().map(|hinge| hinge.name.as_str()).collect();
    let (found, remedy) = match (has_wheels, servos.is_empty()) {
        (true, _) => (
            "motion, but no commands; the gait in the robot's file turns wheels, and the recorded robot hardly ran it",
            "if it did run the gait of its file, say --own-gait",
        ),
        (false, false) => (
            "motion, but no commands, and no gait in the robot's file: the simulated robot would stand still",
            "if its joints swing freely, import it with `realgap robot import --passive`",
        ),
        (false, true) => (
            "motion, but neither servos nor commands: the simulated robot would stand still",
            "a robot that was thrown or pushed starts from its first recorded state, which needs orientations (qw, qx, qy, qz) and all of its joints",
        ),
    };
    let named = if servos.is_empty() { &joints } else { &servos };
    let first = named.first().copied().unwrap_or("NAME");
    Error::usage("nothing drives the robot of these recordings")
        .at_file(&recordings[0].path)
        .found(found)
        .allowed(format!(
            "columns {first}_command_rad (angles), {first}_command_rad_s (speeds) or {first}_command_nm (torques), one per driven joint: {}; of a robot on wheels also linear and angular (m/s, rad/s)",
            shortened(named)
        ))
        .hint(remedy)
}
