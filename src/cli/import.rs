//! `realgap robot import`: reads a robot of another program.

use realgap::file::{Source, read_limited};
use realgap::robot::import::{AssumedLaw, Note, Options};

use super::kit::*;
use super::option::Format;

/// Largest file of a robot, bytes.
pub(super) const MOST_BYTES: u64 = 16_000_000;
/// The first words of a file that this command wrote.
const HEAD: &str = "// Imported by realgap from ";

/// Read a robot from a URDF or an MJCF file, and write it in RON
///
/// Use it to simulate a robot that exists as URDF or MJCF. Links become bodies with their masses, inertias and
/// shapes; meshes become convex hulls, which the RON file holds. Joints keep their limits and friction, motors become
/// servos. What was left out, changed or assumed is listed on standard error, each with a remedy.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap robot import robot.urdf -o robot.ron
  realgap robot import scene.xml --mounted -o arm.ron")]
pub struct Import {
    /// The URDF or MJCF file
    robot: PathBuf,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Folder of a package: package://NAME/... is read from DIR/... (repeatable)
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    package: Vec<(String, PathBuf)>,
    /// Hold the root in place; without this option, only a robot that is fixed to a link `world` is held
    #[arg(long)]
    mounted: bool,
    /// Import joints without servos, even where a URDF states limits of a motor
    #[arg(long)]
    passive: bool,
    /// Control law of servos for which a URDF states only limits
    #[arg(long, value_parser = choice(LAWS), default_value = "velocity", conflicts_with = "passive")]
    law: AssumedLaw,
    /// Start in this keyframe of an MJCF; by default `home`, or the only one
    #[arg(long, value_name = "NAME")]
    keyframe: Option<String>,
    /// Largest number of convex hulls per mesh; hollow and bent meshes need several, and each costs time in every step
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=64))]
    hulls: u16,
    /// How to print the report; json goes to standard output and needs -o
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Control laws to choose from.
const LAWS: &[Choice<AssumedLaw>] = &[
    (
        "velocity",
        AssumedLaw::Velocity,
        "Speed is 20 1/s times the error of the angle, whatever the load",
    ),
    (
        "torque",
        AssumedLaw::Torque,
        "A spring with damping, which yields under load",
    ),
    (
        "direct",
        AssumedLaw::Direct,
        "A motor that exerts the commanded torque",
    ),
];

pub(super) fn package(text: &str) -> std::result::Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() => Ok((name.to_owned(), folder.into())),
        _ => Err("not NAME=DIR".to_owned()),
    }
}

/// The report that `realgap robot import --format json` prints.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Report {
    /// The file that was read.
    file: PathBuf,
    /// Name of the robot.
    name: String,
    /// Number of bodies.
    bodies: usize,
    /// Number of joints that move.
    joints: usize,
    /// Number of joints that are driven.
    actuators: usize,
    /// Mass, kg.
    mass_kg: f64,
    /// Whether the root is held.
    mounted: bool,
    /// What was left out, changed, assumed or looks wrong.
    notes: Vec<Note>,
}

impl Import {
    pub fn run(self) -> Result<()> {
        if let Some(path) = &self.output {
            output::check(path)?;
        } else if self.format == Format::Json {
            return Err(Error::usage(
                "--format json prints the report, and the robot needs a file",
            )
            .hint("add -o robot.ron"));
        }
        let source = source(&self.robot)?;
        let options = Options {
            packages: self.package.clone(),
            mounted: self.mounted,
            passive: self.passive,
            law: self.law,
            keyframe: self.keyframe.clone(),
            hulls: self.hulls.into(),
            ..Options::default()
        };
        let (robot, notes) = Morphology::import(&source, &options)?;
        let text = text(&self.robot, &robot, &notes)?;
        if self.format == Format::Table {
            for note in &notes {
                terminal::note(note.to_string());
            }
        }
        match &self.output {
            None => terminal::print(text.trim_end()),
            Some(path) => {
                output::write_ron(path, &text)?;
                self.finish(&robot, notes, path)?;
            }
        }
        Ok(())
    }

    /// Prints the report, or a summary with the next commands.
    fn finish(&self, robot: &Morphology, notes: Vec<Note>, path: &Path) -> Result<()> {
        let summary = robot.summary();
        if self.format == Format::Json {
            let assembly = robot.assemble();
            return terminal::print_answer(&Report {
                file: self.robot.clone(),
                name: robot.name().to_owned(),
                bodies: summary.modules,
                joints: summary.hinges,
                actuators: summary.servos,
                mass_kg: summary.mass_kg,
                mounted: assembly.world_from_mount.is_some(),
                notes,
            });
        }
        let path = path.display();
        terminal::print(format!(
            "{path}: {} bodies, {} joints that move, {} of them driven, {:.4} kg\nnext:\n  realgap check {path} --plot robot.png\n  realgap simulate {path} --duration 2 -o run.csv\n  realgap replay run.csv --robot {path} -o robot.html",
            summary.modules, summary.hinges, summary.servos, summary.mass_kg
        ));
        Ok(())
    }
}

/// The XML of a robot; a note says where its bytes are not UTF-8.
///
/// # Errors
/// A file that cannot be read, or is too large.
pub(super) fn source(file: &Path) -> Result<Source> {
    let bytes = read_limited(file, MOST_BYTES, "robot")?;
    let xml = match String::from_utf8(bytes) {
        Ok(xml) => xml,
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            terminal::note(format!(
                "changed: byte {at} is not UTF-8: such bytes are read as ?; save the file as UTF-8"
            ));
            String::from_utf8_lossy(error.as_bytes()).into_owned()
        }
    };
    Ok(Source::new(file, xml.trim_start_matches('\u{feff}')))
}

/// The robot as RON text, whose first lines are comments with the notes of the import.
///
/// # Errors
/// Numbers that RON cannot hold.
pub(super) fn text(file: &Path, robot: &Morphology, notes: &[Note]) -> Result<String> {
    let plain = |text: &str| -> String { text.chars().filter(|c| !c.is_control()).collect() };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let mut head = format!("{HEAD}{}\n", plain(&name));
    for note in notes {
        head.push_str(&format!("// {}\n", plain(&note.to_string())));
    }
    Ok(format!("{head}{}", robot.to_ron()?))
}
