//! Feedback control of simulated robots: sensors, rules, radio messages, and groups of robots.
//!
//! An [`Experiment`](super::Experiment) with a [`Controller`] runs with feedback: at a fixed rate every robot reads its sensors
//! at the present poses, receives the messages that were sent to it, and changes the commands of its servos until the next
//! decision. Each robot is simulated in its own world, synchronously with the others: the robots detect each other with their
//! sensors and exchange messages, but there are no contacts between them.

mod check;
mod file;
mod mount;
mod robot_group;
mod rule;

use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::experiment::Experiment;
use super::ground::ground_of;
use super::scene::SceneBody;
use realgap_core::error::Result;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Gait;
use realgap_sensing::arena::{Arena, Boundary, Ground};
use realgap_sensing::graph::Sensorgraph;
use realgap_sensing::radio::{RadioModel, ServiceOptions};
use realgap_sensing::range::RangeModel;

#[cfg(feature = "schema")]
pub use file::ControllerFile;
pub(super) use mount::carrier;
pub(super) use robot_group::steered;
pub use rule::{Condition, Rule};

/// Default name of a robot.
const OWN: &str = "robot";

/// A controller: sensors, rules and radio of a robot, and other robots in its arena.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// The arena that the robot is in.
    pub arena: Arc<Arena>,
    /// Rate at which the robot reads its sensors and decides, Hz.
    pub rate_hz: f64,
    /// The sensors of the robot.
    pub sensors: Vec<Mounted>,
    /// The rules of the robot: the first rule whose condition holds is followed.
    pub rules: Vec<Rule>,
    /// Name of the robot, by which other robots refer to it.
    pub name: String,
    /// Other robots of the same kind, each with the same controller.
    pub others: Vec<Other>,
    /// The radio by which the robots exchange messages.
    pub radio: Option<Radio>,
}

/// A sensor on a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounted {
    /// Unique name.
    pub name: String,
    /// The mark, module or body to which the sensor is fixed.
    pub on: String,
    /// Position relative to the carrier's centre, along the carrier's axes, metres.
    pub at_m: Vector3<f64>,
    /// Rotation about the carrier's z axis, radians; the sensor measures along its own x axis.
    pub turn_rad: f64,
    /// The kind of the sensor.
    pub reads: Reads,
}

/// The kind of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub enum Reads {
    /// A range sensor: the distance to the nearest object ahead.
    Range(Arc<RangeModel>),
    /// A segment of a scanner, whose reading follows from a fitted sensorgraph in the arena's coordinates.
    Scan {
        /// The sensorgraph.
        graph: Arc<Sensorgraph>,
        /// Index of the segment, from 0.
        segment: usize,
    },
}

/// Another robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Other {
    /// Unique name.
    pub name: String,
    /// Start: x and y in the arena, metres, and the heading, radians.
    pub start: [f64; 3],
}

/// Radio messages: every robot sends its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Radio {
    /// Model of the received strength.
    pub model: Arc<RadioModel>,
    /// Time from one message to the next, seconds.
    pub every_s: f64,
    /// Delay and loss of messages; seed and noise are those of the run.
    pub service: ServiceOptions,
}

/// A message that arrived.
#[derive(Debug, Clone, PartialEq)]
pub struct Heard {
    /// Index of the sender in the group.
    pub from: usize,
    /// Position of the sender when it sent the message, in the arena, metres.
    pub position_m: [f64; 3],
    /// Time at which the message was sent, seconds.
    pub sent_s: f64,
    /// Time at which the message arrived, seconds.
    pub arrived_s: f64,
    /// Received strength, dBm.
    pub strength_dbm: f64,
}

/// The information that one robot has when it decides.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// Index of the robot in the group: 0 is the experiment's own robot.
    pub robot: usize,
    /// Time, seconds.
    pub time_s: f64,
    /// Position of its tracked module in the arena: x, y and height, metres.
    pub position_m: [f64; 3],
    /// Reading of each sensor, in its own unit; `None` for a sensor without a reading.
    pub readings: Vec<Option<f64>>,
    /// Angle of each hinge now, by its encoder, radians.
    pub angles_rad: Vec<f64>,
    /// The last message of every other robot that has arrived, by index of the sender.
    pub heard: Vec<Heard>,
}

/// Command of one servo until the next decision.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Steer {
    /// The servo's own gait or recorded commands.
    #[default]
    Own,
    /// Another gait; its time is that of the run.
    Gait(Gait),
    /// A constant command: an angle in radians, or a torque in N m for the law `Direct`.
    Hold(f64),
}

/// One decision of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// The information on which the decision is based.
    pub sensed: Sensed,
    /// Index of the rule that was followed, from 0; `None` if no condition held.
    pub rule: Option<usize>,
}

/// Records of a run with feedback, in addition to the path of the experiment's own robot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// The other robots' tracked modules, in the frame of the experiment's own run, by name.
    pub others: Vec<(String, Trajectory)>,
    /// All decisions, in order of time and, for the same time, of the robots.
    pub decisions: Vec<Decision>,
}

impl Log {
    /// A table with one row per decision: time, robot, position, the reading of every sensor (empty without a reading), the rule
    /// that was followed (from 1, 0 for none), and for every received message the sender's position and the strength.
    pub fn to_csv(&self, controller: &Controller) -> String {
        let mut text = "t_s,robot,x_m,y_m,z_m".to_owned();
        for sensor in &controller.sensors {
            text += &format!(",{}", sensor.name);
        }
        text += ",rule,heard\n";
        let names: Vec<&str> = std::iter::once(controller.name.as_str())
            .chain(controller.others.iter().map(|other| other.name.as_str()))
            .collect();
        for Decision { sensed, rule } in &self.decisions {
            let [x, y, z] = sensed.position_m;
            text += &format!(
                "{:.6},{},{x:.6},{y:.6},{z:.6}",
                sensed.time_s, names[sensed.robot]
            );
            for reading in &sensed.readings {
                text += &reading.map_or(",".to_owned(), |reading| format!(",{reading:.6}"));
            }
            let heard: Vec<String> = sensed
                .heard
                .iter()
                .map(|heard| {
                    let [x, y, _] = heard.position_m;
                    let (name, sent_s) = (names[heard.from], heard.sent_s);
                    format!(
                        "{name} at {x:.3} {y:.3} sent {sent_s:.3} {:.1} dBm",
                        heard.strength_dbm
                    )
                })
                .collect();
            text += &format!(
                ",{},{}\n",
                rule.map_or(0, |rule| rule + 1),
                heard.join("; ")
            );
        }
        text
    }
}

/// A callback that decides in place of rules: it gets the information of one robot and the servo commands that follow from its
/// rules, by hinge, and may change these commands.
///
/// It is called at the controller's rate for one robot after the other, always in the same order.
pub type Feedback<'a> = &'a mut dyn FnMut(&Sensed, &mut [Steer]) -> Result<()>;

/// The pose of a start in the arena.
fn arena_from_start([x, y, heading]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(x, y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
    )
}

impl Controller {
    /// A controller without sensors, rules and obstacles, for use with a [`Feedback`] callback alone; positions are those of the
    /// run itself.
    pub fn bare(rate_hz: f64) -> Self {
        let arena = Arena {
            name: String::new(),
            size_m: [0.0; 2],
            boundary: Boundary::Open,
            objects: Vec::new(),
            anchors: Vec::new(),
            start: Some([0.0; 3]),
            ground: Ground::default(),
        };
        Self {
            arena: Arc::new(arena),
            rate_hz,
            sensors: Vec::new(),
            rules: Vec::new(),
            name: OWN.to_owned(),
            others: Vec::new(),
            radio: None,
        }
    }
}

impl Experiment {
    /// Returns this experiment with a controller: the robot starts at the arena's start pose, and the arena's walls are added to
    /// the scene.
    ///
    /// # Errors
    /// Sensors, rules or other robots that do not fit the robot and the arena.
    pub fn with_controller(&self, controller: Controller) -> Result<Self> {
        controller.check(self)?;
        let mut experiment = self.clone();
        if !controller.arena.objects.is_empty() {
            let walls = SceneBody::of_arena(&controller.arena, true)?;
            experiment.scene.push(walls);
        }
        if !controller.arena.ground.is_plain() {
            experiment.ground = ground_of(&controller.arena, true)?;
        }
        experiment.controller = Some(Arc::new(controller));
        Ok(experiment)
    }
}
