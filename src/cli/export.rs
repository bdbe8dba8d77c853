//! `realgap robot export`: a robot for another simulator.

use clap::builder::PossibleValuesParser;
use realgap::file::Source;
use realgap::simulation::export::{FORMATS, Robot, format_named};
use realgap::simulation::read_arena;

use super::kit::*;
use super::option::recording_unused;

/// Write a robot for another simulator: MJCF for MuJoCo, URDF for ROS and PyBullet
///
/// Use it to run a robot in another simulator. Values of `--set` and `--parameters` (a calibrated floor, say) are
/// written into the file. What the format cannot express is listed on standard error and in comments of the file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap robot export morphologies/tripod.ron --format mjcf -o tripod.xml
  realgap robot export morphologies/tripod.ron --format mjcf --arena arenas/step.ron -o step.xml
  realgap robot export robot.ron --format urdf --parameters best.ron -o out.urdf")]
pub struct Export {
    /// The robot, e.g. morphologies/tripod.ron
    morphology: PathBuf,
    /// Format of the file
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(FORMATS.iter().map(|f| f.name())))]
    format: String,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Add the steps and the height field of this arena, from its start pose; its walls are left out
    #[arg(long, value_name = "FILE")]
    arena: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
}

impl Export {
    pub fn run(self) -> Result<()> {
        let format = format_named(&self.format)?;
        let morphology = read_morphology(&self.morphology)?;
        let mut experiment = Experiment::new(morphology.assemble());
        if let Some(path) = &self.arena {
            let (walls, ground) = read_arena(&Source::read(path, "arena")?, true)?;
            if !walls.is_empty() {
                terminal::note("the walls, boxes and circles of the arena are left out");
            }
            experiment.ground = ground;
        }
        let values = self.values.parameter_set()?;
        terminal::print_warnings(&values.without_effect(&experiment));
        terminal::print_warnings(&recording_unused(&values));
        let experiment = values.apply(&experiment);
        let exported = format.render(&Robot::new(&morphology, &experiment));
        for warning in &exported.warnings {
            terminal::note(format!("{} does not carry: {}", format.name(), warning));
        }
        if self.output.is_none() && !exported.files.is_empty() {
            terminal::note(format!(
                "{} meshes belong to this file: -o FILE writes them beside it",
                exported.files.len()
            ));
        }
        match &self.output {
            Some(path) => {
                for (name, bytes) in &exported.files {
                    output::write(&path.with_file_name(name), bytes)?;
                }
                output::write(path, exported.text.as_bytes())?;
            }
            None => terminal::print(exported.text.trim_end()),
        }
        Ok(())
    }
}
