//! Import of URDF, the Unified Robot Description Format of ROS.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;
use roxmltree::Node;

use super::element::{XmlSource, child, children, words};
use super::note::Notes;
use super::urdf_link::{DENSITY_KG_M3, Reader, ball};
use super::{MOST_SHAPES, Options, refuse_count};
use crate::morphology::body::{Body, MAX_BODIES, Pose, Structure};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// Mass of each link of a robot that states neither masses nor shapes, kg.
const BALL_KG: f64 = 1.0;

/// Reads the robot under the root element.
pub(super) fn read(
    place: XmlSource<'_>,
    root: Node<'_, '_>,
    options: &Options,
    notes: &mut Notes,
    lines: &mut BTreeMap<String, usize>,
) -> Result<Structure> {
    let source = place.source;
    let shapes = root.descendants().filter(|node| {
        let tag = node.tag_name().name();
        tag == "collision" || tag == "visual"
    });
    let checks = [
        ("links", children(root, "link").count(), MAX_BODIES),
        ("joints", children(root, "joint").count(), MAX_BODIES),
        ("shapes", shapes.count(), MOST_SHAPES),
    ];
    for (what, found, most) in checks {
        refuse_count(what, found, most).map_err(|error| place.at(root, error))?;
    }
    let name = match root.attribute("name") {
        Some(name) => name.to_owned(),
        None => {
            let stem = source.path().file_stem().unwrap_or_default();
            notes.assumed(
                place.line(root),
                "the robot has no name: the name of the file is used",
                "add name=\"...\" to <robot>",
            );
            stem.to_string_lossy().into_owned()
        }
    };
    let has = |shape| children(root, "link").any(|link| child(link, shape).is_some());
    let collides = has("collision");
    if !collides {
        let found = match has("visual") {
            true => "no link has collision shapes: the visual shapes are used",
            false => "no link has shapes, neither collision nor visual ones",
        };
        notes.assumed(None, found, "add <collision> elements");
    }
    let reader = Reader {
        place,
        options,
        visuals_collide: !collides,
    };
    let mut robot = Robot {
        reader,
        structure: Structure {
            name,
            description: format!("read from {}", file_name(source)),
            ..Structure::default()
        },
        lines: BTreeMap::new(),
        joint_lines: Vec::new(),
        servos: 0,
        passive: 0,
    };
    robot.links(root, notes)?;
    robot.weigh(notes);
    robot.joints(root, notes)?;
    robot.roots(root, notes)?;
    robot.others(root, notes);
    let bodies = robot.structure.bodies.iter().enumerate();
    lines.extend(bodies.filter_map(|(index, body)| {
        Some((format!("bodies[{index}]"), *robot.lines.get(&body.name)?))
    }));
    let joints = robot.joint_lines.iter().enumerate();
    lines.extend(joints.map(|(index, line)| (format!("joints[{index}]"), *line)));
    Ok(robot.structure)
}

pub(super) fn file_name(source: &Source) -> String {
    let name = source.path().file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// A robot while it is being built from the file.
pub(super) struct Robot<'a> {
    pub reader: Reader<'a>,
    pub structure: Structure,
    /// Lines of the links in the file, by name.
    pub lines: BTreeMap<String, usize>,
    /// Lines of the joints in the file, in the order of the structure's joints.
    joint_lines: Vec<usize>,
    pub servos: usize,
    /// Number of moving joints that get no servo because the file states no effort above 0.
    pub passive: usize,
}

impl Robot<'_> {
    fn links(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        for link in children(root, "link") {
            let body = self.reader.body(link, notes)?;
            let line = self.reader.place.line(link).unwrap_or(0);
            if let Some(first) = self.lines.insert(body.name.clone(), line) {
                let error = Error::invalid("two links have the same name")
                    .found(format!("`{}`, also in line {first}", body.name));
                return Err(self.reader.place.at(link, error));
            }
            self.structure.bodies.push(body);
        }
        Ok(())
    }

    fn joints(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        let mut names = BTreeSet::new();
        for (index, node) in children(root, "joint").enumerate() {
            let name = match node.attribute("name") {
                Some(name) => name.to_owned(),
                None => format!("joint{index}"),
            };
            if !names.insert(name.clone()) {
                let error =
                    Error::invalid("two joints have the same name").found(format!("`{name}`"));
                return Err(self.reader.place.at(node, error));
            }
            self.joint(node, name, notes)?;
            let line = self.reader.place.line(node).unwrap_or(1);
            self.joint_lines.resize(self.structure.joints.len(), line);
        }
        if self.passive > 0 {
            notes.left_out(
                None,
                format!(
                    "servos of {} joints that state no effort above 0: these joints move freely",
                    self.passive
                ),
                "state an effort in their limits, or state `actuators`",
            );
        }
        if self.servos > 0 {
            let law = self.reader.options.law.words();
            notes.assumed(
                None,
                format!(
                    "the servos of {} joints: URDF states only their limits; each {law}, and holds 0 unless another command is stated",
                    self.servos
                ),
                "state control laws and gaits in `actuators`, or import the joints as passive",
            );
        }
        Ok(())
    }

    /// Assumes masses for a robot if none of its links states a mass.
    fn weigh(&mut self, notes: &mut Notes) {
        let bodies = &mut self.structure.bodies;
        if bodies.is_empty() || bodies.iter().any(|body| body.mass_kg > 0.0) {
            return;
        }
        let what = if bodies.iter().any(|body| body.volume_m3() > 0.0) {
            for body in bodies {
                body.mass_kg = DENSITY_KG_M3 * body.volume_m3();
            }
            format!(
                "no link has a mass: the masses are those of the shapes at {DENSITY_KG_M3} kg/m3"
            )
        } else {
            for body in bodies {
                body.mass_kg = BALL_KG;
                body.inertia_kg_m2 = Some(ball(BALL_KG));
            }
            format!(
                "no link has a mass, or a shape that could be read: each link is a ball of {BALL_KG} kg and {DENSITY_KG_M3} kg/m3"
            )
        };
        notes.assumed(
            None,
            what,
            "measure the links and state <inertial>: the motion depends on the masses",
        );
    }

    /// Removes the mimic relation of joints that mimic a joint without a servo, and of joints that mimic each other.
    fn leaders(&mut self, notes: &mut Notes) {
        let structure = &mut self.structure;
        let driven: BTreeSet<String> = structure
            .actuators
            .iter()
            .map(|d| d.joint.clone())
            .collect();
        for driver in &mut structure.actuators {
            if let Some(follow) = driver
                .follows
                .take_if(|follow| !driven.contains(&follow.joint))
            {
                let what = format!(
                    "the mimic relation of joint `{}` to `{}`, which has no servo",
                    driver.joint, follow.joint
                );
                notes.left_out(None, what, "state an effort in the limit of that joint");
            }
        }
        let leaders: BTreeMap<String, String> = (structure.actuators.iter())
            .filter_map(|d| Some((d.joint.clone(), d.follows.as_ref()?.joint.clone())))
            .collect();
        for driver in &mut structure.actuators {
            let mut leader = driver.follows.as_ref().map(|follow| &follow.joint);
            for _ in 0..leaders.len() {
                leader = leader.and_then(|joint| leaders.get(joint));
            }
            if leader.is_some() {
                let what = format!(
                    "the mimic relation of joint `{}`, which mimics a joint that mimics it",
                    driver.joint
                );
                notes.left_out(None, what, "remove the mimic element of one of the joints");
                driver.follows = None;
            }
        }
    }

    /// Finds the root of the tree, and decides whether the robot is mounted.
    fn roots(&mut self, root: Node<'_, '_>, notes: &mut Notes) -> Result<()> {
        self.leaders(notes);
        let only = self.one_root(root)?;
        self.all_reached(only)?;
        if only.name == "world" || self.reader.options.mounted {
            self.structure.mount = Some(Pose::of(&Isometry3::identity()));
        }
        Ok(())
    }

    /// The one body that is not the child of any joint.
    fn one_root(&self, root: Node<'_, '_>) -> Result<&Body> {
        let structure = &self.structure;
        if structure.bodies.is_empty() {
            return Err(self
                .reader
                .place
                .at(root, Error::invalid("a robot without links")));
        }
        let children: BTreeSet<&str> = structure.joints.iter().map(|j| j.child.as_str()).collect();
        let mut parents = BTreeMap::new();
        for joint in &structure.joints {
            if let Some(first) = parents.insert(joint.child.as_str(), &joint.name) {
                let line = self.lines.get(&joint.child).copied().unwrap_or(1);
                return Err(Error::invalid(format!(
                    "link `{}` is the child of two joints: a closed loop",
                    joint.child
                ))
                .at_file(self.reader.place.source.path())
                .at_line(line, 1)
                .found(format!("`{first}` and `{}`", joint.name))
                .allowed("every link is the child of at most one joint")
                .hint("open the loop: remove one of the two joints"));
            }
        }
        let roots: Vec<&Body> = structure
            .bodies
            .iter()
            .filter(|b| !children.contains(b.name.as_str()))
            .collect();
        let [only] = roots.as_slice() else {
            let names: Vec<String> = roots
                .iter()
                .take(8)
                .map(|body| {
                    let line = self.lines.get(&body.name).copied().unwrap_or(0);
                    format!("`{}` (line {line})", body.name)
                })
                .collect();
            let error = match roots.is_empty() {
                true => Error::invalid("the joints form a cycle").found("no link without a parent"),
                false => Error::invalid(
                    "a robot needs exactly one root: a link that is not a child",
                )
                .found(format!("{}: {}", roots.len(), names.join(", ")))
                .hint("connect the other links to it by joints, or put them into a separate file"),
            };
            return Err(self.reader.place.at(root, error));
        };
        Ok(only)
    }

    /// Refuses joints that cannot be reached from the root.
    fn all_reached(&self, only: &Body) -> Result<()> {
        let structure = &self.structure;
        let mut reached = BTreeSet::from([only.name.as_str()]);
        loop {
            let before = reached.len();
            let next = structure.joints.iter();
            let next = next.filter(|joint| reached.contains(joint.parent.as_str()));
            let next: Vec<&str> = next.map(|joint| joint.child.as_str()).collect();
            reached.extend(next);
            if reached.len() == before {
                break;
            }
        }
        let mut joints = structure.joints.iter().zip(&self.joint_lines);
        if let Some((joint, line)) =
            joints.find(|(joint, _)| !reached.contains(joint.child.as_str()))
        {
            return Err(Error::invalid("the joints form a cycle")
                .at_file(self.reader.place.source.path())
                .at_line(*line, 1)
                .found(format!(
                    "joint `{}` has the child `{}`, which is not connected to the root `{}`",
                    joint.name, joint.child, only.name
                ))
                .allowed("a tree: one root, and every other link a child of one parent"));
        }
        Ok(())
    }

    /// Adds one note for each kind of element or attribute that the import ignores.
    fn others(&self, root: Node<'_, '_>, notes: &mut Notes) {
        let mut seen: BTreeMap<String, (usize, Option<usize>)> = BTreeMap::new();
        let known = |parent: &str, tag: &str| match parent {
            "robot" => ["link", "joint", "material"].contains(&tag),
            "link" => ["inertial", "visual", "collision"].contains(&tag),
            "joint" => [
                "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
            ]
            .contains(&tag),
            _ => true,
        };
        let elements = root.descendants().filter(Node::is_element);
        for node in elements {
            let Some(parent) = node.parent_element() else {
                continue;
            };
            let (above, tag) = (parent.tag_name().name(), node.tag_name().name());
            let is_inside = parent == root || parent.parent_element() == Some(root);
            if is_inside && !known(above, tag) {
                let entry = seen.entry(format!("<{tag}> in <{above}>"));
                entry.or_insert((0, self.reader.place.line(node))).0 += 1;
            }
        }
        let lists = root.descendants().flat_map(|node| {
            let named = ["xyz", "rpy", "size", "scale"].into_iter();
            named.filter_map(move |name| Some((node, node.attribute(name)?)))
        });
        for (node, text) in lists {
            let count = words(text).count();
            let what = match count {
                0 => "an empty list is read as three zeros".to_owned(),
                _ if text.contains(',') || count > 3 => {
                    format!("the list {text:?} has commas or more than three numbers")
                }
                _ => continue,
            };
            let remedy = "write three numbers, separated by blanks";
            notes.changed(self.reader.place.line(node), what, remedy);
        }
        for node in root.descendants().filter(Node::is_element) {
            let tag = node.tag_name().name();
            let is_seen_only = node.ancestors().any(|above| above.has_tag_name("visual"));
            let Some(known) = attributes(tag).filter(|_| !is_seen_only) else {
                continue;
            };
            for attribute in node.attributes() {
                if !known.contains(&attribute.name()) {
                    let entry = seen.entry(format!("`{}` of <{tag}>", attribute.name()));
                    entry.or_insert((0, self.reader.place.line(node))).0 += 1;
                }
            }
        }
        for (what, (count, line)) in seen {
            notes.left_out(
                line,
                format!("{what} ({count})"),
                "add what you need of it to the RON file",
            );
        }
    }
}

/// Names of the attributes that the import reads of an element; `None` if it does not check the element's attributes.
fn attributes(tag: &str) -> Option<&'static [&'static str]> {
    Some(match tag {
        "origin" => &["xyz", "rpy", "quat_xyzw"],
        "mass" => &["value"],
        "inertia" => &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
        "axis" => &["xyz"],
        "limit" => &["lower", "upper", "effort", "velocity"],
        "dynamics" => &[
            "damping",
            "friction",
            "stiffness",
            "spring_stiffness",
            "spring_reference",
        ],
        "mimic" => &["joint", "multiplier", "offset"],
        "box" => &["size"],
        "sphere" => &["radius"],
        "cylinder" | "capsule" => &["radius", "length"],
        "mesh" => &["filename", "file", "scale"],
        _ => return None,
    })
}
