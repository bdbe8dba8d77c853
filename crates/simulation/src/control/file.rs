//! The RON form of a controller.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::super::experiment::Experiment;
use super::{Condition, Controller, Mounted, Other, Radio, Reads, Rule, Steer};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, look_up, parse_ron};
use realgap_core::range::Range;
use realgap_robot::morphology::Gait;
use realgap_sensing::arena::{Arena, StartFile};
use realgap_sensing::graph::Sensorgraph;
use realgap_sensing::radio::{RadioModel, ServiceOptions};
use realgap_sensing::range::find_sensor;

/// A controller as its file states it: sensors, rules, radio messages and other robots.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Controller")]
pub struct ControllerFile {
    /// The arena's file, relative to this one.
    arena: PathBuf,
    /// Start of the robot in the arena; by default the start that the arena's file states.
    #[serde(default)]
    start: Option<StartFile>,
    /// Rate at which the robot reads its sensors and decides, Hz.
    rate_hz: f64,
    /// Name of the robot, by which other robots refer to it.
    #[serde(default = "default_name")]
    name: String,
    /// The sensors of the robot.
    #[serde(default)]
    sensors: Vec<SensorFile>,
    /// The rules of the robot: the first rule whose condition holds is followed; if none holds, the robot follows its own gait.
    #[serde(default)]
    rules: Vec<RuleFile>,
    /// Other robots of the same kind, each with the same sensors and rules.
    #[serde(default)]
    others: Vec<OtherFile>,
    /// The radio by which the robots send each other their positions.
    #[serde(default)]
    radio: Option<RadioFile>,
}

fn default_name() -> String {
    super::OWN.to_owned()
}

/// A sensor on a robot. It measures along its x axis.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Sensor")]
struct SensorFile {
    /// Unique name.
    name: String,
    /// The mark, module or body to which the sensor is fixed.
    on: String,
    /// Position relative to the carrier's centre, along the carrier's axes, metres.
    #[serde(default)]
    at_m: (f64, f64, f64),
    /// Rotation about the carrier's z axis, degrees.
    #[serde(default)]
    turn_deg: f64,
    /// A range sensor: the file of a model, relative to this file, or the name of a built-in model.
    #[serde(default)]
    model: Option<String>,
    /// A scanner instead of a range sensor: the file of a fitted sensorgraph, relative to this file.
    #[serde(default)]
    graph: Option<PathBuf>,
    /// Index of the segment of the scan, from 0.
    #[serde(default)]
    segment: usize,
}

/// A rule.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Rule")]
struct RuleFile {
    /// Condition of the rule.
    when: WhenFile,
    /// Time for which the rule is followed once its condition holds, seconds; 0 means until the next decision.
    #[serde(default)]
    for_s: f64,
    /// Actions of the servos; servos that are not named continue with their gaits.
    then: Vec<ThenFile>,
}

/// A condition: a sensor with one of `below_m`, `above_m` and `silent`, or a message from another robot.
#[derive(Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "When")]
struct WhenFile {
    /// The sensor's name.
    #[serde(default)]
    sensor: Option<String>,
    /// The sensor measures a distance below this, metres.
    #[serde(default)]
    below_m: Option<f64>,
    /// The sensor measures a distance above this, metres.
    #[serde(default)]
    above_m: Option<f64>,
    /// The sensor returns no reading.
    #[serde(default)]
    silent: bool,
    /// The robot whose last message is evaluated, or `any`.
    #[serde(default)]
    heard: Option<String>,
    /// The position in the message is nearer than this, metres.
    #[serde(default)]
    within_m: Option<f64>,
}

/// Action of one servo: one of `gait` and `hold`.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Then")]
struct ThenFile {
    /// Name of the actuated joint.
    actuator: String,
    /// Another gait; its time is that of the run.
    #[serde(default)]
    gait: Option<Gait>,
    /// A constant command: an angle in radians, or a torque in N m for the law `Direct`.
    #[serde(default)]
    hold: Option<f64>,
}

/// Another robot of the same kind.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Other")]
struct OtherFile {
    /// Unique name.
    name: String,
    /// Start position along the arena's x axis, metres.
    x_m: f64,
    /// Start position along the arena's y axis, metres.
    y_m: f64,
    /// Start heading, measured counter-clockwise from the x axis, degrees.
    #[serde(default)]
    heading_deg: f64,
}

/// The radio by which robots send each other their positions.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Messages")]
struct RadioFile {
    /// The radio model's file, relative to this file; messages weaker than its sensitivity do not arrive.
    model: PathBuf,
    /// Time from one message to the next, seconds.
    every_s: f64,
    /// Mean time from sending to arriving, seconds.
    #[serde(default)]
    latency_s: f64,
    /// Standard deviation of that time, seconds.
    #[serde(default)]
    latency_sd_s: f64,
    /// Received strength above the sensitivity at which half of the messages are lost, dB.
    #[serde(default)]
    loss_half_db: f64,
    /// Range of strength over which the loss falls from 73 % to 27 %, dB; 0 for a sharp threshold.
    #[serde(default)]
    loss_width_db: f64,
}

impl Controller {
    /// Reads a controller for the robot of an experiment, with its arena and models.
    ///
    /// # Errors
    /// As [`Controller::parse`]; a sensor, rule or start that does not fit the robot.
    pub fn read(path: impl AsRef<Path>, experiment: &Experiment) -> Result<Self> {
        let source = Source::read(path, "controller")?;
        let controller = Self::parse(&source)?;
        controller
            .check(experiment)
            .map_err(|error| source.at_field(error))?;
        Ok(controller)
    }

    /// Parses a controller with its arena and models; whether it fits a robot is not checked.
    ///
    /// # Errors
    /// Missing or malformed files; duplicate names, rules about unknown sensors or robots, a start in a wall.
    pub fn parse(source: &Source) -> Result<Self> {
        let file: ControllerFile = parse_ron(source)?;
        let folder = source.path().parent().unwrap_or(Path::new(""));
        let found = file.in_folder(folder).and_then(|controller| {
            controller.check_alone()?;
            Ok(controller)
        });
        found.map_err(|error| match error.file() {
            Some(_) => error,
            None => source.at_field(error),
        })
    }
}

impl ControllerFile {
    fn in_folder(self, folder: &Path) -> Result<Controller> {
        let mut arena = Arena::parse(&Source::read(folder.join(&self.arena), "arena")?)?;
        arena.start = self.start.map(StartFile::pose).or(arena.start);
        let sensors = self
            .sensors
            .into_iter()
            .map(|sensor| sensor.mounted(folder));
        let sensors = sensors.collect::<Result<Vec<Mounted>>>()?;
        let robots: Vec<&str> = std::iter::once(self.name.as_str())
            .chain(self.others.iter().map(|other| other.name.as_str()))
            .collect();
        let rules = self.rules.into_iter().enumerate().map(|(index, rule)| {
            let rule = rule.checked(&sensors, &robots);
            rule.map_err(|e| e.within(&format!("rules[{index}]")))
        });
        let rules = rules.collect::<Result<Vec<Rule>>>()?;
        let others = self.others.iter().map(|other| Other {
            name: other.name.clone(),
            start: [other.x_m, other.y_m, other.heading_deg.to_radians()],
        });
        let radio = match self.radio {
            Some(radio) => Some(Radio {
                model: Arc::new(RadioModel::read(folder.join(&radio.model))?),
                every_s: radio.every_s,
                service: ServiceOptions {
                    latency_s: radio.latency_s,
                    latency_sd_s: radio.latency_sd_s,
                    loss_half_db: radio.loss_half_db,
                    loss_width_db: radio.loss_width_db,
                    ..ServiceOptions::default()
                },
            }),
            None => None,
        };
        Ok(Controller {
            others: others.collect(),
            arena: Arc::new(arena),
            rate_hz: self.rate_hz,
            name: self.name,
            sensors,
            rules,
            radio,
        })
    }
}

impl SensorFile {
    fn mounted(self, folder: &Path) -> Result<Mounted> {
        let field = format!("sensors.{}", self.name);
        let reads = match (&self.model, &self.graph) {
            (Some(model), None) => {
                let model = match model.ends_with(".ron") {
                    true => find_sensor(&folder.join(model).to_string_lossy()),
                    false => find_sensor(model).map_err(|e| e.field(format!("{field}.model"))),
                };
                Reads::Range(Arc::new(model?))
            }
            (None, Some(graph)) => {
                let graph = Sensorgraph::read(folder.join(graph))?;
                if self.segment >= graph.segments_deg.len() {
                    return Err(Error::invalid("the scanner has no such segment")
                        .field(format!("{field}.segment"))
                        .found(self.segment)
                        .allowed(format!("0 to {}", graph.segments_deg.len() - 1)));
                }
                Reads::Scan {
                    graph: Arc::new(graph),
                    segment: self.segment,
                }
            }
            _ => {
                return Err(Error::invalid("a sensor is a range sensor or a scanner")
                    .field(field)
                    .allowed("one of `model` and `graph`"));
            }
        };
        Ok(Mounted {
            name: self.name,
            on: self.on,
            at_m: [self.at_m.0, self.at_m.1, self.at_m.2].into(),
            turn_rad: self.turn_deg.to_radians(),
            reads,
        })
    }
}

impl RuleFile {
    fn checked(self, sensors: &[Mounted], robots: &[&str]) -> Result<Rule> {
        let then = self.then.into_iter().map(ThenFile::steer);
        Ok(Rule {
            when: self
                .when
                .condition(sensors, robots)
                .map_err(|e| e.within("when"))?,
            for_s: self.for_s,
            then: then.collect::<Result<_>>()?,
        })
    }
}

/// Index of a name in a list; an unknown name is an error.
fn index(what: &str, name: &str, names: &[&str]) -> Result<usize> {
    look_up(what, name, names.iter().enumerate(), |(_, known)| *known).map(|(index, _)| index)
}

impl WhenFile {
    fn condition(&self, sensors: &[Mounted], robots: &[&str]) -> Result<Condition> {
        let names: Vec<&str> = sensors.iter().map(|s| s.name.as_str()).collect();
        let distance = |field: &str, distance_m: f64| {
            Range::above(0.0, 1e6, "m")
                .check(distance_m, field)
                .map(|()| distance_m)
        };
        let asked = (
            &self.sensor,
            &self.heard,
            self.below_m,
            self.above_m,
            self.silent,
            self.within_m,
        );
        match asked {
            (Some(sensor), None, below, above, silent, None) => {
                let sensor = index("sensor", sensor, &names).map_err(|e| e.field("sensor"))?;
                match (below, above, silent) {
                    (Some(d), None, false) => Ok(Condition::Below {
                        sensor,
                        distance_m: distance("below_m", d)?,
                    }),
                    (None, Some(d), false) => Ok(Condition::Above {
                        sensor,
                        distance_m: distance("above_m", d)?,
                    }),
                    (None, None, true) => Ok(Condition::Silent { sensor }),
                    _ => Err(Error::invalid("a condition on a sensor has exactly one test")
                        .allowed("one of below_m, above_m and silent: true")),
                }
            }
            (None, Some(from), None, None, false, Some(within_m)) => Ok(Condition::Heard {
                from: match from.as_str() {
                    "any" => None,
                    name => Some(index("robot", name, robots).map_err(|e| e.field("heard"))?),
                },
                within_m: distance("within_m", within_m)?,
            }),
            (None, None, None, None, false, None) => Ok(Condition::Always),
            _ => Err(Error::invalid("a rule has one condition").allowed(
                "sensor with one of below_m, above_m and silent, or heard with within_m, or nothing for always",
            )),
        }
    }
}

impl ThenFile {
    fn steer(self) -> Result<(String, Steer)> {
        let steer = match (self.gait, self.hold) {
            (Some(gait), None) => Steer::Gait(gait),
            (None, Some(value)) => Steer::Hold(value),
            _ => {
                return Err(Error::invalid("a servo does one thing")
                    .field("then")
                    .found(&self.actuator)
                    .allowed("one of gait and hold"));
            }
        };
        let numbers = match steer {
            Steer::Gait(gait) => {
                vec![
                    gait.offset_rad,
                    gait.amplitude_rad,
                    gait.frequency_hz,
                    gait.phase_rad,
                ]
            }
            Steer::Hold(value) => vec![value],
            Steer::Own => Vec::new(),
        };
        if numbers.iter().any(|v| !v.is_finite()) {
            return Err(Error::invalid("not a finite number")
                .field("then")
                .found(&self.actuator));
        }
        Ok((self.actuator, steer))
    }
}
