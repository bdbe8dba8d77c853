//! The answer of `realgap check --format json` about a file.

use std::collections::BTreeMap;

use realgap::robot::morphology::Dynamics;
use realgap::unit::LengthUnit;

use super::super::kit::*;

/// A file.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FileReport {
    /// Its path.
    pub file: PathBuf,
    /// Whether it is sound.
    pub ok: bool,
    /// What is in it, or what is wrong.
    #[serde(flatten)]
    pub outcome: Outcome,
}

#[derive(Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Outcome {
    /// It is sound.
    Sound {
        /// Kind of file.
        kind: &'static str,
        /// What it holds.
        contents: Box<Contents>,
        /// What the reader should know.
        warnings: Vec<Warning>,
    },
    /// It is not sound.
    Wrong {
        /// What is wrong.
        error: Fault,
    },
}

/// What is wrong with a file.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fault {
    /// What is wrong, in one sentence.
    message: String,
    /// Line, from 1, where that is known.
    line: Option<usize>,
    /// Column, from 1, where that is known.
    column: Option<usize>,
    /// The whole text: where, found, allowed, what to do.
    text: String,
}

/// What a file holds, by its kind.
#[derive(Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Contents {
    /// A robot.
    Morphology {
        /// Its name.
        name: String,
        /// Number of modules.
        modules: usize,
        /// Number of hinges.
        hinges: usize,
        /// Number of rigid parts.
        parts: usize,
        /// Mass, kg.
        mass_kg: f64,
        /// Bounding box at zero servo angles, metres.
        size_m: [f64; 3],
        /// The module that recordings follow.
        track: String,
        /// Body length, metres.
        body_length_m: f64,
        /// The robot at some coordinates of its joints, where `--dynamics` is given.
        #[serde(skip_serializing_if = "Option::is_none")]
        dynamics: Option<States>,
    },
    /// A genome.
    Genome {
        /// Name of the robot.
        name: String,
        /// Number of modules.
        modules: usize,
        /// Why it does not develop, if so.
        misfit: Option<&'static str>,
    },
    /// A study.
    Study {
        /// Name of the robot.
        robot: String,
        /// The metric.
        metric: &'static str,
        /// Its unit.
        unit: Unit,
        /// What is varied.
        parameters: Vec<Varied>,
        /// Points of the grid.
        points: usize,
        /// Number of recordings, where they can be read.
        recordings: Option<usize>,
        /// Simulations of a sweep.
        simulations: Option<usize>,
        /// Their cost, CPU seconds, estimated from a part of one simulation.
        cpu_s: Option<f64>,
    },
    /// A search.
    Search {
        /// The strategy.
        strategy: &'static str,
        /// Number of robots that it simulates.
        robots: usize,
        /// Runs of each.
        repeats: usize,
        /// Time of each run, seconds.
        duration_s: f64,
        /// The quantity that the search maximises.
        objective: String,
        /// Its unit.
        unit: Unit,
        /// Seed of everything random.
        seed: u64,
    },
    /// Values of parameters.
    Parameters {
        /// The values, by name.
        parameters: BTreeMap<&'static str, f64>,
    },
    /// What recordings are.
    Meta {
        /// Name of the robot.
        robot: String,
        /// `Real` or `StandIn`.
        source: String,
        /// Description of the recordings.
        description: String,
        /// Their frame.
        frame: String,
        /// Their licence.
        licence: String,
    },
    /// An arena.
    Arena {
        /// Its name.
        name: String,
        /// Width and depth, metres.
        size_m: [f64; 2],
        /// Number of walls, boxes and circles.
        objects: usize,
        /// Names of the radio stations.
        anchors: Vec<String>,
        /// Where robots start: x and y in metres, heading in radians.
        start: Option<[f64; 3]>,
        /// Names of the regions of the floor.
        regions: Vec<String>,
        /// Names of the steps.
        steps: Vec<String>,
        /// File of the height field, if there is one.
        height_field: Option<String>,
    },
    /// A range sensor.
    Sensor {
        /// Shortest and longest distance.
        range: (f64, f64),
        /// Their unit.
        distance_unit: LengthUnit,
        /// Form of the mean.
        mean: &'static str,
        /// Form of the spread.
        spread: &'static str,
    },
    /// A robot on two wheels.
    Vehicle {
        /// Its name.
        name: String,
        /// Radius, metres.
        radius_m: f64,
        /// Name of its arena.
        arena: String,
    },
    /// A radio model.
    Radio {
        /// How strength falls.
        propagation: &'static str,
        /// Its parameters.
        values: Vec<f64>,
        /// Base of the logarithm.
        log_base: &'static str,
    },
    /// A room with lights and cameras.
    #[cfg(feature = "papers")]
    Scene {
        /// Its name.
        name: String,
        /// Sides of the room, metres.
        room_m: [f64; 3],
        /// Number of lights.
        lights: usize,
        /// Number of cameras.
        cameras: usize,
        /// Number of places where pictures are taken.
        views: usize,
    },
    /// A sensorgraph.
    Sensorgraph {
        /// Number of segments.
        segments: usize,
        /// Number of polynomials.
        polynomials: usize,
        /// Number of their terms.
        terms: usize,
        /// Number of poses that a lookup keeps.
        logged_poses: usize,
    },
    /// A controller.
    Controller {
        /// Name of its arena.
        arena: String,
        /// Number of decisions per second, Hz.
        rate_hz: f64,
        /// Names of its sensors.
        sensors: Vec<String>,
        /// Number of its rules.
        rules: usize,
        /// Names of the robots, its own first.
        robots: Vec<String>,
        /// Whether it was checked for a robot, too.
        fits: bool,
    },
    /// Trajectories.
    Trajectories {
        /// Each recording of the file.
        recordings: Vec<Motion>,
    },
}

/// A robot, its root held, at some coordinates of its joints.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct States {
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of the joints that move.
    pub joints: Vec<String>,
    /// The states.
    pub states: Vec<Dynamics>,
}

/// A parameter that a study varies.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Varied {
    /// Its name.
    pub name: &'static str,
    /// Lowest value.
    pub from: f64,
    /// Highest value.
    pub to: f64,
    /// Points of the grid.
    pub points: usize,
}

/// A trajectory.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Motion {
    /// Its name.
    pub name: String,
    /// Number of samples.
    pub samples: usize,
    /// Time, seconds.
    pub duration_s: f64,
    /// Whether it has orientations.
    pub orientations: bool,
    /// Whether it has velocities.
    pub velocities: bool,
    /// From the first to the last place on the floor, metres.
    pub net_displacement_m: f64,
    /// Length of the path on the floor, metres.
    pub path_length_m: f64,
}

impl Outcome {
    /// Of a file that is not sound.
    pub fn wrong(error: &Error) -> Self {
        let place = error.line_column();
        Self::Wrong {
            error: Fault {
                message: error.message().to_owned(),
                line: place.map(|(line, _)| line),
                column: place.map(|(_, column)| column),
                text: error.to_string(),
            },
        }
    }
}
