//! The posture in which a robot starts: a keyframe of the file.

use super::super::note::Notes;
use super::element::Element;
use super::model::JointType;
use super::robot::Robot;
use crate::morphology::{Gait, ServoLaw};
use realgap_core::error::{Error, Result};

/// The keyframe that is taken where no other is asked for.
const USUAL: &str = "home";
/// The largest command that a servo holds.
const MOST: f64 = 1000.0;

impl Robot<'_> {
    /// Takes one keyframe as the start: the one that is asked for, else `home` or the only one.
    pub(super) fn keyframe(&mut self, asked: Option<&str>, notes: &mut Notes) -> Result<()> {
        let model = self.model;
        let keys: Vec<&Element> = (model.section("keyframe"))
            .filter(|key| key.tag == "key")
            .collect();
        let names: Vec<&str> = (keys.iter())
            .map(|key| key.get("name").unwrap_or("without a name"))
            .collect();
        let wanted = asked.unwrap_or(USUAL);
        let index = match (
            names.iter().position(|name| *name == wanted),
            asked,
            keys.len(),
        ) {
            (Some(index), ..) => index,
            (None, Some(asked), _) => {
                return Err(Error::invalid("the file has no keyframe of this name")
                    .at_file(self.source.path())
                    .found(asked)
                    .allowed(if names.is_empty() {
                        "none: it has no keyframes".to_owned()
                    } else {
                        names.join(", ")
                    }));
            }
            (None, None, 1) => 0,
            (None, None, 0) => return Ok(()),
            (None, None, _) => {
                notes.left_out(
                    None,
                    format!("{} postures (<keyframe>): {}", keys.len(), names.join(", ")),
                    "joints start at 0 now; choose one of them as the start when importing the robot",
                );
                return Ok(());
            }
        };
        let key = keys[index];
        let coordinates = key.list("qpos")?;
        if !coordinates.is_empty() {
            self.starts_at(key, &coordinates)?;
        }
        self.holds(key, &key.list("ctrl")?)?;
        let others = match names.len() {
            1 => String::new(),
            _ => format!(
                "; others are {}",
                names
                    .iter()
                    .filter(|name| **name != names[index])
                    .copied()
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
        };
        notes.assumed(
            None,
            format!("joints start in the posture of the keyframe {}{others}", names[index]),
            "another one may be chosen when importing the robot; the height of a root that is free is not taken: it stands on the floor",
        );
        Ok(())
    }

    /// Starts all joints at the coordinates of a keyframe.
    fn starts_at(&mut self, key: &Element, coordinates: &[f64]) -> Result<()> {
        let mut next = 0;
        for (id, body) in self.model.bodies.iter().enumerate() {
            for (index, joint) in body.joints.iter().enumerate() {
                let count = match joint.kind {
                    JointType::Hinge | JointType::Slide => 1,
                    JointType::Ball => 4,
                    JointType::Free => 7,
                };
                let Some(value) = coordinates.get(next) else {
                    return Err(key.error(
                        Error::invalid("a keyframe states too few coordinates")
                            .found(coordinates.len()),
                    ));
                };
                next += count;
                if count > 1 {
                    continue;
                }
                let own = joint
                    .name
                    .as_deref()
                    .and_then(|name| self.joint_names.get(name));
                let fallback = match body.joints.len() {
                    1 => format!("{}_joint", self.names[id]),
                    _ => format!("{}_joint{index}", self.names[id]),
                };
                let name = own.map_or(fallback, |(name, _)| name.clone());
                let mut joints = self.structure.joints.iter_mut();
                if let Some(joint_here) = joints.find(|known| known.name == name) {
                    let start = value - joint.reference;
                    joint_here.start = (start != 0.0).then_some(start);
                }
            }
        }
        Ok(())
    }

    /// Lets servos hold the commands of a keyframe, or the angles at which their joints start.
    fn holds(&mut self, key: &Element, commands: &[f64]) -> Result<()> {
        if !commands.is_empty() && commands.len() != self.drives.len() {
            return Err(key.error(
                Error::invalid("a keyframe states commands of another number of actuators")
                    .found(commands.len())
                    .allowed(self.drives.len()),
            ));
        }
        for driver in &mut self.structure.actuators {
            let drive = self.drives.iter().position(|drive| {
                let own = drive
                    .joint
                    .as_ref()
                    .and_then(|joint| self.joint_names.get(joint));
                own.is_some_and(|(name, _)| *name == driver.joint)
            });
            let command = drive.and_then(|index| commands.get(index));
            let scale = driver.command.unwrap_or_default();
            let mut joints = self.structure.joints.iter();
            let start = joints
                .find(|joint| joint.name == driver.joint)
                .and_then(|joint| joint.start);
            let held = match (driver.servo.law, command) {
                (_, Some(command)) => Some(scale.apply(*command)),
                (ServoLaw::Direct, None) => None,
                (_, None) => start,
            };
            if let Some(held) = held.filter(|held| *held != 0.0 && held.abs() <= MOST) {
                driver.gait = Some(Gait::hold(held));
            }
        }
        Ok(())
    }
}
