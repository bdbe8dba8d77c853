//! `realgap robot develop`: the robot of a genome.

use std::collections::BTreeMap;

use realgap::results::portrait;
use realgap::robot::genome::Individual;
use realgap::simulation::{Settling, settle};
use realgap::unit::decimals;

use super::genome::named;
use super::kind::read_individual;
use super::kit::*;

/// Build the robot of a genome, or print why it cannot be built
///
/// Use it to turn a genome into a morphology that all other commands read (-o). Every gene turns the robot built so
/// far, turns its own module and glues it on top; `realgap robot genome random` makes a genome to start from. The
/// robot is then put down in the simulator, and a robot that keeps moving or falls over gets a warning.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap robot develop genome.ron -o robot.ron --plot robot.png")]
pub struct Develop {
    /// The genome
    genome: PathBuf,
    /// Write the robot to this file (.ron)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw the robot into this file (.png or .svg)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

/// The robot of a genome, or why there is none.
#[derive(Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum DevelopReport {
    /// The genome builds a robot.
    Robot {
        /// Its name.
        name: String,
        /// Always true: the robot can be built.
        develops: bool,
        /// Number of modules.
        modules: usize,
        /// Number of hinges.
        hinges: usize,
        /// Mass, kg.
        mass_kg: f64,
        /// Bounding box at zero servo angles, metres.
        size_m: [f64; 3],
        /// Centre of mass, robot frame, metres.
        centre_of_mass_robot_m: [f64; 3],
        /// Whether it comes to rest on the floor.
        at_rest: bool,
        /// Whether it fell over.
        toppled: bool,
        /// Time until it was at rest, seconds.
        settle_s: f64,
        /// How far it tilted, radians.
        tilt_rad: Option<f64>,
        /// The numbers of each module, by name.
        genes: Vec<BTreeMap<&'static str, f64>>,
        /// What the reader should know.
        warnings: Vec<Warning>,
        /// The file that it was written to.
        output: Option<PathBuf>,
        /// Version of the program.
        version: &'static str,
    },
    /// The genome builds no robot.
    Misfit {
        /// Its name.
        name: String,
        /// Always false: nothing can be built.
        develops: bool,
        /// Code of the reason.
        reason: &'static str,
        /// The reason.
        message: String,
    },
}

impl Develop {
    pub fn run(self) -> Result<()> {
        output::check_pictures(&self.plot)?;
        let individual = read_individual(&self.genome)?;
        let robot = match individual.develop() {
            Ok(robot) => robot,
            Err(misfit) => {
                if self.print.is_json() {
                    terminal::print_answer(&DevelopReport::Misfit {
                        name: individual.name,
                        develops: false,
                        reason: misfit.code(),
                        message: misfit.to_string(),
                    })?;
                }
                return Err(Error::from(misfit).at_file(&self.genome));
            }
        };
        let settling = settle(&Experiment::new(robot.assemble()))?;
        if let Some(path) = &self.output {
            output::write_ron(path, &robot.to_ron()?)?;
        }
        terminal::print_warnings(&flags(&robot, &settling));
        self.print(&individual, &robot, &settling)?;
        if let Some(plot) = &self.plot {
            portrait::draw(&robot, plot)?;
            terminal::note(format!("drawn: {}", plot.display()));
        }
        Ok(())
    }

    fn print(
        &self,
        individual: &Individual,
        robot: &Morphology,
        settling: &Settling,
    ) -> Result<()> {
        let summary = robot.summary();
        let size = summary.size_m();
        if self.print.is_json() {
            let centre_m = summary.centre_of_mass_robot_m;
            return terminal::print_answer(&DevelopReport::Robot {
                name: robot.name().to_owned(),
                develops: true,
                modules: summary.modules,
                hinges: summary.hinges,
                mass_kg: summary.mass_kg,
                size_m: [size.x, size.y, size.z],
                centre_of_mass_robot_m: [centre_m.x, centre_m.y, centre_m.z],
                at_rest: settling.is_at_rest(),
                toppled: settling.is_toppled(),
                settle_s: settling.taken_s,
                tilt_rad: settling.tilt_rad,
                genes: named(&individual.genome),
                warnings: flags(robot, settling),
                output: self.output.clone(),
                version: env!("CARGO_PKG_VERSION"),
            });
        }
        let mut table = TextTable::new([
            ("module", Side::Left),
            ("kind", Side::Left),
            ("driven face", Side::Left),
            ("on", Side::Left),
            ("amplitude", Side::Right),
            ("frequency", Side::Right),
            ("phase", Side::Right),
            ("offset", Side::Right),
        ]);
        for (index, module) in robot.modules().iter().enumerate() {
            let on = robot
                .attachments()
                .iter()
                .find(|attachment| attachment.child == index);
            let on = on.map_or("", |attachment| {
                robot.modules()[attachment.parent].name.as_str()
            });
            let mut row = vec![module.name.clone()];
            match &module.drive {
                None => {
                    row.extend(["passive", "", on].map(str::to_owned));
                    row.extend(std::iter::repeat_n(String::new(), 4));
                }
                Some(drive) => {
                    row.extend(["active", drive.face.name(), on].map(str::to_owned));
                    let degrees = |angle: f64| decimals(angle.to_degrees(), 1) + " deg";
                    row.push(degrees(drive.actuator.gait.amplitude_rad));
                    row.push(format!("{:.2} Hz", drive.actuator.gait.frequency_hz));
                    row.push(degrees(drive.actuator.gait.phase_rad));
                    row.push(degrees(drive.actuator.gait.offset_rad));
                }
            }
            table.push(row);
        }
        let mut lines = vec![
            format!(
                "{}: {} modules, {} hinges, {:.3} kg, {:.3} x {:.3} x {:.3} m",
                robot.name(),
                summary.modules,
                summary.hinges,
                summary.mass_kg,
                size.x,
                size.y,
                size.z
            ),
            terminal::table(&table),
            match (settling.is_at_rest(), settling.is_toppled()) {
                (true, false) => format!("at rest on the floor after {:.2} s", settling.taken_s),
                (true, true) => "at rest, but toppled on the way".to_owned(),
                (false, _) => "does not come to rest on the floor".to_owned(),
            },
        ];
        if let Some(path) = &self.output {
            lines.push(format!("written: {}", path.display()));
        }
        terminal::print(lines.join("\n"));
        Ok(())
    }
}

/// Warnings about the robot and about how it settles: what is allowed, but probably not intended.
fn flags(robot: &Morphology, settling: &Settling) -> Vec<Warning> {
    let name = |index: usize| &robot.modules()[index].name;
    let blocked = robot.blocked_plates().into_iter().map(|(plate, other)| {
        Code::PlateBlocked.warning(format!(
            "the plate of `{}` hits `{}` when it follows its gait",
            name(plate),
            name(other)
        ))
    });
    let mut flags: Vec<Warning> = blocked.collect();
    flags.extend(robot.warnings());
    flags.extend(settling.warnings());
    flags
}
