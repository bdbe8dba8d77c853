//! Sensors, rules and radio of a robot in an engine's hands, and others of its kind around it.
//!
//! An [`Experiment`](super::Experiment) with a [`Controller`] runs with feedback: at a fixed rate every robot reads its sensors at
//! the poses of that moment, hears what was sent to it, and changes what its servos do until the next time. Each robot is simulated in a world of
//! its own, in step with the others: they see and hear one another, and do not touch.

mod check;
mod file;
mod mount;
mod robot_group;
mod rule;

use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::experiment::Experiment;
use super::scene::SceneBody;
use realgap_core::error::Result;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Gait;
use realgap_sensing::arena::{Arena, Boundary};
use realgap_sensing::graph::Sensorgraph;
use realgap_sensing::radio::{RadioModel, ServiceOptions};
use realgap_sensing::range::RangeModel;

#[cfg(feature = "schema")]
pub use file::ControllerFile;
pub(super) use robot_group::steered;
pub use rule::{Condition, Rule};

/// What a robot is called that has no name.
const OWN: &str = "robot";

/// What a robot reads, hears and does about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// Where it is.
    pub arena: Arc<Arena>,
    /// How often it reads and decides, Hz.
    pub rate_hz: f64,
    /// Its sensors.
    pub sensors: Vec<Mounted>,
    /// What it does about them: the first rule whose condition holds.
    pub rules: Vec<Rule>,
    /// Its name for the others.
    pub name: String,
    /// Others of its kind, each with the same controller.
    pub others: Vec<Other>,
    /// What they tell each other with.
    pub radio: Option<Radio>,
}

/// A sensor on a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounted {
    /// Its name.
    pub name: String,
    /// The mark, module or body that carries it.
    pub on: String,
    /// Its place from there, metres, and how it is turned about the carrier's z axis, radians. It looks along its x axis.
    pub at_m: Vector3<f64>,
    /// Turn about the carrier's z axis, radians.
    pub turn_rad: f64,
    /// What it reads.
    pub reads: Reads,
}

/// What a sensor reads.
#[derive(Debug, Clone, PartialEq)]
pub enum Reads {
    /// The distance to what is ahead.
    Range(Arc<RangeModel>),
    /// What a scanner's segment reads at its place, by a fitted sensorgraph in the arena's coordinates.
    Scan {
        /// The sensorgraph.
        graph: Arc<Sensorgraph>,
        /// Which segment, from 0.
        segment: usize,
    },
}

/// Another robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Other {
    /// Its name.
    pub name: String,
    /// Where it begins: x and y in the arena, metres, and the heading, radians.
    pub start: [f64; 3],
}

/// Messages: every robot says where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Radio {
    /// How strength falls.
    pub model: Arc<RadioModel>,
    /// Time from one message to the next, seconds.
    pub every_s: f64,
    /// How messages travel; seed and noise are those of the run.
    pub service: ServiceOptions,
}

/// A message that arrived.
#[derive(Debug, Clone, PartialEq)]
pub struct Heard {
    /// Who sent it, by its number in the group.
    pub from: usize,
    /// Where it was then, in the arena, metres.
    pub position_m: [f64; 3],
    /// When it was sent, seconds.
    pub sent_s: f64,
    /// When it arrived.
    pub arrived_s: f64,
    /// How strong, dBm.
    pub strength_dbm: f64,
}

/// What one robot knows when it decides.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// Which robot of the group: 0 is the experiment's own.
    pub robot: usize,
    /// Time, seconds.
    pub time_s: f64,
    /// Where its tracked module is, in the arena: x, y and height, metres.
    pub position_m: [f64; 3],
    /// What each sensor read, in its own unit; `None` where nothing came.
    pub readings: Vec<Option<f64>>,
    /// Angle of each hinge now, by its encoder, radians.
    pub angles_rad: Vec<f64>,
    /// The last message of every robot that it heard, by number.
    pub heard: Vec<Heard>,
}

/// What one servo does until the next decision.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Steer {
    /// Its own gait or commands.
    #[default]
    Own,
    /// Another gait, whose time is the run's.
    Gait(Gait),
    /// A constant: an angle in radians, for the law `Direct` a torque in N m.
    Hold(f64),
}

/// What was decided, once a decision of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// What it knew.
    pub sensed: Sensed,
    /// The rule that it followed, from 0.
    pub rule: Option<usize>,
}

/// What a run with feedback left beside the path of its robot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// The other robots' tracked modules, in the frame of the experiment's own run, by name.
    pub others: Vec<(String, Trajectory)>,
    /// Every decision, in order of time and of the robots.
    pub decisions: Vec<Decision>,
}

impl Log {
    /// A table with a row a decision: time, robot, place, every sensor's reading (empty where nothing came), the rule that was followed
    /// (from 1, 0 for none), and for every robot that was heard where it was and how strong.
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

/// Decides in place of rules: gets what one robot knows and what its servos would do by its rules, by hinge, and may change that.
///
/// It is called for robot after robot at the controller's rate, always in the same order.
pub type Feedback<'a> = &'a mut dyn FnMut(&Sensed, &mut [Steer]) -> Result<()>;

/// The pose of a start in the arena.
fn arena_from_start([x, y, heading]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(x, y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
    )
}

impl Controller {
    /// One for a function alone: nothing stands around the robot, and places are those of the run itself.
    pub fn bare(rate_hz: f64) -> Self {
        let arena = Arena {
            name: String::new(),
            size_m: [0.0; 2],
            boundary: Boundary::Open,
            objects: Vec::new(),
            anchors: Vec::new(),
            start: Some([0.0; 3]),
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
    /// Puts the robot where the controller's arena says that robots start, among its walls, with this controller.
    ///
    /// # Errors
    /// Sensors, rules or others that do not fit robot and arena.
    pub fn with_controller(&self, controller: Controller) -> Result<Self> {
        controller.check(self)?;
        let mut experiment = self.clone();
        if !controller.arena.objects.is_empty() {
            let walls = SceneBody::of_arena(&controller.arena, true)?;
            experiment.scene.push(walls);
        }
        experiment.controller = Some(Arc::new(controller));
        Ok(experiment)
    }
}
