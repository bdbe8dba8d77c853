//! Notes on elements of an MJCF that the import ignores.

use std::collections::BTreeMap;

use super::super::note::Notes;
use super::model::JointType;
use super::robot::Robot;

/// Sections that are read, or that have no effect on the motion.
const KNOWN: [&str; 11] = [
    "compiler",
    "option",
    "size",
    "visual",
    "statistic",
    "default",
    "asset",
    "contact",
    "actuator",
    "equality",
    "keyframe",
];

/// Settings that `world.rs` reads.
const WORLDLY: [&str; 4] = ["gravity", "density", "viscosity", "wind"];

impl Robot<'_> {
    /// Adds one note for each kind of element that is ignored.
    pub(super) fn others(&self, notes: &mut Notes) {
        for equality in self.model.section("equality") {
            match equality.tag.as_str() {
                "connect" | "weld" => notes.doubt(None, "a closed loop (connect or weld) is left open", "the robot moves differently from MuJoCo's: remove one branch of the loop, or use another model"),
                _ => notes.left_out(
                    None,
                    "a coupling of joints or tendons (equality)",
                    "let one actuator follow the other: `follows`",
                ),
            }
        }
        let mut seen: BTreeMap<&str, (usize, Option<usize>)> = BTreeMap::new();
        for section in &self.model.sections {
            // Lines of included files are not those of the robot's file.
            let is_here = section.file.as_path() == self.source.path();
            let line = is_here.then_some(section.line);
            let tag = section.tag.as_str();
            let is_of_solver = |name: &String| !WORLDLY.contains(&name.as_str());
            if tag == "option" && section.attributes.keys().any(is_of_solver) {
                notes.left_out(
                    line,
                    "the solver's settings (<option>)",
                    "set realgap's own solver parameters in the study",
                );
            }
            if !KNOWN.contains(&tag) {
                seen.entry(tag).or_insert((0, line)).0 += section.children.len();
            }
        }
        let unknown = self.model.unknown.iter();
        let seen = seen
            .into_iter()
            .map(|(tag, (count, line))| (tag, count, line));
        for (tag, count, line) in
            seen.chain(unknown.map(|(tag, count)| (tag.as_str(), *count, None)))
        {
            notes.left_out(
                line,
                format!("<{tag}> ({count})"),
                "add what you need of it to the RON file",
            );
        }
        if !self.model.classes.is_empty() {
            let classes = self
                .model
                .classes
                .iter()
                .cloned()
                .collect::<Vec<_>>()
                .join(", ");
            notes.doubt(
                None,
                format!("default classes that the file does not define: {classes}"),
                "MuJoCo refuses this file: define them",
            );
        }
        self.of_joints(notes);
    }

    /// Notes on properties of joints that are ignored, one for each kind.
    fn of_joints(&self, notes: &mut Notes) {
        let mut unknown: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for (id, body) in self.model.bodies.iter().enumerate() {
            for joint in &body.joints {
                let name = joint
                    .name
                    .clone()
                    .unwrap_or_else(|| format!("of {}", self.names[id]));
                for what in &joint.unknown {
                    unknown.entry(what).or_default().push(name.clone());
                }
                let resists = joint.damping != 0.0 || joint.armature != 0.0 || joint.dry != 0.0;
                if joint.kind == JointType::Free && resists && self.free_root == Some(id) {
                    unknown
                        .entry("damping, armature or dry friction of the free joint")
                        .or_default()
                        .push(name);
                }
            }
        }
        for (what, joints) in unknown {
            notes.left_out(
                None,
                format!("{what}: joints {}", joints.join(", ")),
                "measure what it changes",
            );
        }
    }
}
