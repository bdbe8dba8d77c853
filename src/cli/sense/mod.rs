//! `realgap sense`: commands for sensors, radio, task times and pictures, as in the papers. No simulation of a robot needs these
//! commands, so they are compiled with the feature `papers` only.

mod belief;
mod draw;
mod fit;
pub mod form;
mod graph;
mod picture;
mod radio;
mod tasks;
mod telling;
mod vision;

use std::fmt::Display;

use super::kind::Kind;

/// A hint for errors that names the commands that read a file of this kind; empty if no command of `realgap sense` reads it.
pub fn hint(kind: Kind, path: &impl Display) -> String {
    match kind {
        Kind::Sensor => format!(
            "`realgap sense belief {path}` and `realgap sense draw {path}` use a sensor model"
        ),
        Kind::Radio => format!(
            "`realgap sense radio evaluate LOG.csv --parameters {path}` and `realgap sense radio send --parameters {path}` use a radio model"
        ),
        Kind::Scene => format!("`realgap sense picture {path}` renders pictures of a scene"),
        Kind::Sensorgraph => format!(
            "`realgap sense graph evaluate SCANS.csv --parameters {path}` uses a sensorgraph"
        ),
        _ => String::new(),
    }
}

/// Examples in the help.
pub const EXAMPLES: &str = "\
Examples:
  realgap sense fit log.csv -o sensor.ron                   # a model of the sensor
  realgap sense belief sensor.ron --distances 5,20          # how sure is it of a distance?
  realgap sense radio fit poses.csv --arena arenas/flat.ron # how far does radio reach?";

commands! {
    /// Sensors and tasks: fit, draw, belief, graph, radio, tasks, picture, vision
    SenseCommand:
    Fit(fit::Fit),
    Draw(draw::Draw),
    Belief(belief::Belief),
    #[command(subcommand)]
    Graph(graph::SensorgraphCommand),
    #[command(subcommand)]
    Radio(radio::RadioCommand),
    #[command(subcommand)]
    Tasks(tasks::TasksCommand),
    Picture(picture::Picture),
    #[command(subcommand)]
    Vision(vision::VisionCommand),
}
