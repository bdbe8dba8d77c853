//! Validation of a controller: by itself, and together with the robot that it controls.

use nalgebra::Isometry3;

use super::super::arena::world_from_robot;
use super::super::experiment::Experiment;
use super::super::kinematics::robot_from_part_at_zero;
use super::super::scene::SceneBody;
use super::mount::{mounting_pose, outline};
use super::{Controller, Steer, arena_from_start};
use realgap_core::error::{Error, Result};
use realgap_core::file::look_up;
use realgap_core::range::Range;
use realgap_sensing::arena::{Arena, Boundary, Ground, Object};

/// Largest number of sensors, and of robots in addition to the first.
const MOST: usize = 255;

impl Controller {
    /// Checks the properties that do not depend on the robot.
    ///
    /// # Errors
    /// A rate or time that is not positive, two sensors or robots of one name, a start that is not finite, outside, or in a wall.
    pub(super) fn check_alone(&self) -> Result<()> {
        Range::above(0.0, 1e6, "Hz").check(self.rate_hz, "rate_hz")?;
        if self.sensors.len() > MOST || self.others.len() > MOST {
            return Err(Error::invalid("too many sensors or robots")
                .field("sensors")
                .allowed(format!("at most {MOST} of each")));
        }
        unique("sensors", self.sensors.iter().map(|s| s.name.as_str()))?;
        let robots = std::iter::once(self.name.as_str());
        unique(
            "others",
            robots.chain(self.others.iter().map(|o| o.name.as_str())),
        )?;
        for (index, rule) in self.rules.iter().enumerate() {
            Range::within(0.0, 3600.0, "s").check(rule.for_s, &format!("rules[{index}].for_s"))?;
        }
        if self.arena.start.is_none() {
            return Err(Error::invalid("the start of the robot is missing")
                .field("start")
                .hint("add e.g. start: (x_m: 1.0, y_m: 1.0), here or in the arena's file"));
        }
        for (field, [x, y, heading]) in self.starts() {
            if !heading.is_finite() {
                return Err(Error::invalid("not a heading").field(field).found(heading));
            }
            let place = self.arena.check_place([x, y], 0.0);
            place.map_err(|e| e.field(field))?;
        }
        if let Some(radio) = &self.radio {
            Range::above(0.0, 1e6, "s").check(radio.every_s, "radio.every_s")?;
        }
        Ok(())
    }

    /// Checks that the controller fits the robot of an experiment.
    ///
    /// # Errors
    /// An error of the controller by itself; more than one decision per timestep, sensors on modules that the robot does not
    /// have, rules about hinges without a servo, a robot that starts in a wall or in another robot.
    pub(in super::super) fn check(&self, experiment: &Experiment) -> Result<()> {
        self.check_alone()?;
        let most_hz = 1.0 / experiment.solver.timestep_s;
        Range::above(0.0, most_hz, "Hz")
            .check(self.rate_hz, "rate_hz")
            .map_err(|e| e.hint("at most once a timestep"))?;
        for mounted in &self.sensors {
            mounting_pose(&experiment.assembly, mounted)?;
        }
        self.by_hinge(experiment)?;
        self.check_starts(experiment)
    }

    /// The servo actions of each rule, by index of the hinge.
    ///
    /// # Errors
    /// A rule about a hinge without a servo.
    pub(super) fn by_hinge(&self, experiment: &Experiment) -> Result<Vec<Vec<(usize, Steer)>>> {
        let of_rule = |index: usize, then: &[(String, Steer)]| {
            let found = then.iter().enumerate().map(|(nth, (name, steer))| {
                let hinges = experiment.assembly.hinges.iter().enumerate();
                let driven = hinges.filter(|(_, hinge)| hinge.actuator.is_some());
                look_up("servo", name, driven, |(_, hinge)| hinge.name.as_str())
                    .map(|(hinge, _)| (hinge, *steer))
                    .map_err(|e| e.field(format!("rules[{index}].then[{nth}].actuator")))
            });
            found.collect::<Result<Vec<_>>>()
        };
        let rules = self.rules.iter().enumerate();
        rules
            .map(|(index, rule)| of_rule(index, &rule.then))
            .collect()
    }

    /// The start of every robot, the controller's own robot first: the name of the field that states it, and x, y and heading.
    fn starts(&self) -> Vec<(String, [f64; 3])> {
        let own = self.arena.start.map(|start| ("start".to_owned(), start));
        let others = self.others.iter().enumerate();
        let others = others.map(|(index, other)| (format!("others[{index}]"), other.start));
        own.into_iter().chain(others).collect()
    }

    /// Outlines of all robots from above at their starts, with joints at zero, in arena coordinates; the experiment's own robot
    /// is the first.
    pub fn plans(&self, experiment: &Experiment) -> Vec<Vec<Object>> {
        let assembly = &experiment.assembly;
        let at_start = |(_, start): (String, [f64; 3])| {
            let arena_from_robot = arena_from_start(start) * world_from_robot(experiment);
            let parts = 0..assembly.parts.len();
            let poses: Vec<Isometry3<f64>> = parts
                .map(|part| arena_from_robot * robot_from_part_at_zero(assembly, part))
                .collect();
            outline(assembly, &poses)
        };
        self.starts().into_iter().map(at_start).collect()
    }

    /// Checks that no robot starts in a wall or in another robot.
    fn check_starts(&self, experiment: &Experiment) -> Result<()> {
        let plans = self.plans(experiment);
        for (robot, (field, start)) in self.starts().into_iter().enumerate() {
            let before = plans[..robot].concat();
            for (what, objects) in [("a wall", &self.arena.objects), ("another robot", &before)] {
                if objects.is_empty() {
                    continue;
                }
                let arena = Arena {
                    name: String::new(),
                    size_m: self.arena.size_m,
                    boundary: Boundary::Open,
                    objects: objects.clone(),
                    anchors: Vec::new(),
                    start: Some(start),
                    ground: Ground::default(),
                };
                SceneBody::of_arena(&arena, true)?
                    .check_clear_of(what, experiment)
                    .map_err(|e| e.field(&field))?;
            }
        }
        Ok(())
    }
}

fn unique<'a>(field: &str, names: impl Iterator<Item = &'a str>) -> Result<()> {
    let mut known: Vec<&str> = Vec::new();
    for name in names {
        if name.is_empty() || known.contains(&name) {
            return Err(Error::invalid("names must be unique and not empty")
                .field(field)
                .found(format!("`{name}`")));
        }
        known.push(name);
    }
    Ok(())
}
